/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whole steps of the gas on forests of tiles: conservation, bits that depend on neither tiles nor dimension, quiet
 * states, the limiter and the stop at a collapse. */
#include "libcore/gas/gas.h"
#include "mesh/lattice/box.h"

#include <unistd.h>

#include "tests/libcore/oracle.h" /* last: cmocka.h defines fail() */

static struct comm *world;

struct scene {
    struct box box;
    struct forest *forest;
    struct gas *gas;
    struct gas_models models;
    struct patch_rules rules[6];
    int cells;
};

static void must(status s) {
    if (s) fail_msg("%s", status_text(s));
}

static void open_scene(struct scene *s, int dim, const int n[3], bool periodic, const char *flux,
                       const char *reconstruct) {
    const double length[3] = {1, 1, 1};
    const bool wrapped[3] = {periodic, periodic, periodic};
    must(box_make(&s->box, dim, n, length, wrapped));
    s->models = (struct gas_models){
        .material = {.diameter = 0.1, .mass = 1, .restitution = 1, .gamma = 5. / 3, .alpha_max = 0.65},
        .eos = eos_find("GoldshteinShapiro"),
        .flux = flux_find(flux),
        .flux_params = own_defaults(&flux_find(flux)->model),
        .reconstruct = reconstruct_find(reconstruct),
        .stepper = stepper_find("SSPRK3"),
        .skip_uniform = true};
    for (int p = 0; p < 6; p++)
        s->rules[p] = (struct patch_rules){.density = {.type = boundary_find("zeroGradient")},
                                           .temperature = {.type = boundary_find("zeroGradient")},
                                           .velocity = {.type = boundary_find("slip")}};
    s->cells = s->box.mesh.ncells;
    must(forest_make(&s->box.lattice, &s->box.mesh, world, dim == 1 ? 16 : 8, &s->forest));
    must(gas_make(s->forest, &s->models, 6, s->rules, &s->gas));
}

static void close_scene(struct scene *s) {
    gas_free(s->gas);
    forest_free(s->forest);
    box_free(&s->box);
}

typedef void initial(const double x[3], double *rho, double u[3], double *T);

static void start(struct scene *s, initial *at) {
    int n = s->cells;
    double *all = malloc(5 * (size_t)n * sizeof *all), *u[3] = {all + n, all + 2 * n, all + 3 * n};
    const struct lattice *l = &s->box.lattice;
    for (int i = 0; i < n; i++) {
        double x[3] = {(i % l->n[0] + 0.5) * l->width[0], (i / l->n[0] % l->n[1] + 0.5) * l->width[1],
                       (i / l->n[0] / l->n[1] + 0.5) * l->width[2]},
               v[3] = {0, 0, 0};
        at(x, &all[i], v, &all[4 * n + i]);
        for (int k = 0; k < 3; k++) u[k][i] = v[k];
    }
    must(gas_set(s->gas, all, (const double *const *)u, all + 4 * n));
    free(all);
}

static void run(struct scene *s, int steps, double maxCo) { /* from t = 0 */
    double t = 0;
    for (int i = 0; i < steps; i++) {
        struct gas_speed speed;
        gas_speed(s->gas, &speed);
        double dt = maxCo / speed.rate;
        must(gas_step(s->gas, t, &dt, maxCo, 0, 1e-3, &speed));
        t += dt;
    }
}

/* Root's conserved state, broadcast: [nvar][cells], caller frees. */
static double *state_of(const struct scene *s) {
    int nvar = gas_variables(s->gas);
    double *all = calloc((size_t)(nvar * s->cells), sizeof *all), *U[MAX_VAR];
    for (int v = 0; v < nvar; v++) U[v] = all + v * s->cells;
    must(gas_get_conserved(s->gas, U));
    comm_broadcast(world, all, (long)sizeof *all * nvar * s->cells);
    return all;
}

static void splash(const double x[3], double *rho, double u[3], double *T) {
    *rho = 300 + 200 * sin(6.283185307179586 * (x[0] + 2 * x[1] - x[2]));
    *T = 2 + cos(6.283185307179586 * (x[0] - x[1]));
    for (int k = 0; k < 3; k++) u[k] = 3 * sin(6.283185307179586 * (x[k] + 0.1 * k)) + k;
}

