/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Heat is conducted with what the stress makes of T and with what cooling takes: nothing is split between these, on
 * either mesh engine, however a half step is cut into parts. */
#include "tests/libcore/sources.h"

#include "tests/libcore/gas/viscous.h" /* last: cmocka.h defines fail() */

static struct comm *world;
enum { N = 32, WIDE = 4 };

static const double SLOW = 0.7, FAST = 70; /* viscosity, heat conductivity */
static void law(const struct own_params *params, const struct closure_line *cells, double *restrict bulk,
                double *restrict shear, double *restrict heat) {
    (void)params;
    for (int i = 0; i < cells->n; i++) {
        bulk[i] = shear[i] = SLOW;
        heat[i] = FAST;
    }
}
static const struct transport LAW = {.coefficients = law};

static bool can(int scheme, bool polyhedral) {
    return diffusion_table[scheme].plan || (!polyhedral && scheme_is_there(scheme));
}

/* What a scheme leaves of a mode that decays by exp(-40) over one step: R(-40), nothing to speak of but where a scheme
 * is A-stable only. Of what a constant source gives such a mode, 1/40 of it a step, it leaves 1 - R times as much. */
static double left_of_40(int scheme) {
    const struct diffusion *d = &diffusion_table[scheme];
    if (d->plan || d->implicit == BY_SDIRK) return 0;
    return d->implicit == BY_MIDPOINT ? -19. / 21 : (1 - 20 + 1600. / 12) / (1 + 20 + 1600. / 12);
}

/* N x WIDE squares, from 0 to 1 along x: periodic, or between walls of T = 1 and 2 with gas that cools and is heated
 * (m^2/s^3). */
static void open_models(struct scene *s, const struct transport *law, const char *diffusion, bool polyhedral,
                        initial *at, bool walls, double heating) {
    const struct cells_recipe boxes = {"boxes", 2, BOXES, {N, WIDE, 1}, {0, 1, 2}, 0, {!walls, true, true}};
    *s = (struct scene){.dim = 2, .models = disks_models(law, diffusion)};
    s->models.source.cooling = walls ? cooling_find("Haff") : NULL;
    if (heating > 0) choose_source(&s->models.source, "uniformHeating", &heating);
    set_walls(s, "slip");
    for (int p = 0; p < 2 && walls; p++)
        s->rules[p].temperature = (struct rule){.type = boundary_find("fixedValue"), .uniform = {1 + p}};
    if (polyhedral) {
        s->mesh = cells_make(&boxes);
        for (int i = 0; i < 3 * s->mesh->npoints; i++) s->mesh->points[i] /= 0.1 * (i % 3 + 1) * N;
        open_mesh(s, world);
    } else {
        open_box(s, world, 2, boxes.n, (double[3]){1, (double)WIDE / N, 1}, boxes.cyclic, 16);
    }
    start(s, at);
}

static void open_scene(struct scene *s, const char *diffusion, bool polyhedral, initial *at) {
    open_models(s, &LAW, diffusion, polyhedral, at, false, 0);
}

/* The state after n half steps, of the same total energy; caller frees. */
static double *after(struct scene *s, int steps, double time) {
    double before[MAX_VAR], end[MAX_VAR];
    ok(gas_totals(s->gas, before));
    spread(s, steps, time / steps);
    ok(gas_totals(s->gas, end));
    assert_near(end[3], before[3], 1e-13 * before[3]);
    return state_of(s, world);
}

/* ---- a shear flow --------------------------------------------------------------------------------------------------
 */

static const double K = TWO_PI, SPEED = 2;
static void shearing(const double x[3], double *rho, double u[3], double *T) {
    *rho = 1;
    *T = 1;
    u[1] = SPEED * sin(K * x[0]);
}

/* The amplitude of T along cos 2 K x that u = SPEED exp(-SLOW K^2 t) sin K x makes by its friction, SLOW u'^2. */
static double exact_wave(double t) {
    const double rate = 2 * SLOW * K * K, loss = 4 * FAST * K * K;
    return 0.25 * SPEED * SPEED * rate * (exp(-rate * t) - exp(-loss * t)) / (loss - rate);
}

static double wave_of(const struct scene *s, const double *all) {
    double sum = 0;
    for (int i = 0; i < s->cells; i++) sum += 2 * temperature(all, 2, s->cells, i) * cos(2 * K * s->centre[3 * i]);
    return sum / s->cells;
}

/* One half step in which the wave of T would decay by exp(-40): a first half of friction and a second one of conduction
 * leave nothing of it, or what a scheme leaves of stiff modes. Schemes that are A-stable only hold twice as much, or a
 * quarter. */
