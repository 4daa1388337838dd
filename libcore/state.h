/* Inside of the gas: what gas.c, ghosts.c, stage.c and step.c share. */
#ifndef LIBCORE_STATE_H
#define LIBCORE_STATE_H

#include "libcore/gas.h"

enum { LEVEL_FIRST_ORDER = 1, LEVEL_RUSANOV = 2 }; /* of a cell's flag: how its faces are redone */

enum { SLACK = 16 }; /* doubles behind every block: the last line is read in whole vectors */

struct work { /* scratch of one tile, [size] each: stays in L2 through a stage */
    double *velocity[MAX_DIM], *eps, *p, *c, *gruneisen;
    double *flux[MAX_VAR];     /* nodal fluxes along the axis in turn */
    double *residual[MAX_VAR]; /* -div F */
};
struct gas {
    struct forest *forest;
    struct gas_models models;
    int dim, nvar, npatches;
    const struct patch_rules *rules; /* [npatches] */
    const struct reconstruct *first_order;
    double **U;      /* [ntiles] state, each [nvar][size] */
    double **U0;     /* after the first half of the sources: the start of the Runge-Kutta step */
    double **V, **W; /* stages */
    double **flag;   /* [ntiles] of [size]: 0, LEVEL_* (as numbers, to travel like a variable) */
    bool *flagged;   /* [ntiles] does the tile, or its ghost layer, hold a flag? */
    double *sums;    /* [ntiles] */
    struct work work;
    double fastest[MAX_DIM]; /* max |u_k| + c, from the last gas_speed */
    double limit;            /* rho < limit */
    struct gas_counts counts;
};

/* Rows: the runs of cells along axis 0 that a pass over a tile visits. margin: ghost cells to include on each active
 * axis, but no corners. Calls visit(context, offset, n) with n <= BATCH. */
typedef void row_visitor(void *context, long offset, int n);
void rows_visit(const struct forest *f, const struct tile *tile, int margin, row_visitor *visit, void *context);

/* U, and what follows from it, for n cells at `offset`: velocity, eps, p, c, gruneisen of the workspace. */
void primitives_of_row(const struct gas *g, double *const U, long offset, int n);

/* Ghost layers of one tile's sides that are patches. */
void ghosts_of_patches(const struct gas *g, int tile, double *U);

/* One stage of one tile: to = W + a (U0 - W), W = from + dt L(from); returns the number of cells that are not
 * admissible and raises their flags. */
int stage_of_tile(struct gas *g, int tile, const double *U0, const double *from, double *to, double a, double dt);

/* Is every cell of the row admissible? Returns how many are not; marks[i] (or NULL) is raised by 1 there. */
int row_inadmissible(const struct gas *g, const double *U, long offset, int n, double *marks);

#endif
