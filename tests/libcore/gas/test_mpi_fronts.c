/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rule of single faces beside fronts of shocks (docs/physics.md 6.12) on both engines: a shock that stands along a
 * line of the mesh stays straight, and the bits depend on neither ranks, tiles, skipping nor restarts. */
#include "libcore/gas/gas.h"

#include "tests/libcore/oracle.h" /* last: cmocka.h defines fail() */
#include "tests/libcore/scene.h"

static struct comm *world, *alone;

struct way { /* in which a problem is run */
    const char *fronts, *flux;
    const struct comm *ranks;
    int tile;
    bool skip, restarts; /* restarts: the state is set anew before each step */
};

static void set_models(struct scene *s, const struct way *way) {
    *s = (struct scene){
        .models = {.material = {.diameter = 0.1, .mass = 1, .restitution = 1, .gamma = 5. / 3, .alpha_max = 0.65},
                   .eos = eos_find("perfectGas"),
                   .flux = flux_find(way->flux),
                   .flux_params = own_defaults(&flux_find(way->flux)->model),
                   .reconstruct = reconstruct_find("WPENO5"),
                   .polynomial = polynomial_find("linear"),
                   .stepper = stepper_find("SSPRK3"),
                   .skip_uniform = way->skip}};
    if (way->fronts)
        model_put(&s->models.flux->model, &s->models.flux_params, "fronts", strcmp(way->fronts, "off") != 0);
    set_walls(s, "zeroGradient");
}

typedef void initial(const struct scene *s, const double x[3], double *rho, double u[3], double *T);

static void start(struct scene *s, initial *at) {
    const int n = s->cells;
    double *all = calloc(5 * (size_t)n, sizeof *all), *u[3] = {all + n, all + 2 * n, all + 3 * n};
    for (int i = 0; i < n; i++) {
        double v[3] = {0, 0, 0};
        at(s, s->centre + 3 * i, &all[i], v, &all[4 * n + i]);
        for (int k = 0; k < 3; k++) u[k][i] = v[k];
    }
    ok(gas_set(s->gas, all, (const double *const *)u, all + 4 * n));
    free(all);
}

static void set_again(struct scene *s, const struct comm *c) {
    double *all = state_of(s, c), *U[MAX_VAR];
    for (int v = 0; v < gas_variables(s->gas); v++) U[v] = all + v * s->cells;
    gas_set_conserved(s->gas, (const double *const *)U);
    free(all);
}

static double *end_of(struct scene *s, const struct way *way, initial *at, int steps) {
    start(s, at);
    for (int i = 0; i < steps; i++) {
        if (way->restarts) set_again(s, way->ranks);
        run(s, 1, 0.5);
    }
    double *U = state_of(s, way->ranks);
    close_scene(s);
    return U;
}

/* A ball of hot gas that bursts into a stream: a shock runs through uniform gas. */
static void burst(const struct scene *s, const double x[3], double *rho, double u[3], double *T) {
    double square = 0;
    for (int k = 0; k < s->dim; k++) square += (x[k] - 0.4) * (x[k] - 0.4);
    *rho = 1;
    *T = square < 0.03 ? 100 : 1;
    u[0] = 1;
    u[1] = -0.5;
}

static double *burst_of(int mesh, const struct way *way, int *numbers) {
    static const struct cells_recipe recipe[] = {
        {"triangles", 2, PRISMS, {12, 7, 1}, {0, 1, 2}, 0.15, {false}},
        {"tetrahedra", 3, TETS, {8, 4, 3}, {0, 1, 2}, 0.1, {false}},
    };
    struct scene s;
    set_models(&s, way);
    if (mesh >= 2)
        open_polyhedra(&s, way->ranks, &recipe[mesh - 2]);
    else
        open_box(&s, way->ranks, 2 + mesh, (int[3]){mesh ? 23 : 41, mesh ? 17 : 27, mesh ? 12 : 1},
                 (double[3]){1, 0.8, 0.7}, (bool[3]){false, true, false}, way->tile);
    *numbers = (s.dim + 2) * s.cells;
    return end_of(&s, way, burst, 8);
}

