/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a lattice that is one full box by hand, for tests and benchmarks of the layers above the mesh. */
#ifndef TESTS_BOX_H
#define TESTS_BOX_H

#include "mesh/lattice/forest.h"

#include <stdlib.h>

struct box {
    struct lattice lattice;
    struct polymesh mesh;    /* counts and patches only; patch 2*axis + (0 low, 1 high) */
    struct patch patches[6]; /* the mesh's patches, so the struct box must not be copied */
};

/* Makes a box of n cells along each of dim axes of the given length (m); periodic axes have no patches. Cell i + n0 (j
 * + n1 k) is at (i, j, k). */
static inline void box_make(struct box *b, int dim, const int n[3], const double length[3], const bool periodic[3]) {
    static char wall[] = "wall", cyclic[] = "cyclic";
    *b = (struct box){.lattice = {.dim = dim, .axis = {0, 1, 2}, .thickness = 1}};
    struct lattice *l = &b->lattice;
    int cells = 1;
    for (int k = 0; k < 3; k++) {
        l->n[k] = k < dim ? n[k] : 1;
        l->width[k] = k < dim ? length[k] / n[k] : 1;
        l->periodic[k] = k < dim && periodic[k];
        cells *= l->n[k];
    }
    l->cell = malloc((size_t)cells * sizeof *l->cell);
    l->face = malloc(6 * (size_t)cells * sizeof *l->face);
    b->mesh = (struct polymesh){.ncells = cells, .npatches = 6, .patch = b->patches};
    for (int i = 0; i < cells; i++) l->cell[i] = i;
    for (int i = 0; i < 6 * cells; i++) l->face[i] = -1;
    int inner = cells * 3; /* there are at most so many internal faces; their numbers do not matter */
    b->mesh.nfaces = b->mesh.ninternal = inner;
    for (int side = 0; side < 6; side++) {
        struct patch *p = &b->patches[side];
        *p = (struct patch){.type = l->periodic[side / 2] ? cyclic : wall, .start = b->mesh.nfaces};
        int k = side / 2, edge = side % 2 ? l->n[k] - 1 : 0, stride = k == 0 ? 1 : k == 1 ? l->n[0] : l->n[0] * l->n[1];
        for (int i = 0; k < dim && i < cells; i++)
            if (i / stride % l->n[k] == edge) l->face[6 * i + side] = b->mesh.nfaces++;
        p->nfaces = b->mesh.nfaces - p->start;
    }
    for (int i = 0; i < cells; i++)
        for (int side = 0; side < 2 * dim; side++)
            if (l->face[6 * i + side] < 0) l->face[6 * i + side] = 0;
}

static inline void box_free(struct box *b) {
    free(b->lattice.cell);
    free(b->lattice.face);
}

#endif
