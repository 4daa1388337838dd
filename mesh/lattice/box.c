/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a lattice that is one full box (box.h) by numbering its cells and faces. */
#include "mesh/lattice/box.h"

#include <limits.h>
#include <stdlib.h>

/* Sets the axes of the lattice; returns its number of cells, or 0 if there is no such box. */
static int set_axes(struct lattice *l, const int n[3], const double length[3], const bool periodic[3]) {
    long cells = 1;
    for (int k = 0; k < 3; k++) {
        l->n[k] = k < l->dim ? n[k] : 1;
        l->width[k] = k < l->dim ? length[k] / n[k] : 1;
        l->periodic[k] = k < l->dim && periodic[k];
        cells = l->n[k] > 0 && cells <= INT_MAX / 9 / l->n[k] ? cells * l->n[k] : 0;
    }
    return (int)cells;
}

/* Numbers the faces of side 2 k + (0 low, 1 high) that lie on its patch. */
static void set_patch(struct box *b, int side) {
    static char wall[] = "wall", cyclic[] = "cyclic";
    const struct lattice *l = &b->lattice;
    const int k = side / 2, edge = side % 2 ? l->n[k] - 1 : 0,
              stride = k == 0   ? 1
                       : k == 1 ? l->n[0]
                                : l->n[0] * l->n[1];
    struct patch *p = &b->patches[side];
    *p = (struct patch){.type = l->periodic[k] ? cyclic : wall, .start = b->mesh.nfaces};
    for (int i = 0; i < b->mesh.ncells; i++)
        if (i / stride % l->n[k] == edge) l->face[6L * i + side] = b->mesh.nfaces++;
    p->nfaces = b->mesh.nfaces - p->start;
}

status box_make(struct box *b, int dim, const int n[3], const double length[3], const bool periodic[3]) {
    *b = (struct box){.lattice = {.dim = dim, .axis = {0, 1, 2}, .thickness = 1}};
    struct lattice *l = &b->lattice;
    const int cells = set_axes(l, n, length, periodic);
    if (!cells) return fail(ERR_INPUT, "a box of %d x %d x %d cells: from 1 to 2e8 in all", l->n[0], l->n[1], l->n[2]);
    TRY(allocate(&l->cell, cells, sizeof *l->cell, "cells of a box"));
    status s = allocate(&l->face, 6L * cells, sizeof *l->face, "faces of a box");
    if (s) {
        box_free(b);
        return s;
    }
    /* An upper bound of the number of faces inside; their numbers do not matter. */
    const int inside = 3 * cells;
    b->mesh = (struct polymesh){
        .ncells = cells, .nfaces = inside, .ninternal = inside, .npatches = 2 * dim, .patch = b->patches};
    for (int i = 0; i < cells; i++) l->cell[i] = i;
    for (long i = 0; i < 6L * cells; i++) l->face[i] = i % 6 < 2 * dim ? 0 : -1;
    for (int side = 0; side < 2 * dim; side++) set_patch(b, side);
    return OK;
}

void box_free(struct box *b) {
    free(b->lattice.cell);
    free(b->lattice.face);
    b->lattice.cell = b->lattice.face = NULL;
}
