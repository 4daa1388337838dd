/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every source against its equation: exact steps, what its row says about it, how sources act together; gravity, shaken
 * or not. */
#include "tests/libcore/oracle.h"
#include "tests/libcore/sources.h"

#define PI 3.14159265358979323846

enum { Y = MAX_DIM + 1 };        /* u, v, w, T */
static const double DENSE = 700; /* grains of 0.1 per unit volume: packing 0.37 */
static const struct material GRAINS = {
    .diameter = 0.1, .mass = 1, .restitution = 0.9, .gamma = 5. / 3, .alpha_max = 0.65};
static const struct eos *gs;

/* dy/dt by each source with the values that `choose` gives it. A new row of source_table needs its own here. */
static void by_cooling(double t, const double y[Y], double rate[Y]) {
    double contact;
    (void)t;
    gs->contact(&GRAINS, 1, &DENSE, &contact);
    rate[3] -= (GRAINS.gamma - 1) * 12 / sqrt(PI) * (1 - 0.81) * contact / GRAINS.diameter * y[3] * sqrt(y[3]);
}

static void by_gravity(double t, const double y[Y], double rate[Y]) {
    const double shaken = 1 + 0.7 * cos(2 * PI * 3 * t + 0.4);
    (void)y;
    rate[0] += 3 * shaken;
    rate[1] -= 7 * shaken;
}

static void by_drag(double t, const double y[Y], double rate[Y]) {
    static const double wind[MAX_DIM] = {1.5, 0, -0.25};
    (void)t;
    for (int k = 0; k < MAX_DIM; k++) rate[k] -= 2 * (y[k] - wind[k]);
    rate[3] -= 2 * 2 * y[3];
}

static void by_heating(double t, const double y[Y], double rate[Y]) {
    (void)t, (void)y;
    rate[3] += 0.3;
}

static const struct equation {
    const char *name;
    void (*add)(double t, const double y[Y], double rate[Y]);
    double value[4]; /* of the parameters one after the other, of a vector three */
} EQUATION[] = {{"cooling", by_cooling, {0}},
                {"gravity", by_gravity, {0}},
                {"linearDrag", by_drag, {2, 1.5, 0, -0.25}},
                {"uniformHeating", by_heating, {0.3}}};

static const struct equation *equation_of(int row) {
    for (size_t i = 0; i < sizeof EQUATION / sizeof *EQUATION; i++)
        if (!strcmp(EQUATION[i].name, source_table[row].model.name)) return &EQUATION[i];
    fail_msg("this test has no equation for the source %s", source_table[row].model.name);
    return NULL;
}

static void choose(struct sources *s, int row) {
    const char *name = source_table[row].model.name;
    choose_source(s, name, equation_of(row)->value);
    if (!strcmp(name, "cooling")) s->cooling = cooling_find("Haff");
    if (strcmp(name, "gravity")) return;
    s->gravity[0] = 3;
    s->gravity[1] = -7;
    s->amplitude = 0.7;
    s->frequency = 3;
    s->phase = 0.4;
}

static struct sources only(int row) {
    struct sources s = {0};
    choose(&s, row);
    return s;
}

/* y after dt, from t on. */
static void step(const struct sources *s, bool backwards, double t, double dt, double y[Y]) {
    struct source_plan plan;
    double rho = DENSE, eps = y[3] / (GRAINS.gamma - 1), mom[MAX_DIM], *at[MAX_DIM] = {mom, mom + 1, mom + 2};
    source_plan(s, gs, &GRAINS, MAX_DIM, t, dt, backwards, &plan);
    for (int k = 0; k < MAX_DIM; k++) mom[k] = rho * y[k];
    for (int i = 0; i < plan.n; i++) plan.step[i].row->step(&plan.step[i], 1, &rho, at, &eps);
    for (int k = 0; k < MAX_DIM; k++) y[k] = mom[k] / rho;
    y[3] = eps * (GRAINS.gamma - 1);
}

/* The same by the classical Runge-Kutta method in 4000 steps. */
static void integrate(const struct sources *s, double t, double dt, double y[Y]) {
    static const double part[4] = {0, 0.5, 0.5, 1}, weight[4] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
    const int n = 4000;
    for (int i = 0; i < n; i++) {
        double slope[Y] = {0}, sum[Y] = {0}, at[Y];
        for (int stage = 0; stage < 4; stage++) {
            for (int k = 0; k < Y; k++) at[k] = y[k] + part[stage] * dt / n * slope[k];
            memset(slope, 0, sizeof slope);
            for (int row = 0; row < source_count; row++)
                if (source_row_active(s, &GRAINS, row))
                    equation_of(row)->add(t + (i + part[stage]) * dt / n, at, slope);
            for (int k = 0; k < Y; k++) sum[k] += weight[stage] * slope[k];
        }
        for (int k = 0; k < Y; k++) y[k] += dt / n * sum[k];
    }
}

