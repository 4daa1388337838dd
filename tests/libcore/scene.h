/* A gas on a lattice or on a polyMesh, with walls that slip, for tests of both mesh engines. */
#ifndef TESTS_LIBCORE_SCENE_H
#define TESTS_LIBCORE_SCENE_H

#include "libcore/gas.h"
#include "tests/box.h"

#include "tests/mesh/cells.h" /* last: cmocka.h defines fail() */

struct scene { /* on a lattice, or on a polyMesh */
    struct box box;
    struct forest *forest;
    struct polymesh *mesh;
    double *centre;
    struct grid *grid;
    struct gas *gas;
    struct gas_models models;
    struct patch_rules rules[6];
    int cells, dim;
};

static void set_walls(struct scene *s) {
    for (int p = 0; p < 6; p++) {
        s->rules[p].density.type = s->rules[p].temperature.type = boundary_find("zeroGradient");
        s->rules[p].velocity.type = boundary_find("slip");
    }
}

static void open_polyhedra(struct scene *s, const struct comm *c, const struct cells_recipe *r) {
    s->mesh = cells_make(r);
    s->cells = s->mesh->ncells;
    s->dim = r->dim;
    double *face = calloc(6 * (size_t)s->mesh->nfaces, sizeof *face), *volume;
    s->centre = calloc(4 * (size_t)s->cells, sizeof *s->centre);
    volume = s->centre + 3 * s->cells;
    polymesh_face_geometry(s->mesh, face, face + 3 * s->mesh->nfaces);
    polymesh_cell_geometry(s->mesh, face, face + 3 * s->mesh->nfaces, s->centre, volume);
    free(face);
    ok(grid_make(NULL, s->mesh, s->centre, volume, c, s->models.polynomial->rings, &s->grid));
    ok(gas_make_mosaic(s->grid, &s->models, 6, s->rules, &s->gas));
}

static void close_scene(struct scene *s) {
    gas_free(s->gas);
    grid_free(s->grid);
    forest_free(s->forest);
    if (s->mesh) polymesh_free(s->mesh);
    if (s->forest) box_free(&s->box);
    free(s->centre);
}

#endif
