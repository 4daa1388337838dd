/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every equation of state: reference values, thermodynamic identities by differences, limits. */
#include "tests/libcore/oracle.h"

#include "libcore/models/eos.h"
#include "libcore/models/kernel.h"

#define PI 3.14159265358979323846

static struct material material(double e, double sigma) {
    return (struct material){.diameter = sigma, .mass = 1, .restitution = e, .gamma = 5. / 3, .alpha_max = 0.65};
}

static void power_is_libm(void **state) {
    (void)state;
    for (double x = 1e-12; x < 1e3; x *= 1.0173)
        for (double a = 0.1; a < 3; a += 0.37)
            assert_close(power(x, a), pow(x, a), 4e-16 * (2 + fabs(a * log(x))), "power");
    assert_close(power(1, 0.3), 1, 0, "1^a");
}

static void exponential_and_logarithm_are_libm(void **state) {
    (void)state;
    for (double x = 1e-250; x < 1e250; x *= 1.37) assert_near(logarithm(x), log(x), 4e-16 * (1 + fabs(log(x))));
    for (double y = 1e-250; y < 690; y *= 1.37) {
        assert_close(exponential(y), exp(y), 4e-16 * (2 + y), "exp");
        assert_close(exponential(-y), exp(-y), 4e-16 * (2 + y), "exp(-)");
        assert_close(exponential_minus_one(y), expm1(y), 4e-16 * (2 + y), "expm1");
        assert_close(exponential_minus_one(-y), expm1(-y), 1e-15, "expm1(-)");
        assert_close(logarithm_plus_one(y), log1p(y), 1e-15, "log1p");
    }
    assert_true(exponential_minus_one(0) == 0 && logarithm_plus_one(0) == 0);
}

static void reference_values(void **state) {
    (void)state;
    FILE *f = oracle_open("gs_eos.csv");
    struct oracle_row r;
    int rows = 0;
    const struct eos *gs = eos_find("GoldshteinShapiro");
    for (oracle_row(f, &r); oracle_row(f, &r); rows++) {
        struct material m = material(oracle_number(&r, 0), cbrt(6 / PI)); /* rho = nu */
        double rho = oracle_number(&r, 1), eps = 1.5, p, c2, gruneisen, G;
        rho /= packing_per_density(&m);
        gs->state(&m, 1, &rho, &eps, &p, &c2, &gruneisen);
        gs->contact(&m, 1, &rho, &G);
        assert_close(G, oracle_number(&r, 2), 1e-12, "G");
        assert_close(p / rho, oracle_number(&r, 5), 1e-12, "A");
        assert_close(c2, oracle_number(&r, 7), 1e-12, "c^2/T");
        assert_close(c2 - p / rho - 2. / 3 * p / rho * p / rho, oracle_number(&r, 6),
                     1e-12 + 4e-16 * c2 / oracle_number(&r, 6), "rho A'");
        assert_close(sqrt(c2), oracle_number(&r, 8), 1e-12, "c");
        assert_close(rho * c2 / p, oracle_number(&r, 9), 1e-12, "gamma_A");
        assert_close(gruneisen, oracle_number(&r, 11), 1e-12, "Grueneisen");
    }
    fclose(f);
    assert_true(rows == 120);
}

