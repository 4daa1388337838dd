/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Starts: places without overlap to dense packings, fields honoured, velocities with exact sums; errors. */
#include "libcore/grains/packing.h"

#include "libcore/grains/random.h"

#include "tests/checks.h"

#include <math.h>
#include <stdlib.h>

#define PI 3.14159265358979323846

static double (*places(int n))[3] {
    double(*x)[3] = calloc((size_t)n, sizeof *x);
    assert_non_null(x);
    return x;
}

static struct grain_box cube(int dim, double length, bool periodic) {
    struct grain_box b = {.dim = dim};
    for (int k = 0; k < dim; k++) {
        b.high[k] = length;
        b.periodic[k] = periodic;
        b.restitution[k][0] = b.restitution[k][1] = 0.5; /* of the run; growth takes elastic walls */
    }
    return b;
}

static int in_order(const void *a, const void *b) {
    const double *p = a, *q = b;
    return (p[0] > q[0]) - (p[0] < q[0]);
}

/* Sweep along axis 0: every pair that is nearer than a diameter there; the nearest distance and the nearest wall. */
static void nearest(const struct grain_box *b, int n, const double (*x)[3], double *pair, double *wall) {
    double L = b->high[0] - b->low[0], reach = 1.5 * pow(L * L * L / n, 1. / 3) + 1.5 * L / sqrt(n);
    double(*s)[3] = places(n);
    memcpy(s, x, (size_t)n * sizeof *s);
    qsort(s, (size_t)n, sizeof *s, in_order);
    *pair = *wall = HUGE_VAL;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < b->dim; k++) {
            assert_true(s[i][k] >= b->low[k] && s[i][k] <= b->high[k]);
            if (!b->periodic[k]) *wall = fmin(*wall, fmin(s[i][k] - b->low[k], b->high[k] - s[i][k]));
        }
        for (int m = 1; m < n; m++) {
            int j = (i + m) % n;
            double d[3] = {s[j][0] - s[i][0] + (j < i ? L : 0)}, r2 = d[0] * d[0];
            if (d[0] > fmin(reach, *pair) || (j < i && !b->periodic[0])) break;
            for (int k = 1; k < b->dim; k++) {
                d[k] = fabs(s[j][k] - s[i][k]);
                if (b->periodic[k]) d[k] = fmin(d[k], b->high[k] - b->low[k] - d[k]);
                r2 += d[k] * d[k];
            }
            *pair = fmin(*pair, sqrt(r2));
        }
    }
    free(s);
}

static const struct packing_field UNIFORM = {.n = {1, 1, 1}};

/* n grains of diameter 1 at a packing fraction in a square or cube; no overlap, walls kept, the same for a seed. */
static void packs(int dim, int n, double packing, bool periodic, bool grows) {
    double volume = dim == 2 ? PI / 4 : PI / 6, pair, wall;
    struct grain_box b = cube(dim, dim == 2 ? sqrt(n * volume / packing) : cbrt(n * volume / packing), periodic);
    double(*x)[3] = places(n), (*again)[3] = places(n);
    struct packing_report report;
    ok(packing_places(&b, 1, &UNIFORM, n, 5, x, &report));
    nearest(&b, n, (const double(*)[3])x, &pair, &wall);
    if (!(pair >= 1 && pair < 2 && wall >= 0.5)) fail_msg("%d %g: pair %.17g wall %.17g", dim, packing, pair, wall);
    assert_true(grows == (report.added < 1) && grows == (report.impacts > 0));
    printf("%d grains, dim %d, packing %.2f: added at %.3f of the diameter, %lld impacts\n", n, dim, packing,
           report.added, (long long)report.impacts);
    ok(packing_places(&b, 1, &UNIFORM, n, 5, again, &report));
    assert_true(memcmp(x, again, (size_t)n * sizeof *x) == 0);
    ok(packing_places(&b, 1, &UNIFORM, n, 6, again, &report));
    assert_true(memcmp(x, again, (size_t)n * sizeof *x) != 0);
    free(x);
    free(again);
}

static void added(void **state) {
    (void)state;
    packs(2, 4000, 0.01, true, false);
    packs(2, 4000, 0.40, false, false);
    packs(3, 20000, 0.10, true, false);
    packs(3, 4000, 0.20, false, false);
}

static void grown(void **state) {
    (void)state;
    packs(2, 3000, 0.60, true, true);
    packs(2, 3000, 0.70, true, true);
    packs(2, 1000, 0.70, false, true);
    packs(3, 3000, 0.55, true, true);
    packs(3, 1000, 0.50, false, true);
}