/* The largest difference: of velocities as a part of 1 m/s, of T as a part of T. */
static double distance(const double a[Y], const double b[Y]) {
    double most = fabs(a[3] / b[3] - 1);
    for (int k = 0; k < MAX_DIM; k++) most = fmax(most, fabs(a[k] - b[k]));
    return most;
}

/* In one step as in two halves of it: exact to the round-off of 4000 additions. */
static void every_source_solves_its_equation(void **state) {
    (void)state;
    for (int row = 0; row < source_count; row++) {
        const struct sources s = only(row);
        for (double dt = 1e-3; dt < 1; dt *= 3)
            for (double T = 0.01; T < 20; T *= 9) {
                double y[Y] = {0.3, -2, 1, T}, exact[Y], halves[Y];
                memcpy(exact, y, sizeof y);
                memcpy(halves, y, sizeof y);
                step(&s, false, 0.2, dt, y);
                integrate(&s, 0.2, dt, exact);
                assert_near(distance(y, exact), 0, 1e-11);
                step(&s, false, 0.2, 0.5 * dt, halves);
                step(&s, true, 0.2 + 0.5 * dt, 0.5 * dt, halves);
                assert_near(distance(halves, y), 0, 1e-14);
            }
    }
}

/* Second order needs a step that is the same forwards and backwards; in the same order twice it is of first. */
static void sources_act_forwards_and_backwards(void **state) {
    (void)state;
    struct sources s = {0};
    for (int row = 0; row < source_count; row++) choose(&s, row);
    for (int mirrored = 0; mirrored < 2; mirrored++) {
        double error[2];
        for (int i = 0; i < 2; i++) {
            const int steps = 20 << i;
            double y[Y] = {0.3, -2, 1, 1}, exact[Y] = {0.3, -2, 1, 1}, h = 0.2 / steps;
            for (int n = 0; n < steps; n++) {
                step(&s, false, n * h, 0.5 * h, y);
                step(&s, mirrored, (n + 0.5) * h, 0.5 * h, y);
            }
            integrate(&s, 0, 0.2, exact);
            error[i] = distance(y, exact);
        }
        assert_near(log2(error[0] / error[1]), 1 + mirrored, 0.1);
    }
}

/* Steps of any length leave T above zero; a row changes nothing but what it says; equal cells stay equal to the bit
 * wherever they stand. */
static void every_source_keeps_its_word(void **state) {
    (void)state;
    for (int row = 0; row < source_count; row++) {
        const struct source_type *r = &source_table[row];
        const struct sources s = only(row);
        for (double dt = 1e-9; dt < 1e6; dt *= 10)
            for (double T = 1e-8; T < 1e8; T *= 100) {
                struct source_plan plan;
                double rho[BATCH], mom[MAX_DIM][BATCH], eps[BATCH], *at[MAX_DIM] = {mom[0], mom[1], mom[2]};
                for (int i = 0; i < BATCH; i++) {
                    rho[i] = DENSE;
                    eps[i] = T;
                    for (int k = 0; k < MAX_DIM; k++) mom[k][i] = DENSE * (k - 0.3);
                }
                source_plan(&s, gs, &GRAINS, MAX_DIM, 0, dt, false, &plan);
                assert_int_equal(plan.n, 1);
                r->step(&plan.step[0], BATCH, rho, at, eps);
                double one[MAX_DIM] = {DENSE * -0.3, DENSE * (1 - 0.3), DENSE * (2 - 0.3)}, alone = T;
                r->step(&plan.step[0], 1, rho, (double *[]){one, one + 1, one + 2}, &alone);
                assert_true(alone > 0 && isfinite(alone));
                assert_true((r->cools || alone >= T) && (r->heats || alone <= T));
                for (int k = 0; k < MAX_DIM; k++) assert_true(r->pushes || one[k] == DENSE * (k - 0.3));
                for (int i = 0; i < BATCH; i++) {
                    assert_true(rho[i] == DENSE && eps[i] == alone);
                    for (int k = 0; k < MAX_DIM; k++) assert_true(mom[k][i] == one[k]);
                }
            }
        assert_int_equal(source_heats(&s), r->heats);
        assert_int_equal(source_thermal(&s), r->heats || r->cools);
    }
}