static void initial_states(void **state) {
    (void)state;
    FILE *f = oracle_open("gs_states.csv");
    struct oracle_row r;
    const struct eos *gs = eos_find("GoldshteinShapiro");
    int rows = 0;
    for (oracle_row(f, &r); oracle_row(f, &r); rows++) {
        struct material m = material(oracle_number(&r, 1), 0.1);
        double rho = oracle_number(&r, 2), eps = oracle_number(&r, 8), p, c2, gruneisen, G;
        gs->state(&m, 1, &rho, &eps, &p, &c2, &gruneisen);
        gs->contact(&m, 1, &rho, &G);
        assert_close(packing_per_density(&m) * rho, oracle_number(&r, 5), 1e-12, "nu");
        assert_close(p, oracle_number(&r, 4), 1e-12, "P");
        assert_close(sqrt(c2), oracle_number(&r, 9), 1e-12, "c");
        double T = 2. / 3 * eps, e = m.restitution;
        double theta = 12 / sqrt(PI) * (1 - e * e) * rho * T * sqrt(T) / m.diameter * G;
        if (e < 1) assert_close(theta, oracle_number(&r, 11), 1e-12, "Theta");
        m.printed_sound = true;
        gs->state(&m, 1, &rho, &eps, &p, &c2, &gruneisen);
        assert_close(sqrt(c2), oracle_number(&r, 10), 1e-12, "c with the printed A'");
    }
    fclose(f);
    assert_true(rows == 12);
}

/* c^2 = p_rho + p p_eps/rho^2 and p = p_eps eps (flux.c relies on it) for every row of the table, p's derivatives by
 * central differences. */
static void sound_speed_is_consistent(void **state) {
    (void)state;
    for (int k = 0; k < eos_count; k++)
        for (double nu = 0.01; nu < (eos_table[k].bounded ? 0.6 : 0.9); nu += 0.031) {
            struct material m = grains_of(&eos_table[k], 0.8, 0.1);
            double h = nu < 0.78 ? 1e-5 : 1e-7, at = nu / packing_per_density(&m),
                   rho[4] = {at * (1 + h), at * (1 - h), at, at};
            double eps[4] = {2, 2, 2 * (1 + h), 2 * (1 - h)}, p[4], c2[4], g[4], one = at, two = 2, p0, c0, g0;
            eos_table[k].state(&m, 4, rho, eps, p, c2, g);
            eos_table[k].state(&m, 1, &one, &two, &p0, &c0, &g0);
            double p_rho = (p[0] - p[1]) / (2 * h * at), p_eps = (p[2] - p[3]) / (4 * h);
            assert_close(c0, p_rho + p0 * p_eps / (at * at), 1e-6, eos_table[k].model.name);
            assert_close(g0, p_eps / at, 1e-9, eos_table[k].model.name);
            assert_close(p0, at * two * g0, 1e-12, "linear in T");
        }
}

/* sigma = 0 and e = 1 need no special code: the dense gas is then the perfect one, to the last bit. */
/* What eos.h derives from p = rho T A(nu), for every row of the table. */
static void pressure_is_linear_in_T(void **state) {
    (void)state;
    for (int k = 0; k < eos_count; k++)
        for (double nu = 0.01; nu < 0.6; nu += 0.031) {
            const struct eos *eos = &eos_table[k];
            struct material m = grains_of(eos, 0.8, 0.1);
            const double h = 1e-6, rho = nu / packing_per_density(&m), eps = 2.3,
                         near[2] = {rho * (1 + h), rho * (1 - h)};
            double p, c2, gruneisen, p1, unit_c2, g1, per, beside[3][2];
            eos->state(&m, 1, &rho, &eps, &p, &c2, &gruneisen);
            eos_unit_state(eos, &m, 1, &rho, &p1, &unit_c2, &g1);
            eos_unit_state(eos, &m, 2, near, beside[0], beside[1], beside[2]);
            pressure_per_temperature(eos, &m, 1, &rho, &per);
            assert_close(p1 * eps, p, 1e-14, "p");
            assert_close(unit_c2 * eps, c2, 1e-14, "c2");
            assert_true(g1 == gruneisen);
            assert_close(per * temperature_of(&m, eps), p, 1e-14, "p/T");
            assert_close(eps_at_pressure(p, p1, 1), eps, 1e-14, "eps of p");
            assert_close(eps_of_pressure(p, rho, gruneisen), eps, 1e-12, "eps of p by Gamma");
            assert_close(enthalpy_of(eps, gruneisen), eps + p / rho, 1e-12, "enthalpy");
            assert_near(gruneisen_slope(unit_c2, g1), (beside[2][0] - beside[2][1]) / (2 * h), 1e-7 * unit_c2);
        }
}

