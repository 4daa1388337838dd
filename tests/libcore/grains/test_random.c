/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random numbers: published outputs, moments, streams. */
#include "libcore/grains/random.h"

#include "tests/checks.h"

#include <math.h>

/* Numbers of the authors' programs xoshiro256plusplus.c from the state 1, 2, 3, 4 and splitmix64.c from 1234567. */
static const uint64_t XOSHIRO[] = {41943041ULL,
                                   58720359ULL,
                                   3588806011781223ULL,
                                   3591011842654386ULL,
                                   9228616714210784205ULL,
                                   9973669472204895162ULL,
                                   14011001112246962877ULL,
                                   12406186145184390807ULL,
                                   15849039046786891736ULL,
                                   10450023813501588000ULL};
static const uint64_t SPLITMIX[] = {6457827717110365317ULL, 3203168211198807973ULL, 9817491932198370423ULL,
                                    4593380528125082431ULL};

static void published(void **state) {
    (void)state;
    struct random r = {.s = {1, 2, 3, 4}, .spare = NAN};
    for (int k = 0; k < 10; k++) assert_true(random_uniform(&r) == (double)(XOSHIRO[k] >> 11) * 0x1p-53);
    r = random_make(1234567, 0);
    for (int k = 0; k < 4; k++) assert_true(r.s[k] == SPLITMIX[k]);
}

/* The polar method once more, with the library's logarithm in long double: ours is good to the last bits. */
static void logarithms(void **state) {
    (void)state;
    struct random r = random_make(7, 1), u = r;
    for (int k = 0; k < 100000; k++) {
        double a, b, s;
        do {
            a = 2 * random_uniform(&u) - 1, b = 2 * random_uniform(&u) - 1, s = a * a + b * b;
        } while (s >= 1 || s == 0);
        double scale = (double)sqrtl(-2 * logl(s) / s), x = random_normal(&r), y = random_normal(&r);
        assert_true(fabs(x - a * scale) <= 1e-15 * fabs(x) && fabs(y - b * scale) <= 1e-15 * fabs(y));
    }
}

/* A hash of 100,000 normals: what gcc and clang give, at -O0 and with the machine's vectors. */
static void same_bits(void **state) {
    (void)state;
    struct random r = random_make(42, 3);
    uint64_t hash = 0, bits;
    for (int k = 0; k < 100000; k++) {
        double x = random_normal(&r);
        memcpy(&bits, &x, sizeof bits);
        hash = hash * 31 + bits;
    }
    assert_true(hash == 0xeb685977c5c37317ULL);
}

/* Sums of n: the bounds are five standard deviations of each estimate. */
static void moments(void **state) {
    (void)state;
    int n = 1000000, beyond = 0;
    struct random r = random_make(42, 0);
    double mean = 0, square = 0, lag = 0, last = 0, m[5] = {0};
    for (int k = 0; k < n; k++) {
        double x = random_uniform(&r) - 0.5;
        assert_true(x >= -0.5 && x < 0.5);
        mean += x, square += x * x, lag += x * last;
        last = x;
    }
    assert_true(fabs(mean / n) < 5 * sqrt(1. / 12 / n));
    assert_true(fabs(square / n - 1. / 12) < 5 * sqrt(1. / 180 / n));
    assert_true(fabs(lag / n) < 5. / 12 / sqrt(n));
    for (int k = 0; k < n; k++) {
        double x = random_normal(&r), power = x;
        for (int j = 1; j <= 4; j++, power *= x) m[j] += power / n;
        beyond += fabs(x) > 3;
    }
    static const double expected[] = {0, 0, 1, 0, 3}, variance[] = {0, 1, 2, 15, 96};
    for (int j = 1; j <= 4; j++) assert_true(fabs(m[j] - expected[j]) < 5 * sqrt(variance[j] / n));
    assert_true(fabs(beyond - 0.0026997960632601913 * n) < 5 * sqrt(0.0027 * n));
}

/* Neighbouring seeds and streams: uncorrelated, all different. */
static void streams(void **state) {
    (void)state;
    enum { MANY = 64, LONG = 4096 };
    static double x[MANY][LONG];
    for (int k = 0; k < MANY; k++) {
        struct random r = random_make((uint64_t)k / 8, (uint64_t)k % 8);
        for (int i = 0; i < LONG; i++) x[k][i] = random_uniform(&r) - 0.5;
    }
    for (int k = 0; k < MANY; k++)
        for (int j = 0; j < k; j++) {
            double sum = 0;
            for (int i = 0; i < LONG; i++) sum += x[k][i] * x[j][i];
            assert_true(fabs(sum * 12) < 6 * sqrt(LONG));
            for (int i = 0; i < 8; i++) assert_true(x[k][i] != x[j][i + 1] && x[k][i] != x[j][i]);
        }
}

/* Speeds at which a drifting Maxwellian passes a point: their rate and first two moments against the integrals of v f,
 * v^2 f and v^3 f over v > 0; the rate of candidates is nowhere less than the true one. */
static void inflow(void **state) {
    (void)state;
    static const double drift[] = {-2, -0.5, 0, 0.3, 1, 5};
    struct random r = random_make(11, 2);
    for (int q = 0; q < 6; q++) {
        const int n = 200000;
        const double sigma = 0.7, u = drift[q] * sigma, a = drift[q], bell = exp(-0.5 * a * a) / sqrt(2 * acos(-1));
        const double above = 0.5 * erfc(-a / sqrt(2)), flux = sigma * (bell + a * above);
        const double first = sigma * sigma * (a * bell + (1 + a * a) * above);
        const double second = pow(sigma, 3) * ((2 + a * a) * bell + (3 * a + a * a * a) * above);
        double sum = 0, square = 0, v;
        int accepted = 0;
        for (int k = 0; k < n; k++) {
            if (!random_inflow(&r, u, sigma, &v)) continue;
            assert_true(v > 0);
            accepted++;
            sum += v;
            square += v * v;
        }
        const double rate = random_inflow_rate(u, sigma), part = flux / rate;
        assert_true(part <= 1 + 1e-12);
        assert_true(fabs(accepted - part * n) <= 5 * sqrt(n * part * (1 - part)) + 1e-9);
        const double mean = first / flux, variance = second / flux - mean * mean;
        assert_true(fabs(sum / accepted - mean) < 5 * sqrt(variance / accepted));
        assert_true(fabs(square / accepted - second / flux) < 5 * sqrt(variance / accepted) * 2 * sqrt(second / flux));
    }
    double v;
    assert_true(random_inflow_rate(3, 0) == 3 && random_inflow_rate(-3, 0) == 0 && random_inflow_rate(-50, 1) == 0);
    assert_true(random_inflow(&r, 3, 0, &v) && v == 3 && !random_inflow(&r, -3, 0, &v));
}

/* Waiting times of mean and variance 1. */
static void waiting(void **state) {
    (void)state;
    const int n = 200000;
    struct random r = random_make(12, 2);
    double sum = 0, square = 0;
    for (int k = 0; k < n; k++) {
        const double t = random_waiting(&r);
        assert_true(t >= 0);
        sum += t;
        square += t * t;
    }
    assert_true(fabs(sum / n - 1) < 5 / sqrt(n) && fabs(square / n - 2) < 5 * sqrt(20. / n));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(published), cmocka_unit_test(logarithms),
                                       cmocka_unit_test(same_bits), cmocka_unit_test(moments),
                                       cmocka_unit_test(streams),   cmocka_unit_test(inflow),
                                       cmocka_unit_test(waiting)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
