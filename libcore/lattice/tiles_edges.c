/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sides of the cells of a lattice, and the faces of patches: these are numbered tile by tile and side by side, the
 * lower axis along a side fastest. Lines over faces have a line for each axis; a face stands where the cell above it
 * does. The sides of a cell are numbered as those of a tile. */
#include "libcore/lattice/tiles.h"

status tiles_edges_make(struct gas *g) {
    const struct forest *f = g->forest;
    int faces = 0;
    TRY(allocate(&g->tiles->edge, 6L * f->ntiles, sizeof *g->tiles->edge, "the faces of patches"));
    for (int i = 0; i < 6 * f->ntiles; i++) {
        const struct tile *tile = &f->tile[i / 6];
        const int axis = i % 6 / 2;
        g->tiles->edge[i] = -1;
        if (axis >= g->dim || tile->side[i % 6].patch < 0) continue;
        g->tiles->edge[i] = faces;
        faces += tile->n[0] * tile->n[1] * tile->n[2] / tile->n[axis];
    }
    return OK;
}

bool tiles_sides(const struct gas *g, const struct row *row, int k, struct sides *out) {
    const struct forest *f = g->forest;
    const struct tile *t = &f->tile[row->block];
    const int axis = k / 2, high = k % 2;
    if (axis >= g->dim) return false;
    const int across = (int)row->at + (int)(high ? f->stride[axis] : -f->stride[axis]);
    const int face = (int)(axis * f->size + row->at + (high ? f->stride[axis] : 0));
    out->line = true;
    for (int i = 0; i < row->n; i++) {
        out->across[i] = across + i;
        out->face[i] = high ? face + i : ~(face + i);
        out->edge[i] = -1;
    }
    if (t->side[k].patch < 0) return true;
    const int place = forest_place_along(f, row->block, row->at, axis) - t->low[axis];
    const int wanted = (high ? t->n[axis] - 1 : 0) - place; /* cells of the row that lie at the side */
    for (int i = 0; i < row->n; i++) {
        if ((axis == 0 ? i : 0) != wanted) continue;
        const int at = face_at_side(f, row->block, k, row->at + i);
        out->edge[i] = g->tiles->edge[6 * row->block + k] + at;
        out->patch[i] = (struct patch_face){t->side[k].patch, t->side[k].face[at]};
    }
    return true;
}

/* Visits the faces that a block has at one side of its tile. */
static void visit_side(const struct gas *g, const struct forest_block *b, int side, edge_face_visitor *visit,
                       void *context) {
    const struct forest *f = g->forest;
    const struct tile *t = &f->tile[b->tile];
    const int axis = side / 2, across = side < 2 ? 1 : 0, deep = side < 4 ? 2 : 1;
    const int first = g->tiles->edge[6 * b->tile + side];
    struct gas_face face = {.patch = t->side[side].patch, .area = f->volume / f->width[axis]};
    if (f->radial == axis) face.area *= forest_radius(f, b->low[axis] + (side % 2 ? b->n[axis] : 0));
    const double area = face.area;
    face.normal[axis] = side % 2 ? 1 : -1;
    face.centre[axis] = f->origin[axis] + (b->low[axis] + (side % 2 ? b->n[axis] : 0)) * f->width[axis];
    for (int k = 0; k < b->n[deep]; k++)
        for (int j = 0; j < b->n[across]; j++) {
            const int at[2] = {f->step[across] ? j : 0, f->step[deep] ? k : 0};
            if (across < f->dim)
                face.centre[across] = f->origin[across] + (b->low[across] + j + 0.5) * f->width[across];
            if (deep < f->dim) face.centre[deep] = f->origin[deep] + (b->low[deep] + k + 0.5) * f->width[deep];
            if (f->radial >= 0 && f->radial == across) face.area = area * forest_radius(f, b->low[across] + j + 0.5);
            visit(context, first + at[1] * t->n[across] + at[0], face.area, &face);
        }
}

void tiles_edges(const struct gas *g, int block, edge_face_visitor *visit, void *context) {
    const struct forest_block *b = &g->forest->block[block];
    for (int side = 0; side < 2 * g->dim; side++)
        if (g->tiles->edge[6 * b->tile + side] >= 0) visit_side(g, b, side, visit, context);
}
