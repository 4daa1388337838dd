/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the segregation scheme (segregation.h). */
#ifndef LIBCORE_SEGREGATION_PRIVATE_H
#define LIBCORE_SEGREGATION_PRIVATE_H

#include "libcore/segregation/segregation.h"
#include "libcore/segregation/slab.h"

static const double SEGREGATION_ROUND = 1e-13; /* an excess beyond 0 or 1 up to this is round-off */

struct tridiagonal { /* below[0] is row 1's, above[0] row 0's; both have n - 1 numbers */
    double *below, *diagonal, *above, *right;
};
struct segregation {
    struct segregation_line line;
    struct segregation_scheme scheme;
    struct segregation_counts counts;
    double thinnest; /* width of the thinnest cell, m */
    double fastest;  /* largest |f|, m/s */
    bool resolved;   /* is the central flux monotone on all faces, at the last step's D? */
    double *room;    /* holds all arrays of double */
    double *width;   /* [n] */
    /* [n + 1] weight of the node above in a face's values; 1 / distance of the face's two nodes, 1/m */
    double *share, *nearness;
    double *diffusivity;       /* [n + 1] m^2/s, of this step where a law gives it */
    double *flux;              /* [n + 1] m/s, mean over the step; always 0 at the walls */
    double *upward, *downward; /* [n + 1] derivatives of the flux to phi' below and above the face; 0 at the walls */
    double *mean;              /* [n] P, at which the flux is taken */
    double *value, *slope;     /* [n] f P (1 - P), and its derivative to phi' */
    double *found;             /* [n] phi' of Crank-Nicolson */
    double *low, *low_flux;    /* [n], [n + 1] phi' of the monotone scheme */
    double *excess, *part;     /* [n + 1] Crank-Nicolson's flux - low_flux; share of it that is let through, 0 .. 1 */
    double *least, *most;      /* [n] bounds of phi' */
    double *before, *whole, *halves; /* [n] room of struct segregation_steps */
    bool *watched;                   /* [n] does the cell limit its faces? */
    struct tridiagonal matrix;
};

/* Fills the matrix: rows of phi' - phi + dt/width (flux_{i+1} - flux_i) = 0 about `found`, from s->flux, upward and
 * downward. */
void segregation_rows(struct segregation *s, double dt, const double *phi, const double *found);
/* Solves for the change of the unknowns, which stands in matrix.right (the matrix is destroyed); false: it is
 * singular. */
bool segregation_solve(struct segregation *s);
/* Sets found[n] to phi' of the same balance within bounds; before, s->flux and found are those of Crank-Nicolson's last
 * iterate. */
status segregation_bound(struct segregation *s, double dt, const double *phi, double *found);

/* A line or a lattice as segregation_steps.c sees it. `late` is 1/2 for a Crank-Nicolson step, 1 for implicit Euler. */
struct segregation_steps {
    void *of;
    status (*step)(void *of, double dt, double late, double *phi);
    long n;
    const struct slab *slab;         /* has the ranks that share the cells; NULL: one has all */
    const double *weight;            /* [n] weight of a cell in means; NULL: 1 */
    double *before, *whole, *halves; /* [n] room */
};
/* segregation_damped and segregation_adapt are what segregation_step (damped) and segregation_advance document. */
status segregation_damped(const struct segregation_steps *s, double dt, double *phi);
status segregation_adapt(const struct segregation_steps *s, double allowed, double *dt, double *next, long *rejected,
                         double *phi);

/* Is the central flux on a face not monotone? */
static inline bool segregation_coarse(const struct segregation *s, int face) {
    const double *f = s->line.speed;
    return larger(fabs(f[face - 1]), fabs(f[face])) > 2 * s->diffusivity[face] * s->nearness[face];
}

#endif
