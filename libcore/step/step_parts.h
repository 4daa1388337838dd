/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A time step is a table of parts (libcore/step/step_parts.c). Each part that is active begins, in the order of the
 * table; then come the Runge-Kutta stages; then the parts end, in the reverse order, so that a step is symmetric in
 * time. Seconds are taken and changes are booked for each part by that loop. */
#ifndef LIBCORE_STEP_PARTS_H
#define LIBCORE_STEP_PARTS_H

#include "libcore/gas/gas_private.h"

struct attempt { /* at a step */
    double t, dt, maxCo;
    const struct stepper *stepper;
    const struct gas_speed *speed; /* of g->U, from which dt was chosen */
    bool guarded;                  /* is each stage looked at, and mended at once? */
    bool sources;                  /* are there any? */
    const struct state *now;       /* the state that the parts have made so far */
    long bad;                      /* its inadmissible cells on this rank */
    const struct state *U0;        /* the start of the stages; NULL: a part before them failed */
    bool hot;                      /* out: did sources heat the gas so much that dt is too long? */
    bool spoilt;                   /* has the limiter failed to mend a stage, of this attempt or one before? */
    bool at_once;                  /* does the last stage do the ending, tile by tile? */
    struct ending ending;
    struct source_plan last; /* of the ending: the second half of the sources */
};

struct stage_now { /* a Runge-Kutta stage from `from` to g->W, as the hook of engine.h */
    int number;
    bool is_last;
    const struct state *from;
    double a, dt;
    double part;  /* fraction of what it adds that reaches the end of the step */
    double share; /* fraction of dt that reaches the end of the step */
};

/* Each function returns whether the attempt goes on; all ranks return the same. NULL: the part does nothing then. */
struct part {
    const char *name;
    bool (*active)(const struct gas *g, const struct attempt *a); /* asked once an attempt */
    bool (*begin)(struct gas *g, struct attempt *a);              /* moves a->now to another state, or to itself */
    bool (*stage)(struct gas *g, struct attempt *a, const struct stage_now *s);
    bool (*end)(struct gas *g, struct attempt *a); /* acts on g->V */
    int cause;  /* enum gas_cause of what `end` changes; BOOKS_ITSELF: the part books its own changes */
    bool folds; /* can the last stage do its `end`, tile by tile (struct ending)? */
};
enum { BOOKS_ITSELF = -1 };
extern const struct part carried_part; /* which does its work when a step stands */

/* Adds seconds to those of a part: it did something outside of the loop. */
void parts_add_seconds(struct gas *g, const struct part *p, double seconds);
/* Tries the step from g->U to g->V; returns whether V is of use. */
bool parts_try(struct gas *g, struct attempt *a);

/* Returns the largest over the ranks of each rank's number. */
long any_rank(const struct gas *g, long mine);
/* Returns the largest rate of wave speeds (1/s), over all ranks, in g->U0, from which the stages start. */
double rate_of_start(struct gas *g);
static inline void swap_states(struct state *a, struct state *b) {
    const struct state c = *a;
    *a = *b;
    *b = c;
}

/* ---- stages (libcore/step/stages.c) ---- */

struct stage_now stages_next(const struct gas *g, const struct attempt *a, int number);
/* Moves the stage's result from W to V, where the next one starts, and a->U0 to the start of its two steps. */
void stages_pass(struct gas *g, struct attempt *a, int number);

/* ---- sources (libcore/step/sources.c) ---- */

/* Plans the sources, in a step with a bed without gravity, over the first half of the step or over the second half, in
 * which they act backwards. */
void sources_plan(const struct gas *g, const struct attempt *a, bool second, struct source_plan *out);
/* Lets gravity act over a half step on cells that fall freely, beside a bed or where stages do a local step: the first
 * time these are found. */
void sources_kick(struct gas *g, const struct attempt *a, bool second, const struct state *s);

#endif