static void dilute_limit(void **state) {
    (void)state;
    const struct eos *gs = eos_find("GoldshteinShapiro"), *perfect = eos_find("perfectGas");
    struct material m = material(0.9, 0);
    double rho[2] = {1e-3, 1e4}, eps[2] = {1, 7}, p[2][2], c2[2][2], g[2][2], G[2];
    gs->state(&m, 2, rho, eps, p[0], c2[0], g[0]);
    perfect->state(&m, 2, rho, eps, p[1], c2[1], g[1]);
    gs->contact(&m, 2, rho, G);
    for (int i = 0; i < 2; i++) {
        assert_true(p[0][i] == p[1][i] && g[0][i] == g[1][i] && G[i] == 0);
        assert_close(c2[0][i], c2[1][i], 1e-15, "c^2");
    }
}

/* A batch gives each state the bits it has alone, wherever it stands in the line. */
static void batch_is_a_loop(void **state) {
    (void)state;
    double rho[BATCH], eps[BATCH], p[BATCH], c2[BATCH], g[BATCH];
    for (int k = 0; k < eos_count; k++) {
        struct material m = grains_of(&eos_table[k], 0.9, 0.1);
        for (int i = 0; i < BATCH; i++) {
            rho[i] = 0.0005 * (1 + 19 * i) / packing_per_density(&m);
            eps[i] = 0.1 + i * 0.37;
        }
        for (int n = 1; n <= BATCH; n += 9) {
            eos_table[k].state(&m, n, rho, eps, p, c2, g);
            for (int i = 0; i < n; i++) {
                double p1, c1, g1;
                eos_table[k].state(&m, 1, rho + i, eps + i, &p1, &c1, &g1);
                assert_true(p1 == p[i] && c1 == c2[i] && g1 == g[i]);
            }
        }
    }
}

/* chi and chi' of disks and spheres, with and without the smoothing, through p and c^2. */
static void torquato_values(void **state) {
    (void)state;
    FILE *f = oracle_open("torquato_chi.csv");
    struct oracle_row r;
    int rows = 0;
    for (oracle_row(f, &r); oracle_row(f, &r); rows++) {
        const int d = (int)oracle_number(&r, 0);
        const struct eos *eos = eos_find(d == 2 ? "TorquatoDisks" : "TorquatoSpheres");
        struct material m = grains_of(eos, 0.75, 0.1);
        m.smoothing = oracle_number(&r, 1);
        const double nu = oracle_number(&r, 2), chi = oracle_number(&r, 3), slope = oracle_number(&r, 4);
        double rho = nu / packing_per_density(&m), T = 0.7, eps = T / (m.gamma - 1), G, p, c2, g;
        double A = 1 + (d - 1) * 1.75 * nu * chi, rest = (d - 1) * 1.75 * nu * (chi + nu * slope);
        assert_close(m.gamma, d == 2 ? 2 : 5. / 3, 0, "gamma");
        eos->contact(&m, 1, &rho, &G);
        const double tolerance = 1e-12 + 4e-16 * nu / (m.alpha_max - nu); /* of nu, rounded */
        assert_close(G, nu * chi, tolerance, "G");
        if (nu == 0) continue;
        eos->state(&m, 1, &rho, &eps, &p, &c2, &g);
        assert_close(p, rho * T * A, tolerance, "p");
        assert_close(c2, T * (A + rest + (m.gamma - 1) * A * A), 2 * tolerance, "c^2");
        assert_close(c2 / T - A - (m.gamma - 1) * A * A, rest, 2 * tolerance + 4e-16 * c2 / T / rest, "rho A'");
    }
    fclose(f);
    assert_true(rows == 316);
}

