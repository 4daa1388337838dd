/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rooms of hard grains: the facets and the cells that grains see of a sound polyMesh. */
#include "libcore/grains/facets.h"
#include "solvers/grains/grains_mesh.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void try_facet(const struct facet *f, int dim) {
    double size = 0, normal[3], near[3] = {0};
    for (int k = 0; k < dim; k++) size += f->normal[k] * f->normal[k];
    PROMISE(fabs(size - 1) < 1e-9, "a facet has a unit normal");
    for (int k = 0; k < dim; k++) {
        PROMISE(f->low[k] <= f->high[k], "a facet lies in its box");
        for (int j = 0; j < dim; j++) near[k] += f->corner[j][k] / dim;
    }
    const double length = fmax(f->high[0] - f->low[0], f->high[1] - f->low[1]) + fabs(near[0]) + fabs(near[1]) +
                          (dim > 2 ? f->high[2] - f->low[2] + fabs(near[2]) : 0);
    PROMISE(facet_distance(f, dim, near, normal) <= 1e-6 * length, "the middle of a facet lies on it");
}

static double square_to(const struct grains_mesh *m, long cell, int dim, const double x[3]) {
    double square = 0;
    for (int k = 0; k < dim; k++) square += (m->base.centre[cell][k] - x[k]) * (m->base.centre[cell][k] - x[k]);
    return square;
}

/* Beyond each side of the room, where no half spaces tell the cell, that with the nearest centre is found. */
static void try_outside(const struct grains_mesh *m, int dim) {
    for (int side = 0; side < 2 * dim && m->search; side++) {
        const int k = side / 2;
        double x[3] = {m->base.centre[0][0], m->base.centre[0][1], m->base.centre[0][2]};
        bool inside;
        if (m->periodic[k]) continue;
        x[k] = side % 2 ? 1.5 * m->high[k] - 0.5 * m->low[k] : 1.5 * m->low[k] - 0.5 * m->high[k];
        const long cell = m->base.locate(&m->base, x, &inside);
        PROMISE(!inside, "a place beyond the room is in no cell");
        for (long c = 0; c < m->base.cells; c++)
            PROMISE(square_to(m, cell, dim, x) <= square_to(m, c, dim, x) * (1 + 1e-9), "the nearest cell is found");
    }
}

static void try_room(const struct grains_mesh *m, int dim) {
    const struct facets *f = m->facets;
    for (long c = 0; c < m->base.cells; c++) {
        bool inside;
        const long cell = m->base.locate(&m->base, m->base.centre[c], &inside);
        PROMISE(cell >= 0 && cell < m->base.cells, "a place has a cell, or a nearest one");
        PROMISE(m->base.volume[c] > 0, "a cell has a volume");
    }
    try_outside(m, dim);
    if (!f) return;
    PROMISE(f->own > 0 && f->n >= f->own, "walls have facets");
    for (int i = 0; i < f->own; i++) {
        PROMISE(f->facet[i].wall >= 0 && f->facet[i].wall < m->setup->mesh->npatches, "a facet is part of a patch");
        try_facet(&f->facet[i], dim);
    }
}

static void try_grains(struct polymesh *mesh, const struct polymesh_geometry *g) {
    struct setup s = {.mesh = mesh, .centre = g->cell_centre, .volume = g->volume, .mesh_path = "polyMesh"};
    bool *open = calloc((size_t)mesh->npatches + 1, sizeof *open);
    double low[3], high[3];
    s.dim = polymesh_axes(mesh, s.axis);
    if (s.dim == 2) s.axis[2] = 3 - s.axis[0] - s.axis[1];
    polymesh_bounds(mesh, low, high);
    for (int k = 0; open && k < 2 && s.dim > 1; k++) { /* small grains, and some as large as the room */
        struct grains_mesh *m;
        open[0] = k;
        if (accepted(grains_mesh_make(&s, (k ? 1 : 1e-3) * (high[s.axis[0]] - low[s.axis[0]]), open, &m))) {
            try_room(m, s.dim);
            grains_mesh_free(m);
        }
    }
    free(open);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char dir[256];
    struct polymesh *m = NULL;
    scratch_unpack("polyMesh", "points", data, size);
    snprintf(dir, sizeof dir, "%s/polyMesh", scratch());
    if (accepted(polymesh_read(dir, &m))) {
        struct polymesh_geometry g = {.volume = NULL};
        if (accepted(polymesh_check_geometry(m, &g))) try_grains(m, &g);
        polymesh_geometry_free(&g);
        polymesh_free(m);
    }
    scratch_clear();
    return 0;
}
