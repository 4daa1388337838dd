/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time schemes: a table of the coefficients of strong-stability-preserving Runge-Kutta schemes for both kinds of mesh
 * (stepper.c cites the papers), and local time steps on polyhedra. */
#ifndef LIBCORE_STEPPER_H
#define LIBCORE_STEPPER_H

#include "libcore/models/param.h"

struct stepper { /* stage s: U = a[s] U0 + (1 - a[s]) (U + b[s] dt L(U)) */
    struct model model;
    int stages;
    int exchange; /* after this many stages U0 and U become 0.1 U0 + 0.9 U and 0.6 U0 + 0.4 U; 0: never */
    bool local;   /* does each cell take steps of its own (libcore/polyhedral/cells_local.c)? Then there is one stage */
    double courant; /* largest maxCo allowed (the Euler step: 1) */
    double a[10], b[10];
};
extern const struct stepper stepper_table[];
extern const int stepper_count;
/* SSPRK43: of a step that `local`, or few stages beside a bed, would leave inadmissible */
extern const struct stepper *const stepper_instead;
const struct stepper *stepper_find(const char *name); /* NULL: none */
/* The scheme of a step with a bed, whose Courant number beside the bed is `courant` <= 1/2 (libcore/gas/dense.c):
 * `chosen`, or one of fewer stages that is stable there. Heun's lets waves grow by (nu k)^4/8 a step, of nu = c dt/h
 * and k a cell. damps: does the reconstruction take more from them at nu = 1/2? Those of five cells take nu k^6/60,
 * which leaves 1.04 nu^10 at most: below 0.4 that is Heun's method, too, else SSPRK3. */
const struct stepper *stepper_beside_bed(const struct stepper *chosen, bool damps, double courant);

/* Makes struct stepper's exchange for one number: U0 is `start` and becomes *next, U is *state. */
static inline void stepper_exchange(double start, double *next, double *state) {
    double s = *state;
    *next = start + 0.9 * (s - start);
    *state = start + 0.4 * (s - start);
}

#endif
