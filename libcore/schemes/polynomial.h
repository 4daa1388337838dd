/* Face values on polyhedra: a polynomial in each cell from the averages of its stencil. A table of ways to fit it.
 *
 * U(x) = average + sum_k a_k phi_k(x), phi_k = the monomials of degree 1 (and 2) of (x - c)/h less their means over the
 * cell, h = volume^(1/dim): the average stays. Fits are linear in the averages and their weights are made once;
 * limiters and nonlinear weights act on the coefficients, in the frame that moves with the cell. The variables are
 * those of a gas, (rho, rho u, E). Constants are reproduced to the last bit, and results depend neither on units nor on
 * the velocity of the observer: what is small is so against the cell's density, sqrt(2 eps), and internal energy. */
#ifndef LIBCORE_POLYNOMIAL_H
#define LIBCORE_POLYNOMIAL_H

#include "libcore/models/kernel.h"
#include "libcore/models/param.h"
#include "mesh/polyhedral/polyhedra.h"

enum { MAX_COEFFICIENT = 9 }; /* of a quadratic in 3D, without the constant */

struct fit;         /* weights, face points, and the values there of the last fit_cells */
struct polynomial { /* a way to fit */
    struct model model;
    int rings;  /* of the polyhedra (mesh/polyhedral/polyhedra.h) */
    int degree; /* 0, 1, 2 */
    /* Fits a batch of cells to the averages U[dim + 2][size], mirrors included; NULL: the averages are the values. */
    void (*cells)(struct fit *f, int batch, const double *const *U);
};
extern const struct polynomial polynomial_table[]; /* firstOrder, linear (limited), CWENO3 */
extern const int polynomial_count;
const struct polynomial *polynomial_find(const char *name); /* NULL: none */

/* The polyhedra must outlive the fit. unknown: [mirror.n] mirrors that nothing is fitted to; NULL: there are none. They
 * count for limits all the same. */
status fit_make(const struct polyhedra *m, const struct polynomial *p, const bool *unknown, struct fit **out);
void fit_free(struct fit *f);

/* Fits cells from <= i < to (< nnear): dim + 2 lines U[v][size]. Cells are fitted in batches: those that share a batch
 * with the first and the last one are fitted, too, from what U holds, and rightly once their own turn comes. */
void fit_cells(struct fit *f, int from, int to, const double *const *U);
/* Values at the face points from <= i < from + n, n <= BATCH, of the cells on side 0 (left) or 1 (right; not for
 * boundary faces): out[v][n]. */
void fit_points(const struct fit *f, int side, int from, int n, const double *const *U, double *const *out);

#endif
