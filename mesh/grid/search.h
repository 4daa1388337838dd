/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the cell of a polyMesh that holds a point. Cells are star-shaped about their centres, faces are made of
 * triangles about the mean of their corners, so that cells leave no gaps between warped faces. */
#ifndef MESH_SEARCH_H
#define MESH_SEARCH_H

#include "mesh/format/polymesh.h"

struct search; /* the cells in buckets by place */
/* axis[dim] are the solved axes; positions along the others do not matter. m and centre[ncells][3] (m) are borrowed. */
status search_make(const struct polymesh *m, const double *centre, int dim, const int axis[3], struct search **out);
/* The same among some cells alone; among[ncells] is borrowed, too (NULL: all). */
status search_make_among(const struct polymesh *m, const double *centre, int dim, const int axis[3], const bool *among,
                         struct search **out);
void search_free(struct search *s);
/* Returns the cell that holds the point, the lowest of those that share it (within a millionth of their size), or -1
 * outside the mesh. */
int search_cell(const struct search *s, const double point[3]);

#endif
