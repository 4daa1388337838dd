/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of diffusion on polyhedra: what libcore/polyhedral/cells_diffusion.c and cells_terms.c share. */
#ifndef LIBCORE_CELLS_DIFFUSER_H
#define LIBCORE_CELLS_DIFFUSER_H

#include "libcore/polyhedral/cells_gradient.h"

struct cells_diffuser {                  /* lines of [size], a batch longer, or of [faces] */
    double *sum[2][MAX_DIM];             /* S of the last stage, and of the one before */
    double *start[MAX_DIM];              /* q_0 */
    double *gradient[MAX_DIM * MAX_DIM]; /* dS_c/dx_k at k lines + c, lines: components of u, or 1 */
    double *cell[3];                     /* bulk, shear, heat */
    double *T;                           /* T at which the coefficients were taken */
    struct cells_walls wall;             /* what wall_shares says of the mirrors */
    bool slides;                         /* does gas slip along any wall that drags it? */
    bool lifts;                          /* is any wall.lift not 0? */
    double *cross;                       /* -cross d rho/dn times the area, left to right; NULL: no such term */
    double *alike, *keep;                /* of cells_find_keep, for the fluxes of heat; NULL where no r is not 0 */
    double *face[3];                     /* lambda, shear, heat times the area */
    double *inverse;                     /* 1/(n.e) */
    double *share;            /* fraction of the way from the left centre to the right one that lies before the face */
    double *oblique[MAX_DIM]; /* r = n - e/(n.e) */
    bool skewed;              /* is any r not 0? */
    struct cells_turn *turn;  /* NULL: the mesh is none of a body of revolution */
};
/* Bodies of revolution (libcore/polyhedral/cells_turn.c). */
status cells_turn_make(const struct gas *g, struct cells_turn **out);
void cells_turn_free(struct cells_turn *t);
/* Sets what faces and gradients see of S in cells from <= i < to, mirrors included: u_r/r, and the
 * angular velocity of a swirl instead of its line. S holds the swirl, of a mirror that at its face. */
void cells_turn_see(const struct gas *g, const struct cells_turn *t, int from, int to, double **S);
/* Sets u_r/r on n faces from `at` on, and where the stress around the axis on them goes; u: the line of u_r. */
void cells_turn_faces(const struct gas *g, struct cells_turn *t, int at, int n, const double *u, const double **around,
                      double **hoop);
/* Adds the force of the stress around the axis to line v of the residuals of n cells, if it is that of the radius.
 * Makes of line v the change by torques, if it is that of the swirl. */
void cells_turn_push(const struct gas *g, const struct cells_turn *t, int v, int at, int n, double *M);
/* Finds what cells_turn_rate needs, by the coefficients on the faces. */
void cells_turn_rates(const struct gas *g, struct cells_turn *t);
/* The sum over the faces of cell i that bounds its rate, which is `plane` without that stress. */
double cells_turn_rate(const struct cells_turn *t, int i, double plane);
/* How many times as fast the swirl of a rigid rotation is at the face of a mirror as in the cell before it. */
double cells_turn_out(const struct gas *g, const struct cells_turn *t, int mirror);

/* The coefficient of two ways one behind the other: `share` of the way with a, 1 - share with b. Two zeros give 0. */
ALWAYS_INLINE double harmonic(double share, double a, double b) {
    return a * b / (share * b + (1 - share) * a + 1e-300);
}

/* The heat flux -cross grad rho (libcore/polyhedral/cells_terms.c): its memory; the coefficients of cells to
 * d->start[0], at d->T; from these d->cross, and what it changes of conduction at walls; zeros on the faces of flagged
 * cells. */
status cells_cross_make(struct gas *g, struct cells_diffuser *d);
void cells_cross_coefficients(struct gas *g, const double *rho);
void cells_cross_faces(struct gas *g, const double *rho);
void cells_cross_drop(struct gas *g);

#endif
