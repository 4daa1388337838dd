/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls of a gas with transport, on tiles: walls that move and that take heat, against exact solutions. */
#include "tests/libcore/gas/viscous.h" /* last: cmocka.h defines fail() */

#define PI 3.14159265358979323846

static struct comm *world;

static const double DENSITY = 2;
static void even(const struct own_params *params, const struct closure_line *cells, double *restrict bulk,
                 double *restrict shear, double *restrict heat) {
    constant_law(params, cells, bulk, shear, heat);
    for (int i = 0; i < cells->n; i++) heat[i] = 1e4;
}
static const struct transport EVEN = {.coefficients = even}; /* T is the same everywhere */

/* A channel of disks between walls at y = 0 and 1, periodic along x. */
enum { LOW = 2, HIGH = 3, ALONG = 4 }; /* patches, cells */

static struct scene channel(int across, const struct transport *transport) {
    struct scene s = {.cells = ALONG * across, .models = disks_models(transport, "RKL2")};
    set_walls(&s, "noSlip");
    return s;
}

static void moving(struct scene *s, int patch, double speed) {
    s->rules[patch].velocity = (struct rule){.type = boundary_find("translatingWallVelocity"), .params = {{speed}}};
}

static void isothermal(struct scene *s, int patch, double T) {
    s->rules[patch].temperature = (struct rule){.type = boundary_find("fixedValue"), .uniform = {T}};
}

static void absorbing(struct scene *s, int patch, double restitution) {
    s->rules[patch].temperature = (struct rule){.type = boundary_find("granularWall"), .params = {{restitution}}};
}

static void open_channel(struct scene *s, initial *at) {
    const int across = s->cells / ALONG;
    open_box(s, world, 2, (int[3]){ALONG, across, 1}, (double[3]){(double)ALONG / across, 1, 1},
             (bool[3]){true, false, false}, 8);
    start(s, at);
}

static void still(const double x[3], double *rho, double u[3], double *T) {
    (void)x, (void)u;
    *rho = DENSITY;
    *T = 1;
}

/* rho, u, v, T (gamma - 1 is 1) of the rows, broadcast; caller frees. */
static double *rows_of(const struct scene *s) {
    const int n = s->cells, rows = n / ALONG;
    double *all = state_of(s, world), *out = calloc(4 * (size_t)rows, sizeof *out);
    for (int j = 0; j < rows; j++) {
        const double *q = all + j * ALONG;
        const double u = q[n] / q[0], v = q[2 * n] / q[0];
        out[j] = q[0];
        out[rows + j] = u;
        out[2 * rows + j] = v;
        out[3 * rows + j] = q[3 * n] / q[0] - 0.5 * (u * u + v * v);
        for (int i = 1; i < ALONG; i++)
            for (int k = 0; k < 4; k++) assert_true(q[k * n + i] == q[k * n]);
    }
    free(all);
    return out;
}

/* ---- walls that move -----------------------------------------------------------------------------------------------
 */

/* u/u_w at time t after the wall at y = 1 was set in motion. */
static double started(double y, double nu_t) {
    double sum = y;
    for (int k = 1; k < 40; k++)
        sum += 2 / (k * PI) * (k % 2 ? -1 : 1) * exp(-k * k * PI * PI * nu_t) * sin(k * PI * y);
    return sum;
}

static double start_error(int n) {
    struct scene s = channel(n, &CONSTANT);
    const double speed = 1e-4, time = 0.25;
    moving(&s, HIGH, speed);
    open_channel(&s, still);
    go(&s, 6 * n, time / (6 * n));
    double *q = rows_of(&s), error = 0;
    for (int j = 0; j < n; j++)
        error = fmax(error, fabs(q[n + j] / speed - started((j + 0.5) / n, VISCOSITY / DENSITY * time)));
    free(q);
    close_scene(&s);
    return error;
}

/* Whole steps: the fluxes of the inviscid gas add no friction of their own. */
static void couette_starts(void **state) {
    (void)state;
    double coarse = start_error(16), fine = start_error(32);
    assert_near(fine, 0, 1e-3);
    assert_near(log2(coarse / fine), 2, 0.1);
}

static const double FAST = 1.5, RISE = 0.7 * 1.5 * 1.5 / (2 * 1.1); /* speed; viscosity speed^2/(2 conduction) */
static void steady(const double x[3], double *rho, double u[3], double *T) {
    const double y = x[1];
    *rho = DENSITY;
    *T = 1 + 0.3 * y + RISE * y * (1 - y);
    u[0] = FAST * y;
}

