/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One problem with one scheme, watched: what came of it. */
#ifndef STRESS_RUN_H
#define STRESS_RUN_H

#include "tests/stress/problem.h"

struct scheme { /* of a lattice and of polyhedra */
    const char *flux, *reconstruct, *polynomial, *stepper;
    double courant;
};
struct run_options {
    int cap;         /* steps at most, times the patience of the problem */
    int most;        /* steps at most of any problem; 0: no such bound */
    double fraction; /* minDeltaTFraction */
    bool bare;       /* the engine as it is: nothing is checked but the last state */
    bool full;       /* uniform regions are computed, too */
    bool explicit;   /* sound limits dt everywhere */
    int restart;     /* a restart ahead of this step; 0: none */
    bool verbose;    /* a line per step */
    bool keep;       /* outcome has the last state */
    double solved;   /* error allowed in solutions of implicit diffusion; 0: the default */
    bool brief;      /* short runs (README.md): all but a few come to their end */
};
enum verdict { FINISHED, CAPPED, COLLAPSED, STATED, FAILED, VERDICTS };
enum conserved { MASS, MOMENTUM, ENERGY, CONSERVED };

struct outcome {
    enum verdict verdict;
    char why[400]; /* of COLLAPSED, STATED and FAILED */
    int steps, cells;
    int beds; /* steps that were planned with implicit acoustics; some may have been made without */
    struct gas_counts counts;
    bool left;      /* was it stopped at the bound of questions? */
    double end;     /* s: where the run was to end */
    double reached; /* share of that */
    double least;   /* dt taken over the Courant step, the smallest */
    double packed;  /* largest alpha / alpha_max at the end */
    double packed_at_first;
    double drift[CONSERVED];    /* of what was conserved, in units of its bound in watch.c; -1: not conserved here */
    double relative[CONSERVED]; /* the same over the sum of magnitudes: in the report */
    double rubbed;              /* the most energy that friction gave, over the largest that there was */
    double source;              /* worst difference of a source step from the exact one, in units of its bound */
    uint64_t checksum;          /* of the last state */
    uint64_t image;             /* on round lattices: the same in the mirror image */
    double *state;              /* [variables][cells] if it is to be kept; for free() */
    int variables;
};
/* A status is an error of the test itself: a mesh that cannot be made. */
status stress_run(const struct problem *p, const struct scheme *s, const struct run_options *o, const struct comm *c,
                  struct outcome *out);

/* Compares a problem, whose outcome is there, with the same one seen in all ways that hold for it. Fails by `out`. */
status views_compare(const struct problem *p, const struct scheme *scheme, const struct run_options *o,
                     const struct comm *c, struct outcome *out);

#endif
