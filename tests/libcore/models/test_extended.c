/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Extended kinetic theory against tables that do not come from this code (tests/oracles/extended.py): packing, stress,
 * conduction and loss of sheared spheres, with and without friction; steps of any length; and a cell that shears under
 * constant pressure, which flows or stops. */
#include "tests/libcore/oracle.h"

#include "libcore/models/cooling.h"
#include "libcore/models/kernel.h"
#include "libcore/models/transport.h"

#define PI 3.14159265358979323846

enum { COLUMNS = 16 };
enum { E, FRICTION, PACKED, NU, G, STEEP, F1, F2, F3, F4, F0, F0_JENKINS, LENGTH, T_STEADY, P_STEADY, RATIO };
static const struct eos *vescovi;
static const struct transport *transport;

/* Grains of density and diameter 1. */
static struct material grains(double e, double friction, double packed) {
    struct material m = grains_of(vescovi, e, 1);
    m.mass = PI / 6;
    m.friction = friction;
    m.alpha_max = packed;
    return m;
}

/* Calls `check` with the numbers of each row. */
static void each_row(void (*check)(const double *v, const struct material *m)) {
    FILE *f = oracle_open("extended.csv");
    struct oracle_row r;
    int rows = 0;
    for (oracle_row(f, &r); oracle_row(f, &r); rows++) {
        double v[COLUMNS];
        for (int i = 0; i < COLUMNS; i++) v[i] = oracle_number(&r, i);
        const struct material m = grains(v[E], v[FRICTION], v[PACKED]);
        check(v, &m);
    }
    fclose(f);
    assert_true(rows == 141);
}

static void check_state(const double *v, const struct material *m) {
    const double tolerance = 1e-12 + 4e-16 * v[NU] / (v[PACKED] - v[NU]), eps = 1.5 * 4;
    double contact, steep, p, c2, gruneisen;
    vescovi->contact(m, 1, &v[NU], &contact);
    vescovi->slope(m, 1, &v[NU], &steep);
    vescovi->state(m, 1, &v[NU], &eps, &p, &c2, &gruneisen);
    assert_close(contact, v[G], tolerance, "G");
    assert_close(steep, v[STEEP], 2 * tolerance + 1e-13, "nu dG/dnu");
    assert_close(p, v[F1] * 4, tolerance, "p");
    assert_close(vescovi->packing(v[FRICTION]), v[PACKED], 1e-15, "nu_s");
}

static void check_coefficients(const double *v, const struct material *m) {
    struct own_params own = own_defaults(&transport->model);
    const double tolerance = 1e-12 + 4e-16 * v[NU] / (v[PACKED] - v[NU]), T = 4;
    const struct closure_line cells = {.eos = vescovi, .material = m, .n = 1, .rho = &v[NU], .T = &T};
    double bulk, shear, heat;
    transport->coefficients(&own, &cells, &bulk, &shear, &heat);
    assert_close(shear, v[F2] * 2, tolerance, "shear viscosity");
    assert_close(heat, v[F4] * 2, tolerance, "heat conductivity");
    assert_false(transport_terms(transport, &own).cross);
}

static double half(const char *name, const struct material *m, double nu, double T, double shear_rate, double dt,
                   bool late) {
    const struct cooling *c = cooling_find(name);
    struct own_params own = own_defaults(&c->model);
    const struct closure_line cells = {
        .eos = vescovi, .material = m, .n = 1, .rho = &nu, .shear_rate = &shear_rate, .late = late};
    double eps = eps_of(m, T);
    c->step(&own, &cells, dt, &eps);
    return temperature_of(m, eps);
}

/* Whole steps, each of two halves. */
static double steps(const char *name, const struct material *m, double nu, double T, double shear_rate, double dt,
                    int n) {
    for (int i = 0; i < n; i++) {
        T = half(name, m, nu, T, shear_rate, 0.5 * dt / n, false);
        T = half(name, m, nu, T, shear_rate, 0.5 * dt / n, true);
    }
    return T;
}

/* T after dt, by the two solutions of dT/dt = -B T^(3/2)/max(1, a/sqrt T), B = (2/3) f3/nu. */
static double exact(const double *v, double f0, double T, double shear_rate, double dt) {
    const double B = 2. / 3 * v[F3] / v[NU], a = f0 * shear_rate, root = sqrt(T);
    const double until = a > 0 ? 2 / B * (1 / a - 1 / root) : HUGE_VAL; /* the time when sqrt T = a */
    if (until >= dt) return T / ((1 + B * root * dt / 2) * (1 + B * root * dt / 2));
    const double from = until > 0 ? a * a : T, rest = until > 0 ? dt - until : dt;
    return 1 / (1 / from + B * rest / a);
}

/* T far above, near, and below the bound a^2, over times in which little, half, and most of it is lost. Errors are of
 * second order; but T that passes a^2 there, where L has a kink, does so within one of the steps. */