static void conservation(void **state) {
    (void)state;
    for (int flux = 0; flux < flux_count; flux++)
        for (int dim = 1; dim <= 3; dim++)
            for (int walls = 0; walls < 2; walls++) {
                struct scene s;
                double before[MAX_VAR], after[MAX_VAR];
                open_scene(&s, dim, (int[3]){dim == 1 ? 60 : 16, 12, 8}, !walls, flux_table[flux].model.name, "WENO5");
                start(&s, splash);
                must(gas_totals(s.gas, before));
                run(&s, 20, 0.5);
                must(gas_totals(s.gas, after));
                double scale = before[dim + 1];
                assert_near(after[0], before[0], 2e-14 * before[0]);
                assert_near(after[dim + 1], before[dim + 1], 2e-14 * scale);
                for (int k = 1; k <= dim && !walls; k++) assert_near(after[k], before[k], 2e-14 * scale);
                must(gas_check(s.gas));
                close_scene(&s);
            }
}

static int direction; /* along which the planar flow varies */
static void planar(const double x[3], double *rho, double u[3], double *T) {
    double s = x[direction];
    *rho = s < 0.4 ? 400 : 120 + 30 * sin(20 * s);
    *T = s < 0.6 ? 3 : 1;
    u[direction] = 2 * sin(6 * s);
}

/* Fluxes and reconstructions do not know of ranks, only of cells that are there: on several ranks each is paired with
 * one or two of the others, on one rank with all of them. */
static bool paired(int flux, int r) {
    const int fewer = flux_count < reconstruct_count ? flux_count : reconstruct_count;
    return comm_size(world) == 1 || flux % fewer == r % fewer;
}

static void run_fixed(struct gas *g) { /* with a given dt: the Courant number counts the axes */
    for (int i = 0; i < 15; i++) {
        struct gas_speed speed;
        double dt = 2e-4;
        gas_speed(g, &speed);
        must(gas_step(g, 0, &dt, 1, 0, 0, &speed));
    }
}

/* A planar flow has the same bits in 1D, 2D, 3D and along x, y, z, for any tiles. */
static void one_is_two_is_three(void **state) {
    (void)state;
    for (int flux = 0; flux < flux_count; flux++)
        for (int r = 0; r < reconstruct_count; r++) {
            if (!paired(flux, r)) continue;
            struct scene line;
            direction = 0;
            open_scene(&line, 1, (int[3]){40, 1, 1}, false, flux_table[flux].model.name,
                       reconstruct_table[r].model.name);
            start(&line, planar);
            run_fixed(line.gas);
            double *expected = state_of(&line);
            for (int dim = 2; dim <= 3; dim++)
                for (direction = 0; direction < dim; direction++) {
                    struct scene s;
                    int n[3] = {4, 4, 4}, stride = 1;
                    n[direction] = 40;
                    for (int k = 0; k < direction; k++) stride *= n[k];
                    open_scene(&s, dim, n, false, flux_table[flux].model.name, reconstruct_table[r].model.name);
                    /* the same cell size along the flow */
                    start(&s, planar);
                    run_fixed(s.gas);
                    double *found = state_of(&s);
                    for (int i = 0; i < s.cells; i++) {
                        int at = i / stride % 40;
                        assert_true(found[i] == expected[at]);
                        assert_true(found[(1 + direction) * s.cells + i] == expected[40 + at]);
                        assert_true(found[(dim + 1) * s.cells + i] == expected[80 + at]);
                    }
                    free(found);
                    close_scene(&s);
                }
            free(expected);
            close_scene(&line);
        }
}

static void stream(const double x[3], double *rho, double u[3], double *T) {
    (void)x;
    *rho = 343.7;
    *T = 14.39;
    u[0] = 44.5;
    u[1] = -44.5;
    u[2] = 3;
}

