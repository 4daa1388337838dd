/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every cooling law against its equation: reference values, an integration in small steps, steps of any length, and the
 * limits of the threshold of elastic impacts. */
#include "tests/defaults.h"
#include "tests/libcore/oracle.h"

#include "libcore/models/cooling.h"
#include "libcore/models/kernel.h"

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

static const struct material GLASS = {.diameter = 1e-3,
                                      .mass = 2600 * PI / 6 * 1e-9,
                                      .restitution = 0.9,
                                      .gamma = 5. / 3,
                                      .alpha_max = 0.64,
                                      .freezing = 0.49,
                                      .smoothing = 0.01};

static const struct cooling *haff;
static const struct eos *gs;

static void homogeneous_cooling(void **state) {
    (void)state;
    FILE *f = oracle_open("hcs.csv");
    struct oracle_row r;
    int rows = 0;
    const struct eos *torquato = eos_find("TorquatoDisks");
    for (oracle_row(f, &r); oracle_row(f, &r);) {
        const bool disks = strncmp(r.word[0], "Carrillo2D", 10) == 0, sonine = strncmp(r.word[0], "GD3D", 4) == 0;
        const struct eos *eos = disks ? torquato : sonine ? eos_find("TorquatoSpheres") : gs;
        const struct cooling *law = sonine ? cooling_find("GarzoDufty") : haff;
        struct material m = disks ? DISKS : sonine ? GLASS : GRAINS;
        const double per = sonine ? m.mass : 1; /* T of those rows is an energy */
        m.restitution = oracle_number(&r, 1);
        double rho = oracle_number(&r, 2) / packing_per_density(&m), T0 = oracle_number(&r, 3) / per;
        double t = oracle_number(&r, 4);
        const struct closure_line cells = {.eos = eos, .material = &m, .n = 1, .rho = &rho};

        for (int steps = 1; steps <= 7; steps += 6) { /* exact: in one step or in seven */
            double eps = T0 / (m.gamma - 1);
            for (int i = 0; i < steps; i++) law->step(NULL, &cells, t / steps, &eps);
            assert_close((m.gamma - 1) * eps, oracle_number(&r, 5) / per, 1e-10, "T(t)");
        }
        rows++;
    }
    fclose(f);
    assert_true(rows == 42);
}

/* dT/dt by each law, of GRAINS at DENSE in gas without shear (test_extended.c has the others). A new row of
 * cooling_table needs its own here. */
static double by_haff(const struct material *m, double contact, double T) {
    return -(m->gamma - 1) * 12 / sqrt(PI) * (1 - m->restitution * m->restitution) * contact / m->diameter * T *
           sqrt(T);
}

/* In three dimensions Garzo & Dufty (1999) print c = 2 a2; of spheres only. */
static double by_garzo_dufty(const struct material *m, double contact, double T) {
    const double e = m->restitution, c = 32 * (1 - e) * (1 - 2 * e * e) / (81 - 17 * e + 30 * e * e * (1 - e));
    return by_haff(m, contact, T) * (1 + 3. / 32 * c);
}

static const struct equation {
    const char *name;
    double (*rate)(const struct material *m, double contact, double T);
} EQUATION[] = {{"Haff", by_haff}, {"GarzoDufty", by_garzo_dufty}, {"Jenkins", by_haff}, {"BerziVescovi", by_haff}};

static const struct equation *equation_of(const struct cooling *c) {
    for (size_t i = 0; i < sizeof EQUATION / sizeof *EQUATION; i++)
        if (!strcmp(EQUATION[i].name, c->model.name)) return &EQUATION[i];
    fail_msg("this test has no equation for the law %s", c->model.name);
    return NULL;
}

/* T at dt by the classical Runge-Kutta method: an error below 1e-13 in 4000 steps. */
static double integrate(const struct equation *e, double contact, double T, double dt) {
    const int n = 4000;
    for (int i = 0; i < n; i++) {
        const double h = dt / n, a = e->rate(&GRAINS, contact, T), b = e->rate(&GRAINS, contact, T + 0.5 * h * a),
                     c = e->rate(&GRAINS, contact, T + 0.5 * h * b), d = e->rate(&GRAINS, contact, T + h * c);
        T += h / 6 * (a + 2 * b + 2 * c + d);
    }
    return T;
}