/* On lattices, triangles and tetrahedra fronts are found, with the same bits in every way. */
static void no_way_changes_a_bit(void **state) {
    (void)state;
    const struct way ways[] = {
        {"on", "common", world, 8, false, false},   {"on", "common", world, 8, true, false},
        {"on", "common", world, 8, true, true},     {"on", "common", alone, 8, true, false},
        {"off", "common", alone, 40, false, false},
    };
    for (int mesh = 0; mesh < 4; mesh++) {
        int n;
        double *U = burst_of(mesh, &(struct way){"on", "common", alone, 40, false, false}, &n);
        for (int w = 0; w < 5; w++) {
            double *other = burst_of(mesh, &ways[w], &n);
            int differ = 0;
            for (int i = 0; i < n; i++) differ += U[i] != other[i];
            if (w == 4 ? differ == 0 : differ > 0)
                fail_msg("mesh %d, way %d: %d of %d numbers differ", mesh, w, differ, n);
            free(other);
        }
        free(U);
    }
}

static const double MACH = 8; /* of the stream before the shock, where rho, c are 1 */

/* A shock that stands in the middle; noise of 1e-3 along it in the gas before it. */
static void standing(const struct scene *s, const double x[3], double *rho, double u[3], double *T) {
    const double g = 5. / 3, denser = (g + 1) * MACH * MACH / ((g - 1) * MACH * MACH + 2);
    const double hotter = (2 * g * MACH * MACH - (g - 1)) / (g + 1) / denser, noise = 1e-3 * MACH;
    const bool before = x[0] < 0.5;
    *rho = before ? 1 : denser;
    *T = (before ? 1 : hotter) / g;
    u[0] = before ? MACH : MACH / denser;
    for (int k = 1; k < s->dim; k++) u[k] = before ? noise * sin(1e4 * x[0] + 2e4 * x[1] + 3e4 * x[2] + k) : 0;
}

/* The speed along the front over that of the stream, after some steps. */
static double bent(const char *fronts, const char *flux, int dim, const struct cells_recipe *recipe, int steps) {
    const struct way way = {fronts, flux, world, 40, false, false};
    const bool cyclic[3] = {false, true, true};
    struct scene s;
    double most = 0;
    set_models(&s, &way);
    if (recipe)
        open_polyhedra(&s, world, recipe);
    else
        open_box(&s, world, dim, (int[3]){20, 10, dim > 2 ? 6 : 1}, (double[3]){1, 0.5, 0.3}, cyclic, 40);
    const int n = s.cells;
    double *U = end_of(&s, &way, standing, steps);
    for (int k = 2; k <= dim; k++)
        for (int i = 0; i < n; i++) most = fmax(most, fabs(U[k * n + i] / U[i]) / MACH);
    free(U);
    return most;
}

/* After five crossings of the box the shock is as straight as by Marquina's flux: noise of 1e-3 has died down, while
 * without the rule it has grown to a tenth of the stream, more than ten times as much. The bound is what the issue of
 * carbuncles asks for. */
static void shocks_stay_straight(void **state) {
    (void)state;
    const struct cells_recipe quads = {"quads", 2, BOXES, {20, 5, 1}, {0, 1, 2}, 0, {false, true, false}};
    for (int dim = 2; dim <= 3; dim++) {
        const double on = bent("on", "common", dim, NULL, 300), off = bent("off", "common", dim, NULL, 300);
        if (on > 1e-2 || off < 10 * on) fail_msg("%dD: %g with the rule, %g without", dim, on, off);
    }
    const double on = bent("on", "common", 2, &quads, 500), off = bent("off", "common", 2, &quads, 500);
    if (on > 1e-2 || off < 10 * on) fail_msg("quads: %g with the rule, %g without", on, off);
}

int main(int argc, char **argv) {
    ok(comm_start(&argc, &argv, &world));
    ok(comm_alone(&alone));
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_way_changes_a_bit),
        cmocka_unit_test(shocks_stay_straight),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_alone_free(alone);
    comm_finish(world);
    return failed;
}
