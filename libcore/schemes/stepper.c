#include "libcore/schemes/stepper.h"

#include <stddef.h>
#include <string.h>

#define ALL(x)                                                                                                         \
    { x, x, x, x, x, x, x, x, x, x }

/* a, b: struct stepper. Ketcheson's two registers are the state and the start, which the fifth stage exchanges for
 * 0.1 start + 0.9 state, the state becoming 0.6 start + 0.4 state: all are convex, so admissible. The theory allows it
 * maxCo 6, but there fifth-order reconstructions no longer converge (postprocessing/reports/workPrecision.md).
 * The limiter's theorem wants a Courant number of 1/2 of every Euler step (libcore/schemes/limit.h): maxCo up to 0.5 /
 * max(b). Above that steps may be rejected where something was limited. */
const struct stepper stepper_table[] = {
    {"SSPRK3",
     "three stages, third order, maxCo up to 1; admissible by theorem to 0.5 (Shu & Osher 1988)",
     3,
     0,
     1,
     {0, 3. / 4, 1. / 3},
     ALL(1)},
    {"SSPRK43",
     "four stages, third order, maxCo up to 2; admissible by theorem to 1 (Spiteri & Ruuth 2002)",
     4,
     0,
     2,
     {0, 0, 2. / 3},
     ALL(0.5)},
    {"SSPRK104",
     "ten stages, fourth order, maxCo up to 3; admissible by theorem to 3 (Ketcheson 2008)",
     10,
     5,
     3,
     {[9] = 0.4},
     ALL(1. / 6)},
    {"SSPRK2",
     "two stages, second order, maxCo up to 1; admissible by theorem to 0.5 (Heun)",
     2,
     0,
     1,
     {0, 1. / 2},
     ALL(1)},
    {"Euler", "one stage, first order, maxCo up to 1; admissible by theorem to 0.5", 1, 0, 1, {0}, ALL(1)},
};
const int stepper_count = sizeof stepper_table / sizeof *stepper_table;

const struct stepper *stepper_find(const char *name) {
    for (int i = 0; i < stepper_count; i++)
        if (!strcmp(name, stepper_table[i].name)) return &stepper_table[i];
    return NULL;
}
