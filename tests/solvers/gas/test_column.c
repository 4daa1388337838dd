/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The isothermal column: against the exact gas, and by its own equation for dense grains. */
#include "solvers/gas/initial.h"
#include "solvers/gas/layers.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h> /* last: it needs the standard headers, and its macro `fail` would hide ours */

static struct gas_models models_of(const char *eos, double e) {
    struct gas_models m = {.eos = eos_find(eos)};
    m.material = (struct material){.diameter = 1,
                                   .mass = 1,
                                   .restitution = e,
                                   .gamma = m.eos->disks ? 2 : 5. / 3,
                                   .alpha_max = m.eos->disks ? 0.82 : 0.65,
                                   .disks = m.eos->disks,
                                   .freezing = 0.69,
                                   .smoothing = 0.01};
    return m;
}

static struct column *column(const struct gas_models *m, double g, double T, double mass, double lid) {
    struct column *c = NULL;
    status s = column_make(m, g, T, mass, lid, &c);
    if (s) fail_msg("%s", status_text(s));
    return c;
}

static void close_to(double found, double expected, double tolerance) {
    if (!(fabs(found - expected) <= tolerance)) fail_msg("%.17g, expected %.17g +- %g", found, expected, tolerance);
}

/* p = rho T: rho falls as exp(-g h/T), in boxes that hold nearly all of it, or a small part. */
static void barometric(void **state) {
    (void)state;
    struct gas_models m = models_of("perfectGas", 1);
    for (double lid = 0.05; lid < 1000; lid *= 5) {
        struct column *c = column(&m, 2, 3, 7, lid);
        const double bottom = column_bottom(c, 7), exact = 7 / -expm1(-2 * lid / 3);
        close_to(bottom / exact, 1, 1e-9);
        for (double h = 0; h < 90; h += 1.7) close_to(column_above(c, exact, h) / (exact * exp(-2 * h / 3)), 1, 1e-9);
        column_free(c);
    }
}

/* P(-dw/dh) = g w/T at every height of columns of several masses, at all packings */
static void equilibrium(void **state) {
    (void)state;
    const struct {
        const char *eos;
        double e, g, T;
    } gas[] = {{"GoldshteinShapiro", 0.9, 10, 30},
               {"TorquatoDisks", 0.75, 981, 30},
               {"TorquatoDisks", 0.75, 981, 1e4},
               {"TorquatoSpheres", 1, 10, 3}};
    for (size_t i = 0; i < sizeof gas / sizeof *gas; i++) {
        struct gas_models m = models_of(gas[i].eos, gas[i].e);
        const double g = gas[i].g, T = gas[i].T;
        struct column *c = column(&m, g, T, 6, 60);
        for (double mass = 1e-3; mass <= 6; mass *= 1.9) {
            const double bottom = column_bottom(c, mass);
            close_to((bottom - column_above(c, bottom, 60)) / mass, 1, 1e-13);
            for (double h = 0.01; h < 20; h *= 1.3) {
                const double d = 1e-4 * fmin(T / g, 1), w = column_above(c, bottom, h);
                double rho = (column_above(c, bottom, h - d) - column_above(c, bottom, h + d)) / (2 * d), P;
                if (w < 1e-9) break;
                pressure_per_temperature(m.eos, &m.material, 1, &rho, &P);
                if (rho > 0.999 * density_limit(m.eos, &m.material)) continue; /* the difference is too coarse there */
                close_to(P / (g * w / T), 1, 1e-5);
            }
        }
        column_free(c);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(barometric), cmocka_unit_test(equilibrium)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
