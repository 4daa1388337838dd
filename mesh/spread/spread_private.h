/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of struct spread (a polyMesh that no rank holds as a whole): spread.c (reading, dealing),
 * spread_outline.c (what every rank knows). */
#ifndef MESH_SPREAD_PRIVATE_H
#define MESH_SPREAD_PRIVATE_H

#include "mesh/spread/lists.h"
#include "mesh/spread/spread.h"

/* Finds the CRC-32 of the arrays of the whole mesh (polymesh_checksum) from the slices. Collective. */
status outline_sum(const struct lists *s, unsigned long *out);
/* Finds the box around all points. Collective. */
void outline_box(const struct lists *s, struct outline *o);
/* Numbers of a face on a patch on its way: patch, number in it, cell; of a lattice also the cell's place, the side, the
 * turn (sites.h); from WALL_CENTRE on centre and area. */
enum { WALL_CENTRE = 6, WALL = 12 };
/* Gives each rank the n faces on patches of each, which are not empty. all: the faces of all ranks, in their order,
 * which the caller frees. Collective. */
status outline_walls(const struct comm *c, struct polymesh *m, const double *mine, long n, double **all, long *nall);
/* Finds out whether the mesh is a lattice with sound patches, of which it then knows the sites and all of the outline
 * but the sum. Collective. */
status sites_find(const struct lists *s, struct polymesh *m, bool *found);
/* Fills the rest of the outline, and checks the mesh: *sound is false on all ranks where it has a defect. Collective.
 */
status outline_make(const struct spread *s, struct polymesh *m, bool *sound);

#endif
