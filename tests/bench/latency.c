/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The network between ranks 0 and 1: mpirun -np 2 bench_latency [repeats]. Prints the time of a message of 8 bytes, the
 * bytes a second of long ones in each direction, and the time of a reduction, in seconds: medians of exchanges by
 * mesh/base/comm.h, as runs have them. */
#include "mesh/base/comm.h"
#include "tests/bench/clock.h"

#include <stdio.h>
#include <stdlib.h>

enum { LONG = 1 << 18, ROUNDS = 10 }; /* doubles; exchanges that are timed at once */

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Returns the median time of an exchange, or of a reduction where there is none. */
static double time_of(const struct comm *c, struct comm_exchange *x, int times, int repeats, double *taken) {
    for (int i = 0; i < repeats; i++) {
        double none = 0;
        const double start = seconds();
        for (int k = 0; k < ROUNDS; k++) {
            if (x) {
                comm_exchange_start(x, times);
                comm_exchange_finish(x);
            } else {
                comm_max(c, &none, 1);
            }
        }
        taken[i] = (seconds() - start) / ROUNDS;
    }
    qsort(taken, (size_t)repeats, sizeof *taken, by_size);
    return taken[repeats / 2];
}

static status measure(const struct comm *c, int repeats) {
    struct comm_link link = {.rank = 1 - comm_rank(c), .n = 1};
    struct comm_exchange *x;
    double *taken;
    if (comm_size(c) != 2) return fail(ERR_INPUT, "%d ranks; needed: 2, say  mpirun -np 2 bench_latency", comm_size(c));
    TRY(allocate(&link.out, LONG, sizeof *link.out, "a message"));
    TRY(allocate(&link.in, LONG, sizeof *link.in, "a message"));
    TRY(allocate(&taken, repeats, sizeof *taken, "times"));
    TRY(comm_exchange_make(c, 1, &link, &x));
    const double one = time_of(c, x, 1, repeats, taken), many = time_of(c, x, LONG, repeats, taken);
    const double reduction = time_of(c, NULL, 0, repeats, taken);
    if (comm_root(c))
        printf("latency %.3g s, bandwidth %.3g B/s, reduction %.3g s\n", one,
               (double)(LONG - 1) * sizeof(double) / (many - one), reduction);
    comm_exchange_free(x);
    free(taken);
    free(link.in);
    free(link.out);
    return OK;
}

int main(int argc, char **argv) {
    struct comm *c;
    status s = comm_start(&argc, &argv, &c);
    if (!s) s = measure(c, argc > 1 && atoi(argv[1]) > 0 ? atoi(argv[1]) : 100);
    const int code = status_print(s, true);
    status_free(s);
    comm_finish(c);
    return code;
}
