/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The multigrid on grids of growing size, in the blocks of beds on lattices: bench_multigrid [largest cells a side
 * [repeats [axes]]], also under mpirun -np 2; axes: 2 or 3 alone; in space sides are an eighth as long. Prints
 * iterations to a reduction of 1e-3 and of 1e-8, what is then left of the error in the norm of A, wall time a row of
 * set-up (new links; the same links) and of a solution to 1e-3, best of the repeats, of the slowest rank. */
#include "tests/libcore/multigrid/multigrid_grid.h"

#include <stdio.h>
#include <time.h>

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double since(const struct comm *c, double start) {
    double t = seconds() - start;
    comm_max(c, &t, 1);
    return t;
}

/* sqrt(e' A e) of e = x - y, of one rank. */
static double energy(const struct mg_grid *g, const double *x, const double *y) {
    double sum = 0;
    for (int i = 0; i < g->rows.rows; i++) {
        double ae = g->diagonal[i] * (x[i] - y[i]);
        for (int k = g->link_first[i]; k < g->link_first[i + 1]; k++)
            ae -= g->weight[k] * (x[g->link[k]] - y[g->link[k]]);
        sum += (x[i] - y[i]) * ae;
    }
    return sqrt(sum);
}

static status time_case(const struct comm *c, const struct mg_case *o, int repeats) {
    struct mg_grid g;
    struct multigrid *m;
    double best[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, *exact, *zero, left = 0;
    int loose = 0, tight = 0;
    mg_open(&g, o, c);
    TRY(multigrid_make(c, &m));
    for (int i = 0; i < repeats; i++) {
        double none = 0, start;
        comm_max(c, &none, 1); /* together */
        for (int same = 0; same < 2; same++) {
            start = seconds();
            TRY(multigrid_setup(m, &g.rows, same));
            best[same] = fmin(best[same], since(c, start));
        }
        start = seconds();
        TRY(multigrid_solve(m, &g.rows, g.b, 1e-3, 400, g.x, &loose));
        best[2] = fmin(best[2], since(c, start));
    }
    const long n = g.rows.rows + g.rows.ghosts;
    TRY(allocate(&exact, n, sizeof *exact, "a solution"));
    TRY(allocate(&zero, n, sizeof *zero, "a solution"));
    TRY(multigrid_solve(m, &g.rows, g.b, 1e-8, 400, exact, &tight));
    if (comm_size(c) == 1) {
        int more;
        double *better;
        TRY(allocate(&better, n, sizeof *better, "a solution"));
        TRY(multigrid_solve(m, &g.rows, g.b, 1e-13, 400, better, &more));
        left = energy(&g, g.x, better) / energy(&g, zero, better);
        free(better);
    }
    long rows = g.rows.rows;
    comm_sum_long(c, &rows, 1);
    const double ns = 1e9 / (double)rows;
    if (comm_root(c))
        printf("%4d x %4d x %3d %8ld rows, contrast %6.0f, shift %5.0e, holes %2.0f %% | %3d %3d  %7.1e | %6.1f %6.1f "
               "%7.1f ns\n",
               o->n[0], o->n[1], o->n[2], rows, o->contrast, o->shift, 100 * o->holes, loose, tight, left, ns * best[0],
               ns * best[1], ns * best[2]);
    free(exact);
    free(zero);
    multigrid_free(m);
    mg_close(&g);
    return OK;
}

static status time_sizes(const struct comm *c, struct mg_case o, int largest, int repeats) {
    static const int flat[][2] = {{6, 7},     {14, 14},   {64, 80},   {96, 120},
                                  {128, 160}, {256, 320}, {512, 640}, {1024, 1280}};
    static const int solid[] = {6, 16, 24, 32, 48, 64, 96};
    for (int i = 0; i < 8 && o.dim == 2 && flat[i][0] <= largest; i++) {
        o.n[0] = flat[i][0];
        o.n[1] = flat[i][1];
        TRY(time_case(c, &o, repeats));
    }
    for (int i = 0; i < 7 && o.dim == 3 && solid[i] <= largest; i++) {
        o.n[0] = o.n[1] = o.n[2] = solid[i];
        TRY(time_case(c, &o, repeats));
    }
    return OK;
}

int main(int argc, char **argv) {
    static const double contrasts[] = {1, 20.085536923187668, 1e4}, shifts[] = {1e-2, 1e-6, 1e-10};
    struct comm *c;
    status s = comm_start(&argc, &argv, &c);
    const int largest = argc > 1 ? atoi(argv[1]) : 512, repeats = argc > 2 ? atoi(argv[2]) : 3,
              axes = argc > 3 ? atoi(argv[3]) : 0;
    for (int dim = 2; dim <= 3; dim++)
        for (int holes = 0; holes < 2; holes++)
            for (int k = 0; !s && k < 9 && (!axes || axes == dim); k++) {
                struct mg_case o = {.dim = dim, .n = {1, 1, 1}, .block = {60, 8, 1}, .holes = 0.2 * holes};
                if (dim == 3) o.block[0] = o.block[1] = 32, o.block[2] = 8;
                o.contrast = contrasts[k / 3];
                o.shift = shifts[k % 3];
                s = time_sizes(c, o, dim == 2 ? largest : largest / 8, repeats);
            }
    int code = status_print(s, true);
    status_free(s);
    comm_finish(c);
    return code;
}
