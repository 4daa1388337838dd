/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Laws of friction: mu of the inertial number, the share of friction in the stress, and what entries mean together. */
#include "tests/defaults.h"
#include "tests/libcore/oracle.h"

#include "libcore/models/friction.h"
#include "libcore/models/kernel.h"

static struct own_params entries_of(const char *row) {
    return own_defaults(&friction_find(row)->model);
}

static void put(const char *row, struct own_params *own, const char *name, double value) {
    model_put(&friction_find(row)->model, own, name, value);
}

static struct material spheres(void) {
    return grains_of(eos_find("TorquatoSpheres"), 0.9, 1e-3);
}

static double mu_of(const char *row, const struct friction_params *p, double inertia) {
    double mu;
    friction_find(row)->coefficient(p, 1, &inertia, &mu);
    return mu;
}

/* mu(I) of glass beads (Jop, Forterre & Pouliquen 2006): 0.38 at rest, half way to 0.64 at I = 0.279, 0.64 at most. */
static void coefficients(void **state) {
    (void)state;
    const struct material m = spheres();
    struct own_params own = entries_of("muI");
    struct friction_params p = friction_params(&own, &m);
    assert_true(mu_of("muI", &p, 0) == 0.38);
    assert_close(mu_of("muI", &p, 0.279), 0.51, 1e-15, "mu at I0");
    assert_close(mu_of("muI", &p, 0.1), 0.38 + 0.26 * 0.1 / 0.379, 1e-15, "mu at I = 0.1");
    assert_close(mu_of("muI", &p, 1e300), 0.64, 1e-15, "mu at large I");
    assert_close(mu_of("muI", &p, HUGE_VAL), 0.64, 1e-15, "mu at infinite I");
    own = entries_of("Coulomb");
    put("Coulomb", &own, "muStatic", 0.5);
    p = friction_params(&own, &m);
    assert_true(mu_of("Coulomb", &p, 0) == 0.5 && mu_of("Coulomb", &p, 10) == 0.5 && p.mu_dynamic == 0.5);
}

static void batch_is_a_loop(void **state) {
    (void)state;
    const struct material m = spheres();
    double inertia[BATCH], mu[BATCH];
    for (int i = 0; i < BATCH; i++) inertia[i] = 0.01 * i;
    for (int k = 0; k < friction_count; k++) {
        const struct friction *f = &friction_table[k];
        const struct own_params own = own_defaults(&f->model);
        const struct friction_params p = friction_params(&own, &m);
        assert_true(f->on == (f->coefficient != NULL) && f->on == friction_acts(f));
        for (int n = 1; n <= BATCH && f->on; n += 9) {
            f->coefficient(&p, n, inertia, mu);
            for (int i = 0; i < n; i++) assert_true(mu[i] == mu_of(f->model.name, &p, inertia[i]));
        }
    }
    assert_false(friction_acts(NULL));
    assert_null(friction_find("mui"));
}

/* What is not given follows from alphaMax, from the angle, or from the row. */
static void defaults(void **state) {
    (void)state;
    struct material m = spheres();
    m.alpha_max = 0.6;
    for (int k = 0; k < friction_count; k++) {
        struct own_params own = own_defaults(&friction_table[k].model);
        const struct friction_params p = friction_params(&own, &m);
        assert_close(p.alpha_friction, 0.78 * 0.6, 1e-15, "alphaFriction");
        assert_close(p.alpha_solid, 0.54, 1e-15, "alphaSolid");
        assert_true(p.mu_static == 0.38 && p.I0 == 0.279 && p.modulus == 300);
        assert_true(p.cohesion == 0 && p.surface_cohesion == 0.5 && p.heating == 0);
        assert_null(friction_objection(&p));
    }
    struct own_params own = entries_of("muI");
    put("muI", &own, "frictionAngle", 30);
    put("muI", &own, "alphaSolid", 0.55);
    const struct friction_params p = friction_params(&own, &m);
    assert_close(p.mu_static, 0.5, 1e-15, "sin 30");
    assert_true(p.alpha_solid == 0.55);
    friction_complete(&own, &m); /* a second time, for the log */
    assert_close(friction_params(&own, &m).mu_static, 0.5, 1e-15, "sin 30");
}

static void objections(void **state) {
    (void)state;
    const struct material m = spheres();
    const struct {
        const char *name;
        double value;
    } bad[] = {
        {"muDynamic", 0.3}, {"muStatic", 0.7}, {"frictionAngle", 45}, {"alphaSolid", 0.4}, {"alphaFriction", 0.6}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct own_params own = entries_of("muI");
        put("muI", &own, bad[i].name, bad[i].value);
        const struct friction_params p = friction_params(&own, &m);
        assert_non_null(friction_objection(&p));
    }
}

/* s is 0 below alphaFriction, 1 above alphaSolid, and linear between. */
static void shares(void **state) {
    (void)state;
    const struct material m = spheres();
    struct own_params own = entries_of("Coulomb");
    put("Coulomb", &own, "alphaFriction", 0.5);
    put("Coulomb", &own, "alphaSolid", 0.6);
    const struct friction_params p = friction_params(&own, &m);
    const double alpha[] = {1e-6, 0.499, 0.5, 0.525, 0.55, 0.59, 0.6001, 0.639}, s[] = {0, 0, 0, 0.25, 0.5, 0.9, 1, 1};
    double rho[8], share[8];
    for (int i = 0; i < 8; i++) rho[i] = alpha[i] / packing_per_density(&m);
    friction_share(&p, &m, 8, rho, share);
    for (int i = 0; i < 8; i++) assert_near(share[i], s[i], 1e-14);
    assert_true(share[0] == 0 && share[1] == 0 && share[6] == 1 && share[7] == 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(coefficients), cmocka_unit_test(batch_is_a_loop), cmocka_unit_test(defaults),
        cmocka_unit_test(objections),   cmocka_unit_test(shares),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