static void fast_conduction_holds_the_heat_of_friction(void **state) {
    (void)state;
    const double time = 40 / (4 * FAST * K * K);
    for (int scheme = 0; scheme < diffusion_count; scheme++)
        for (int polyhedral = 0; polyhedral < 2 && can(scheme, polyhedral); polyhedral++) {
            struct scene s;
            open_scene(&s, diffusion_table[scheme].model.name, polyhedral, shearing);
            double *all = after(&s, 1, time);
            assert_close(wave_of(&s, all), (1 - left_of_40(scheme)) * exact_wave(time), 0.2,
                         diffusion_table[scheme].model.name);
            free(all);
            close_scene(&s);
        }
}

static void friction_and_conduction_are_of_second_order(void **state) {
    (void)state;
    const double time = 4 / (4 * FAST * K * K);
    for (int polyhedral = 0; polyhedral < 2; polyhedral++) {
        struct scene s;
        open_scene(&s, "explicit", polyhedral, shearing);
        double *exact = after(&s, 512, time);
        assert_close(wave_of(&s, exact), exact_wave(time), 0.03, "many small steps");
        close_scene(&s);
        for (int scheme = 0; scheme < diffusion_count && can(scheme, polyhedral); scheme++) {
            double error[2] = {0, 0};
            for (int i = 0; i < 2; i++) {
                open_scene(&s, diffusion_table[scheme].model.name, polyhedral, shearing);
                double *all = after(&s, 4 << i, time);
                for (int k = 0; k < 4 * s.cells; k++) error[i] = fmax(error[i], fabs(all[k] - exact[k]));
                free(all);
                close_scene(&s);
            }
            assert_true(log2(error[0] / error[1]) > 1.8);
            assert_true(error[1] < 0.01 * exact_wave(time));
        }
        free(exact);
    }
}

/* ---- thin cells ----------------------------------------------------------------------------------------------------
 */

static double spot_T; /* of the second one */
static void thin_cells(const double x[3], double *rho, double u[3], double *T) {
    const int i = (int)(x[0] * N);
    shearing(x, rho, u, T);
    if (i == N / 2) *rho = 0.01;
    if (i == N / 4) {
        *rho = 0.01;
        *T = spot_T;
    }
}

/* T of the first thin column above the mean of those beside it. */
static double excess(const struct scene *s, const double *all) {
    double sum = 0;
    for (int i = 0; i < s->cells; i++) {
        const int off = abs((int)(s->centre[3 * i] * N) - N / 2);
        if (off < 2) sum += (off ? -0.5 : 1) * temperature(all, 2, s->cells, i) / WIDE;
    }
    return sum;
}

/* A thin cell between dense ones loses heat so fast that it stays nearly as cold as they are, whatever friction brings
 * to it (with A-stable schemes 1 - R(-40) times as warm): also when the half step is done in parts, here as another one
 * is hot and would be left below zero. */
static void thin_cells_stay_cold(void **state) {
    (void)state;
    const double time = 40 / (2 * FAST * N * N / 0.01);
    for (int hot = 0; hot < 2; hot++)
        for (int polyhedral = 0; polyhedral < 2; polyhedral++) {
            struct scene s;
            long repeated = 0;
            spot_T = hot ? 300 : 1;
            open_scene(&s, "explicit", polyhedral, thin_cells);
            double *all = after(&s, 16, time);
            const double exact = excess(&s, all);
            free(all);
            close_scene(&s);
            for (int scheme = 0; scheme < diffusion_count && can(scheme, polyhedral); scheme++) {
                open_scene(&s, diffusion_table[scheme].model.name, polyhedral, thin_cells);
                all = after(&s, 1, time);
                repeated += gas_counts(s.gas).repeated;
                const bool again = gas_counts(s.gas).repeated > 0; /* in parts, by backward Euler if it is implicit */
                assert_close(excess(&s, all), (again ? 1 : 1 - left_of_40(scheme)) * exact, 0.12,
                             diffusion_table[scheme].model.name);
                free(all);
                close_scene(&s);
            }
            assert_true((repeated > 0) == hot);
        }
}

/* ---- friction of packed grains -------------------------------------------------------------------------------------
 */

static double part; /* of the viscosities of LAW */
static void law_in_part(const struct own_params *params, const struct closure_line *cells, double *restrict bulk,
                        double *restrict shear, double *restrict heat) {
    law(params, cells, bulk, shear, heat);
    for (int i = 0; i < cells->n; i++) {
        bulk[i] *= part;
        shear[i] *= part;
    }
}

