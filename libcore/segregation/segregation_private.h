/* What the parts of the segregation scheme share. */
#ifndef LIBCORE_SEGREGATION_PRIVATE_H
#define LIBCORE_SEGREGATION_PRIVATE_H

#include "libcore/segregation/segregation.h"

static const double SEGREGATION_ROUND = 1e-13; /* beyond 0 and 1, this is no more than round-off */

struct tridiagonal { /* below and above: n - 1 each, row 1's and row 0's first */
    double *below, *diagonal, *above, *right;
};
struct segregation {
    struct segregation_line line;
    struct segregation_scheme scheme;
    struct segregation_counts counts;
    double thinnest;           /* cell's width */
    double *room;              /* holds all arrays of double */
    double *width;             /* [n] */
    double *share, *nearness;  /* [n + 1] weight of the node above in a face's values; 1 / distance of its nodes */
    double *diffusivity;       /* [n + 1] of this step */
    double *flux;              /* [n + 1] of a scheme, mean over the step; always 0 at the walls */
    double *upward, *downward; /* [n + 1] its derivatives to phi' below and above the face; 0 at the walls */
    double *mean;              /* [n] P, where the flux is taken */
    double *value, *slope;     /* [n] f P (1 - P) there, and its derivative to phi' */
    double *found;             /* [n] phi' of Crank-Nicolson */
    double *low, *low_flux;    /* [n], [n + 1] phi' of the monotone scheme */
    double *excess, *part;     /* [n + 1] Crank-Nicolson's flux - low_flux; what of it is let through, 0 .. 1 */
    double *least, *most;      /* [n] bounds */
    double *before, *whole, *halves; /* [n] of steps made of steps */
    bool *watched;                   /* [n] cells that limit their faces */
    struct tridiagonal matrix;
};

/* Rows of phi' - phi + dt/width (flux_{i+1} - flux_i) = 0 about `found`, from s->flux, upward and downward. */
void segregation_rows(struct segregation *s, double dt, const double *phi, const double *found);
/* The change of the unknowns, in matrix.right (matrix is destroyed). */
bool segregation_solve(struct segregation *s);
/* found[n] <- phi' of the same balance within bounds; s->flux and found are those of Crank-Nicolson's last iterate. */
status segregation_bound(struct segregation *s, double dt, const double *phi, double *found);

/* A line or a lattice as steps made of steps see it; late: 1/2 Crank-Nicolson, 1 implicit Euler. */
struct segregation_steps {
    void *of;
    status (*step)(void *of, double dt, double late, double *phi);
    long n;
    const double *weight;            /* [n] of a cell in means; NULL: 1 */
    double *before, *whole, *halves; /* [n] room */
};
status segregation_damped(const struct segregation_steps *s, double dt, double *phi);
status segregation_adapt(const struct segregation_steps *s, double allowed, double *dt, double *next, long *rejected,
                         double *phi);

/* A face on which a central flux is not monotone. */
static inline bool segregation_coarse(const struct segregation *s, int face) {
    const double *f = s->line.speed;
    return larger(fabs(f[face - 1]), fabs(f[face])) > 2 * s->diffusivity[face] * s->nearness[face];
}

#endif
