/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every reconstruction: constants to the bit, mirror images, order; values of the published formulas. */
#include "tests/libcore/oracle.h"

#include "libcore/models/kernel.h"
#include "libcore/schemes/reconstruct.h"

static double face(const struct reconstruct *r, const double *q) {
    const double *line[5] = {q, q + 1, q + 2, q + 3, q + 4};
    double out;
    r->face(1, line, &out);
    return out;
}

static void constants_are_exact(void **state) {
    (void)state;
    for (int k = 0; k < reconstruct_count; k++)
        for (double c = -1e9; c < 1e9; c = c < -1e-9 ? c / 7.3 : c < 1e-9 ? 1e-7 : c * 9.1) {
            double q[5] = {c, c, c, c, c};
            assert_true(face(&reconstruct_table[k], q) == c);
        }
}

/* Averages of sin over cells of width h: the error of the face value falls with the stated order. */
static double error_of(const struct reconstruct *r, double h, double x) {
    double q[5];
    for (int j = 0; j < 5; j++) q[j] = (cos(x + (j - 3) * h) - cos(x + (j - 2) * h)) / h; /* face at x */
    return fabs(face(r, q) - sin(x));
}

static void orders(void **state) {
    (void)state;
    const struct {
        const char *name;
        double least;
    } expected[] = {{"PHM", 2.9},   {"WPENO5", 3.9}, {"WENO5", 4.9},
                    {"WENOZ", 4.9}, {"TENO5", 4.9},  {"firstOrder", 0.98}};
    assert_int_equal(reconstruct_count, 6); /* a new row needs an order here */
    for (int k = 0; k < reconstruct_count; k++) {
        const struct reconstruct *r = reconstruct_find(expected[k].name);
        double coarse = error_of(r, 0.02, 0.6), fine = error_of(r, 0.01, 0.6);
        if (!(log2(coarse / fine) > expected[k].least))
            fail_msg("%s: order %.3f, expected at least %.2f", r->model.name, log2(coarse / fine), expected[k].least);
    }
}

/* The hyperbola as it is cited (PHM, docs/physics.md 6.8), with its logarithm. */
static void phm_is_the_hyperbola(void **state) {
    (void)state;
    const struct reconstruct *r = reconstruct_find("PHM");
    for (double ratio = 0.02; ratio < 60; ratio *= 1.07) {
        if (fabs(ratio - 1) < 0.03) continue; /* the printed form cancels there */
        double l = 0.3, right = 0.3 * ratio, q[5] = {9, 1, 1.3, 1.3 + right, -4};
        double d = 2 * l * right / (l + right);
        double a = l <= right ? 2 * (sqrt(d / l) - 1) : 2 * (1 - sqrt(d / right));
        double printed = 1.3 + d * (1 / (a * (1 - a / 2)) - log((2 + a) / (2 - a)) / (a * a));
        assert_close(face(r, q), printed, 1e-12, "PHM");
    }
    double extremum[5] = {0, 1, 2, 1.5, 0}, flat[5] = {0, 1, 1, 3, 5};
    assert_true(face(r, extremum) == 2 && face(r, flat) == 1);
}

/* The values of tests/oracles/reconstruct.py. They may differ by the round-off of the differences of a stencil, whose
 * largest ones may cancel in a smoothness: 1e-13 of its range; and by that of adding one to the cell's average. (PHM's
 * series has an error of 6e-15.) */
static void values_are_the_published_ones(void **state) {
    (void)state;
    FILE *f = oracle_open("reconstruct.csv");
    struct oracle_row head, r;
    int rows = 0;
    oracle_row(f, &head);
    for (; oracle_row(f, &r); rows++) {
        double q[5], low = HUGE_VAL, high = -HUGE_VAL;
        for (int i = 0; i < 5; i++) {
            q[i] = oracle_number(&r, 1 + i);
            low = smaller(low, q[i]);
            high = larger(high, q[i]);
        }
        const bool even = q[0] == q[1] && q[1] == q[2]; /* ours keeps such values (nothing_reaches_uniform_gas) */
        for (int k = 6; k < head.n; k++) {
            const double expected = even ? q[2] : oracle_number(&r, k), found = face(reconstruct_find(head.word[k]), q);
            const double allowed = 1e-13 * (high - low) + 2.3e-16 * fabs(expected);
            if (!(fabs(found - expected) <= allowed))
                fail_msg("%s of %s: %.17g, expected %.17g, error %.2g, allowed %.2g", head.word[k], r.word[0], found,
                         expected, fabs(found - expected), allowed);
        }
    }
    fclose(f);
    assert_int_equal(head.n, 11);
    assert_int_equal(rows, 74);
}