/* Cooling and falling, a uniform stream stays uniform to the bit, for every scheme. */
static void free_stream(void **state) {
    (void)state;
    for (int flux = 0; flux < flux_count; flux++)
        for (int r = 0; r < reconstruct_count; r++) {
            if (!paired(flux, r)) continue;
            struct scene s;
            open_scene(&s, 2, (int[3]){20, 12, 1}, true, flux_table[flux].model.name, reconstruct_table[r].model.name);
            gas_free(s.gas);
            s.models.material.restitution = 0.9;
            s.models.source = (struct sources){.cooling = cooling_find("Haff"), .gravity = {700, -700, 0}};
            must(gas_make(s.forest, &s.models, 6, s.rules, &s.gas));
            start(&s, stream);
            run(&s, 30, 0.5);
            double *U = state_of(&s);
            for (int v = 0; v < 4; v++)
                for (int i = 1; i < s.cells; i++) assert_true(U[v * s.cells + i] == U[v * s.cells]);
            free(U);
            close_scene(&s);
        }
}

static void pellet(const double x[3], double *rho, double u[3], double *T) { /* a dense pellet in a falling stream */
    double r = 0;
    for (int k = 0; k < 3; k++) r += (x[k] - 0.4) * (x[k] - 0.4) * (k < 2 || x[2] != 0.5);
    *rho = r < 0.02 ? 600 : 100;
    *T = r < 0.02 ? 30 : 4;
    u[0] = 3;
    u[1] = -2;
}

enum sides { WALLED, PERIODIC, OPEN, SIDES };
static const char *const sides_text[] = {"walls", "periodic", "open"};

/* A pellet in a falling stream that cools; the fluxes have no rules of single faces if `plain`. */
static void open_pellet(struct scene *s, int dim, enum sides sides, const char *flux, bool plain,
                        const char *reconstruct, bool skip) {
    open_scene(s, dim, (int[3]){dim == 1 ? 120 : 41, dim == 2 ? 27 : 14, 9}, sides == PERIODIC, flux, reconstruct);
    gas_free(s->gas);
    for (int p = 0; p < 6 && sides == OPEN; p++) s->rules[p].velocity.type = boundary_find("zeroGradient");
    if (plain) s->models.flux_params = (struct own_params){0};
    s->models.skip_uniform = skip;
    s->models.material.restitution = 0.9;
    s->models.source = (struct sources){.cooling = cooling_find("Haff"), .gravity = {30, -20, 0}};
    must(gas_make(s->forest, &s->models, 6, s->rules, &s->gas));
    start(s, pellet);
}

static void compare_skipping(int dim, enum sides sides, const char *flux, bool plain, const char *reconstruct) {
    double *U[2];
    int cells = 0, nvar = dim + 2;
    for (int skip = 0; skip < 2; skip++) {
        struct scene s;
        open_pellet(&s, dim, sides, flux, plain, reconstruct, skip);
        run(&s, dim == 3 ? 3 : 12, 0.6);
        U[skip] = state_of(&s);
        cells = s.cells;
        close_scene(&s);
    }
    for (int i = 0; i < nvar * cells; i++)
        if (U[0][i] != U[1][i])
            fail_msg("%s%s %s %dD %s: variable %d of cell %d is %.17g, with skipping %.17g", flux,
                     plain ? " without rules" : "", reconstruct, dim, sides_text[sides], i / cells, i % cells, U[0][i],
                     U[1][i]);
    free(U[0]);
    free(U[1]);
}

/* What is left out is exactly zero: the same bits with and without skipping, in every dimension, with walls and open
 * patches, cooling, gravity, and limited cells. Fluxes and reconstructions meet each kind of sides in each dimension,
 * not each pair of them. */
static void skipping_changes_no_bit(void **state) {
    (void)state;
    for (int flux = 0; flux < flux_count; flux++)
        for (int r = 0; r < reconstruct_count; r++)
            for (int dim = 1; dim <= 3 && paired(flux, r); dim++)
                compare_skipping(dim, (flux + r + dim) % SIDES, flux_table[flux].model.name, false,
                                 reconstruct_table[r].model.name);
    for (int r = 0; r < reconstruct_count; r++)
        for (int dim = 1; dim <= 3; dim++) compare_skipping(dim, OPEN, "common", true, reconstruct_table[r].model.name);
}

/* The fewer cells a reconstruction reads, the fewer are computed beside those that differ. Rules of faces read as many
 * as WENO5, but let fewer differ. */