/* The splitting leaves the heating of half a step at isothermal walls: dt goes with h^2. */
static double steady_error(int n) {
    struct scene s = channel(n, &CONSTANT);
    moving(&s, HIGH, FAST);
    isothermal(&s, LOW, 1);
    isothermal(&s, HIGH, 1.3);
    open_channel(&s, steady);
    spread(&s, 3 * n * n, 0.2 / (n * n));
    double *q = rows_of(&s), error = 0;
    for (int j = 0; j < n; j++) {
        double rho, u[3], T;
        steady((double[3]){0, (j + 0.5) / n, 0}, &rho, u, &T);
        assert_near(q[n + j], u[0], 1e-13);
        error = fmax(error, fabs(q[3 * n + j] - T));
    }
    free(q);
    close_scene(&s);
    return error;
}

/* What the moving wall does in work, the walls take as heat. */
static void couette_is_steady(void **state) {
    (void)state;
    double coarse = steady_error(8), fine = steady_error(16);
    assert_near(fine, 0, 1e-3);
    assert_near(log2(coarse / fine), 2, 0.1);
}

static void rough(const double x[3], double *rho, double u[3], double *T) {
    const double y = x[1];
    *rho = 30 * (1 + 0.9 * sin(7 * y));
    *T = 1 + 0.8 * cos(9 * y);
    u[0] = sin(5 * y);
    u[1] = 0.3 * sin(PI * y);
}

/* Between a wall that moves and one without friction: mass stays, and what comes in as energy is momentum times speed.
 */
static void work_is_momentum_times_speed(void **state) {
    (void)state;
    for (int whole = 0; whole < 2; whole++) {
        const double speed = -0.8;
        struct scene s = channel(24, transport_find("JenkinsRichman"));
        double before[MAX_VAR], after[MAX_VAR];
        s.rules[LOW].velocity.type = boundary_find("slip");
        moving(&s, HIGH, speed);
        open_channel(&s, rough);
        ok(gas_totals(s.gas, before));
        if (whole)
            go(&s, 20, 1e-3);
        else
            spread(&s, 20, 1e-3);
        ok(gas_totals(s.gas, after));
        assert_near(after[0], before[0], 1e-14 * before[0]);
        const double given = after[1] - before[1], work = after[3] - before[3];
        assert_true(fabs(given) > 1e-3 * before[0]);
        assert_near(work, speed * given, 1e-13 * before[3]);
        close_scene(&s);
    }
}

/* ---- walls that take heat ------------------------------------------------------------------------------------------
 */

/* Where conduction is fast, dT/dt = -B T^(3/2) with B = 2 c p/(rho T), of two walls at a distance of 1. */
static void losses_follow_haff(void **state) {
    (void)state;
    const double restitution = 0.7, time = 0.8, packing = DENSITY * PI * 0.01 / 4,
                 G = packing * (1 - 0.436 * packing) / ((1 - packing) * (1 - packing));
    const double B = 2 * (1 - restitution * restitution) / sqrt(2 * PI) * (1 + 1.9 * G);
    struct scene s = channel(8, &EVEN);
    absorbing(&s, LOW, restitution);
    absorbing(&s, HIGH, restitution);
    open_channel(&s, still);
    spread(&s, 40, time / 40);
    double *q = rows_of(&s);
    for (int j = 0; j < 8; j++) assert_near(q[3 * 8 + j] * pow(1 + 0.5 * B * time, 2), 1, 3e-5);
    close_scene(&s);
    free(q);
}

static double pressure(double rho, double T) {
    const struct eos *eos = eos_find("TorquatoDisks");
    const struct material m = grains_of(eos, 0.9, 0.1);
    double p, c2, gruneisen;
    eos->state(&m, 1, &rho, &T, &p, &c2, &gruneisen);
    return p;
}

/* At y = 0 the gas rests under its weight, and conducts what a wall of restitution 0.95 takes. */
static const double PULL = 3, RESTITUTION = 0.95, HEAVY = 30;
static double loss(void) {
    return (1 - RESTITUTION * RESTITUTION) / sqrt(2 * PI) * pressure(HEAVY, 1);
}
static double p_rho(void) {
    const double step = 1e-3;
    return (pressure(HEAVY + step, 1) - pressure(HEAVY - step, 1)) / (2 * step);
}

/* A law whose heat flux knows the gradient of rho, too, if `crossing` is not 0. */
static double crossing;
static void constant_cross(const struct own_params *params, const struct closure_line *cells, double *restrict cross) {
    (void)params;
    for (int i = 0; i < cells->n; i++) cross[i] = crossing;
}
static struct transport_terms crossed(const struct own_params *params) {
    (void)params;
    return (struct transport_terms){.cross = crossing != 0};
}
static const struct transport CROSSED = {.coefficients = constant_law, .terms = crossed, .cross = constant_cross};

