/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An engine that calls another one and looks at every state that comes out: admissible? conserved? the source exact?
 * Its checks are written apart from those of libcore, in long double. */
#ifndef STRESS_WATCH_H
#define STRESS_WATCH_H

#include "libcore/gas/gas_private.h"

struct budget { /* sums over the domain of mass, momentum (around an axis: angular momentum), energy */
    long double now[MAX_VAR], start[MAX_VAR];
    long double gained[2][MAX_VAR];   /* by the two halves of the sources of the step in hand */
    long double weighed[10][MAX_VAR]; /* by gravity in its stages */
    long double gain[MAX_VAR];        /* by both in all steps that were accepted */
    /* Of mass, momentum, energy and angular momentum: */
    long double rounding[4];  /* what a step may lose: magnitudes, summed over stages */
    long double magnitude[4]; /* of the start */
    long double largest;      /* of energy, in any step */
};
struct watch {
    struct engine engine; /* first: struct gas points at it */
    const struct engine *inner;
    long bad;             /* inadmissible cells of the attempt in hand */
    double trial, source; /* struct outcome */
    long ends;            /* super steps of diffusion in the step in hand, of all its attempts */
    struct budget budget;
    long double *before; /* [cells][MAX_VAR] what a source step, or a step of Runge-Kutta, starts from */
    bool *falls;         /* [cells] does gravity act in the half steps, and not in the stages? */
    double lift;         /* J: what beds were lifted by so far */
    bool *flagged;       /* [cells] are its faces limited in the stage in hand? */
    int stage;           /* the one in hand */
    long double kick[2][MAX_DIM], impulse[MAX_DIM]; /* m/s: what gravity gives in both half steps; in all stages */
    char why[200];
};

/* Are the states of its stages no results, or are there none? Then it is looked at after each step. */
bool watch_by_steps(const struct gas *g);
/* Between gas_set and the first step; g's engine from now on is w's. */
status watch_start(struct watch *w, struct gas *g);
/* After every gas_step: false if a state of the accepted attempt was not admissible (see why). */
bool watch_step_finish(struct watch *w, struct gas *g);
void watch_free(struct watch *w);

/* Calls visit for each cell of this rank: its number here, volume, and values. */
typedef void watch_visitor(void *context, long cell, double volume, const double U[MAX_VAR]);
void watch_cells(const struct gas *g, const struct state *s, watch_visitor *visit, void *context);

#endif