/* Added grains are uncorrelated far away: counts in 400 boxes vary less than Poisson's, and evenly. */
static void uniform(void **state) {
    (void)state;
    enum { N = 20000, SIDE = 20 };
    struct grain_box b = cube(2, sqrt(N * PI / 4 / 0.2), true);
    double(*x)[3] = places(N), chi2 = 0;
    int count[SIDE * SIDE] = {0};
    struct packing_report report;
    double alpha[9];
    for (int c = 0; c < 9; c++) alpha[c] = 0.2;
    struct packing_field f = {.n = {3, 3, 1}, .alpha = alpha};
    assert_true(packing_number(&b, 1, &f) == N);
    ok(packing_places(&b, 1, &f, N, 1, x, &report));
    for (int i = 0; i < N; i++) count[(int)(x[i][0] / b.high[0] * SIDE) + SIDE * (int)(x[i][1] / b.high[0] * SIDE)]++;
    for (int c = 0; c < SIDE * SIDE; c++) chi2 += pow(count[c] - 1. * N / SIDE / SIDE, 2) * SIDE * SIDE / N;
    double share = chi2 / (SIDE * SIDE - 1); /* compressibility of hard disks at 0.2: 0.43; five standard deviations */
    if (!(fabs(share - 0.43) < 0.43 * 5 * sqrt(2. / (SIDE * SIDE))))
        fail_msg("variance of counts / Poisson's: %g", share);
    free(x);
}

/* alpha high in every third column of cells, low elsewhere: chi-square over the cells, with each wish. */
static void two_levels(int dim, double low, double high, bool periodic) {
    enum { COLUMNS = 12 };
    int n[3] = {COLUMNS, 4, dim == 3 ? 2 : 1}, cells = n[0] * n[1] * n[2], count[COLUMNS * 8] = {0};
    double alpha[COLUMNS * 8], chi2 = 0, sum = 0, pair, wall;
    for (int c = 0; c < cells; c++) sum += alpha[c] = c % 3 == 0 ? high : low;
    struct packing_field f = {.n = {n[0], n[1], n[2]}, .alpha = alpha};
    struct grain_box b = cube(dim, dim == 2 ? 120 : 36, periodic);
    int many = packing_number(&b, 1, &f);
    double(*x)[3] = places(many);
    struct packing_report report;
    ok(packing_places(&b, 1, &f, many, 11, x, &report));
    nearest(&b, many, (const double(*)[3])x, &pair, &wall);
    assert_true(pair >= 1 && wall >= 0.5);
    for (int i = 0; i < many; i++) {
        int at[3] = {0};
        for (int k = 0; k < dim; k++) at[k] = (int)(x[i][k] / b.high[k] * n[k]);
        count[at[0] + n[0] * (at[1] + n[1] * at[2])]++;
    }
    double dense = 0;
    for (int c = 0; c < cells; c++) {
        double wish = many * alpha[c] / sum;
        chi2 += (count[c] - wish) * (count[c] - wish) / wish;
        if (c % 3 == 0) dense += count[c];
    }
    double share = dense / many, wanted = high / (high + 2 * low);
    printf("dim %d, alpha %g and %g: chi2 %.1f of %d cells, share of the dense %.4f (wanted %.4f)\n", dim, low, high,
           chi2, cells, share, wanted);
    assert_true(chi2 < cells + 5 * sqrt(2. * cells));
    assert_true(fabs(share - wanted) < (report.added < 1 ? 0.01 : 0.0005)); /* growth lets the dense spread a little */
    free(x);
}

static void fields_are_honoured(void **state) {
    (void)state;
    two_levels(2, 0.05, 0.35, true);
    two_levels(3, 0.03, 0.25, true);
    two_levels(2, 0.1, 0.3, false);
    two_levels(2, 0.2, 0.6, true);
}

/* A layer in fine cells, the lowest of them out of the reach of centres; nothing where alpha is 0 (but near it). */
static void layer(void **state) {
    (void)state;
    enum { CELLS = 400 };
    double alpha[CELLS] = {0}, highest = 0;
    for (int c = 0; c < 60; c++) alpha[c] = 0.5;
    struct packing_field f = {.n = {1, CELLS, 1}, .alpha = alpha};
    struct grain_box b = cube(2, 100, false);
    b.periodic[0] = true;
    int n = packing_number(&b, 1, &f);
    assert_true(n == (int)floor(0.5 * 0.15 * 1e4 / (PI / 4) + 0.5));
    double(*x)[3] = places(n), pair, wall;
    struct packing_report report;
    ok(packing_places(&b, 1, &f, n, 3, x, &report));
    nearest(&b, n, (const double(*)[3])x, &pair, &wall);
    assert_true(pair >= 1 && wall >= 0.5);
    for (int i = 0; i < n; i++) highest = fmax(highest, x[i][1]);
    assert_true(highest < 17);
    free(x);
}

/* Two triangles of a square, whose boxes are the same: 0 below the diagonal, 1 above it. */
static long triangle_of(const struct grain_mesh *self, const double x[3], bool *inside) {
    (void)self;
    *inside = true;
    return x[1] > x[0];
}