/* dT/dy at y = 0 where so much heat goes into the wall and so much weight lies on it: p_rho d rho/dy + p_T dT/dy =
 * -rho pull, and p_T is p at T = 1. */
static double rise_of(double heat, double pull) {
    return (heat + crossing * HEAVY * pull / p_rho()) / (CONDUCTION - crossing * pressure(HEAVY, 1) / p_rho());
}

static void weighing(const double x[3], double *rho, double u[3], double *T) {
    const double rise = rise_of(loss(), PULL), per = p_rho();
    (void)u;
    *T = 1 + rise * x[1];
    *rho = HEAVY * exp(-(PULL + pressure(HEAVY, 1) * rise / HEAVY) / per * x[1]);
}

static double weighing_error(int n) {
    struct scene s = channel(n, &CROSSED);
    const double dt = 1e-8;
    double before[MAX_VAR], after[MAX_VAR];
    absorbing(&s, LOW, RESTITUTION);
    s.models.source.gravity[1] = -PULL;
    open_channel(&s, weighing);
    ok(gas_totals(s.gas, before));
    go(&s, 1, dt);
    ok(gas_totals(s.gas, after));
    close_scene(&s);
    return (before[3] - after[3]) / (dt * ALONG / n * loss()) - 1;
}

/* Both halves of a step take the pressure on the wall itself. */
static void weight_counts_at_the_wall(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        const int n = i ? 128 : 16; /* with cross from 16 on the orders are 1.6, 1.8, 1.9 */
        crossing = i ? 0.03 : 0;
        const double coarse = weighing_error(n), fine = weighing_error(2 * n);
        print_message("cross %g: %.3g, %.3g: order %.2f\n", crossing, coarse, fine, log2(coarse / fine));
        assert_near(fine, 0, 1e-3);
        assert_near(log2(coarse / fine), 2, 0.1);
    }
}

static double *rows_after(int patch, const struct rule *temperature, int whole) {
    struct scene s = channel(24, transport_find("JenkinsRichman"));
    if (temperature) s.rules[patch].temperature = *temperature;
    open_channel(&s, rough);
    if (whole)
        go(&s, 10, 1e-3);
    else
        spread(&s, 10, 1e-3);
    double *q = rows_of(&s);
    close_scene(&s);
    return q;
}

static void elastic_walls_are_adiabatic(void **state) {
    (void)state;
    const struct rule elastic = {.type = boundary_find("granularWall"), .params = {{1}}};
    for (int whole = 0; whole < 2; whole++) {
        double *a = rows_after(LOW, NULL, whole), *b = rows_after(LOW, &elastic, whole);
        assert_memory_equal(a, b, 4 * 24 * sizeof *a);
        free(a);
        free(b);
    }
}

static void wild_rows(const double x[3], double *rho, double u[3], double *T) {
    wild((double[3]){x[1], 0, 0}, rho, u, T);
    u[1] = u[2] = 0;
}

/* Walls that swallow grains' energy, and walls next to absolute zero: T > 0, however long the steps. */
static void cold_walls_leave_heat(void **state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        struct scene s = channel(24, transport_find("JenkinsRichman"));
        double last[MAX_VAR], now[MAX_VAR];
        for (int p = LOW; p <= HIGH; p++) {
            if (kind % 2)
                isothermal(&s, p, 1e-9);
            else
                absorbing(&s, p, 0);
        }
        open_channel(&s, kind < 2 ? wild_rows : rough);
        ok(gas_totals(s.gas, last));
        const double mass = last[0];
        for (int i = 0; i < 20; i++) {
            spread(&s, 1, (i % 2 ? 40 : 0.9) / fastest(&s, world));
            ok(gas_totals(s.gas, now));
            assert_true(now[0] == mass);
            assert_true(now[3] < last[3]);
            memcpy(last, now, sizeof last);
        }
        close_scene(&s);
    }
}

/* ---- walls with friction -------------------------------------------------------------------------------------------
 */

static void rubbing(struct scene *s, int patch, double specularity, double restitution, double speed) {
    const struct rule rule = {
        .type = boundary_find("JohnsonJacksonSlip"), .params = {{specularity, restitution}}, .uniform = {speed}};
    s->rules[patch].velocity = s->rules[patch].temperature = rule;
}

