/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Strong-stability-preserving Runge-Kutta schemes for both kinds of mesh: a table of coefficients (stepper.c cites the
 * papers). */
#ifndef LIBCORE_STEPPER_H
#define LIBCORE_STEPPER_H

#include "libcore/models/param.h"

struct stepper { /* stage s: U = a[s] U0 + (1 - a[s]) (U + b[s] dt L(U)) */
    struct model model;
    int stages;
    int exchange;   /* after this many stages U0 and U become 0.1 U0 + 0.9 U and 0.6 U0 + 0.4 U; 0: never */
    double courant; /* largest maxCo allowed (the Euler step: 1) */
    double a[10], b[10];
};
extern const struct stepper stepper_table[];
extern const int stepper_count;
const struct stepper *stepper_find(const char *name); /* NULL: none */

/* Makes struct stepper's exchange for one number: U0 is `start` and becomes *next, U is *state. */
static inline void stepper_exchange(double start, double *next, double *state) {
    double s = *state;
    *next = start + 0.9 * (s - start);
    *state = start + 0.4 * (s - start);
}

#endif