/* Half steps of the shear flow, between alphaFriction and alphaSolid if it has friction; caller frees. */
static double *sheared(bool polyhedral, double viscous, double share) {
    static const struct transport IN_PART = {.coefficients = law_in_part};
    struct scene s = {.dim = 2};
    const struct material grains = grains_of(eos_find("TorquatoDisks"), 0.9, 0.1);
    const double alpha = packing_per_density(&grains); /* of rho = 1 */
    part = viscous;
    open_models(&s, &IN_PART, "RKL2", polyhedral, shearing, false, 0);
    /* the coefficients of a half step are found in it */
    s.gas->models.friction = friction_find(share < 0 ? "none" : "Coulomb");
    s.gas->models.friction_params = (struct friction_params){.alpha_friction = 0, .alpha_solid = alpha / share};
    double *all = after(&s, 2, 0.01 / (SLOW * K * K));
    close_scene(&s);
    return all;
}

/* Where friction is the share s of the stress, viscosities keep 1 - s, and conduction is whole. */
static void viscosity_fades_where_friction_acts(void **state) {
    (void)state;
    const double share[] = {0.25, 0.75, 1};
    for (int polyhedral = 0; polyhedral < 2; polyhedral++)
        for (int i = 0; i < 3; i++) {
            double *fading = sheared(polyhedral, 1, share[i]);
            double *plain = sheared(polyhedral, fmax(1 - share[i], 1e-9), -1), *whole = sheared(polyhedral, 1, -1);
            double apart = 0;
            for (int k = 0; k < 4 * N * WIDE; k++) {
                assert_near(fading[k], plain[k], 1e-13);
                apart = fmax(apart, fabs(fading[k] - whole[k]));
            }
            assert_true(apart > 1e-3);
            free(fading);
            free(plain);
            free(whole);
        }
}

/* ---- cooling -------------------------------------------------------------------------------------------------------
 */

static void between_walls(const double x[3], double *rho, double u[3], double *T) {
    (void)u;
    *rho = 25;
    *T = 1 + x[0];
}

/* Steady, after n whole steps. */
static double *settled(bool polyhedral, double heating, int steps) {
    struct scene s;
    open_models(&s, transport_find("JenkinsRichman"), "RKJ2", polyhedral, between_walls, true, heating);
    go(&s, steps, 4. / steps);
    double *all = state_of(&s, world);
    close_scene(&s);
    return all;
}

/* Where conduction balances cooling, or cooling and a thermostat, their splitting leaves an error of second order, also
 * beside walls that hold T: one after the other, of first order there. */
static void sources_and_conduction_are_of_second_order(void **state) {
    (void)state;
    for (int c = 0; c < 4; c++) {
        double *all[3], error[2] = {0, 0};
        const bool heated = c / 2;
        for (int i = 0; i < 3; i++) all[i] = settled(c % 2, heated ? 2 : 0, (heated ? 800 : 400) << i);
        for (int i = 0; i < 2; i++)
            for (int k = 0; k < N * WIDE; k++)
                error[i] =
                    fmax(error[i], fabs(temperature(all[i], 2, N * WIDE, k) - temperature(all[i + 1], 2, N * WIDE, k)));
        for (int i = 0; i < 3; i++) free(all[i]);
        assert_true(log2(error[0] / error[1]) > 1.9);
        assert_near(error[1], 0, 1e-4);
    }
}

/* ---- the budget ----------------------------------------------------------------------------------------------------
 */

/* Viscous columns between others that are not: through the faces of the first only those parts of the stress of a
 * flow that turns pass that take from T, of which there is little. */
static void law_of_stripes(const struct own_params *params, const struct closure_line *cells, double *restrict bulk,
                           double *restrict shear, double *restrict heat) {
    (void)params;
    for (int i = 0; i < cells->n; i++) {
        bulk[i] = shear[i] = cells->rho[i] > 1.5 ? SLOW : 1e-3 * SLOW;
        heat[i] = 1e-4;
    }
}
static const struct transport STRIPES = {.coefficients = law_of_stripes};

static void cold_and_turning(const double x[3], double *rho, double u[3], double *T) {
    *rho = (int)(x[0] * 24) % 2 ? 2 : 1;
    *T = 1e-3;
    u[0] = 3 * (x[1] - 0.5);
    u[1] = -6 * (x[0] - 0.5);
}

/* Half steps that are done again as a whole count once: between walls at rest, of a temperature, what is not heat from
 * these is lost. */
static void budget_counts_the_last_attempt(void **state) {
    (void)state;
    struct scene s = {.models = disks_models(&STRIPES, "RKL2")};
    struct gas_budget b;
    set_walls(&s, "noSlip");
    for (int p = 0; p < 6; p++)
        s.rules[p].temperature = (struct rule){.type = boundary_find("fixedValue"), .uniform = {40}};
    open_box(&s, world, 2, (int[3]){24, 18, 1}, (double[3]){1, 1, 1}, (bool[3]){false, false, false}, 8);
    start(&s, cold_and_turning);
    ok(gas_audit(s.gas));
    run(&s, 3, 0.4);
    ok(gas_budget(s.gas, &b));
    assert_true(gas_counts(s.gas).plain > 0);
    assert_near(b.lost[1], 0, 1e-13 * b.energy);
    assert_true(fabs(b.gained[GAS_HEAT]) > 1e-6 * b.energy);
    close_scene(&s);
}

