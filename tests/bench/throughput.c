/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Million cell-stages per second of the whole solver on one core: bench_throughput [cells a side, default 400] [steps]
 * [flux reconstruct [dimensions [tile [skipUniform, 1 or 0]]]].
 *
 * A granular gas (e = 0.97, with cooling and gravity; in one row a perfect gas without sources) in a periodic box,
 * disturbed everywhere, subsonic and supersonic, so that no part of the domain is cheaper than another. Times whole
 * steps as granularGas takes them: speed of the waves, sources, ghost cells, stages, checks. CPU time of the process.
 */
#include "libcore/gas/gas.h"
#include "mesh/lattice/box.h"
#include "tests/bench/clock.h"
#include "tests/defaults.h"

#include <stdio.h>

static status fill(struct gas *g, const int n[3], int dim) {
    long cells = (long)n[0] * n[1] * n[2];
    double *all, *u[3];
    TRY(allocate(&all, 5 * cells, sizeof(double), "fields"));
    for (int k = 0; k < 3; k++) u[k] = all + (2 + k) * cells;
    for (long i = 0; i < cells; i++) {
        double x = 6.283185307 * (double)(i % n[0]) / n[0], y = 6.283185307 * (double)(i / n[0] % n[1]) / n[1];
        double z = 6.283185307 * (double)(i / n[0] / n[1]) / n[2];
        all[i] = 200 + 60 * sin(2 * x + y) * cos(y - z);
        all[cells + i] = 20 + 5 * cos(x - 2 * y + z);
        for (int k = 0; k < dim; k++) u[k][i] = 30 * sin(x + y + k) * cos(z) + 5;
    }
    status s = gas_set(g, all, (const double *const *)u, all + cells);
    free(all);
    return s;
}

/* Floating-point operations a cell and stage of the 2D granular gas as tests/bench/flops.py counts them at 100 a side
 * (an fma as two, thrown-away lanes included); 0: not counted. They depend on the waves of this very box. */
static double operations(const char *eos, int dim, const char *flux, const char *reconstruct) {
    static const struct {
        const char *flux, *reconstruct;
        double n;
    } counted[] = {{"common", "PHM", 1342},      {"common", "WENO5", 1677},        {"common", "WPENO5", 1887},
                   {"common", "WENOZ", 1801},    {"LaxFriedrichs", "WENO5", 2462}, {"Marquina", "PHM", 2529},
                   {"Marquina", "WPENO5", 3664}, {"Rusanov", "firstOrder", 320}};
    for (int i = 0; i < (int)(sizeof counted / sizeof *counted); i++)
        if (dim == 2 && !strcmp(eos, "GoldshteinShapiro") && !strcmp(flux, counted[i].flux) &&
            !strcmp(reconstruct, counted[i].reconstruct))
            return counted[i].n;
    return 0;
}

static status time_scheme(const struct comm *c, const char *eos, int dim, int side, int tile, bool skip, int steps,
                          const char *flux, const char *reconstruct) {
    struct box box;
    struct forest *f;
    struct gas *g;
    int n[3] = {side, dim > 1 ? side : 1, dim > 2 ? side : 1};
    TRY(box_make(&box, dim, n, (double[3]){10, 10, 10}, (bool[3]){true, true, true}));
    struct gas_models m = {
        .material = {.diameter = 0.1, .mass = 1, .restitution = 0.97, .gamma = 5. / 3, .alpha_max = 0.65},
        .eos = eos_find(eos),
        .flux = flux_find(flux),
        .flux_params = own_defaults(&flux_find(flux)->model),
        .reconstruct = reconstruct_find(reconstruct),
        .stepper = stepper_find("SSPRK3"),
        .skip_uniform = skip};
    if (strcmp(eos, "perfectGas") != 0)
        m.source = (struct sources){.cooling = cooling_find("Haff"), .gravity = {980, -980, 0}};
    TRY(forest_make(&box.lattice, &box.mesh, c, tile, &f));
    TRY(gas_make(f, &m, 0, NULL, &g));
    TRY(fill(g, n, dim));
    double t = 0, *seconds;
    TRY(allocate(&seconds, steps, sizeof *seconds, "times"));
    for (int i = -1; i < steps; i++) { /* the first one warms up */
        double start = cpu_seconds();
        struct gas_speed speed;
        gas_speed(g, &speed);
        double dt = 0.5 / speed.rate;
        TRY(gas_step(g, t, &dt, 0.5, 0, 1e-3, &speed));
        t += dt;
        if (i >= 0) seconds[i] = cpu_seconds() - start;
    }
    qsort(seconds, (size_t)steps, sizeof *seconds, by_size);
    double work = 3e-6 * f->ncells_all;
    printf("%dD %-18s %-14s %-10s %5d a side: median %6.2f, best %6.2f M cell-stages/s", dim, eos, flux, reconstruct,
           side, work / seconds[steps / 2], work / seconds[0]);
    double each = operations(eos, dim, flux, reconstruct);
    if (each > 0) printf(", %4.1f GFLOP/s of %4.0f operations", 1e-3 * each * work / seconds[steps / 2], each);
    if (gas_counts(g).cells) printf(" (%ld cells limited)", gas_counts(g).cells);
    printf("\n");
    free(seconds);
    gas_free(g);
    forest_free(f);
    box_free(&box);
    return OK;
}

static status all_schemes(const struct comm *c, int side, int steps) {
    const char *pairs[][2] = {{"common", "PHM"},        {"Marquina", "PHM"},        {"common", "WPENO5"},
                              {"common", "WENO5"},      {"LaxFriedrichs", "WENO5"}, {"Marquina", "WPENO5"},
                              {"Rusanov", "firstOrder"}};
    for (int i = 0; i < (int)(sizeof pairs / sizeof *pairs); i++)
        TRY(time_scheme(c, "GoldshteinShapiro", 2, side, 63, true, steps, pairs[i][0], pairs[i][1]));
    TRY(time_scheme(c, "perfectGas", 2, side, 63, true, steps, "common", "WENO5"));
    TRY(time_scheme(c, "GoldshteinShapiro", 1, side * 100, 63, true, steps, "common", "PHM"));
    TRY(time_scheme(c, "GoldshteinShapiro", 3, side / 6 + 1, 40, true, steps, "common", "PHM"));
    TRY(time_scheme(c, "GoldshteinShapiro", 3, side / 6 + 1, 40, true, steps, "common", "WENO5"));
    return time_scheme(c, "GoldshteinShapiro", 3, side / 6 + 1, 40, true, steps, "LaxFriedrichs", "WENO5");
}

int main(int argc, char **argv) {
    struct comm *c;
    status s = comm_start(&argc, &argv, &c);
    int side = argc > 1 ? atoi(argv[1]) : 400, steps = argc > 2 ? atoi(argv[2]) : 20;
    int dim = argc > 5 ? atoi(argv[5]) : 2, tile = argc > 6 ? atoi(argv[6]) : dim < 3 ? 63 : 40;
    bool skip = argc < 8 || atoi(argv[7]) != 0;
    if (!s && argc > 4)
        s = time_scheme(c, "GoldshteinShapiro", dim, side, tile, skip, steps, argv[3], argv[4]);
    else if (!s)
        s = all_schemes(c, side, steps);
    int code = status_print(s, true);
    status_free(s);
    comm_finish(c);
    return code;
}