/* With none the wall is one that slips, with all there is one that holds the gas: to the bit. */
static void friction_has_limits(void **state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        const bool full = kind % 2, whole = kind / 2;
        double *q[2];
        for (int i = 0; i < 2; i++) {
            struct scene s = channel(24, transport_find("JenkinsRichman"));
            if (i == 0) {
                rubbing(&s, LOW, full ? 1e40 : 0, 0.7, 0.4);
            } else {
                absorbing(&s, LOW, 0.7);
                s.rules[LOW].velocity.type = boundary_find("slip");
                if (full) moving(&s, LOW, 0.4);
            }
            open_channel(&s, rough);
            if (whole)
                go(&s, 10, 1e-3);
            else
                spread(&s, 10, 1e-3);
            q[i] = rows_of(&s);
            close_scene(&s);
        }
        assert_memory_equal(q[0], q[1], 4 * 24 * sizeof *q[0]);
        free(q[0]);
        free(q[1]);
    }
}

/* A wall without losses that rubs gets its work and nothing else: friction's heat stays in the gas, all of the energy
 * of the gas if the wall is at rest. */
static void friction_heats_the_gas(void **state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        const double speed = kind % 2 ? -0.8 : 0;
        struct scene s = channel(24, transport_find("JenkinsRichman"));
        double before[MAX_VAR], after[MAX_VAR];
        s.rules[LOW].velocity.type = boundary_find("slip");
        rubbing(&s, HIGH, 0.6, 1, speed);
        open_channel(&s, rough);
        ok(gas_totals(s.gas, before));
        if (kind / 2)
            go(&s, 20, 1e-3);
        else
            spread(&s, 20, 1e-3);
        ok(gas_totals(s.gas, after));
        assert_near(after[0], before[0], 1e-14 * before[0]);
        const double given = after[1] - before[1];
        assert_true(fabs(given) > 1e-3 * before[0]);
        assert_near(after[3] - before[3], speed * given, 1e-13 * before[3]);
        close_scene(&s);
    }
}

/* At y = 0 gas of T = 1 slips at RUB along a wall at rest, and conducts what the wall takes less what friction gives.
 */
static const double RUB = 0.2, SPECULARITY = 0.5;
static double hits(void) { /* mass of the grains that hit the wall */
    return pressure(HEAVY, 1) / sqrt(2 * PI);
}
static double dragged(void) {
    return SPECULARITY * hits() * RUB;
}
static void slipping(const double x[3], double *rho, double u[3], double *T) {
    const double rise = rise_of(loss() - dragged() * RUB, 0), per = p_rho();
    u[0] = RUB + dragged() / VISCOSITY * x[1];
    *T = 1 + rise * x[1];
    *rho = HEAVY * exp(-pressure(HEAVY, 1) * rise / HEAVY / per * x[1]);
}

static double slipping_error(int n) {
    struct scene s = channel(n, &CROSSED);
    const double dt = 1e-8, area = (double)ALONG / n;
    double before[MAX_VAR], after[MAX_VAR];
    rubbing(&s, LOW, SPECULARITY, RESTITUTION, 0);
    s.rules[HIGH].velocity.type = boundary_find("slip");
    open_channel(&s, slipping);
    ok(gas_totals(s.gas, before));
    go(&s, 1, dt);
    ok(gas_totals(s.gas, after));
    close_scene(&s);
    const double stress = (before[1] - after[1]) / (dt * area), lost = (before[3] - after[3]) / (dt * area);
    return larger(fabs(stress / dragged() - 1), fabs(lost / loss() - 1));
}

/* Drag and losses are those of the gas on the wall itself. */
static void friction_counts_at_the_wall(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        const int n = i ? 128 : 16; /* with cross from 16 on the orders are 1.6, 1.8, 1.9 */
        crossing = i ? 0.03 : 0;
        const double coarse = slipping_error(n), fine = slipping_error(2 * n);
        print_message("cross %g: %.3g, %.3g: order %.2f\n", crossing, coarse, fine, log2(coarse / fine));
        assert_near(fine, 0, 1e-3);
        assert_near(log2(coarse / fine), 2, 0.1);
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(couette_starts),
        cmocka_unit_test(couette_is_steady),
        cmocka_unit_test(work_is_momentum_times_speed),
        cmocka_unit_test(losses_follow_haff),
        cmocka_unit_test(weight_counts_at_the_wall),
        cmocka_unit_test(elastic_walls_are_adiabatic),
        cmocka_unit_test(cold_walls_leave_heat),
        cmocka_unit_test(friction_has_limits),
        cmocka_unit_test(friction_heats_the_gas),
        cmocka_unit_test(friction_counts_at_the_wall),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
