/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gases of disks and spheres with transport, for tests of diffusion on both mesh engines. */
#ifndef TESTS_LIBCORE_VISCOUS_H
#define TESTS_LIBCORE_VISCOUS_H

#include "libcore/gas/gas_private.h"
#include "solvers/gas/linear.h"
#include "tests/libcore/gas/manufactured.h"

#include "tests/libcore/oracle.h" /* last: cmocka.h defines fail() */
#include "tests/libcore/scene.h"

static const double BULK_VISCOSITY = 0.4, VISCOSITY = 0.7, CONDUCTION = 1.1;

static inline void constant_law(const struct own_params *params, const struct closure_line *cells,
                                double *restrict bulk, double *restrict shear, double *restrict heat) {
    (void)params;
    for (int i = 0; i < cells->n; i++) {
        bulk[i] = BULK_VISCOSITY;
        shear[i] = VISCOSITY;
        heat[i] = CONDUCTION;
    }
}
/* Coefficients that do not change with T or u: what is left in time is the schemes. */
static inline void density_law(const struct own_params *params, const struct closure_line *cells, double *restrict bulk,
                               double *restrict shear, double *restrict heat) {
    const double *rho = cells->rho;
    (void)params;
    for (int i = 0; i < cells->n; i++) {
        bulk[i] = 0.4 * rho[i];
        shear[i] = 0.7 * rho[i] * rho[i];
        heat[i] = 1.1 / rho[i];
    }
}
static inline void density_cross(const struct own_params *params, const struct closure_line *cells,
                                 double *restrict cross) {
    (void)params;
    for (int i = 0; i < cells->n; i++) cross[i] = 0.8 / cells->rho[i];
}
static inline void density_dilation(const struct own_params *params, const struct closure_line *cells,
                                    double *restrict dilation) {
    (void)params;
    for (int i = 0; i < cells->n; i++) dilation[i] = -0.5 * cells->rho[i];
}
static const struct transport CONSTANT = {.coefficients = constant_law}, VARIED = {.coefficients = manufactured_law},
                              OF_DENSITY = {.coefficients = density_law,
                                            .terms = manufactured_terms,
                                            .cross = density_cross,
                                            .dilation = density_dilation},
                              DIAGONAL = {.coefficients = manufactured_law, .terms = manufactured_diagonal},
                              COMPLETE = {.coefficients = manufactured_law,
                                          .terms = manufactured_terms,
                                          .cross = manufactured_cross,
                                          .dilation = manufactured_dilation};

/* The module of PETSc as the programs load it; NULL if haff was built without PETSc. */
static inline const struct linear_module *linear_module(void) {
    const struct linear_module *module;
    status_free(linear_load(&module));
    return module;
}

