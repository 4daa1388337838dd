/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of Runge-Kutta schemes (docs/physics.md 7.1); each row cites its paper. */
#include "libcore/schemes/stepper.h"

/* The Courant number up to which reconstructions of five cells bear Heun's method: no wave grows by more than e in
 * 8,000 steps. */
static const double HEUN = 0.4;

#define ALL(x)                                                                                                         \
    { x, x, x, x, x, x, x, x, x, x }

/* Ketcheson's two registers are the state and the start. After the fifth stage the start becomes 0.1 start + 0.9 state,
 * the state 0.6 start + 0.4 state; all these means are convex, hence admissible. The theory allows maxCo 6, but there
 * fifth-order reconstructions no longer converge (postprocessing/reports/workPrecision.md).
 * The limiter's theorem wants a Courant number of 1/2 of every Euler step (libcore/schemes/limit.h): maxCo up to 0.5 /
 * max(b). Above that steps may be rejected where a face was limited. */
const struct stepper stepper_table[] = {
    {MODEL("SSPRK3", "three stages, third order, maxCo up to 1; admissible by theorem to 0.5 (Shu & Osher 1988)"),
     .stages = 3, .courant = 1, .a = {0, 3. / 4, 1. / 3}, .b = ALL(1)},
    {MODEL("SSPRK43", "four stages, third order, maxCo up to 2; admissible by theorem to 1 (Spiteri & Ruuth 2002)"),
     .stages = 4, .courant = 2, .a = {0, 0, 2. / 3}, .b = ALL(0.5)},
    {MODEL("SSPRK104", "ten stages, fourth order, maxCo up to 3; admissible by theorem to 3 (Ketcheson 2008)"),
     .stages = 10, .exchange = 5, .courant = 3, .a = {[9] = 0.4}, .b = ALL(1. / 6)},
    {MODEL("SSPRK2", "two stages, second order, maxCo up to 1; admissible by theorem to 0.5 (Heun)"), .stages = 2,
     .courant = 1, .a = {0, 1. / 2}, .b = ALL(1)},
    {MODEL("Euler", "one stage, first order, maxCo up to 1; admissible by theorem to 0.5"), .stages = 1, .courant = 1,
     .b = ALL(1)},
    {MODEL("local", "each cell takes steps of its own in powers of two, second order, maxCo up to 1; polyhedra with "
                    "linear or firstOrder"),
     .stages = 1, .local = true, .courant = 1, .b = ALL(1)},
};
const int stepper_count = sizeof stepper_table / sizeof *stepper_table;

const struct stepper *const stepper_instead = &stepper_table[1];

const struct stepper *stepper_find(const char *name) {
    return model_find(stepper_table, sizeof *stepper_table, stepper_count, name);
}

const struct stepper *stepper_beside_bed(const struct stepper *chosen, bool damps, double courant) {
    const struct stepper *fewer = stepper_find(damps || courant <= HEUN ? "SSPRK2" : "SSPRK3");
    return chosen->stages > fewer->stages ? fewer : chosen;
}
