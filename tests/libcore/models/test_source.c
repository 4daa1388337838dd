/* Exact source steps: homogeneous cooling, free fall, shaken gravity. */
#include "tests/libcore/oracle.h"

#include "libcore/models/source.h"

#define PI 3.14159265358979323846

static const double DENSE = 700; /* grains of 0.1 per unit volume: packing 0.37 */
static const struct material GRAINS = {
    .diameter = 0.1, .mass = 1, .restitution = 0.9, .gamma = 5. / 3, .alpha_max = 0.65};
static const struct material DISKS = {.diameter = 0.01,
                                      .mass = 1,
                                      .restitution = 0.75,
                                      .gamma = 2,
                                      .alpha_max = 0.82,
                                      .disks = true,
                                      .freezing = 0.69,
                                      .smoothing = 0.01};

static void homogeneous_cooling(void **state) {
    (void)state;
    FILE *f = oracle_open("hcs.csv");
    struct oracle_row r;
    int rows = 0;
    const struct eos *gs = eos_find("GoldshteinShapiro"), *torquato = eos_find("TorquatoDisks");
    for (oracle_row(f, &r); oracle_row(f, &r);) {
        const bool disks = strncmp(r.word[0], "Carrillo2D", 10) == 0;
        if (strncmp(r.word[0], "GS", 2) != 0 && !disks) continue;
        struct material m = disks ? DISKS : GRAINS;
        m.restitution = oracle_number(&r, 1);
        struct sources s = {.cooling = true};
        double rho = oracle_number(&r, 2) / packing_per_density(&m), T0 = oracle_number(&r, 3);
        double t = oracle_number(&r, 4), zero[MAX_DIM] = {0};
        for (int steps = 1; steps <= 7; steps += 6) { /* exact: in one step or in seven */
            double mass = rho, mom = 0, E = rho * T0 / (m.gamma - 1), *U[MAX_VAR] = {&mass, &mom, &E};
            for (int i = 0; i < steps; i++) source_apply(&s, disks ? torquato : gs, &m, 1, 1, t / steps, zero, U);
            assert_close((m.gamma - 1) * E / mass, oracle_number(&r, 5), 1e-10, "T(t)");
            assert_true(mass == rho && mom == 0);
        }
        rows++;
    }
    fclose(f);
    assert_true(rows == 32);
}

static void free_fall(void **state) {
    (void)state;
    struct material m = {.diameter = 0.1, .mass = 1, .restitution = 1, .gamma = 5. / 3, .alpha_max = 0.65};
    struct sources s = {.cooling = true, .gravity = {3, -7, 0}};
    double kick[MAX_DIM], rho = 2, mx = 1, my = 0, E = 2 * (1.5 * 0.3) + 0.25, *U[MAX_VAR] = {&rho, &mx, &my, &E};
    source_kick(&s, 5, 0.25, kick);
    source_apply(&s, eos_find("GoldshteinShapiro"), &m, 1, 2, 0.25, kick, U);
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
    struct sources s = {.cooling = true};
    assert_false(source_active(&s, &m));
    m.restitution = 0.9;
    assert_true(source_active(&s, &m));
    m.diameter = 0;
    assert_false(source_active(&s, &m));
    s.gravity[2] = 1;
    assert_true(source_active(&s, &m));
}

/* T after `steps` steps over dt in all, from T0, in a gas at rest; B: of dT/dt = -B T^(3/2) phi. */
static double cooled(double threshold, double T0, double dt, int steps) {
    struct sources s = {.cooling = true};
    struct material m = GRAINS;
    double zero[MAX_DIM] = {0}, rho = DENSE, mom = 0, E = rho * 1.5 * T0, *U[MAX_VAR] = {&rho, &mom, &E};
    m.threshold = threshold;
    for (int i = 0; i < steps; i++) source_apply(&s, eos_find("GoldshteinShapiro"), &m, 1, 1, dt / steps, zero, U);
    assert_true(rho == DENSE && mom == 0);
    return 2. / 3 * E / rho;
}

static double rate_of(void) { /* B, by the exact solution without a threshold: 1/sqrt(T) grows by B dt/2 */
    return 2 * (1 / sqrt(cooled(0, 1, 1, 1)) - 1);
}

/* int_a^b 4 e^(s^2)/(1 + s^2) ds by Simpson's rule: B v_c dt from T = (v_c/2a)^2 to (v_c/2b)^2, by definition of phi */
static double path_between(double a, double b) {
    const int n = 4000;
    double sum = 0, h = (b - a) / n;
    for (int i = 0; i <= n; i++) {
        double s = a + i * h, weight = i == 0 || i == n ? 1 : i % 2 ? 4 : 2;
        sum += weight * 4 * exp(s * s) / (1 + s * s);
    }
    return sum * h / 3;
}

static double exact_cooled(double threshold, double T0, double dt) {
    double path = rate_of() * threshold * dt, start = 0.5 * threshold / sqrt(T0), low = start, high = 25;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        *(path_between(start, middle) < path ? &low : &high) = middle;
    }
    return 0.25 * threshold * threshold / (low * low);
}

static void threshold_is_of_second_order(void **state) {
    (void)state;
    const double v = 0.3, rate = rate_of();
    for (double T0 = 1e-3; T0 < 2; T0 *= 7) { /* from x = 22, where little is lost, to 0.02 */
        double dt = 2 / (rate * sqrt(T0)), exact = exact_cooled(v, T0, dt), error[4];
        for (int i = 0; i < 4; i++) error[i] = fabs(cooled(v, T0, dt, 4 << i) / exact - 1);
        assert_near(error[0], 0, 0.02);
        if (error[3] < 1e-12) continue; /* round-off */
        assert_near(log2(error[2] / error[3]), 2, 0.15);
    }
}

static void threshold_of_any_step(void **state) {
    (void)state;
    const double v = 0.3, rate = rate_of();
    for (double T0 = 1e-3; T0 < 1e5; T0 *= 30) {
        double before = T0;
        for (double loss = 1e-3; loss < 1e13; loss *= 10) { /* = B sqrt(T0) dt, in a single step */
            double dt = loss / (rate * sqrt(T0)), found = cooled(v, T0, dt, 1);
            assert_true(found > 0 && found <= before);                              /* longer steps cool more */
            assert_close(found, exact_cooled(v, T0, dt), 0.27, "T after one step"); /* worst: 26 %, path 10 */
            before = found;
        }
    }
}

static void threshold_has_both_limits(void **state) {
    (void)state;
    for (double T = 1e-8; T < 1e9; T *= 1000) {
        double dt = 5 / sqrt(T);
        for (double small = 1e-8; small > 1e-170; small *= 1e-20) /* phi = 1: Haff's cooling */
            assert_close(cooled(small * sqrt(T), T, dt, 1), cooled(0, T, dt, 1), 1e-14, "T, warm");
        for (double x = 800; x < 1e200; x *= 1e3) /* phi = 0: none */
            assert_close(cooled(sqrt(4 * x * T), T, dt, 1), T, 4e-16, "T, cold");
    }
    assert_true(cooled(0.3, 1, 0, 1) == 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(homogeneous_cooling),   cmocka_unit_test(free_fall),
        cmocka_unit_test(shaken_gravity),        cmocka_unit_test(ramped_shaking),
        cmocka_unit_test(what_costs_nothing),    cmocka_unit_test(threshold_is_of_second_order),
        cmocka_unit_test(threshold_of_any_step), cmocka_unit_test(threshold_has_both_limits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
