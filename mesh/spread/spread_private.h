/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of struct spread (a polyMesh that no rank holds as a whole): spread.c (reading, dealing),
 * spread_outline.c (what every rank knows). */
#ifndef MESH_SPREAD_PRIVATE_H
#define MESH_SPREAD_PRIVATE_H

#include "mesh/spread/slices.h"
#include "mesh/spread/spread.h"

/* Finds the CRC-32 of the arrays of the whole mesh (polymesh_checksum) from the slices. Collective. */
status outline_sum(const struct slices *s, unsigned long *out);
/* Fills the rest of the outline, and checks the mesh: *sound is false on all ranks where it has a defect. Collective.
 */
status outline_make(const struct spread *s, struct polymesh *m, bool *sound);

#endif
