/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscosities and conductivity against reference values, and what holds at the ends of the range. */
#include "tests/libcore/oracle.h"

#include "libcore/models/kernel.h"
#include "libcore/models/transport.h"

#define PI 3.14159265358979323846

static void reference_values(void **state) {
    (void)state;
    FILE *f = oracle_open("carrillo_2d.csv");
    struct oracle_row r;
    const struct eos *eos = eos_find("TorquatoDisks");
    const struct transport *t = transport_find("JenkinsRichman");
    struct own_params own = own_defaults(&t->model), printed = own;
    model_put(&t->model, &printed, "bulk", 1);
    int rows = 0;
    for (oracle_row(f, &r); oracle_row(f, &r); rows++) {
        struct material m = grains_of(eos, oracle_number(&r, 0), 1);
        const double nu = oracle_number(&r, 1), tolerance = 1e-12 + 4e-16 * nu / (m.alpha_max - nu);
        double rho = nu / packing_per_density(&m), T = 1, bulk, shear, heat, hot[3];
        const struct closure_line cells = {eos, &m, 1, &rho, &T, NULL, NULL, false};
        t->coefficients(&own, &cells, &bulk, &shear, &heat);
        assert_close(bulk, oracle_number(&r, 8), tolerance, "bulk");
        assert_close(shear, oracle_number(&r, 9), tolerance, "shear");
        assert_close(heat, oracle_number(&r, 10), tolerance, "heat");
        T = 9;
        t->coefficients(&printed, &cells, &hot[0], &hot[1], &hot[2]);
        assert_close(hot[0], 6 * bulk, 1e-14, "sqrt T, printed bulk viscosity");
        assert_close(hot[1], 3 * shear, 1e-14, "sqrt T");
        assert_close(hot[2], 3 * heat, 1e-14, "sqrt T");
    }
    fclose(f);
    assert_true(rows == 72);
}

/* The columns of the oracles of Garzo & Dufty are in units of shear0, heat0 and heat0 T/n, with sigma = m = 1. */
static void garzo_dufty_values(const char *file, const char *eos_name, double shear0, double heat_ratio, int expected) {
    FILE *f = oracle_open(file);
    struct oracle_row r;
    const struct eos *eos = eos_find(eos_name);
    const struct transport *t = transport_find("GarzoDufty");
    struct own_params own = own_defaults(&t->model), full;
    int rows = 0;
    model_put(&t->model, &own, "alphaMin", 0);
    model_put(&t->model, &own, "zetaU", 1);
    full = own;
    model_put(&t->model, &full, "zetaU", 2);
    for (oracle_row(f, &r); oracle_row(f, &r); rows++) {
        struct material m = grains_of(eos, oracle_number(&r, 0), 1);
        /* the column of phi = 0 is the limit, and 1/(phi_c - phi) of a phi of 16 digits loses some of them */
        const double nu = larger(oracle_number(&r, 1), 1e-15);
        const double tolerance = 1e-12 + 4e-16 * nu / (m.alpha_max - nu), low = oracle_number(&r, 1) == 0 ? 1e-13 : 0;
        double rho = nu / packing_per_density(&m), T = 4, bulk, shear, heat, cross, zeta[2];
        const struct closure_line cells = {eos, &m, 1, &rho, &T, NULL, NULL, false};
        t->coefficients(&own, &cells, &bulk, &shear, &heat);
        t->cross(&own, &cells, &cross);
        t->dilation(&own, &cells, &zeta[0]);
        t->dilation(&full, &cells, &zeta[1]);
        const double unit = shear0 * 2, heat0 = heat_ratio * unit, sink = rho * eps_of(&m, T);
        assert_near(bulk / unit, oracle_number(&r, 12), tolerance * oracle_number(&r, 12) + low);
        assert_close(shear / unit, oracle_number(&r, 13), tolerance + low, "shear");
        assert_close(heat / heat0, oracle_number(&r, 15), tolerance + low, "heat");
        assert_near(cross * rho / (T * heat0), oracle_number(&r, 17), tolerance * fabs(oracle_number(&r, 17)) + 1e-14);
        assert_near(zeta[0] / sink, oracle_number(&r, 7), tolerance * fabs(oracle_number(&r, 7)) + 1e-14);
        assert_near((zeta[1] - zeta[0]) / sink, oracle_number(&r, 8), 1e-11 * fabs(oracle_number(&r, 7)) + 1e-14);
    }
    fclose(f);
    assert_true(rows == expected);
}

static void garzo_dufty(void **state) {
    (void)state;
    garzo_dufty_values("garzo_dufty_3d.csv", "TorquatoSpheres", 5 / (16 * sqrt(PI)), 15. / 4, 150);
    garzo_dufty_values("garzo_2d.csv", "TorquatoDisks", 1 / (2 * sqrt(PI)), 4, 160);
}

