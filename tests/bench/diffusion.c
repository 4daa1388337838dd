/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nanoseconds a cell and stage of viscous stress and of heat conduction on tiles, of what a super step of 25 stages has
 * at its ends, and of a whole half step, on one core: bench_diffusion [rounds]. Disks between two walls, periodic
 * along them, disturbed everywhere. Then whole steps of spheres in a periodic 3D box, at a Courant number of 1/2 and so
 * little diffusion that two stages do, over those of the same gas without transport. CPU time of the process, the best
 * of the rounds. */
#include "libcore/gas/gas_private.h"
#include "mesh/grid/grid.h"
#include "mesh/lattice/box.h"
#include "tests/bench/clock.h"
#include "tests/defaults.h"

#include <stdio.h>

enum { STAGES = 25 };

static status fill(struct gas *g, int nx, int ny) {
    double *all, *u[3] = {NULL};
    const long cells = (long)nx * ny;
    TRY(allocate(&all, 4 * cells, sizeof(double), "fields"));
    for (int k = 0; k < 2; k++) u[k] = all + (2 + k) * cells;
    for (long i = 0; i < cells; i++) {
        const double x = 6.283185307 * (double)(i % nx) / nx, y = 6.283185307 * (double)(i / nx) / ny;
        all[i] = 0.5 + 0.4 * sin(2 * x + y) * cos(y);
        all[cells + i] = 20 + 5 * cos(x - 2 * y);
        for (int k = 0; k < 2; k++) u[k][i] = 30 * sin(x + y + k);
    }
    status s = gas_set(g, all, (const double *const *)u, all + cells);
    free(all);
    return s;
}

/* Seconds of `super` super steps of that many stages, their last one included. */
static double time_stages(struct gas *g, enum diffusing what, int super, int stages, double dt) {
    const double start = cpu_seconds();
    for (int i = 0; i < super; i++) {
        double c[5];
        g->engine->diffusion.begin(g, what, &g->U, dt, 0);
        for (int j = 2; j <= stages; j++) {
            g->models.diffusion->stage(STAGES, j, c);
            c[2] *= dt;
            c[3] *= dt;
            c[4] = 0;
            g->engine->diffusion.stage(g, what, &g->U, c, dt);
        }
        (void)g->engine->diffusion.end(g, what, &g->U, &g->U0, dt, dt);
    }
    return cpu_seconds() - start;
}

/* Prints the parts of a half step, each the best of the rounds. */
static void time_parts(struct gas *g, const char *name, double cells, int rounds) {
    const int super = cells < 1e5 ? 20 : 1;
    double best[2] = {1, 1}, ends[2] = {1, 1}, coefficients = 1, rate[2];
    for (int i = 0; i < rounds; i++) {
        const double start = cpu_seconds();
        g->engine->diffusion.rates(g, &g->U, rate, NULL);
        coefficients = smaller(coefficients, cpu_seconds() - start);
        const double dt = 1 / larger(rate[0], rate[1]);
        for (int what = 0; what < 2; what++) {
            const double two = time_stages(g, what, super, 2, dt) / super;
            ends[what] = smaller(ends[what], two);
            best[what] = smaller(best[what], (time_stages(g, what, super, STAGES, dt) / super - two) / (STAGES - 2));
        }
    }
    printf(
        "%-11s ns a cell and stage: viscous %5.2f, heat %5.2f; ends of a super step %5.2f, %5.2f, coefficients %5.2f\n",
        name, 1e9 * best[VISCOUS] / cells, 1e9 * best[HEAT] / cells, 1e9 * ends[VISCOUS] / cells,
        1e9 * ends[HEAT] / cells, 1e9 * coefficients / cells);
}

static status time_box(const struct comm *c, int nx, int ny, int rounds) {
    struct box box;
    struct forest *f;
    struct gas *g;
    static struct patch_rules rules[6];

    struct gas_models m = {.material = {.diameter = 1, .mass = 1, .restitution = 0.75, .gamma = 2, .disks = true},
                           .eos = eos_find("TorquatoDisks"),
                           .flux = flux_find("common"),
                           .reconstruct = reconstruct_find("WENO5"),
                           .stepper = stepper_find("SSPRK3"),
                           .transport = transport_find("JenkinsRichman"),
                           .diffusion = diffusion_find("RKL2")};
    model_defaults(&m.eos->model, &m.material);
    m.transport_params = own_defaults(&m.transport->model);
    for (int p = 0; p < 6; p++) {
        rules[p] = (struct patch_rules){.density = {.type = NULL}};
        rules[p].density.type = rules[p].temperature.type = boundary_find("zeroGradient");
        rules[p].velocity.type = boundary_find("slip");
    }
    TRY(box_make(&box, 2, (int[3]){nx, ny, 1}, (double[3]){2. * nx, ny, 1}, (bool[3]){true, false, false}));
    TRY(forest_make(&box.lattice, &box.mesh, c, 60, &f));
    TRY(gas_make(f, &m, 6, rules, &g));
    TRY(fill(g, nx, ny));
    char name[32];
    (void)snprintf(name, sizeof name, "%4d x %-4d", nx, ny);
    time_parts(g, name, (double)nx * ny, rounds);
    gas_free(g);
    forest_free(f);
    box_free(&box);
    return OK;
}