static void check_loss(const double *v, const struct material *m) {
    static const struct {
        const char *name;
        int f0;
    } LAW[] = {{"BerziVescovi", F0}, {"Jenkins", F0_JENKINS}};
    for (int law = 0; law < 2; law++)
        for (double root = 0.1; root < 20; root *= 3)
            for (double lost = 0.1; lost < 2; lost *= 4) {
                const double T = root * root, shear_rate = 1 / v[LAW[law].f0], dt = lost * v[NU] / v[F3] / root;
                const double right = exact(v, v[LAW[law].f0], T, shear_rate, dt);
                double error[2];
                for (int k = 0; k < 2; k++)
                    error[k] = fabs(steps(LAW[law].name, m, v[NU], T, shear_rate, dt, 32 << k) / right - 1);
                assert_true(error[1] < 1e-4);
                if (error[1] > 1e-11 && (root < 1 || right > 1)) assert_near(log2(error[0] / error[1]), 2, 0.1);
                assert_close(steps(LAW[law].name, m, v[NU], T, 0, dt, 1), exact(v, v[LAW[law].f0], T, 0, dt), 1e-11,
                             "without shear");
            }
}

/* At sqrt T = a, where L leaves sigma, the rule of the second half goes over to the other without a jump; and the
 * second half backwards in time is the first half. */
static void halves_are_symmetric(void **state) {
    (void)state;
    const struct material m = grains(0.7, 0, 0.636);
    for (double shear_rate = 0.1; shear_rate < 100; shear_rate *= 1.7)
        for (double dt = 1e-3; dt < 0.2; dt *= 3) {
            const double after = half("BerziVescovi", &m, 0.55, 1, shear_rate, dt, true);
            assert_close(half("BerziVescovi", &m, 0.55, after, shear_rate, -dt, false), 1, 1e-12, "T, back");
            const double nudged = half("BerziVescovi", &m, 0.55, 1, shear_rate * (1 + 1e-9), dt, true);
            assert_close(nudged, after, 1e-8, "no jump");
        }
}

/* At the T of the table heating by shear and loss are equal; the table's p and s/p follow. */
static void check_shear(const double *v, const struct material *m) {
    struct own_params own = own_defaults(&transport->model);
    const double T = v[T_STEADY], eps = eps_of(m, T), dt = 1e-8;
    const struct closure_line cells = {.eos = vescovi, .material = m, .n = 1, .rho = &v[NU], .T = &T};
    double bulk, shear, heat, p, c2, gruneisen;
    transport->coefficients(&own, &cells, &bulk, &shear, &heat);
    vescovi->state(m, 1, &v[NU], &eps, &p, &c2, &gruneisen);
    assert_close(p, v[P_STEADY], 1e-11, "p");
    assert_close(shear / p, v[RATIO], 1e-11, "s/p");
    const double loss = v[NU] * (eps - eps_of(m, half("BerziVescovi", m, v[NU], T, 1, dt, false))) / dt;
    assert_close(loss, shear, 1e-4, "loss at a shear rate of 1");
}

static void table(void **state) {
    (void)state;
    each_row(check_state);
    each_row(check_coefficients);
    each_row(check_loss);
    each_row(check_shear);
}

/* In gas without shear the laws have the bits of Haff's, with a threshold, too. */
static void no_shear_is_haff(void **state) {
    (void)state;
    for (double threshold = 0; threshold < 1; threshold += 0.3) {
        struct material m = grains(0.8, 0.2, 0.6);
        m.threshold = threshold;
        for (double T = 1e-9; T < 1e9; T *= 7)
            for (double dt = 1e-9; dt < 1e9; dt *= 50) {
                const double haff = half("Haff", &m, 0.55, T, 0, dt, false);
                for (int late = 0; late < 2; late++) {
                    assert_true(half("BerziVescovi", &m, 0.55, T, 0, dt, late) == haff);
                    assert_true(half("Jenkins", &m, 0.55, T, 0, dt, late) == haff);
                }
            }
    }
}

/* Where friction carries a part of the stress, L has the shear rate that impacts carry alone. */
static void friction_fades_correlations(void **state) {
    (void)state;
    const struct material m = grains(0.7, 0.5, 0.581);
    const double nu = 0.57, shear_rate = 3;
    const struct cooling *c = cooling_find("BerziVescovi");
    struct own_params own = own_defaults(&c->model);
    for (double share = 0; share <= 1; share += 0.25) {
        const struct closure_line cells = {
            .eos = vescovi, .material = &m, .n = 1, .rho = &nu, .shear_rate = &shear_rate, .by_impacts = &share};
        double eps = eps_of(&m, 0.1);
        c->step(&own, &cells, 0.01, &eps);
        assert_close(temperature_of(&m, eps), half("BerziVescovi", &m, nu, 0.1, share * shear_rate, 0.01, false), 1e-15,
                     "T");
    }
}