/* Grains lie in the cells of a mesh that have some, not in all of the boxes around these. */
static void on_a_mesh(void **state) {
    (void)state;
    enum { N = 500 };
    const double L = 100, volume[2] = {L * L / 2, L * L / 2}, alpha[2] = {N * PI / 4 / (L * L / 2), 0};
    const double centre[2][3] = {{2 * L / 3, L / 3, 0}, {L / 3, 2 * L / 3, 0}};
    const double bounds[2][6] = {{0, 0, 0, L, L, 0}, {0, 0, 0, L, L, 0}};
    const struct grain_mesh m = {2, volume, centre, bounds, triangle_of};
    const struct packing_field f = {.n = {1, 1, 1}, .mesh = &m, .alpha = alpha};
    struct grain_box b = cube(2, L, true);
    double(*x)[3] = places(N), pair, wall;
    struct packing_report report;
    assert_true(packing_number(&b, 1, &f) == N);
    ok(packing_places(&b, 1, &f, N, 3, x, &report));
    nearest(&b, N, (const double(*)[3])x, &pair, &wall);
    assert_true(pair >= 1 && report.impacts == 0);
    for (int i = 0; i < N; i++) assert_true(x[i][1] <= x[i][0]);
    free(x);
}

static void velocities(void **state) {
    (void)state;
    enum { N = 30000 };
    double T[4] = {1, 4, 0, 0.25}, u[4] = {0.5, -1, 2, 0}, v[4] = {3, 0, 0, -2};
    struct packing_field f = {.n = {2, 2, 1}, .T = T, .u = {u, v, NULL}};
    struct grain_box b = cube(2, 1, true);
    double(*x)[3] = places(N), (*w)[3] = places(N), sum[2] = {0}, energy = 0, var[4] = {0}, fourth = 0, number[4] = {0};
    struct random r = random_make(9, 9);
    for (int i = 0; i < N; i++)
        for (int k = 0; k < 2; k++) x[i][k] = random_uniform(&r);
    packing_velocities(&b, &f, N, 8, (const double(*)[3])x, w);
    for (int i = 0; i < N; i++) {
        int c = (x[i][0] >= 0.5) + 2 * (x[i][1] >= 0.5);
        double a = w[i][0] - u[c], d = w[i][1] - v[c];
        assert_true(w[i][2] == 0 && (T[c] > 0 || (a == 0 && d == 0)));
        sum[0] += a, sum[1] += d;
        energy += (w[i][0] * w[i][0] + w[i][1] * w[i][1] - u[c] * u[c] - v[c] * v[c]) / 2 - T[c];
        var[c] += (a * a + d * d) / 2, number[c] += 1;
        if (c == 1) fourth += (a * a * a * a + d * d * d * d) / 2;
    }
    assert_true(fabs(sum[0]) < 1e-9 && fabs(sum[1]) < 1e-9 && fabs(energy) < 1e-8);
    for (int c = 0; c < 4; c++) assert_true(fabs(var[c] / number[c] - T[c]) <= 5 * T[c] / sqrt(number[c]));
    assert_true(fabs(fourth / number[1] - 48) < 5 * 16 * sqrt(96 / (2 * number[1])));
    free(x);
    free(w);
}

static void errors(void **state) {
    (void)state;
    struct packing_report report;
    double(*x)[3] = places(20000), nothing[4] = {0};
    struct grain_box b = cube(2, 10, true);
    says(packing_places(&b, 1, &UNIFORM, 116, 1, x, &report), "116 disks of diameter 1 m cannot fit|0.9111|0.9069");
    says(packing_places(&b, 1, &UNIFORM, 114, 1, x, &report), "jam at a packing fraction of 0.8|before the 0.895|114");
    b = cube(3, 10, false);
    says(packing_places(&b, 1, &UNIFORM, 1415, 1, x, &report), "1415 spheres of diameter 1 m cannot fit|0.7409|0.7405");
    b = cube(3, 0.9, false);
    says(packing_places(&b, 1, &UNIFORM, 1, 1, x, &report),
         "0.9 m long along axis 0, which has walls|grains of 1 m need more than 1 m");
    b = cube(2, 2.9, true);
    says(packing_places(&b, 1, &UNIFORM, 1, 1, x, &report), "axis 0, which is periodic|need more than 3 m");
    b = cube(2, 10, true);
    struct packing_field empty = {.n = {2, 2, 1}, .alpha = nothing};
    says(packing_places(&b, 1, &empty, 1, 1, x, &report), "no room for grains");
    ok(packing_places(&b, 1, &empty, 0, 1, x, &report));
    free(x);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(added),      cmocka_unit_test(uniform),
                                       cmocka_unit_test(velocities), cmocka_unit_test(fields_are_honoured),
                                       cmocka_unit_test(layer),      cmocka_unit_test(on_a_mesh),
                                       cmocka_unit_test(grown),      cmocka_unit_test(errors)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
