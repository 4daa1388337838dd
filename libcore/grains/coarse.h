/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coarse graining: fields on equal cells from grains and their impacts (Goldhirsch, Granular Matter 12 (2010) 239;
 * Weinhart et al., Granular Matter 14 (2012) 289; docs/physics.md 10.4). A grain at x counts with the share w_i(x) in
 * cell i, sum w_i = 1:
 *
 *   rho = sum m w / V,  rho U = sum m u w / V,  T = sum m |u - U|^2 w / (dim rho V),  p = p_kin + p_coll,
 *   T_k = sum m (u_k - U_k)^2 w / (rho V): T is the mean of these,  p_kin = rho T,
 *   p_coll = 1/(dim V tau) sum over impacts in tau of impulse * branch * psi,
 *
 * V: volume of a cell (disks: area); branch: distance of the centres (to a wall: radius); psi: the mean of w along the
 * branch, from its ends and its middle by Simpson's rule, which has the first three moments of the whole branch right.
 * U is the cell's own mean velocity, so the mean flow adds to T only by its change across the kernel. Averages over
 * time are averages of the sums, so that U and T belong to all grains that were there. Because the shares of a grain
 * add up to 1, the fields have the mass, momentum and energy of the grains to round-off, and the impacts' impulse *
 * branch, for every kernel: a kernel is mirrored at walls and wrapped at periodic sides. T is summed as deviations from
 * a running mean (West, Comm. ACM 22 (1979) 532): a cold stream has T = 0, however fast. */
#ifndef LIBCORE_COARSE_H
#define LIBCORE_COARSE_H

#include "libcore/grains/grain_mesh.h"
#include "libcore/grains/grains.h"

enum coarse_kernel {
    COARSE_CELL,      /* w = 1 in the cell that holds x */
    COARSE_HEAVISIDE, /* equal for cells whose centres are nearer than width; where there is none, the cell of x */
    COARSE_GAUSSIAN   /* the integral of exp(-r^2/(2 width^2)) over the cell, cut at 3 width along each axis; its
                       * variance with the cell's is width^2 + h^2/12, and width -> 0 is COARSE_CELL */
};
struct coarse_grid {
    int dim, n[3];       /* cells along each axis; 1 for axes >= dim */
    double low[3], h[3]; /* m: lower corner, size of a cell */
    bool periodic[3];
    enum coarse_kernel kernel;
    double width;                    /* m, at most the longest side of the grid */
    double mass, diameter;           /* kg, m: of a grain */
    const struct grain_kinds *kinds; /* of a mixture: mass and diameter are those of its law; NULL: all are alike */
    /* Its cells are used and not those of the grid, which is a box around them; NULL: none. The kernels have other
     * shares then, see coarse.c. */
    const struct grain_mesh *mesh;
    bool rough; /* are spins and the whole stress of contacts summed, too? For coarse_rough, coarse_contact */
};
enum coarse_field {
    COARSE_RHO,
    COARSE_ALPHA,
    COARSE_U,
    COARSE_T,
    COARSE_P,
    COARSE_T_AXES,
    COARSE_P_AXES,
    COARSE_P_SHEAR,
    COARSE_SPIN,
    COARSE_FIELDS
};

struct coarse; /* the sums; it is a grain_observer of the impacts */
/* Fails with ERR_INPUT on a width that is not positive or too large, on a kernel of more than 2^24 cells, and
 * on another kernel than COARSE_CELL with a mesh and `rough`. */
status coarse_make(const struct coarse_grid *grid, struct coarse **out);
void coarse_free(struct coarse *c);
struct grain_observer *coarse_observer(struct coarse *c);

void coarse_clear(struct coarse *c); /* sets all sums to 0 */
/* Adds n grains at one moment, in the frame of the box (m, m/s), of a mixture with their kinds (else NULL). Grains with
 * x = NAN are not there. x may lie beyond the grid by less than the grid's size; it is mirrored or wrapped. */
void coarse_sample(struct coarse *c, int n, const double (*x)[3], const double (*u)[3], const uint8_t *kinds);
/* The same of rough grains with spins (1/s). */
void coarse_rough(struct coarse *c, int n, const double (*x)[3], const double (*u)[3], const double (*spin)[3]);
struct coarse_contact { /* of a grain at x: vector from the other grain's centre, or from the wall, and force on it */
    double x[3], branch[3], force[3]; /* m, m, N */
};
/* Adds n contacts at one moment, whose stress is force branch psi/V. */
void coarse_contacts(struct coarse *c, long n, const struct coarse_contact *contact);
/* Computes a field from the sums, with impacts observed for `tau` seconds (0: no p_coll). out[k]: [cells], axis 0
 * fastest, component k of U and of COARSE_T_AXES, which is T_k (else k = 0). Cells without grains have U = T = 0 and
 * p = p_coll. Of rough grains, with tau the number of samples: the components P_k along the axes and P_xy, P_xz, P_yz
 * of the whole pressure tensor, rho <u' u'> + sum of force branch psi/(V tau), and the mean spin (3 components). */
void coarse_value(const struct coarse *c, double tau, enum coarse_field f, double *const out[3]);
/* The same of one kind of a mixture: f is COARSE_ALPHA, COARSE_U or COARSE_T, about the mean velocity of that kind. */
void coarse_kind(const struct coarse *c, int kind, enum coarse_field f, double *const out[3]);
/* The sums for restarts: coarse_size doubles at coarse_sums. */
long coarse_size(const struct coarse *c);
double *coarse_sums(struct coarse *c);

#endif
