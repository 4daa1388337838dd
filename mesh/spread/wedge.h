/* SPDX-License-Identifier: GPL-3.0-or-later */
/* OpenFOAM's meshes of bodies of revolution: one layer of cells between two planes through the axis, the patches of
 * type `wedge`. They become the plane mesh of (axial, radial) cells that struct revolution (polymesh.h) knows, cell by
 * cell: fields keep their order, so that what is written belongs to the files of the wedge. */
#ifndef MESH_WEDGE_H
#define MESH_WEDGE_H

#include "mesh/format/polymesh.h"

bool wedge_has(const struct polymesh *m); /* has the mesh a patch of type wedge? */
/* Turns such a mesh, which has its arrays, into a plane one: the planes, at an angle about the axis, become parallel,
 * `empty`, and as far from each other as at the greatest radius. Where cells have an edge on the axis it becomes a face
 * of a patch of type symmetryPlane at the end, `axis`; a patch of that name without faces makes room for it. Fails,
 * with the file of the patches, on wedges that are not two planes, equally far on both sides of a coordinate plane,
 * through an axis along x, y or z, and on cells that do not lie between both. A mesh without wedges stays as it is. */
status wedge_flatten(struct polymesh *m, const char *dir);

#endif
