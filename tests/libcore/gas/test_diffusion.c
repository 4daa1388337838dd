/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The explicit schemes of diffusion, mode by mode: what a super step leaves of a mode that decays at a given rate. */
#include "tests/libcore/oracle.h"

#include "libcore/gas/diffusion.h"

/* R(z) after a super step of n stages, z = -dt times the rate */
static double left_of(const struct diffusion *d, int stages, double z) {
    double c[4], S[2] = {0, 0}, q = 1;
    for (int j = 1; j <= stages; j++) {
        d->stage(stages, j, c);
        const double next = (j > 1 ? c[0] * S[0] : 0) + (j > 2 ? c[1] * S[1] : 0) + c[2] * q + c[3];
        S[1] = S[0];
        S[0] = next;
        q = 1 + z * next;
    }
    return q;
}

typedef void visitor(const struct diffusion *d, int stages, double z);

/* z of all decades up to the end of a step of any of the ratios that the plans are for */
static void visit_modes(visitor *visit) {
    for (int i = 0; i < diffusion_count && diffusion_table[i].plan; i++) /* the implicit one is last */
        for (double ratio = 0.01; ratio < 1e4; ratio *= 1.37) {
            int stages;
            const long steps = diffusion_table[i].plan(ratio, &stages);
            const double end = 2 * ratio / (double)steps;
            for (int k = 0; k <= 4000; k++) visit(&diffusion_table[i], stages, -end * k * k / 16e6);
        }
}

static void compare_with_crank_nicolson(const struct diffusion *d, int stages, double z) {
    const double R = left_of(d, stages, z), slow = (2 + z) / (2 - z);
    if (!(R >= slow - 1e-9 && R <= 1 + 1e-9))
        fail_msg("%s, %d stages: %g is left of a mode with z = %g, Crank-Nicolson leaves %g", d->model.name, stages, R,
                 z, slow);
}

/* So the work of the stress never cools (libcore/gas/diffusion.h), and nothing grows. */
static void no_mode_falls_faster_than_by_crank_nicolson(void **state) {
    (void)state;
    visit_modes(compare_with_crank_nicolson);
}

static void slow_modes_are_of_second_order(void **state) {
    (void)state;
    for (int i = 0; i < diffusion_count && diffusion_table[i].plan; i++) /* the implicit one is last */
        for (double ratio = 1; ratio < 1e4; ratio *= 3) {
            int stages;
            (void)diffusion_table[i].plan(ratio, &stages);
            const double z = 0.05, error[2] = {fabs(left_of(&diffusion_table[i], stages, -z) - exp(-z)),
                                               fabs(left_of(&diffusion_table[i], stages, -z / 2) - exp(-z / 2))};
            assert_near(log2(error[0] / error[1]), 3, 0.1);
        }
}

static void leave_a_tenth(const struct diffusion *d, int stages, double z) {
    if (!strcmp(d->model.name, "RKJ2") && z < -8 && fabs(left_of(d, stages, z)) > 0.11)
        fail_msg("%d stages: %g is left of a mode with z = %g", stages, left_of(d, stages, z), z);
}

static void stiff_modes_die(void **state) {
    (void)state;
    visit_modes(leave_a_tenth);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_mode_falls_faster_than_by_crank_nicolson),
        cmocka_unit_test(slow_modes_are_of_second_order),
        cmocka_unit_test(stiff_modes_die),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