/* ---- whole steps in 3D ---- */

enum { SIDE = 64, GASES = 3 };
static const char *const gas_name[GASES] = {"inviscid", "GarzoDufty", "GarzoDufty, zetaU full"};

static status fill_spheres(struct gas *g) {
    double *all, *u[3];
    const long cells = (long)SIDE * SIDE * SIDE;
    TRY(allocate(&all, 5 * cells, sizeof(double), "fields"));
    for (int k = 0; k < 3; k++) u[k] = all + (2 + k) * cells;
    for (long i = 0; i < cells; i++) {
        const double turn = 6.283185307 / SIDE, x = turn * (double)(i % SIDE), y = turn * (double)(i / SIDE % SIDE),
                     z = turn * (double)(i / SIDE / SIDE);
        all[i] = 500 + 200 * sin(2 * x + y) * cos(y - z);
        all[cells + i] = 20 + 5 * cos(x - 2 * y + z);
        for (int k = 0; k < 3; k++) u[k][i] = 10 * sin(x + y + k) * cos(z) + 5;
    }
    status s = gas_set(g, all, (const double *const *)u, all + cells);
    free(all);
    return s;
}

static status make_spheres(struct forest *f, const char *reconstruct, int which, struct gas **out) {
    static struct patch_rules none[6];
    struct gas_models m = {.material = {.diameter = 0.1, .mass = 1, .restitution = 0.9},
                           .eos = eos_find("TorquatoSpheres"),
                           .flux = flux_find("common"),
                           .reconstruct = reconstruct_find(reconstruct),
                           .stepper = stepper_find("SSPRK3"),
                           .diffusion = diffusion_find("RKJ2"),
                           .source = {.cooling = cooling_find("GarzoDufty"), .gravity = {10, -10, 0}}};
    model_defaults(&m.eos->model, &m.material);
    if (which) {
        m.transport = transport_find("GarzoDufty");
        m.transport_params = own_defaults(&m.transport->model);
        model_put(&m.transport->model, &m.transport_params, "zetaU", which == 2 ? 2 : 0);
    }
    TRY(gas_make(f, &m, 6, none, out));
    return fill_spheres(*out);
}

/* Steps of the three gases in turn. */
static status time_steps(struct forest *f, const char *reconstruct, int rounds) {
    struct gas *g[GASES];
    double best[GASES], t[GASES] = {0};
    for (int i = 0; i < GASES; i++) {
        TRY(make_spheres(f, reconstruct, i, &g[i]));
        best[i] = HUGE_VAL;
    }
    for (int round = -1; round < rounds; round++) /* the first one warms up */
        for (int i = 0; i < GASES; i++) {
            const double start = cpu_seconds();
            struct gas_speed speed;
            gas_speed(g[i], &speed);
            double dt = 0.5 / speed.rate;
            TRY(gas_step(g[i], t[i], &dt, 0.5, 0, 0, &speed));
            t[i] += dt;
            if (round >= 0) best[i] = smaller(best[i], cpu_seconds() - start);
        }
    for (int i = 0; i < GASES; i++) {
        const struct gas_counts n = gas_counts(g[i]);
        printf("%d^3 %-6s %-22s ns a cell and step %7.1f, over inviscid %.2f", SIDE, reconstruct, gas_name[i],
               1e9 * best[i] / f->ncells_all, best[i] / best[0]);
        if (i)
            printf(", stages %.2f and %.2f a half step, %ld repeated", (double)n.stages[VISCOUS] / (double)n.halves,
                   (double)n.stages[HEAT] / (double)n.halves, n.repeated);
        printf("\n");
        gas_free(g[i]);
    }
    return OK;
}

static status time_spheres(const struct comm *c, int rounds) {
    struct box box;
    struct forest *f;
    struct gas *g;
    TRY(box_make(&box, 3, (int[3]){SIDE, SIDE, SIDE}, (double[3]){10, 10, 10}, (bool[3]){true, true, true}));
    TRY(forest_make(&box.lattice, &box.mesh, c, grid_tile_size(3), &f));
    TRY(make_spheres(f, "PHM", 1, &g));
    time_parts(g, "64^3", f->ncells_all, rounds / 4 + 1);
    gas_free(g);
    TRY(time_steps(f, "PHM", rounds));
    TRY(time_steps(f, "WENO5", rounds));
    forest_free(f);
    box_free(&box);
    return OK;
}

int main(int argc, char **argv) {
    struct comm *c;
    status s = comm_start(&argc, &argv, &c);
    const int rounds = argc > 1 ? atoi(argv[1]) : 20;
    if (!s) s = time_box(c, 75, 60, rounds);
    if (!s && rounds < 100) s = time_box(c, 1000, 1000, rounds / 10 + 1);
    if (!s) s = time_spheres(c, rounds);
    int code = status_print(s, true);
    status_free(s);
    comm_finish(c);
    return code;
}