/* Mass, momentum and energy of cells that differ. */
static void fill_cells(double U[MAX_VAR][BATCH], double totals[MAX_VAR]) {
    for (int v = 0; v < MAX_VAR; v++) totals[v] = 0;
    for (int i = 0; i < BATCH; i++) {
        U[0][i] = 300 + 5 * i;
        U[4][i] = U[0][i] * (1 + 0.1 * i);
        for (int k = 0; k < MAX_DIM; k++) {
            U[1 + k][i] = U[0][i] * sin(i + k);
            U[4][i] += 0.5 * U[0][i] * sin(i + k) * sin(i + k);
        }
        for (int v = 0; v < MAX_VAR; v++) totals[v] += U[v][i];
    }
}

/* Where a row says what energy it gives to a gas of some mass and momentum, that is what its step gives. */
static void energy_is_what_rows_say(void **state) {
    (void)state;
    for (int row = 0; row < source_count; row++) {
        const struct sources s = only(row);
        struct source_plan plan;
        double U[MAX_VAR][BATCH], before[MAX_VAR], after = 0, *at[MAX_VAR] = {U[0], U[1], U[2], U[3], U[4]};
        if (!source_table[row].gained) continue;
        fill_cells(U, before);
        source_plan(&s, gs, &GRAINS, MAX_DIM, 0.1, 0.3, false, &plan);
        source_apply(&plan, BATCH, at, NULL, NULL, NULL);
        for (int i = 0; i < BATCH; i++) after += U[4][i];
        assert_close(plan.step[0].row->gained(&plan.step[0], before), after - before[4], 1e-12,
                     source_table[row].model.name);
    }
}

/* The pull of a source is the mean acceleration of gas at rest. */
static void gas_at_rest_is_pulled(void **state) {
    (void)state;
    for (int row = 0; row < source_count; row++) {
        const struct sources s = only(row);
        double y[Y] = {0, 0, 0, 1}, pull[MAX_DIM];
        source_pull(&s, gs, &GRAINS, MAX_DIM, 0.3, 0.02, pull);
        step(&s, false, 0.3, 0.02, y);
        for (int k = 0; k < MAX_DIM; k++) assert_near(pull[k], y[k] / 0.02, 1e-13);
        assert_true(source_table[row].pushes || (pull[0] == 0 && pull[1] == 0 && pull[2] == 0));
    }
}

/* Gas that moves with the gas that drags it keeps its bits. */
static void drag_leaves_what_moves_along(void **state) {
    (void)state;
    struct sources s = {0};
    for (int row = 0; row < source_count; row++)
        if (!strcmp(source_table[row].model.name, "linearDrag")) s = only(row);
    struct source_plan plan;
    double rho = 0.1, u = 0.1 * 1.5, w = 0.1 * -0.25, v = 0, eps = 1, *mom[MAX_DIM] = {&u, &v, &w};
    source_plan(&s, gs, &GRAINS, MAX_DIM, 0, 0.7, false, &plan);
    for (int i = 0; i < 100; i++) plan.step[0].row->step(&plan.step[0], 1, &rho, mom, &eps);
    assert_true(u == 0.1 * 1.5 && v == 0 && w == 0.1 * -0.25);
    assert_close(eps, exp(-2 * 2 * 70.), 1e-12, "T");
}

static void free_fall(void **state) {
    (void)state;
    struct material m = {.diameter = 0.1, .mass = 1, .restitution = 1, .gamma = 5. / 3, .alpha_max = 0.65};
    struct sources s = {.cooling = cooling_find("Haff"), .gravity = {3, -7, 0}};
    struct source_plan plan;
    double rho = 2, mx = 1, my = 0, E = 2 * (1.5 * 0.3) + 0.25, *U[MAX_VAR] = {&rho, &mx, &my, &E};
    source_plan(&s, eos_find("GoldshteinShapiro"), &m, 2, 5, 0.25, false, &plan);
    source_apply(&plan, 1, U, NULL, NULL, NULL);
    assert_close(mx / rho, 0.5 + 0.75, 1e-15, "u");
    assert_close(my / rho, -1.75, 1e-15, "v");
    assert_close(E, 2 * 1.5 * 0.3 + (1.25 * 1.25 + 1.75 * 1.75), 1e-15, "E: the temperature stays");
}

