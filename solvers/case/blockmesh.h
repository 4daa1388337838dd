/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mesh of a case: constant/polyMesh or, without one, system/blockMeshDict in OpenFOAM's own grammar, where it says
 * a union of boxes along the axes whose cells are all equal: vertices ((0 0 0) ..); blocks (hex (0 1 2 3 4 5 6 7) (60
 * 60 1) simpleGrading (1 1 1) ..); boundary (floor { type wall; faces ((0 1 5 4) ..); } ..); */
#ifndef SOLVERS_BLOCKMESH_H
#define SOLVERS_BLOCKMESH_H

#include "mesh/format/polymesh.h"
#include "solvers/dict/keywords.h"

enum { MESH_PATH = 4096 };
struct case_mesh {
    struct polymesh *mesh;
    struct spread *spread; /* NULL: each rank has the mesh */
    char path[MESH_PATH];  /* of the folder or file it was read from */
    bool older;            /* is that the polyMesh, and was system/blockMeshDict changed after it? */
};
/* Reads the mesh of the case in `dir`; a polyMesh is still to be checked (polymesh_check). Both being there, the
 * polyMesh counts, as in OpenFOAM. Local. */
status case_mesh_read(const char *dir, struct case_mesh *out);
/* The same; a polyMesh that is a lattice may have sites in place of arrays (polymesh.h), any other that several ranks
 * read may be spread over them; both are checked then. arrays: one rank keeps those that it reads. Collective. */
struct comm;
status case_mesh_spread(const char *dir, const struct comm *c, bool arrays, struct case_mesh *out);
void blockmesh_keywords(struct keywords *k); /* of system/blockMeshDict */

#endif
