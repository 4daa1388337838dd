/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lattice is a mesh of equal axis-parallel boxes (holes allowed). It is recognised in the polyMesh, because the fast
 * engine needs one. */
#ifndef MESH_LATTICE_H
#define MESH_LATTICE_H

#include "mesh/format/polymesh.h"

struct lattice {
    int dim;          /* 1..3, number of axes that `empty` patches leave */
    int axis[3];      /* [dim] physical axis (0 x, 1 y, 2 z) of computational axis k, ascending */
    int n[3];         /* cells along computational axis k of the bounding box; 1 for k >= dim */
    double origin[3]; /* lower corner along computational axis k, m */
    double width[3];  /* cell size along computational axis k, m; for k >= dim the thickness of the mesh there */
    int *cell;        /* [n0*n1*n2], axis 0 fastest: polyMesh cell, or -1 in a hole */
    int *face;        /* [ncells][6] by polyMesh cell: face at side 2*k + (0 low, 1 high); -1 for k >= dim */
    double thickness; /* product of the mesh's extents along the empty axes, m^(3-dim): volume = product(width) */
    bool periodic[3]; /* axis k is wrapped by cyclic patches */
    bool uniform[3];  /* the forest shall hold one layer of cells along axis k, which stands for all. lattice_recognise
                         sets none; who sets it knows that all values are the same along k, and keeps them so */
};

/* Makes the lattice of a mesh. If the mesh is sound but no lattice, *out is NULL and why[] says the reason (e.g. "cell
 * 17 is no box"). Fails only on a mesh that no engine could run. Tolerance of coordinates: 1e-6 of a cell. */
status lattice_recognise(const struct polymesh *m, struct lattice **out, char why[256]);
void lattice_free(struct lattice *l);

/* Sets the centres [ncells][3] (m) of the cells along the solved axes from their places, so that a layer of cells has
 * one coordinate, to the bit, and expressions in it one value. */
void lattice_centres(const struct lattice *l, double *centre);

/* Can the lattice be uniform along axis k? It must be a periodic box without holes, and more than one cell long. */
bool lattice_may_be_uniform(const struct lattice *l, const struct polymesh *m, int k);

#endif
