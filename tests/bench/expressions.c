/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints nanoseconds per point of expressions at the centres of boxes and at scattered points: one point after the
 * other, and all in one call.
 *
 *   bench_expressions [cells a side]
 */
#include "solvers/dict/expr.h"
#include "tests/bench/clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const char *const texts[] = {
    "1 + .1*cos(pi*(2*x - y + z)/50 + .3)",
    "x < 20 ? 1 : 0.125",
    "exp(-((x - 50)^2 + (y - 50)^2)/sqr(10))",
};

/* Returns the best of five times, ns per point. */
static double measure(const struct expr *e, long n, const double *x, bool together, double *v) {
    double best = HUGE_VAL;
    for (int round = 0; round < 5; round++) {
        const double start = cpu_seconds();
        if (together) expr_values(e, n, x, 0, v);
        for (long i = 0; i < n && !together; i++) v[i] = expr_value(e, x[3 * i], x[3 * i + 1], x[3 * i + 2], 0);
        best = fmin(best, cpu_seconds() - start);
    }
    return 1e9 * best / (double)n;
}

int main(int argc, char **argv) {
    const long side = argc > 1 ? atol(argv[1]) : 64, n = side * side * side;
    double *x = malloc((size_t)(4 * n) * sizeof *x);
    if (!x) return 1;
    printf("ns per point: alone, together, ratio\n");
    for (int scattered = 0; scattered < 2; scattered++) {
        for (long i = 0; i < n; i++) {
            const long cell[] = {i % side, i / side % side, i / side / side};
            for (int k = 0; k < 3; k++)
                x[3 * i + k] =
                    scattered ? 100 * (double)rand() / RAND_MAX : ((double)cell[k] + .5) * 100 / (double)side;
        }
        for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
            struct expr *e;
            if (expr_compile(texts[k], &e)) return 1;
            const double alone = measure(e, n, x, false, x + 3 * n), all = measure(e, n, x, true, x + 3 * n);
            printf("%-9s %-42s %6.1f %6.1f %5.1f\n", scattered ? "scattered" : "boxes", texts[k], alone, all,
                   alone / all);
            expr_free(e);
        }
    }
    free(x);
    return 0;
}