static void reach_decides_what_is_computed(void **state) {
    (void)state;
    const char *const reconstruct[] = {"firstOrder", "PHM", "WENO5", "PHM"};
    double share[4];
    for (int i = 0; i < 4; i++) {
        struct scene s;
        open_pellet(&s, 2, OPEN, "common", i < 3, reconstruct[i], true);
        run(&s, 1, 0.6);
        share[i] = gas_computed_share(s.gas);
        close_scene(&s);
    }
    assert_true(share[0] > 0.05 && share[0] < share[1] && share[1] < share[3] && share[3] < share[2]);
}

/* A disk of hot gas in a stream along y. */
static void burst(const double x[3], double *rho, double u[3], double *T) {
    *rho = 100;
    *T = (x[0] - 0.5) * (x[0] - 0.5) + (x[1] - 0.5) * (x[1] - 0.5) < 0.01 ? 8 : 4;
    u[1] = 1;
}

/* Ahead of a wave nothing moves across the stream but what falls from cell to cell without ever being 0. It ends where
 * the wave's density does, and is not carried on by three cells a stage; nothing else changes. */
static void waves_end(void **state) {
    (void)state;
    struct scene s;
    double before[MAX_VAR], after[MAX_VAR];
    int denser = 0, moving = 0;
    open_scene(&s, 2, (int[3]){100, 100, 1}, true, "common", "WENO5");
    start(&s, burst);
    must(gas_totals(s.gas, before));
    run(&s, 20, 0.5);
    must(gas_totals(s.gas, after));
    double *U = state_of(&s);
    for (int i = 0; i < s.cells; i++) {
        denser += U[i] != U[0];
        moving += U[s.cells + i] != 0;
    }
    assert_true(denser > 400 && moving < 1.05 * denser && denser < 0.5 * s.cells);
    assert_near(after[0], before[0], 2e-14 * before[0]);
    assert_near(after[3], before[3], 2e-14 * before[3]);
    free(U);
    close_scene(&s);
}

static const double FAINT = 0x1p-40;
/* A stream along x whose velocity across is a wave of FAINT times some speed of sound. */
static void faint(const double x[3], double *rho, double u[3], double *T) {
    *rho = 300;
    *T = 2;
    u[0] = 1;
    u[1] = FAINT * sin(6.283185307179586 * x[0]);
}

/* Only what is below round-off counts as none: a faint wave of momentum, which changes no bit of mass and energy, is
 * carried as any other. A wave of 2^-30 is off by 7.4e-5 of itself, this one by 1.08e-4; the bound is 1.3 times that.
 */
static void faint_waves_are_carried(void **state) {
    (void)state;
    enum { N = 32 };
    struct scene s;
    open_scene(&s, 2, (int[3]){N, 4, 1}, true, "common", "WENO5");
    start(&s, faint);
    double t = 0, most = 0;
    while (t < 0.25) {
        struct gas_speed speed;
        gas_speed(s.gas, &speed);
        double dt = smaller(0.5 / speed.rate, 0.25 - t);
        must(gas_step(s.gas, t, &dt, 0.5, 0, 1e-3, &speed));
        t += dt;
    }
    double *U = state_of(&s);
    for (int i = 0; i < s.cells; i++) {
        const double wave = FAINT * sin(6.283185307179586 * ((i % N + 0.5) / N - t));
        most = larger(most, fabs(U[2 * s.cells + i] / U[i] - wave));
    }
    assert_true(most < 1.4e-4 * FAINT);
    free(U);
    close_scene(&s);
}

static void blast(const double x[3], double *rho, double u[3], double *T) {
    bool inside = x[0] > 0.4 && x[0] < 0.6;
    *rho = inside ? 1100 : 1e-3; /* close packing is at 1241 */
    *T = inside ? 1e-6 : 1e-6;
    u[0] = x[0] < 0.5 ? 5 : -5;
}

/* Grains that collide at Mach 5000 near close packing beside a vacuum: the net holds, mass stays, the run says so. */
static void safety_net(void **state) {
    (void)state;
    for (int flux = 0; flux < flux_count; flux++) {
        struct scene s;
        double before[MAX_VAR], after[MAX_VAR];
        open_scene(&s, 1, (int[3]){80, 1, 1}, false, flux_table[flux].model.name, "WENO5");
        start(&s, blast);
        must(gas_totals(s.gas, before));
        run(&s, 40, 0.5);
        must(gas_check(s.gas));
        must(gas_totals(s.gas, after));
        assert_near(after[0], before[0], 1e-13 * before[0]);
        assert_near(after[2], before[2], 1e-13 * before[2]);
        struct gas_counts c = gas_counts(s.gas);
        if (strcmp(flux_table[flux].model.name, "Rusanov") != 0) assert_true(c.cells + c.rejected > 0);
        assert_true(c.faces <= 2 * c.cells);
        close_scene(&s);
    }
}

