/* Gases of disks with transport, for tests of diffusion on both mesh engines. */
#ifndef TESTS_LIBCORE_VISCOUS_H
#define TESTS_LIBCORE_VISCOUS_H

#include "libcore/gas/gas_private.h"
#include "solvers/gas/linear.h"
#include "tests/libcore/gas/manufactured.h"

#include "tests/libcore/oracle.h" /* last: cmocka.h defines fail() */
#include "tests/libcore/scene.h"

static const double BULK_VISCOSITY = 0.4, VISCOSITY = 0.7, CONDUCTION = 1.1;

static inline void constant_law(const struct own_params *params, const struct eos *eos, const struct material *m, int n,
                                const double *restrict rho, const double *restrict T, double *restrict bulk,
                                double *restrict shear, double *restrict heat) {
    (void)params, (void)eos, (void)m, (void)rho, (void)T;
    for (int i = 0; i < n; i++) {
        bulk[i] = BULK_VISCOSITY;
        shear[i] = VISCOSITY;
        heat[i] = CONDUCTION;
    }
}
/* Coefficients that do not change with T or u: what is left in time is the schemes. */
static inline void density_law(const struct own_params *params, const struct eos *eos, const struct material *m, int n,
                               const double *restrict rho, const double *restrict T, double *restrict bulk,
                               double *restrict shear, double *restrict heat) {
    (void)params, (void)eos, (void)m, (void)T;
    for (int i = 0; i < n; i++) {
        bulk[i] = 0.4 * rho[i];
        shear[i] = 0.7 * rho[i] * rho[i];
        heat[i] = 1.1 / rho[i];
    }
}
static const struct transport CONSTANT = {.coefficients = constant_law}, VARIED = {.coefficients = manufactured_law},
                              OF_DENSITY = {.coefficients = density_law};

/* The module of PETSc as the programs load it; NULL if haff was built without PETSc. */
static inline const struct linear_module *linear_module(void) {
    const struct linear_module *module;
    status_free(linear_load(&module));
    return module;
}

static inline struct gas_models disks_models(const struct transport *transport, const char *diffusion) {
    const struct eos *eos = eos_find("TorquatoDisks");
    return (struct gas_models){.material = grains_of(eos, 0.9, 0.1),
                               .eos = eos,
                               .flux = flux_find("common"),
                               .polynomial = polynomial_find("linear"),
                               .reconstruct = reconstruct_find("WENO5"),
                               .stepper = stepper_find("SSPRK3"),
                               .transport = transport,
                               .transport_params = own_defaults(&transport->model),
                               .diffusion = diffusion_find(diffusion),
                               .linear = diffusion_find(diffusion)->plan ? NULL : linear_module()};
}

/* Is this row of diffusion_table there? The log of a test tells what is left out without PETSc's module. */
static inline bool scheme_is_there(int scheme) {
    if (diffusion_table[scheme].plan || linear_module()) return true;
    print_message("left out: diffusion %s, whose module is not there\n", diffusion_table[scheme].model.name);
    return false;
}

typedef void initial(const double x[3], double *rho, double u[3], double *T);

static inline void start(struct scene *s, initial *at) {
    int n = s->cells;
    double *all = malloc(5 * (size_t)n * sizeof *all), *u[3] = {all + n, all + 2 * n, all + 3 * n};
    for (int i = 0; i < n; i++) {
        double v[3] = {0, 0, 0};
        at(s->centre + 3 * i, &all[i], v, &all[4 * n + i]);
        for (int k = 0; k < 3; k++) u[k][i] = v[k];
    }
    ok(gas_set(s->gas, all, (const double *const *)u, all + 4 * n));
    free(all);
}

/* Only the diffusion, `steps` times dt; it leaves T > 0 everywhere. */
static inline void spread(struct scene *s, int steps, double dt) {
    struct gas *g = s->gas;
    for (int i = 0; i < steps; i++) {
        assert_true(diffuse(g, &g->U, &g->U0, dt, i % 2, 0));
        struct state moved = g->U0;
        g->U0 = g->U;
        g->U = moved;
    }
    ok(gas_check(g));
}

/* Whole steps, `count` times dt. */
static inline void go(struct scene *s, int count, double dt) {
    for (int i = 0; i < count; i++) {
        struct gas_speed speed;
        double taken = dt;
        gas_speed(s->gas, &speed);
        ok(gas_step(s->gas, i * dt, &taken, 1, 0, 0, &speed));
        assert_true(taken == dt);
    }
}

/* An Euler step of the faster kind of diffusion is just stable with the inverse of this. */
static inline double fastest(struct scene *s, const struct comm *c) {
    double rate[2];
    s->gas->engine->diffusion.rates(s->gas, &s->gas->U, rate);
    comm_max(c, rate, 2);
    return larger(rate[0], rate[1]);
}

/* T of a state of disks */
static inline double temperature(const double *all, int dim, int cells, int i) {
    double square = 0;
    for (int k = 1; k <= dim; k++) square += all[k * cells + i] * all[k * cells + i];
    return (all[(dim + 1) * cells + i] - 0.5 * square / all[i]) / all[i];
}

/* ---- fields --------------------------------------------------------------------------------------------------------
 */

static inline void turning(const double x[3], double *rho, double u[3], double *T) {
    *rho = 1 + x[0] * x[0] + 0.5 * x[1];
    *T = 2;
    u[0] = -3 * (x[1] - 0.4);
    u[1] = 3 * (x[0] - 0.3);
}

/* Six decades of density and temperature, Mach numbers of hundreds; no libm, for its bits. */
static inline void wild(const double x[3], double *rho, double u[3], double *T) {
    uint64_t h = (uint64_t)(x[0] * 1024) * 0x9e3779b97f4a7c15u + (uint64_t)(x[1] * 1024) * 0xc2b2ae3d27d4eb4fu +
                 (uint64_t)(x[2] * 1024) * 0x2545f4914f6cdd1du + 7;
    double q[5];
    for (int i = 0; i < 5; i++) {
        h ^= h >> 29;
        h *= 0xbf58476d1ce4e5b9u;
        q[i] = (double)(h >> 40) / 16777216;
    }
    *rho = 95 * q[0] * q[0] * q[0] * q[0] + 1e-4;
    *T = 1e3 * q[1] * q[1] * q[1] * q[1] * q[1] * q[1] + 1e-3;
    for (int k = 0; k < 3; k++) u[k] = 20 * (q[2 + k] - 0.5);
}

static inline void uniform(const double x[3], double *rho, double u[3], double *T) {
    (void)x;
    *rho = 61.7;
    *T = 0.3;
    u[0] = 0.1;
    u[1] = -0.7;
    u[2] = 0.4;
}

#endif
