/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Face values on polyhedral meshes: a polynomial in each cell from the averages of its stencil, and a table of ways to
 * fit it (docs/physics.md 6.11).
 *
 * U(x) = average + sum_k a_k phi_k(x), where phi_k are the monomials of degree 1 (and 2) of (x - c)/h less their means
 * over the cell, h = volume^(1/dim): the average stays. Fits are linear in the averages and their weights are made
 * once; limiters and nonlinear weights act on the coefficients, in the frame that moves with the cell. The variables
 * are those of a gas, (rho, rho u, E). Constants are reproduced to the last bit. Results depend neither on units nor on
 * the velocity of the observer: thresholds are relative to the cell's density, sqrt(2 eps), and internal energy. */
#ifndef LIBCORE_POLYNOMIAL_H
#define LIBCORE_POLYNOMIAL_H

#include "libcore/models/kernel.h"
#include "libcore/models/param.h"
#include "mesh/polyhedral/polyhedra.h"

enum { MAX_COEFFICIENT = 9 }; /* coefficients of a quadratic in 3D, without the constant */

struct fit;         /* the weights, the face points, and the values there after the last fit_cells */
struct polynomial { /* a way to fit */
    struct model model;
    int rings;  /* rings of the stencils (polyhedra_make) */
    int degree; /* 0, 1, 2 */
    /* Fits a batch of cells to the averages U[components + 2][size], mirrors included; NULL: the averages are the
     * values. */
    void (*cells)(struct fit *f, int batch, const double *const *U);
};
extern const struct polynomial polynomial_table[]; /* firstOrder, linear (limited), CWENO3 */
extern const int polynomial_count;
const struct polynomial *polynomial_find(const char *name); /* NULL: none */

/* Makes the weights of a fit. The polyhedra must outlive it. unknown[mirror.n] marks mirrors that are left out of fits
 * (NULL: none is); they count for limits all the same. components: of u, no less than the mesh has axes. */
status fit_make(const struct polyhedra *m, const struct polynomial *p, int components, const bool *unknown,
                struct fit **out);
void fit_free(struct fit *f);

/* From now on fits are of the deviation U - w U*: U* is a state at rest, whose rho and E [size] are given, and w = near
 * [nnear], 0 .. 1, the share of each cell. fit_points then returns values without the change of U* within the cell. All
 * arrays are borrowed. Uniform cells (fit_watch) are no longer looked for. */
void fit_rest(struct fit *f, const double *rho, const double *E, const double *near);

/* From now on fits draw a polynomial towards the average of its cell, as a whole, until at all face points rho stays
 * between `least` and `most` and the internal energy above 0, each by the share KEPT of the average's distance. */
void fit_keep(struct fit *f, double least, double most);

/* From now on fits keep the values at the face points of a cell only as long as they are wanted, in little memory, when
 * they take turns: turn k < n fits cells up to cells[k], then reads the points of the faces up to faces[k] (of the
 * latter, no cell may be beyond the former). After the last turn the other cells are fitted and all other points
 * read. */
status fit_turns(struct fit *f, int n, const int *cells, const int *faces);

/* From now on fits note the cells whose stencils are uniform: all members, mirrors included, equal the cell. If `skip`,
 * batches of cells that fit_look finds to be so cost almost nothing. Not for fits of degree 0. */
status fit_watch(struct fit *f, bool skip);
/* Looks for uniform gas in the lines U, which fits see next: first in own cells and their mirrors, then (`all`) in
 * ghosts and the mirrors beyond them. Cells from ninner on are fitted after the latter alone. U NULL: finds none. */
void fit_look(struct fit *f, const double *const *U, bool all);
/* Returns [nnear]: 1 where the last fit of a cell found its stencil uniform; NULL: fits do not note it. */
const unsigned char *fit_uniform(const struct fit *f);
/* Returns [nnear]: 1 where fit_look has found the stencils of a cell and of those across its faces (of a ghost: its
 * own) uniform; it may miss some. NULL: it has found none. */
const unsigned char *fit_still(const struct fit *f);

/* From now on batches of cells that are all spared[nnear] are not fitted: their values, which are not to be read, are
 * averages. NULL: every batch is fitted. Borrowed. */
void fit_spare(struct fit *f, const unsigned char *spared);

/* Fits cells from <= i < to (< nnear) to the lines U[v][size] of the variables. Cells are fitted batch by batch: cells
 * that share a batch with the first or the last one are fitted, too, from whatever U holds, and again when their own
 * turn comes. */
void fit_cells(struct fit *f, int from, int to, const double *const *U);
/* From now on fit_due may be called. Fits must not take turns. */
status fit_hold(struct fit *f);
/* Fits the cells with due[nnear]; all others keep their values. */
void fit_due(struct fit *f, const bool *due, const double *const *U);
/* Copies values at n <= BATCH points, as fit_points does. */
void fit_faces(const struct fit *f, int side, int n, const int *point, const double *const *U, double *const *out);
/* Copies values at the face points from <= i < from + n, n <= BATCH, in the cells on side 0 (left) or 1 (right; not for
 * boundary faces), to out[v][n]. */
void fit_points(const struct fit *f, int side, int from, int n, const double *const *U, double *const *out);

#endif