/* With a threshold speed the step is of second order, and T stays above 0 in steps of any length. */
static void threshold_is_of_second_order(void **state) {
    (void)state;
    struct material m = grains(0.7, 0, 0.636);
    m.threshold = 0.1;
    for (double T = 0.01; T < 0.1; T *= 2.2) { /* L/diameter is 4.7 .. 1.5 there */
        const double dt = 0.3, fine = steps("BerziVescovi", &m, 0.55, T, 0.5, dt, 1024);
        const double coarse = fabs(steps("BerziVescovi", &m, 0.55, T, 0.5, dt, 8) - fine),
                     finer = fabs(steps("BerziVescovi", &m, 0.55, T, 0.5, dt, 16) - fine);
        assert_near(log2(coarse / finer), 2, 0.2);
        assert_true(steps("BerziVescovi", &m, 0.55, T, 0.5, 1e12, 1) > 0);
    }
}

/* ---- a cell under constant pressure 1 and shear stress s ---- */

static double nu_of_pressure(const struct material *m, double T) {
    double low = 1e-3, high = m->alpha_max;
    for (int i = 0; i < 100; i++) {
        const double nu = 0.5 * (low + high);
        double per;
        pressure_per_temperature(vescovi, m, 1, &nu, &per);
        *(per * T < 1 ? &low : &high) = nu;
    }
    return low;
}

struct cell { /* of one T: packing, shear rate s/shear, and dT/dt by the work of s */
    double nu, shear_rate, heating;
};

/* The coefficients end so near to packing that the cell can stop. */
static struct cell cell_at(const struct material *m, double s, double T) {
    struct own_params own = own_defaults(&transport->model);
    const double nu = nu_of_pressure(m, T);
    const struct closure_line cells = {.eos = vescovi, .material = m, .n = 1, .rho = &nu, .T = &T};
    double bulk, shear, heat;
    model_put(&transport->model, &own, "packingEnd", 1 - 1e-12);
    transport->coefficients(&own, &cells, &bulk, &shear, &heat);
    return (struct cell){nu, s / shear, s * (s / shear) / (1.5 * nu)};
}

/* Half a step of loss, a step of heating, half a step of loss, as the programs do. */
static double advanced(const struct material *m, const struct cell *c, double T, double dt) {
    T = half("BerziVescovi", m, c->nu, T, c->shear_rate, 0.5 * dt, false) + dt * c->heating;
    return half("BerziVescovi", m, c->nu, T, c->shear_rate, 0.5 * dt, true);
}

/* Midpoint steps in which heating and loss change T by 2 % each at most. Returns the time of T = 1e-10, or of the end;
 * *T: as it is then. */
static double sheared(double s, double end, double *T) {
    const struct material m = grains(0.7, 0.5, 0.581);
    double t = 0;
    for (*T = 0.02; t<end && * T> 1e-10;) {
        struct cell c = cell_at(&m, s, *T);
        const double probe = 1e-9 * *T / c.heating,
                     lost = *T - half("BerziVescovi", &m, c.nu, *T, c.shear_rate, probe, false);
        const double dt = 0.02 * *T / larger(c.heating, lost / probe);
        c = cell_at(&m, s, advanced(&m, &c, *T, 0.5 * dt));
        *T = advanced(&m, &c, *T, dt);
        t += dt;
    }
    return t;
}

static void cells_stop_or_flow(void **state) {
    (void)state;
    FILE *f = oracle_open("arrest.csv");
    struct oracle_row r;
    int rows = 0;
    for (oracle_row(f, &r); oracle_row(f, &r); rows++) {
        const double time = oracle_number(&r, 1);
        double T, t = sheared(oracle_number(&r, 0), 30, &T);
        if (time > 0)
            assert_close(t, time, 0.01, "time of the stop");
        else
            assert_close(T, oracle_number(&r, 2), 0.01, "T of the flow");
    }
    fclose(f);
    assert_true(rows == 6);
}

static void friction_of_grains(void **state) {
    (void)state;
    struct material m = grains(0.7, 0, 0.636);
    assert_true(effective_restitution(&m) == 0.7);
    m.friction = 1. / 3; /* where the least is */
    assert_close(effective_restitution(&m), 0.7 - 0.5 * exp(-1), 1e-14, "restitution");
    m.restitution = 0.1;
    assert_true(effective_restitution(&m) == 0);
    assert_close(vescovi->packing(0.2), 0.6, 1e-14, "nu_s, linear between rows");
    assert_true(vescovi->packing(7) == 0.573);
}

static int find_laws(void **state) {
    (void)state;
    vescovi = eos_find("VescoviSpheres");
    transport = transport_find("JenkinsBerzi");
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table),
        cmocka_unit_test(halves_are_symmetric),
        cmocka_unit_test(no_shear_is_haff),
        cmocka_unit_test(friction_fades_correlations),
        cmocka_unit_test(threshold_is_of_second_order),
        cmocka_unit_test(cells_stop_or_flow),
        cmocka_unit_test(friction_of_grains),
    };
    return cmocka_run_group_tests(tests, find_laws, NULL);
}