static bool has_param(const struct model *row, const char *name) {
    bool found = false;
    for (int i = 0; i < row->nparam; i++) found |= strcmp(row->param[i].name, name) == 0;
    return found;
}

/* Below alphaMin, of laws that have it, and above packing the coefficients are proportional to rho, so that
 * diffusivities are bounded. The coefficient of grad rho, which goes as T heat/rho, is constant above packing; in thin
 * gas it falls with rho, too, as nothing there makes heat rise against grad rho. */
static void ends_of_the_range(void **state) {
    (void)state;
    for (int row = 0; row < transport_count; row++) {
        const struct transport *t = &transport_table[row];
        if (!has_param(&t->model, "alphaMin")) continue;
        const struct eos *eos = eos_find(t->valid & GRAINS_SPHERES ? "TorquatoSpheres" : "TorquatoDisks");
        struct material m = grains_of(eos, 0.75, 0.01);
        struct own_params own = own_defaults(&t->model);
        double nu[4] = {1e-4, 1e-9, 0.9999 * m.alpha_max, 1.5}, rho[4], T[4] = {1, 1, 1, 1}, out[3][4], cross[4];
        const struct closure_line cells = {eos, &m, 4, rho, T, NULL, NULL, false};
        for (int i = 0; i < 4; i++) rho[i] = nu[i] / packing_per_density(&m);
        t->coefficients(&own, &cells, out[0], out[1], out[2]);
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 4; i += 2)
                assert_close(out[k][i + 1] / rho[i + 1], out[k][i] / rho[i], 1e-10, "coefficient per density");
        if (t->cross) t->cross(&own, &cells, cross);
        if (!t->cross) continue;
        assert_close(cross[1] / rho[1], cross[0] / rho[0], 1e-10, "coefficient of grad rho in thin gas");
        assert_close(cross[3], cross[2], 1e-10, "coefficient of grad rho above packing");
    }
}

/* The Knudsen cut multiplies all coefficients by alpha/(alpha + value); dilation, which is no diffusion, is not cut. */
static void knudsen_cut(void **state) {
    (void)state;
    const struct eos *eos = eos_find("TorquatoSpheres");
    const struct transport *t = transport_find("GarzoDufty");
    struct material m = grains_of(eos, 0.9, 0.01);
    struct own_params own = own_defaults(&t->model), cut;
    model_put(&t->model, &own, "zetaU", 1);
    cut = own;
    model_put(&t->model, &cut, "knudsenCut", 0.01);
    double rho = 0.02 / packing_per_density(&m), T = 3, whole[5], left[5];
    const struct closure_line cells = {eos, &m, 1, &rho, &T, NULL, NULL, false};
    t->coefficients(&own, &cells, &whole[0], &whole[1], &whole[2]);
    t->cross(&own, &cells, &whole[3]);
    t->dilation(&own, &cells, &whole[4]);
    t->coefficients(&cut, &cells, &left[0], &left[1], &left[2]);
    t->cross(&cut, &cells, &left[3]);
    t->dilation(&cut, &cells, &left[4]);
    for (int k = 0; k < 4; k++) assert_close(left[k], whole[k] * 2 / 3, 1e-14, "cut");
    assert_true(left[4] == whole[4] && whole[4] < 0);
}

static void batch_is_a_loop(void **state) {
    (void)state;
    const struct eos *eos = eos_find("TorquatoDisks");
    struct material m = grains_of(eos, 0.75, 0.01);
    double rho[BATCH], T[BATCH], bulk[BATCH], shear[BATCH], heat[BATCH];
    for (int i = 0; i < BATCH; i++) {
        rho[i] = 0.014 * i / packing_per_density(&m);
        T[i] = 1 + 3 * i;
    }
    for (int k = 0; k < transport_count; k++) {
        struct own_params own = own_defaults(&transport_table[k].model);
        for (int n = 1; n <= BATCH; n += 9) {
            const struct closure_line cells = {eos, &m, n, rho, T, T, NULL, false};
            transport_table[k].coefficients(&own, &cells, bulk, shear, heat);
            for (int i = 0; i < n; i++) {
                const struct closure_line one = {eos, &m, 1, rho + i, T + i, T + i, NULL, false};
                double b, s, h;
                transport_table[k].coefficients(&own, &one, &b, &s, &h);
                assert_true(b == bulk[i] && s == shear[i] && h == heat[i]);
            }
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reference_values), cmocka_unit_test(garzo_dufty),     cmocka_unit_test(ends_of_the_range),
        cmocka_unit_test(knudsen_cut),      cmocka_unit_test(batch_is_a_loop),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
