/* Viscosities and conductivity against reference values, and what holds at the ends of the range. */
#include "tests/libcore/oracle.h"

#include "libcore/models/kernel.h"
#include "libcore/models/transport.h"

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
        t->coefficients(&own, eos, &m, 1, &rho, &T, &bulk, &shear, &heat);
        assert_close(bulk, oracle_number(&r, 8), tolerance, "bulk");
        assert_close(shear, oracle_number(&r, 9), tolerance, "shear");
        assert_close(heat, oracle_number(&r, 10), tolerance, "heat");
        T = 9;
        t->coefficients(&printed, eos, &m, 1, &rho, &T, &hot[0], &hot[1], &hot[2]);
        assert_close(hot[0], 6 * bulk, 1e-14, "sqrt T, printed bulk viscosity");
        assert_close(hot[1], 3 * shear, 1e-14, "sqrt T");
        assert_close(hot[2], 3 * heat, 1e-14, "sqrt T");
    }
    fclose(f);
    assert_true(rows == 72);
}

/* Below alpha_min and above packing the coefficients are proportional to rho: diffusivities are bounded. */
static void ends_of_the_range(void **state) {
    (void)state;
    const struct eos *eos = eos_find("TorquatoDisks");
    struct material m = grains_of(eos, 0.75, 0.01);
    struct own_params own = own_defaults(&transport_table[0].model);
    double nu[4] = {1e-4, 1e-9, 0.9999 * m.alpha_max, 1.5}, rho[4], T[4] = {1, 1, 1, 1}, out[3][4];
    for (int i = 0; i < 4; i++) rho[i] = nu[i] / packing_per_density(&m);
    transport_table[0].coefficients(&own, eos, &m, 4, rho, T, out[0], out[1], out[2]);
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 4; i += 2)
            assert_close(out[k][i + 1] / rho[i + 1], out[k][i] / rho[i], 1e-10, "coefficient per density");
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
            transport_table[k].coefficients(&own, eos, &m, n, rho, T, bulk, shear, heat);
            for (int i = 0; i < n; i++) {
                double b, s, h;
                transport_table[k].coefficients(&own, eos, &m, 1, rho + i, T + i, &b, &s, &h);
                assert_true(b == bulk[i] && s == shear[i] && h == heat[i]);
            }
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reference_values),
        cmocka_unit_test(ends_of_the_range),
        cmocka_unit_test(batch_is_a_loop),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