static void shaken_gravity(void **state) {
    (void)state;
    struct sources s = {.gravity = {980, 0, 0}, .amplitude = 3, .frequency = 200, .phase = 0.4};
    double t = 0.0013, dt = 0.0017, kick[MAX_DIM], sum = 0;
    int n = 20000;
    for (int i = 0; i < n; i++) sum += 980 * (1 + 3 * cos(2 * PI * 200 * (t + (i + 0.5) * dt / n) + 0.4)) * dt / n;
    source_kick(&s, t, dt, kick);
    assert_close(kick[0], sum, 1e-8, "kick");
    s.frequency = 0;
    source_kick(&s, t, dt, kick);
    assert_close(kick[0], 980 * dt * (1 + 3 * cos(0.4)), 1e-14, "kick without oscillation");
}

static double between(double t, int n, const double knot[][2]) {
    int i = 1;
    while (i < n - 1 && knot[i][0] < t) i++;
    double part = (t - knot[i - 1][0]) / (knot[i][0] - knot[i - 1][0]);
    return knot[i - 1][1] + (knot[i][1] - knot[i - 1][1]) * fmin(fmax(part, 0), 1);
}

/* Against sums, over steps before, within, across and beyond the knots; a step in pieces gives what the whole gives. */
static void ramped_shaking(void **state) {
    (void)state;
    static const double knot[4][2] = {{0.1, 3}, {0.3, 2}, {0.31, 5}, {0.5, 0}},
                        span[][2] = {{0, 0.05}, {0.05, 0.4}, {0.12, 0.01}, {0.3, 0.005}, {0, 1}, {0.2, 0.3}, {0.6, 1}};
    struct sources s = {.gravity = {0, -9, 0}, .frequency = 3.5, .phase = 0.4, .knots = 4, .ramp = knot[0]};
    const struct material m = {.restitution = 1};
    double kick[MAX_DIM], half[MAX_DIM], rest[MAX_DIM];
    for (size_t c = 0; c < sizeof span / sizeof *span; c++) {
        double t = span[c][0], dt = span[c][1], sum = 0;
        const int n = 200000;
        for (int i = 0; i < n; i++) {
            double at = t + (i + 0.5) * dt / n;
            sum += -9 * (1 + between(at, 4, knot) * cos(2 * PI * 3.5 * at + 0.4)) * dt / n;
        }
        source_kick(&s, t, dt, kick);
        assert_close(kick[1], sum, 1e-8, "kick");
        source_kick(&s, t, 0.37 * dt, half);
        source_kick(&s, t + 0.37 * dt, 0.63 * dt, rest);
        assert_close(half[1] + rest[1], kick[1], 1e-13, "kick in two pieces");
    }
    assert_true(source_active(&s, &m) && source_shaken(&s));
    struct sources one = {.gravity = {0, -9, 0}, .frequency = 3.5, .phase = 0.4, .knots = 1, .ramp = knot[0]},
                   constant = {.gravity = {0, -9, 0}, .frequency = 3.5, .phase = 0.4, .amplitude = 3};
    source_kick(&one, 0.7, 0.1, kick);
    source_kick(&constant, 0.7, 0.1, half);
    assert_close(kick[1], half[1], 1e-15, "a table of one pair");
    one.ramp = (const double[]){0, 0};
    assert_false(source_shaken(&one));
}

static void what_costs_nothing(void **state) {
    (void)state;
    struct material m = {.diameter = 0.1, .mass = 1, .restitution = 1, .gamma = 5. / 3, .alpha_max = 0.65};
    struct sources s = {.cooling = cooling_find("Haff")};
    assert_false(source_active(&s, &m) || source_cools(&s, &m));
    m.restitution = 0.9;
    assert_true(source_active(&s, &m) && source_cools(&s, &m));
    assert_true(source_thermal(&s) && !source_heats(&s));
    m.diameter = 0;
    assert_false(source_active(&s, &m) || source_cools(&s, &m));
    s.gravity[2] = 1;
    assert_true(source_active(&s, &m));
}

static int find_eos(void **state) {
    (void)state;
    gs = eos_find("GoldshteinShapiro");
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_source_solves_its_equation),
        cmocka_unit_test(sources_act_forwards_and_backwards),
        cmocka_unit_test(every_source_keeps_its_word),
        cmocka_unit_test(energy_is_what_rows_say),
        cmocka_unit_test(gas_at_rest_is_pulled),
        cmocka_unit_test(drag_leaves_what_moves_along),
        cmocka_unit_test(free_fall),
        cmocka_unit_test(shaken_gravity),
        cmocka_unit_test(ramped_shaking),
        cmocka_unit_test(what_costs_nothing),
    };
    return cmocka_run_group_tests(tests, find_eos, NULL);
}