static double stepped(const struct cooling *c, double T, double dt, int steps) {
    const struct own_params params = own_defaults(&c->model);
    const double still = 0;
    const struct closure_line cells = {.eos = gs, .material = &GRAINS, .n = 1, .rho = &DENSE, .shear_rate = &still};
    double eps = T / (GRAINS.gamma - 1);
    for (int i = 0; i < steps; i++) c->step(&params, &cells, dt / steps, &eps);
    return eps * (GRAINS.gamma - 1);
}

/* The laws have their default parameters. As none depends on time, each takes in two halves what it takes at once. */
static void every_law_solves_its_equation(void **state) {
    (void)state;
    double contact;
    gs->contact(&GRAINS, 1, &DENSE, &contact);
    for (int i = 0; i < cooling_count; i++) {
        const struct cooling *c = &cooling_table[i];
        const struct equation *e = equation_of(c);
        for (double T = 1e-4; T < 1e5; T *= 100)
            for (double loss = 0.01; loss < 20; loss *= 5) {
                const double dt = loss / (-by_haff(&GRAINS, contact, T) / T);
                const double found = stepped(c, T, dt, 1);
                assert_close(found, integrate(e, contact, T, dt), 1e-11, c->model.name);
                assert_close(stepped(c, T, dt, 2), found, 1e-14, "in two halves");
            }
    }
}

/* Every law in steps of any length: T stays above zero and does not rise, and equal cells stay equal to the bit,
 * wherever they stand in a batch. */
static void every_law_is_safe(void **state) {
    (void)state;
    for (int i = 0; i < cooling_count; i++)
        for (double T = 1e-10; T < 1e10; T *= 10)
            for (double dt = 1e-12; dt < 1e8; dt *= 10) {
                const struct own_params params = own_defaults(&cooling_table[i].model);
                double rho[BATCH], shear_rate[BATCH], eps[BATCH], alone = T;
                for (int k = 0; k < BATCH; k++) rho[k] = DENSE, shear_rate[k] = 1, eps[k] = T;
                struct closure_line cells = {gs, &GRAINS, BATCH, rho, NULL, shear_rate, NULL, false};
                cooling_table[i].step(&params, &cells, dt, eps);
                cells.n = 1;
                cooling_table[i].step(&params, &cells, dt, &alone);
                assert_true(alone > 0 && alone <= T);
                for (int k = 0; k < BATCH; k++) assert_true(eps[k] == alone);
            }
}

static void names_are_found(void **state) {
    (void)state;
    for (int i = 0; i < cooling_count; i++) assert_true(cooling_find(cooling_table[i].model.name) == &cooling_table[i]);
    assert_null(cooling_find("haff"));
}

/* T after `steps` steps over dt in all, from T0, in a gas at rest; B: of dT/dt = -B T^(3/2) phi. */
static double cooled(double threshold, double T0, double dt, int steps) {
    struct material m = GRAINS;
    const struct closure_line cells = {.eos = gs, .material = &m, .n = 1, .rho = &DENSE};
    double eps = 1.5 * T0;
    m.threshold = threshold;

    for (int i = 0; i < steps; i++) haff->step(NULL, &cells, dt / steps, &eps);
    return eps / 1.5;
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

static int find_laws(void **state) {
    (void)state;
    haff = cooling_find("Haff");
    gs = eos_find("GoldshteinShapiro");
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(homogeneous_cooling),
        cmocka_unit_test(every_law_solves_its_equation),
        cmocka_unit_test(every_law_is_safe),
        cmocka_unit_test(names_are_found),
        cmocka_unit_test(threshold_is_of_second_order),
        cmocka_unit_test(threshold_of_any_step),
        cmocka_unit_test(threshold_has_both_limits),
    };
    return cmocka_run_group_tests(tests, find_laws, NULL);
}