/* Every step from a state that was set, as after a restart, where nothing is known of earlier mended cells. */
static void run_restarting(struct scene *s, int steps, double maxCo) {
    double t = 0, *U[MAX_VAR];
    for (int i = 0; i < steps; i++) {
        struct gas_speed speed;
        double *all = state_of(s);
        for (int v = 0; v < gas_variables(s->gas); v++) U[v] = all + v * s->cells;
        gas_set_conserved(s->gas, (const double *const *)U);
        free(all);
        gas_speed(s->gas, &speed);
        double dt = maxCo / speed.rate;
        must(gas_step(s->gas, t, &dt, maxCo, 0, 1e-3, &speed));
        t += dt;
    }
}

/* A step that is done again stage by stage has the bits and counts of one that was looked at so from its start. */
static void looking_once_a_step(void **state) {
    (void)state;
    const char *steppers[] = {"SSPRK3", "SSPRK104"};
    for (int i = 0; i < 2; i++) {
        double *U[2];
        struct gas_counts c[2];
        int numbers = 0;
        for (int restarting = 0; restarting < 2; restarting++) {
            struct scene s;
            open_scene(&s, 1, (int[3]){80, 1, 1}, false, "Marquina", "WENO5");
            gas_free(s.gas);
            s.models.stepper = stepper_find(steppers[i]);
            s.models.material.restitution = 0.9;
            s.models.source = (struct sources){.cooling = cooling_find("Haff"), .gravity = {30, -20, 0}};
            must(gas_make(s.forest, &s.models, 6, s.rules, &s.gas));
            start(&s, blast);
            (restarting ? run_restarting : run)(&s, 40, 0.5);
            U[restarting] = state_of(&s);
            c[restarting] = gas_counts(s.gas);
            numbers = gas_variables(s.gas) * s.cells;
            close_scene(&s);
        }
        assert_true(c[0].cells > 0);
        assert_memory_equal(&c[0], &c[1], sizeof c[0]);
        assert_memory_equal(U[0], U[1], (size_t)numbers * sizeof *U[0]);
        free(U[0]);
        free(U[1]);
    }
}

static void pile(const double x[3], double *rho, double u[3], double *T) {
    *rho = x[0] > 0.9 ? 1200 : 100;
    *T = 1;
    u[0] = 20;
}

/* A cooling gas driven onto a wall packs in finite time: a clean stop with time, place and the last good state. */
static void collapse(void **state) {
    (void)state;
    struct scene s;
    open_scene(&s, 1, (int[3]){40, 1, 1}, false, "common", "PHM");
    gas_free(s.gas);
    s.models.material.restitution = 0.5;
    s.models.source = (struct sources){.cooling = cooling_find("Haff"), .gravity = {980, 0, 0}};
    must(gas_make(s.forest, &s.models, 6, s.rules, &s.gas));
    start(&s, pile);
    double t = 0;
    status stop = OK;
    for (int i = 0; i < 20000 && !stop; i++) {
        struct gas_speed speed;
        gas_speed(s.gas, &speed);
        double dt = 0.5 / speed.rate;
        stop = gas_step(s.gas, t, &dt, 0.5, 0, 1e-2, &speed);
        t += stop ? 0 : dt;
    }
    assert_non_null(stop);
    assert_int_equal(status_kind(stop), ERR_STATE);
    assert_non_null(strstr(status_text(stop), "inelastic collapse at t = "));
    status_free(stop);
    must(gas_check(s.gas));
    close_scene(&s);
}

