/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Million cells per second of fitting polynomials and of their values at the face points on one core, for 4 variables
 * (5 in 3D): bench_polynomial [cells, default 200000] [rounds]. CPU time of the process, median of the rounds. */
#include "libcore/schemes/polynomial.h"
#include "tests/bench/clock.h"
#include "tests/simplices.h"

#include <stdio.h>

static void points(const struct fit *f, const struct polyhedra *m, int nvar, const double *const *U) {
    static double room[MAX_VAR][BATCH];
    double *out[MAX_VAR];
    for (int v = 0; v < nvar; v++) out[v] = room[v];
    for (int side = 0; side < 2; side++) {
        int end = m->face.point_start[side ? m->face.ninternal : m->face.n];
        for (int p = 0, n; p < end; p += n) {
            n = end - p < BATCH ? end - p : BATCH;
            fit_points(f, side, p, n, U, out);
        }
    }
}

static status time_fit(const struct polyhedra *m, enum shape shape, const struct polynomial *kind, int rounds) {
    static const char *const name[] = {"quads", "triangles", "hexes", "tets"};
    struct fit *f;
    double *all, *seconds[2], made = cpu_seconds();
    const double *U[MAX_VAR];
    const int nvar = m->dim + 2;
    TRY(fit_make(m, kind, m->dim, NULL, &f));
    made = cpu_seconds() - made;
    TRY(allocate(&all, (long)nvar * m->size, sizeof *all, "averages"));
    for (int k = 0; k < 2; k++) TRY(allocate(&seconds[k], rounds, sizeof(double), "times"));
    for (int v = 0; v < nvar; v++) {
        U[v] = all + (long)v * m->size;
        for (int i = 0; i < m->size; i++)
            all[(long)v * m->size + i] = 2 + sin(9 * m->centre[0][i] + v) * cos(7 * m->centre[1][i]);
    }
    for (int i = 0; i < rounds; i++) {
        double start = cpu_seconds();
        fit_cells(f, 0, m->nnear, U);
        double middle = cpu_seconds();
        points(f, m, nvar, U);
        seconds[0][i] = middle - start;
        seconds[1][i] = cpu_seconds() - middle;
    }
    double each[2];
    for (int k = 0; k < 2; k++) {
        qsort(seconds[k], (size_t)rounds, sizeof(double), by_size);
        each[k] = 1e6 * seconds[k][rounds / 2] / m->nown;
    }
    printf("%-9s %-10s %d variables: %6.2f M cells/s (cells %.3f, points %.3f us a cell; made in %.2f s)\n",
           name[shape], kind->model.name, nvar, 1 / (each[0] + each[1]), each[0], each[1], made);
    for (int k = 0; k < 2; k++) free(seconds[k]);
    free(all);
    fit_free(f);
    return OK;
}

static status run(const struct comm *c, int cells, int rounds) {
    static const int split[] = {1, 2, 1, 6};
    for (enum shape shape = QUADS; shape <= TETS; shape++) {
        struct sample s;
        int n = (int)(power((double)cells / split[shape], sample_flat(shape) ? 0.5 : 1. / 3) + 0.5);
        TRY(sample_make(&s, shape, (int[3]){n, n, sample_flat(shape) ? 1 : n}, (double[3]){1, 1, 1}, 0.2));
        for (int rings = 1; rings <= 2; rings++) {
            struct polyhedra *m;
            TRY(polyhedra_make(s.mesh, c, rings, &m));
            for (int k = 0; k < polynomial_count; k++)
                if (polynomial_table[k].rings == rings) TRY(time_fit(m, shape, &polynomial_table[k], rounds));
            polyhedra_free(m);
        }
        sample_free(&s);
    }
    return OK;
}

int main(int argc, char **argv) {
    struct comm *c;
    status s = comm_start(&argc, &argv, &c);
    if (!s) s = run(c, argc > 1 ? atoi(argv[1]) : 200000, argc > 2 ? atoi(argv[2]) : 15);
    int code = status_print(s, false);
    comm_finish(c);
    return code;
}