/* ---- flagged cells -------------------------------------------------------------------------------------------------
 */

enum { SIDE = 24 };
static bool turned_over[2]; /* axes along which the flow is its mirror image */

static void mirrored(const double x[3], double *rho, double u[3], double *T) {
    double at[3] = {x[0], x[1], 0};
    for (int k = 0; k < 2; k++)
        if (turned_over[k]) at[k] = 1 - x[k];
    cold_and_turning(at, rho, u, T);
    *rho = (int)(at[0] * SIDE) % 3 ? 2 : 1;
    u[1] += 0.4 * (at[0] > 0.3); /* no mirror image of its own */
    for (int k = 0; k < 2; k++)
        if (turned_over[k]) u[k] = -u[k];
}

/* The state by row and column, turned back; caller frees. */
static double *ordered(const struct scene *s, const bool over[2]) {
    double *all = state_of(s, world), *out = malloc(4 * SIDE * SIDE * sizeof *out);
    for (int i = 0; i < s->cells; i++) {
        int at[2];
        for (int k = 0; k < 2; k++) {
            at[k] = (int)(s->centre[3 * i + k] * SIDE);
            if (over[k]) at[k] = SIDE - 1 - at[k];
        }
        for (int v = 0; v < 4; v++) {
            const bool negative = v > 0 && v < 3 && over[v - 1];
            out[(v * SIDE + at[1]) * SIDE + at[0]] = (negative ? -1 : 1) * all[v * s->cells + i];
        }
    }
    free(all);
    return out;
}

/* The viscous gas of stripes after a step in which cells were flagged. */
static double *flagged_gas(bool polyhedral, int tile, const bool over[2]) {
    const struct cells_recipe boxes = {"boxes", 2, BOXES, {SIDE, SIDE, 1}, {0, 1, 2}, 0, {true, true, true}};
    struct scene s = {.dim = 2, .models = disks_models(&STRIPES, "RKL2")};
    double before[MAX_VAR], after[MAX_VAR];
    set_walls(&s, "slip");
    memcpy(turned_over, over, sizeof turned_over);
    if (polyhedral) {
        s.mesh = cells_make(&boxes);
        for (int i = 0; i < 3 * s.mesh->npoints; i++) s.mesh->points[i] /= 0.1 * (i % 3 + 1) * SIDE;
        open_mesh(&s, world);
    } else {
        open_box(&s, world, 2, boxes.n, (double[3]){1, 1, 1}, boxes.cyclic, tile);
    }
    start(&s, mirrored);
    ok(gas_totals(s.gas, before));
    spread(&s, 2, 30 / fastest(&s, world));
    ok(gas_totals(s.gas, after));
    assert_true(gas_counts(s.gas).plain > 0);
    assert_true(after[0] == before[0]);
    for (int v = 1; v < 4; v++) assert_near(after[v], before[v], 1e-14 * before[3]);
    double *all = ordered(&s, over);
    close_scene(&s);
    return all;
}

/* Faces of flagged cells are treated alike on all sides of the cell, and by both tiles that compute them: momentum and
 * energy are conserved, tiles change no bit, and the mirror image has the mirrored result (to round-off that some
 * hundred stages leave of values up to 10). */
static void flagged_cells_have_no_sides(void **state) {
    (void)state;
    for (int polyhedral = 0; polyhedral < 2; polyhedral++) {
        double *plain = flagged_gas(polyhedral, SIDE, (bool[2]){false, false});
        for (int i = 1; i < 5; i++) {
            double *other = flagged_gas(polyhedral, i == 4 ? 8 : SIDE, (bool[2]){i & 1, i >> 1 & 1});
            for (int k = 0; k < 4 * SIDE * SIDE; k++) assert_near(other[k], plain[k], 1e-12);
            if (i == 4) assert_memory_equal(other, plain, 4 * SIDE * SIDE * sizeof *plain);
            free(other);
        }
        free(plain);
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fast_conduction_holds_the_heat_of_friction),
        cmocka_unit_test(friction_and_conduction_are_of_second_order),
        cmocka_unit_test(thin_cells_stay_cold),
        cmocka_unit_test(viscosity_fades_where_friction_acts),
        cmocka_unit_test(sources_and_conduction_are_of_second_order),
        cmocka_unit_test(budget_counts_the_last_attempt),
        cmocka_unit_test(flagged_cells_have_no_sides),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
