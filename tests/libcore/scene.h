/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a gas on a lattice or on a polyhedral mesh, for tests of both engines. */
#ifndef TESTS_LIBCORE_SCENE_H
#define TESTS_LIBCORE_SCENE_H

#include "libcore/gas/gas.h"
#include "mesh/lattice/box.h"

#include "tests/mesh/polyhedral/cells.h" /* last: cmocka.h defines fail() */

struct scene { /* a gas on a lattice (box, forest) or on a polyhedral mesh (mesh, grid) */
    struct box box;
    struct forest *forest;
    struct polymesh *mesh;
    double *centre; /* [cells][3] m */
    struct grid *grid;
    struct gas *gas;
    struct gas_models models;
    struct patch_rules rules[6];
    int cells, dim;
};

static inline void set_walls(struct scene *s, const char *velocity) {
    for (int p = 0; p < 6; p++) {
        s->rules[p] = (struct patch_rules){.density = {.type = NULL}};
        s->rules[p].density.type = s->rules[p].temperature.type = boundary_find("zeroGradient");
        s->rules[p].velocity.type = boundary_find(velocity);
    }
}

/* Makes the gas on a box; the caller has set s->models and s->rules. */
static inline void open_box(struct scene *s, const struct comm *c, int dim, const int n[3], const double length[3],
                            const bool periodic[3], int tile) {
    const struct lattice *l = &s->box.lattice;
    ok(box_make(&s->box, dim, n, length, periodic));
    s->cells = s->box.mesh.ncells;
    s->dim = dim;
    s->centre = calloc(3 * (size_t)s->cells, sizeof *s->centre);
    for (int i = 0; i < s->cells; i++) {
        const int at[3] = {i % l->n[0], i / l->n[0] % l->n[1], i / l->n[0] / l->n[1]};
        for (int k = 0; k < dim; k++) s->centre[3 * i + k] = (at[k] + 0.5) * l->width[k];
    }
    ok(forest_make(l, &s->box.mesh, c, tile, &s->forest));
    ok(gas_make(s->forest, &s->models, 6, s->rules, &s->gas));
}

/* Makes the gas on a polyhedral mesh; the caller has set s->models, s->rules and s->mesh. */
static inline void open_mesh(struct scene *s, const struct comm *c) {
    s->cells = s->mesh->ncells;
    double *face = calloc(6 * (size_t)s->mesh->nfaces, sizeof *face), *volume;
    s->centre = calloc(4 * (size_t)s->cells, sizeof *s->centre);
    volume = s->centre + 3 * s->cells;
    polymesh_face_geometry(s->mesh, face, face + 3 * s->mesh->nfaces);
    ok(polymesh_cell_geometry(s->mesh, face, face + 3 * s->mesh->nfaces, s->centre, volume));
    free(face);
    ok(grid_make(NULL, s->mesh, s->centre, c, s->models.polynomial->rings, s->models.stepper->local, &s->grid));
    ok(gas_make_polyhedral(s->grid, &s->models, 6, s->rules, &s->gas));
}

static inline void open_polyhedra(struct scene *s, const struct comm *c, const struct cells_recipe *r) {
    s->mesh = cells_make(r);
    s->dim = r->dim;
    open_mesh(s, c);
}

static inline void close_scene(struct scene *s) {
    gas_free(s->gas);
    grid_free(s->grid);
    forest_free(s->forest);
    if (s->mesh) polymesh_free(s->mesh);
    if (s->forest) box_free(&s->box);
    free(s->centre);
}

/* Returns the root's conserved state, broadcast: [nvar][cells], which the caller frees. */
static inline double *state_of(const struct scene *s, const struct comm *c) {
    int nvar = gas_variables(s->gas);
    double *all = calloc((size_t)(nvar * s->cells), sizeof *all), *U[MAX_VAR];
    for (int v = 0; v < nvar; v++) U[v] = all + v * s->cells;
    ok(gas_get_conserved(s->gas, U));
    comm_broadcast(c, all, (long)sizeof *all * nvar * s->cells);
    return all;
}

static inline void run(struct scene *s, int steps, double courant) {
    double t = 0;
    for (int i = 0; i < steps; i++) {
        struct gas_speed speed;
        gas_speed(s->gas, &speed);
        double dt = courant / speed.rate;
        ok(gas_step(s->gas, t, &dt, courant, 0, 0, &speed));
        t += dt;
    }
}

#endif