static inline struct gas_models grains_models(const char *name, double restitution, double diameter,
                                              const struct transport *transport, const char *diffusion) {
    const struct eos *eos = eos_find(name);
    return (struct gas_models){.material = grains_of(eos, restitution, diameter),
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

static inline struct gas_models disks_models(const struct transport *transport, const char *diffusion) {
    return grains_models("TorquatoDisks", 0.9, 0.1, transport, diffusion);
}

/* Inelastic spheres by the law of Garzo & Dufty; `dilated`: with zeta_U, which takes energy where the gas expands. */
static inline struct gas_models spheres_models(double restitution, double diameter, bool dilated,
                                               const char *diffusion) {
    const struct transport *law = transport_find("GarzoDufty");
    struct gas_models m = grains_models("TorquatoSpheres", restitution, diameter, law, diffusion);
    model_put(&law->model, &m.transport_params, "zetaU", dilated ? 2 : 0);
    return m;
}

/* Disks in one and two dimensions, spheres in three, each by a law for them. */
static inline struct gas_models models_of(int dim, const char *diffusion) {
    return dim < 3 ? disks_models(transport_find("JenkinsRichman"), diffusion)
                   : spheres_models(0.8, 0.2, false, diffusion);
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
        assert_true(diffuse(g, &g->U, &g->U0, i * dt, dt, i % 2, 0));
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

/* What keeps the manufactured fields steady is added in halves around each of `count` steps that take `time` together,
 * of the diffusion alone or whole ones; what is left at the end is the error of space and splitting. error: the largest
 * of all cells, and the mean over the cells of the worst variable. */
static inline void drive(struct scene *s, const struct comm *c, enum manufactured_part parts, double time, int count,
                         double error[2]) {
    const int nvar = gas_variables(s->gas), numbers = nvar * s->cells;
    start(s, manufactured_fields);
    double *begin = state_of(s, c), *rates = malloc((size_t)numbers * sizeof *rates);
    for (int i = 0; i < s->cells; i++) {
        double out[MAX_VAR];
        manufactured_rates(&s->models, s->dim, parts, s->centre + 3 * i, out);
        for (int v = 0; v < nvar; v++) rates[v * s->cells + i] = out[v];
    }
    for (int step = 0; step < 2 * count; step++) {
        double *now = state_of(s, c);
        const double *U[MAX_VAR];
        for (int i = 0; i < numbers; i++) now[i] -= 0.5 * time / count * rates[i];
        for (int v = 0; v < nvar; v++) U[v] = now + v * s->cells;
        gas_set_conserved(s->gas, U);
        free(now);
        if (step % 2) continue;
        if (parts & OF_CONVECTION)
            go(s, 1, time / count);
        else
            spread(s, 1, time / count);
    }
    double *end = state_of(s, c);
    error[0] = error[1] = 0;
    for (int v = 0; v < nvar; v++) {
        double sum = 0;
        for (int i = v * s->cells; i < (v + 1) * s->cells; i++) {
            sum += fabs(end[i] - begin[i]) / s->cells;
            error[0] = larger(error[0], fabs(end[i] - begin[i]));
        }
        error[1] = larger(error[1], sum);
    }
    free(begin);
    free(rates);
    free(end);
}

/* An Euler step of the faster kind of diffusion is just stable with the inverse of this. */
static inline double fastest(struct scene *s, const struct comm *c) {
    double rate[2];
    s->gas->engine->diffusion.rates(s->gas, &s->gas->U, rate, NULL);
    comm_max(c, rate, 2);
    return larger(rate[0], rate[1]);
}

/* In the unit box; its cells grow along x if they are graded, and no wall but two lies along an axis if they `lean`. */
static inline void open_reshaped(struct scene *s, const struct comm *c, const struct cells_recipe *r, bool graded,
                                 double lean) {
    s->mesh = cells_make(r);
    s->dim = r->dim;
    for (int i = 0; i < 3 * s->mesh->npoints; i++) s->mesh->points[i] /= 0.1 * (i % 3 + 1) * r->n[i % 3];
    for (int i = 0; i < s->mesh->npoints; i++) {
        double *x = s->mesh->points + 3 * i;
        if (graded) x[0] *= 0.2 + 0.8 * x[0];
        x[0] += lean * x[1];
    }
    open_mesh(s, c);
    for (int i = 0; i < s->cells; i++)
        for (int k = s->dim; k < 3; k++) s->centre[3 * i + k] = 0;
}

static inline void open_cells(struct scene *s, const struct comm *c, const struct cells_recipe *r) {
    open_reshaped(s, c, r, false, 0);
}

/* T of a state of disks, in which T is eps */
static inline double temperature(const double *all, int dim, int cells, int i) {
    double square = 0;
    for (int k = 1; k <= dim; k++) square += all[k * cells + i] * all[k * cells + i];
    return (all[(dim + 1) * cells + i] - 0.5 * square / all[i]) / all[i];
}

/* ---- fields --------------------------------------------------------------------------------------------------------
 */

/* Rigid rotation at the rates `spin` about a point in the box; in less than three dimensions about the third axis. */
static double spin[3] = {0, 0, 3};
static inline void turning(const double x[3], double *rho, double u[3], double *T) {
    const double arm[3] = {x[0] - 0.3, x[1] - 0.4, x[2] - 0.6};
    *rho = 1 + x[0] * x[0] + 0.5 * x[1] + 0.3 * x[2];
    *T = 2;
    for (int k = 0; k < 3; k++) u[k] = spin[(k + 1) % 3] * arm[(k + 2) % 3] - spin[(k + 2) % 3] * arm[(k + 1) % 3];
}

/* The axis of a box of dim dimensions: none of the mesh's, if there are three. */
static inline void turn(int dim) {
    for (int k = 0; k < 3; k++) spin[k] = dim == 3 ? (const double[]){1.2, -2, 1.9}[k] : k == 2 ? 3 : 0;
}

/* An Euler step of the viscous part alone. */
static inline void shear(struct scene *s, double dt) {
    struct gas *g = s->gas;
    double rate[2];
    g->engine->diffusion.rates(g, &g->U, rate, NULL);
    g->engine->diffusion.begin(g, VISCOUS, &g->U, dt, 0);
    assert_true(g->engine->diffusion.end(g, VISCOUS, &g->U, &g->U, dt, dt) == 0);
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
