/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the benchmarks measure with. */
#ifndef TESTS_BENCH_CLOCK_H
#define TESTS_BENCH_CLOCK_H

#include <time.h>

static inline double cpu_seconds(void) { /* of this process */
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static inline int by_size(const void *a, const void *b) { /* for qsort of doubles */
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

#endif
