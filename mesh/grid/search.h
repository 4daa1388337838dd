/* Which cell of a polyMesh holds a point? Cells are star-shaped about their centres, faces are made of triangles about
 * the mean of their corners, so that cells leave no gaps between warped faces. */
#ifndef MESH_SEARCH_H
#define MESH_SEARCH_H

#include "mesh/format/polymesh.h"

struct search; /* the cells in buckets by place; mesh and centres are borrowed */
/* axis[dim]: the solved ones, which alone count. */
status search_make(const struct polymesh *m, const double *centre, int dim, const int axis[3], struct search **out);
void search_free(struct search *s);
/* Of cells that share the point (within a millionth of their size) the lowest; -1: outside. */
int search_cell(const struct search *s, const double point[3]);

#endif