/* -q gives the negative value, to the bit. */
static void sign_is_symmetric(void **state) {
    (void)state;
    double q[5] = {0.3, -1.7, 2.9, 3.1, 8.8}, m[5];
    for (int i = 0; i < 5; i++) m[i] = -q[i];
    for (int k = 0; k < reconstruct_count; k++)
        assert_true(face(&reconstruct_table[k], q) == -face(&reconstruct_table[k], m));
}

/* Differences of any size, down to those whose products are 0, leave a face value that is a number. */
static void tiny_differences_are_numbers(void **state) {
    (void)state;
    for (int k = 0; k < reconstruct_count; k++)
        for (double h = 1; h > 0; h *= 0.3) {
            const double q[5] = {0, 0, h, 3 * h, 4 * h}, value = face(&reconstruct_table[k], q);
            if (!(value >= 0 && value <= 4 * h)) fail_msg("%s: %g at %g", reconstruct_table[k].model.name, value, h);
        }
}

/* Values in another unit have face values in that unit: to the bit if it is a power of two, else to round-off, which
 * TENO5's choice of stencils may not see here. */
static void units_do_not_matter(void **state) {
    (void)state;
    static const double units[] = {0x1p-66, 0x1p-40, 0x1p-20, 0x1p66, 0x1p100, 1e-20, 1e20};
    for (int k = 0; k < reconstruct_count; k++)
        for (int trial = 0; trial < 300; trial++) {
            double q[5], most = 0;
            for (int i = 0; i < 5; i++) {
                const double wave = sin(0.7 * trial + 0.01 * (trial % 7) * i), rough = sin(5.1 * i * i + trial);
                q[i] = trial % 3 == 0 ? wave : trial % 3 == 1 ? rough : i < trial % 5 ? 0.125 : 1;
                most = larger(most, fabs(q[i]));
            }
            for (int u = 0; u < 7; u++) {
                double other[5];
                for (int i = 0; i < 5; i++) other[i] = units[u] * q[i];
                const double found = face(&reconstruct_table[k], other) / units[u];
                const double error = fabs(found - face(&reconstruct_table[k], q));
                if (!(error <= (u < 5 ? 0 : 1e-12 * most)))
                    fail_msg("%s, unit %g, stencil %d: off by %g", reconstruct_table[k].model.name, units[u], trial,
                             error);
            }
        }
}

/* What is uniform upwind stays so to the bit, whatever comes. */
static void nothing_reaches_uniform_gas(void **state) {
    (void)state;
    for (int k = 0; k < reconstruct_count; k++)
        for (double jump = 1e-14; jump < 1e3; jump *= 10) {
            const double q[5] = {0.7, 0.7, 0.7, 0.7 + jump, 0.7 - 2 * jump};
            assert_true(face(&reconstruct_table[k], q) == 0.7);
        }
}

static void batch_is_a_loop(void **state) {
    (void)state;
    double q[5][BATCH], out[BATCH];
    const double *line[5] = {q[0], q[1], q[2], q[3], q[4]};
    for (int m = 0; m < 5; m++)
        for (int i = 0; i < BATCH; i++) q[m][i] = sin(1.3 * i + 2.1 * m * m) + (i % 3 ? 0.2 * m : 0);
    for (int k = 0; k < reconstruct_count; k++) {
        reconstruct_table[k].face(BATCH - 5, line, out);
        for (int i = 0; i < BATCH - 5; i++) {
            double one[5] = {q[0][i], q[1][i], q[2][i], q[3][i], q[4][i]};
            assert_true(face(&reconstruct_table[k], one) == out[i]);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(constants_are_exact),         cmocka_unit_test(orders),
        cmocka_unit_test(phm_is_the_hyperbola),        cmocka_unit_test(values_are_the_published_ones),
        cmocka_unit_test(sign_is_symmetric),           cmocka_unit_test(batch_is_a_loop),
        cmocka_unit_test(nothing_reaches_uniform_gas), cmocka_unit_test(tiny_differences_are_numbers),
        cmocka_unit_test(units_do_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
