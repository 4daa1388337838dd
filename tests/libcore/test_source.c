/* Exact source steps: homogeneous cooling, free fall, shaken gravity. */
#include "tests/libcore/oracle.h"

#include "libcore/source.h"

#define PI 3.14159265358979323846

static void homogeneous_cooling(void **state) {
    (void)state;
    FILE *f = oracle_open("hcs.csv");
    struct row r;
    int rows = 0;
    const struct eos *gs = eos_find("GoldshteinShapiro");
    for (oracle_row(f, &r); oracle_row(f, &r);) {
        if (strncmp(r.word[0], "GS", 2) != 0) continue;
        struct material m = {
            .diameter = 0.1, .mass = 1, .restitution = oracle_number(&r, 1), .gamma = 5. / 3, .alpha_max = 0.65};
        struct sources s = {.cooling = true};
        double rho = oracle_number(&r, 2) / packing_per_density(&m), T0 = oracle_number(&r, 3);
        double t = oracle_number(&r, 4), zero[MAX_DIM] = {0};
        for (int steps = 1; steps <= 7; steps += 6) { /* exact: in one step or in seven */
            double mass = rho, mom = 0, E = rho * 1.5 * T0, *U[MAX_VAR] = {&mass, &mom, &E};
            for (int i = 0; i < steps; i++) source_apply(&s, gs, &m, 1, 1, t / steps, zero, U);
            assert_close(2. / 3 * E / mass, oracle_number(&r, 5), 1e-10, "T(t)");
            assert_true(mass == rho && mom == 0);
        }
        rows++;
    }
    fclose(f);
    assert_true(rows == 24);
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(homogeneous_cooling),
        cmocka_unit_test(free_fall),
        cmocka_unit_test(shaken_gravity),
        cmocka_unit_test(what_costs_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
