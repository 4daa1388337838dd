/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scheme of steps in which dense cells are a bed: which it is, and that no wave grows in them
 * (docs/physics.md 9.2). */
#include "libcore/schemes/stepper.h"

#include <complex.h>

#include "libcore/models/kernel.h"
#include "tests/libcore/oracle.h" /* last: cmocka.h defines fail() */

enum { WAVES = 100 };
static const double PI = 3.141592653589793, MOST = 0.5; /* the largest Courant number beside a bed */
static const double SLOW = 0.4;                         /* up to there five cells bear Heun's method, too */

/* -dq/dx h of exp(i k x/h) by upwind differences of that order. */
static double complex upwind(int order, double k) {
    const double complex e = cexp(I * k);
    switch (order) {
    case 2:
        return -(e + 3 - 5 / e + 1 / (e * e)) / 4;
    case 3:
        return -(2 * e + 3 - 6 / e + 1 / (e * e)) / 6;
    default:
        return -(-3 * e * e + 30 * e + 20 - 60 / e + 15 / (e * e) - 2 / (e * e * e)) / 60;
    }
}

static double factor(const struct stepper *s, double complex rate) {
    double complex q = 1;
    for (int n = 0; n < s->stages; n++) q = s->a[n] + (1 - s->a[n]) * (q + s->b[n] * rate * q);
    return cabs(q);
}

/* The largest factor by which a wave in a plane grows in a step of that Courant number. */
static double growth(const struct stepper *s, int order, double nu) {
    double most = 0;
    for (int i = 0; i <= WAVES; i++)
        for (int j = 1; j <= WAVES; j++)
            most = larger(most, factor(s, nu / 2 * (upwind(order, i * PI / WAVES) + upwind(order, j * PI / WAVES))));
    return most;
}

static void test_no_wave_grows_beside_a_bed(void **unused) {
    (void)unused;
    const struct stepper *chosen = stepper_find("SSPRK43");
    for (int order = 2; order <= 3; order++)
        assert_true(growth(stepper_beside_bed(chosen, true, MOST), order, MOST) < 1);
    assert_true(growth(stepper_beside_bed(chosen, false, MOST), 5, MOST) < 1);
    assert_true(growth(stepper_beside_bed(chosen, true, MOST), 5, MOST) > 1 + 5e-4); /* hence the third stage */
    const struct stepper *slow = stepper_beside_bed(chosen, false, SLOW);
    assert_int_equal(slow->stages, 2);
    assert_true(growth(slow, 5, SLOW) < exp(1. / 8000));
}

static void test_scheme_beside_a_bed(void **unused) {
    (void)unused;
    static const struct {
        const char *chosen, *damped, *hardly; /* the latter above SLOW */
    } row[] = {{"SSPRK43", "SSPRK2", "SSPRK3"}, {"SSPRK104", "SSPRK2", "SSPRK3"}, {"SSPRK3", "SSPRK2", "SSPRK3"},
               {"SSPRK2", "SSPRK2", "SSPRK2"},  {"Euler", "Euler", "Euler"},      {"local", "local", "local"}};
    for (unsigned i = 0; i < sizeof row / sizeof *row; i++) {
        const struct stepper *chosen = stepper_find(row[i].chosen);
        assert_ptr_equal(stepper_beside_bed(chosen, true, MOST), stepper_find(row[i].damped));
        assert_ptr_equal(stepper_beside_bed(chosen, false, SLOW), stepper_find(row[i].damped));
        assert_ptr_equal(stepper_beside_bed(chosen, false, nextafter(SLOW, 1)), stepper_find(row[i].hardly));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_no_wave_grows_beside_a_bed),
        cmocka_unit_test(test_scheme_beside_a_bed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
