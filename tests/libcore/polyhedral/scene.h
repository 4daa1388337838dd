/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A gas on a mesh of cells_make, from its start through whole steps to its state, for the tests of the polyhedra. */
#ifndef TESTS_SCENE_H
#define TESTS_SCENE_H

#include "libcore/gas/gas.h"
#include "tests/defaults.h"

#include "tests/mesh/polyhedral/cells.h" /* last: cmocka.h defines fail() */

static struct comm *world; /* of the test that includes this file */

struct scene {
    struct polymesh *mesh;
    struct grid *grid;
    struct gas *gas;
    struct gas_models models;
    struct patch_rules rules[6];
    double *centre, *volume, length[3];
    int cells, dim;
};

static inline void open_scene(struct scene *s, const struct cells_recipe *r, const char *eos, const char *flux,
                              const char *polynomial) {
    memset(s, 0, sizeof *s);
    s->models = (struct gas_models){
        .material = {.diameter = 0.1, .mass = 1, .restitution = 1, .gamma = 5. / 3, .alpha_max = 0.65},
        .eos = eos_find(eos),
        .flux = flux_find(flux),
        .flux_params = own_defaults(&flux_find(flux)->model),
        .polynomial = polynomial_find(polynomial),
        .stepper = stepper_find("SSPRK3"),
        .skip_uniform = true};
    for (int p = 0; p < 6; p++) {
        s->rules[p] = (struct patch_rules){.density = {.type = NULL}};
        s->rules[p].density.type = s->rules[p].temperature.type = boundary_find("zeroGradient");
        s->rules[p].velocity.type = boundary_find("slip");
    }
    s->mesh = cells_make(r);
    s->cells = s->mesh->ncells;
    s->dim = r->dim;
    for (int k = 0; k < 3; k++) s->length[k] = 0.1 * (k + 1) * r->n[k];
    double *face = calloc(6 * (size_t)s->mesh->nfaces, sizeof *face);
    s->centre = calloc(4 * (size_t)s->cells, sizeof *s->centre);
    s->volume = s->centre + 3 * s->cells;
    polymesh_face_geometry(s->mesh, face, face + 3 * s->mesh->nfaces);
    ok(polymesh_cell_geometry(s->mesh, face, face + 3 * s->mesh->nfaces, s->centre, s->volume));
    free(face);
    ok(grid_make(NULL, s->mesh, s->centre, world, s->models.polynomial->rings, s->models.stepper->local, &s->grid));
    ok(gas_make_polyhedral(s->grid, &s->models, 6, s->rules, &s->gas));
}

static inline void close_scene(struct scene *s) {
    gas_free(s->gas);
    grid_free(s->grid);
    polymesh_free(s->mesh);
    free(s->centre);
}

typedef void initial(const struct scene *s, const double x[3], double *rho, double u[3], double *T);

static inline void start(struct scene *s, initial *at) {
    int n = s->cells;
    double *all = malloc(5 * (size_t)n * sizeof *all), *u[3] = {all + n, all + 2 * n, all + 3 * n};
    for (int i = 0; i < n; i++) {
        double v[3] = {0, 0, 0};
        at(s, s->centre + 3 * i, &all[i], v, &all[4 * n + i]);
        for (int k = 0; k < 3; k++) u[k][i] = v[k];
    }
    ok(gas_set(s->gas, all, (const double *const *)u, all + 4 * n));
    free(all);
}

static inline double run(struct scene *s, int steps, double maxCo, double end) { /* from t = 0; returns the time */
    double t = 0;
    for (int i = 0; i < steps && t < end; i++) {
        struct gas_speed speed;
        gas_speed(s->gas, &speed);
        double dt = maxCo / speed.rate;
        if (t + dt > end) dt = end - t;
        ok(gas_step(s->gas, t, &dt, maxCo, 0, 1e-3, &speed));
        t += dt;
    }
    return t;
}

/* Root's conserved state, broadcast: [nvar][cells], caller frees. */
static inline double *state_of(const struct scene *s) {
    int nvar = gas_variables(s->gas);
    double *all = calloc((size_t)(nvar * s->cells), sizeof *all), *U[MAX_VAR];
    for (int v = 0; v < nvar; v++) U[v] = all + v * s->cells;
    ok(gas_get_conserved(s->gas, U));
    comm_broadcast(world, all, (long)sizeof *all * nvar * s->cells);
    return all;
}

#endif