/* dt is maxCo over the largest sum of (|u_k| + c)/width_k of all cells: no larger, and no smaller. */
static void speed_is_the_largest_rate(void **state) {
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        const int n[3] = {24, 20, 16};
        struct scene s = {.gas = NULL};
        struct gas_speed speed;
        double most = 0, fast[3] = {0, 0, 0};
        open_scene(&s, dim, n, true, "common", "WENO5");
        start(&s, splash);
        gas_speed(s.gas, &speed);
        for (int i = 0; i < s.cells; i++) {
            const int at[3] = {i % n[0], i / n[0] % n[1], i / n[0] / n[1]};
            double x[3], u[3] = {0, 0, 0}, rho, T, p, c2, g, rate = 0;
            for (int k = 0; k < 3; k++) x[k] = k < dim ? (at[k] + 0.5) / n[k] : 0.5;
            splash(x, &rho, u, &T);
            const double eps = T / (s.models.material.gamma - 1);
            s.models.eos->state(&s.models.material, 1, &rho, &eps, &p, &c2, &g);
            for (int k = 0; k < dim; k++) {
                rate += (fabs(u[k]) + sqrt(c2)) * n[k];
                fast[k] = larger(fast[k], fabs(u[k]) + sqrt(c2));
            }
            most = larger(most, rate);
        }
        assert_close(speed.rate, most, 1e-12, "rate");
        for (int k = 0; k < dim; k++) assert_close(speed.axis[k], fast[k], 1e-12, "speed along an axis");
        close_scene(&s);
    }
}

/* Cells whose density is the last number below the limit, of grains whose alpha is rounded to alphaMax there, and so
 * hot that c^2 overflows. */
static double last_density;
static void to_the_last_digit(const double x[3], double *rho, double u[3], double *T) {
    (void)u;
    *rho = x[0] > 0.5 ? last_density : 100;
    *T = x[0] > 0.5 ? 1e285 : 1;
}

static void stands_still(struct scene *s, double t, double dt, const char *parts) {
    struct gas_speed speed;
    gas_speed(s->gas, &speed);
    if (dt == 0) dt = 0.5 / speed.rate;
    status stop = gas_step(s->gas, t, &dt, 0.5, 0, 0, &speed);
    assert_non_null(stop);
    assert_int_equal(status_kind(stop), ERR_STATE);
    char copy[256];
    snprintf(copy, sizeof copy, "%s", parts);
    for (char *part = strtok(copy, "|"); part; part = strtok(NULL, "|"))
        if (!strstr(status_text(stop), part)) fail_msg("'%s' does not say '%s'", status_text(stop), part);
    status_free(stop);
}

/* A step that would be 0, or less than some last digits of t, ends the run; without that the test would hang. */
static void endless_steps(void **state) {
    (void)state;
    struct scene s;
    open_scene(&s, 1, (int[3]){40, 1, 1}, false, "common", "PHM");
    do {
        s.models.material.diameter += 1e-3;
        last_density = nextafter(density_limit(s.models.eos, &s.models.material), 0);
    } while (last_density * packing_per_density(&s.models.material) < s.models.material.alpha_max);
    gas_free(s.gas);
    must(gas_make(s.forest, &s.models, 6, s.rules, &s.gas));
    (void)alarm(60);
    start(&s, to_the_last_digit);
    stands_still(&s, 0, 0, "the speed of sound is without bound at t = 0, (0.5|alpha = 0.6|start below it");
    start(&s, pile);
    stands_still(&s, 1e16, 1e-3, "time stands still at t = 1e+16|less than some last digits of t|alpha = ");
    s.rules[1].velocity.type = boundary_find("zeroGradient");
    s.rules[1].density = (struct rule){.type = boundary_find("fixedValue"), .uniform = {100}};
    start(&s, pile);
    stands_still(&s, 1e16, 1e-3, "time stands still|gives the density and leaves T free");
    (void)alarm(0);
    close_scene(&s);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(conservation),
        cmocka_unit_test(one_is_two_is_three),
        cmocka_unit_test(free_stream),
        cmocka_unit_test(skipping_changes_no_bit),
        cmocka_unit_test(reach_decides_what_is_computed),
        cmocka_unit_test(waves_end),
        cmocka_unit_test(faint_waves_are_carried),
        cmocka_unit_test(safety_net),
        cmocka_unit_test(collapse),
        cmocka_unit_test(endless_steps),
        cmocka_unit_test(looking_once_a_step),
        cmocka_unit_test(speed_is_the_largest_rate),
    };
    status s = comm_start(&argc, &argv, &world);
    if (s) return status_print(s, true);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
