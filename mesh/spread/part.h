/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A part of a polyMesh: some of its cells with all their faces. It is a polyMesh itself, whose cells, faces and points
 * are numbered in the order of their numbers in the whole mesh, so that what is computed of a cell from its faces in
 * their order has the same bits. A face of a cyclic patch is never without its other half. */
#ifndef MESH_PART_H
#define MESH_PART_H

#include "mesh/base/share.h"
#include "mesh/format/polymesh.h"

struct mesh_part {
    struct polymesh mesh;     /* names of patches are borrowed */
    int *cell, *face, *point; /* numbers in the whole mesh, ascending */
    bool *whole; /* [cells] are all faces of the cell here? The others are only beyond faces of such cells */
};
/* A face on its way is: number, owner, neighbour (-1: none), number of corners, corners; by numbers in the whole
 * mesh. */
enum { RECORD = 4 };

/* Makes a part of faces, which come in any order and may come again, without places of points and without cells that
 * are whole. */
status part_of_faces(const struct polymesh *all, long ints, const int *records, struct mesh_part *out);
/* Fetches the places of the points from the slices of the ranks. Collective. */
status part_places(struct mesh_part *p, const struct share *points, const double *slice);
long part_cell(const struct mesh_part *p, int cell); /* the number here of a cell of the whole mesh, or -1 */
void part_free(struct mesh_part *p);

#endif