static void gas_of_disks(void **state) {
    (void)state;
    FILE *f = oracle_open("carrillo_2d.csv");
    struct oracle_row r;
    const struct eos *eos = eos_find("TorquatoDisks");
    int rows = 0;
    for (oracle_row(f, &r); oracle_row(f, &r); rows++) {
        struct material m = grains_of(eos, oracle_number(&r, 0), 1);
        const double nu = oracle_number(&r, 1), tolerance = 1e-12 + 4e-16 * nu / (m.alpha_max - nu);
        double rho = nu / packing_per_density(&m), eps = 1, p, c2, gruneisen, G, e = m.restitution;
        eos->state(&m, 1, &rho, &eps, &p, &c2, &gruneisen);
        eos->contact(&m, 1, &rho, &G);
        assert_close(rho, oracle_number(&r, 5), 1e-12, "rho");
        assert_close(G, oracle_number(&r, 3), tolerance, "G");
        assert_close(p, oracle_number(&r, 6), tolerance, "p");
        assert_close(c2, oracle_number(&r, 7), 2 * tolerance, "c^2");
        if (e < 1) assert_close(cooling_factor(&m) * (1 - e * e) * rho * G, oracle_number(&r, 11), tolerance, "sink");
    }
    fclose(f);
    assert_true(rows == 72);
}

/* G and nu G' of every row that has an alphaMax, where 1 - nu/alphaMax is 1e-1, .. 1e-12, and at last its last digit:
 * they grow, as the formulas do, and nothing is infinite, not even where rho is rounded up to the bound. */
static void packing_is_a_bound(void **state) {
    (void)state;
    enum { PLACES = 14 };
    for (int k = 0; k < eos_count; k++) {
        struct material m = grains_of(&eos_table[k], 0.8, 0.1);
        const double per = packing_per_density(&m), c = m.alpha_max;
        const bool diverges = m.freezing > 0 || !strcmp(eos_table[k].model.name, "GoldshteinShapiro");
        if (!(c > 0)) continue;
        double rho[PLACES], eps[PLACES], G[PLACES], steep[PLACES], p[PLACES], c2[PLACES], g[PLACES];
        for (int i = 0; i < PLACES; i++) {
            rho[i] = density_limit(&eos_table[k], &m) * (1 - pow(10, -1 - i));
            eps[i] = 1;
        }
        rho[PLACES - 2] = nextafter(density_limit(&eos_table[k], &m), 0);
        rho[PLACES - 1] = density_limit(&eos_table[k], &m) * (1 + 0x1p-51);
        eos_table[k].contact(&m, PLACES, rho, G);
        eos_table[k].slope(&m, PLACES, rho, steep);
        eos_table[k].state(&m, PLACES, rho, eps, p, c2, g);
        for (int i = 0; i < PLACES; i++) {
            assert_true(isfinite(G[i]) && isfinite(steep[i]) && isfinite(p[i]) && isfinite(c2[i]));
            assert_true(G[i] >= (i ? G[i - 1] : 0) && steep[i] >= (i ? steep[i - 1] : 0));
            assert_true(p[i] >= (i ? p[i - 1] : 0) && c2[i] >= (i ? c2[i - 1] : 0));
            if (i >= PLACES - 2 || !diverges) continue;
            assert_true(p[i] > 5 * (i ? p[i - 1] : 0) && c2[i] > 25 * (i ? c2[i - 1] : 0));
            const long double nu = (long double)per * rho[i], near = 1 - nu / c, a = 4.L / 3 * c;
            const long double x = powl(nu / c, a), f = m.freezing,
                              chi = m.disks ? (1 - 0.436L * f) / powl(1 - f, 2) : (1 - f / 2) / powl(1 - f, 3);
            const long double exact = f > 0 ? nu * chi * (c - f) / (c - nu) : nu / (1 - x);
            const long double slope = f > 0 ? exact * c / (c - nu) : exact * (1 + a * x / (1 - x));
            const double tolerance = 1e-13 + 1e-15 / (double)near; /* nu, rounded, is the less of 1 - nu/c */
            assert_close(G[i], (double)exact, tolerance, eos_table[k].model.name);
            assert_close(steep[i], (double)slope, 2 * tolerance, eos_table[k].model.name);
        }
    }
}

