/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a lattice that is one full box, for programs in C that have no mesh file. */
#ifndef MESH_BOX_H
#define MESH_BOX_H

#include "mesh/lattice/lattice.h"

struct box {
    struct lattice lattice;
    struct polymesh mesh;    /* counts and patches only; patch 2*axis + (0 low, 1 high) */
    struct patch patches[6]; /* the mesh's patches, so the struct box must not be copied */
};

/* Makes a box of n[k] cells along each of dim axes of the given length (m), with its lower corner at 0. Cell i + n0 (j
 * + n1 k) is at (i, j, k). A periodic axis has cyclic patches, which take no rules; the others have the type `wall`.
 * Fails if memory is missing, or if a number of cells is less than 1 or all are too many for an int. */
status box_make(struct box *b, int dim, const int n[3], const double length[3], const bool periodic[3]);
void box_free(struct box *b);

#endif
