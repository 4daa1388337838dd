/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A polyMesh that no rank holds as a whole. Of its points and cells each rank has a slice, in the order of their
 * numbers: it reads it, checks it, and hands out of it what other ranks ask for. What every rank knows of such a mesh
 * is its outline (polymesh.h): counts, patches, faces on patches that are not empty. */
#ifndef MESH_SPREAD_H
#define MESH_SPREAD_H

#include "mesh/spread/part.h"

struct spread {
    const struct comm *comm;
    struct share cells, points;
    double *point;                     /* [points of the slice][3] m */
    struct mesh_part home;             /* the cells of the slice, which are whole there, and those beside them */
    int base;                          /* the number in `home` of the first cell of the slice; the others follow */
    struct polymesh_geometry geometry; /* of home; of cells that are not whole it has centres alone */
    int *cell_start, *cell_face;       /* polymesh_cell_faces of home */
};

/* Reads and checks the polyMesh in a folder (polymesh_read, polymesh_check). Where a lattice is looked for, one makes a
 * mesh with sites (polymesh.h), *out is NULL then, and one rank leaves a mesh that is none to polymesh_read; `arrays`:
 * one rank keeps the arrays of such a mesh, since they will be read. *mesh is NULL if the mesh is not sound, or not as
 * writers put it: the error then comes from the reader of the whole mesh. Errors are those of the file `boundary`, and
 * those of lists that labels of 32 bits cannot count. Collective. */
status spread_read(const char *dir, const struct comm *c, bool lattice, bool arrays, struct spread **out,
                   struct polymesh **mesh);
void spread_free(struct spread *s);
void spread_trim(struct spread *s); /* frees all but the volumes of the cells: no part is fetched any more */

/* Centre (m) and volume (m^3) of a cell of this rank's slice. */
void spread_centre(const struct spread *s, long cell, double x[3]);
double spread_volume(const struct spread *s, long cell);

/* Fetches the part of n cells (ascending), which are whole in it. Collective. */
status spread_part(const struct spread *s, const struct polymesh *all, long n, const int *cell, struct mesh_part *out);

#endif