/* With `tangent` G is its own tangent above 0.9999 nu_c: convex, and p and c^2 finite at any density. */
static void no_density_is_forbidden(void **state) {
    (void)state;
    for (int k = 0; k < eos_count; k++) {
        if (strncmp(eos_table[k].model.name, "Torquato", 8) != 0) continue;
        struct material m = grains_of(&eos_table[k], 0.8, 0.1);
        m.tangent = true;
        const double last = 0.9999 * m.alpha_max, h = 1e-9;
        double rho[4], G[4], nu[4] = {last * (1 - h), last, last * (1 + h), 3};
        for (int i = 0; i < 4; i++) rho[i] = nu[i] / packing_per_density(&m);
        assert_true(density_limit(&eos_table[k], &m) == HUGE_VAL);
        eos_table[k].contact(&m, 4, rho, G);
        double slope[3];
        for (int i = 0; i < 3; i++) slope[i] = (G[i + 1] - G[i]) / (nu[i + 1] - nu[i]);
        assert_close(slope[0], slope[1], 1e-4, "G' is continuous");
        assert_close(slope[2], slope[1], 1e-4, "G is straight");
        double eps = 1, p, c2, g;
        eos_table[k].state(&m, 1, &rho[3], &eps, &p, &c2, &g);
        assert_true(isfinite(p) && isfinite(c2) && c2 > 0);
        assert_null(eos_objection(&eos_table[k], &m));
        m.smoothing = m.freezing;
        assert_non_null(eos_objection(&eos_table[k], &m));
        m.smoothing = 0.16;
        assert_non_null(eos_objection(&eos_table[k], &m));
        m.freezing = 0.6; /* the joint ends at 0.995 alphaMax, and overshoots: c^2 < 0 */
        m.smoothing = 0.02;
        m.alpha_max = 0.623155;
        assert_non_null(eos_objection(&eos_table[k], &m));
        m.smoothing = 0.005;
        assert_null(eos_objection(&eos_table[k], &m));
    }
}

/* slope is nu G', by central differences of contact, on both sides of every joint. */
static void slope_is_a_derivative(void **state) {
    (void)state;
    for (int k = 0; k < eos_count; k++) {
        struct material m = grains_of(&eos_table[k], 0.8, 0.1);
        const double most = m.alpha_max > 0 ? m.alpha_max : 1;
        for (double part = 0.01; part < 0.999; part += 0.0137) {
            const double nu = part * most, h = 1e-5 * (most - nu), at[3] = {nu - h, nu, nu + h};
            double rho[3], G[3], steep;
            for (int i = 0; i < 3; i++) rho[i] = at[i] / packing_per_density(&m);
            eos_table[k].contact(&m, 3, rho, G);
            eos_table[k].slope(&m, 1, &rho[1], &steep);
            assert_close(steep, nu * (G[2] - G[0]) / (at[2] - at[0]), 1e-6, eos_table[k].model.name);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(power_is_libm),
        cmocka_unit_test(exponential_and_logarithm_are_libm),
        cmocka_unit_test(reference_values),
        cmocka_unit_test(initial_states),
        cmocka_unit_test(sound_speed_is_consistent),
        cmocka_unit_test(pressure_is_linear_in_T),
        cmocka_unit_test(dilute_limit),
        cmocka_unit_test(batch_is_a_loop),
        cmocka_unit_test(torquato_values),
        cmocka_unit_test(gas_of_disks),
        cmocka_unit_test(packing_is_a_bound),
        cmocka_unit_test(no_density_is_forbidden),
        cmocka_unit_test(slope_is_a_derivative),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
