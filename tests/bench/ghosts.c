/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ghost fill against memcpy of as many bytes: bench_ghosts [repeats], also under mpirun -np 2. Periodic boxes of
 * one rank's usual size; wall time, best of the repeats, of the slowest rank. */
#include "mesh/lattice/box.h"
#include "mesh/lattice/forest.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

struct scene {
    int dim, n[3], tile;
};

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static long ghost_bytes(const struct forest *f, int nvar) {
    long cells = 0;
    for (int t = 0; t < f->ntiles; t++)
        for (int k = 0; k < f->dim; k++) cells += 2L * GHOSTS * f->tile[t].n[(k + 1) % 3] * f->tile[t].n[(k + 2) % 3];
    return cells * nvar * (long)sizeof(double);
}

static double time_copy(long bytes, int repeats) {
    char *from = calloc((size_t)bytes, 1), *to = calloc((size_t)bytes, 1);
    double best = HUGE_VAL;
    for (int i = 0; from && to && i < repeats; i++) {
        double start = seconds();
        memcpy(to, from, (size_t)bytes);
        best = fmin(best, seconds() - start);
        from[i % bytes] = to[bytes - 1]; /* so that no copy can be left out */
    }
    free(from);
    free(to);
    return best;
}

static double time_fill(struct forest *f, int nvar, double *const *data, int repeats) {
    double best = HUGE_VAL;
    for (int i = 0; i < repeats; i++) {
        double none = 0;
        comm_max(f->comm, &none, 1); /* together */
        double start = seconds();
        forest_fill(f, nvar, data);
        best = fmin(best, seconds() - start);
    }
    return best;
}

static status time_scene(const struct comm *c, const struct scene *s, int repeats) {
    struct box box;
    struct forest *f;
    double *block, **data;
    int nvar = s->dim + 2;
    TRY(box_make(&box, s->dim, s->n, (double[3]){1, 1, 1}, (bool[3]){true, true, true}));
    TRY(forest_make(&box.lattice, &box.mesh, c, s->tile, &f));
    TRY(allocate(&block, f->ntiles * nvar * f->size, sizeof *block, "blocks"));
    TRY(allocate(&data, f->ntiles, sizeof *data, "blocks"));
    for (int t = 0; t < f->ntiles; t++) data[t] = block + t * nvar * f->size;
    long bytes = ghost_bytes(f, nvar);
    double all[3] = {time_fill(f, nvar, data, repeats), time_copy(bytes, repeats), (double)bytes};
    comm_max(c, all, 3);
    if (comm_root(c))
        printf("%dD %4d a side, tiles of %d: %7.1f kB a rank, fill %7.1f us, memcpy %6.1f us, ratio %5.2f\n", s->dim,
               s->n[0], s->tile, 1e-3 * all[2], 1e6 * all[0], 1e6 * all[1], all[0] / all[1]);
    free(data);
    free(block);
    forest_free(f);
    box_free(&box);
    return OK;
}

int main(int argc, char **argv) {
    static const struct scene scenes[] = {{2, {400, 400, 1}, 50}, {2, {100, 100, 1}, 50}, {3, {60, 60, 60}, 20}};
    struct comm *c;
    status s = comm_start(&argc, &argv, &c);
    int repeats = argc > 1 ? atoi(argv[1]) : 1000;
    for (int i = 0; !s && i < (int)(sizeof scenes / sizeof *scenes); i++) s = time_scene(c, &scenes[i], repeats);
    int code = status_print(s, true);
    status_free(s);
    comm_finish(c);
    return code;
}
