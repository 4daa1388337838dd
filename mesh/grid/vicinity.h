/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which cells lie around each point of a polyMesh, across cyclic patches, too; and what follows for values in cells:
 * gradients, values at the mesh's points, and values anywhere. All are exact for linear fields on any mesh, beside
 * walls as inside, and are the same for whoever computes them. */
#ifndef MESH_VICINITY_H
#define MESH_VICINITY_H

#include "mesh/base/pool.h"
#include "mesh/format/polymesh.h"

struct vicinity {
    struct pool pool;
    const struct polymesh *mesh;
    const double *centre; /* [ncells][3] m, borrowed */
    int dim, axis[3];
    int *cell_start, *face; /* [ncells + 1], faces of each cell */
    int *own_start, *point; /* [ncells + 1], points of each cell, each once */
    int *start, *cell;      /* [npoints + 1], cells around each point */
    /* [start[npoints]] and image of each: 0, or that beyond cyclic patches whose shift is to be added to its place */
    unsigned char *image;
    double (*shift)[3]; /* [images] m */
    bool *border;       /* [npoints] is the point on a patch that is neither cyclic nor empty? */
};
/* The mesh and the centres of its cells must outlive it. dim and axis come from polymesh_axes. Along other axes nothing
 * varies. */
status vicinity_make(const struct polymesh *m, const double *centre, int dim, const int axis[3], struct vicinity **out);
void vicinity_free(struct vicinity *v);

/* A field: value[stride cell] in all cells. Gradients and values at points are kept, once they are found, where there
 * is room for them. */
struct vicinity_field {
    const struct vicinity *v;
    const double *value; /* borrowed */
    int stride;
    double (*gradient)[3]; /* [ncells], first NAN: not found yet; NULL: gradients are not kept */
    double *at_point;      /* [npoints], as gradient */
};
/* Makes a field with room. A field of which few values are read needs none: {v, value, stride, NULL, NULL}. */
status vicinity_field_make(const struct vicinity *v, const double *value, int stride, struct vicinity_field *out);
void vicinity_field_free(struct vicinity_field *f);

/* The gradient is that of least squares over the cells that share a point with the cell, each weighted by the number of
 * points and the inverse square of its distance; 0 along empty axes and along those in which the cell has no
 * neighbours. */
void vicinity_gradient(const struct vicinity_field *f, int cell, double gradient[3]);
/* Returns the value at a point of the mesh: the mean of what the cells around it extrapolate. Where cells are on all
 * its sides, it is kept within their values, so that no jump makes new extremes. */
double vicinity_at_point(const struct vicinity_field *f, int point);
/* Marks the cells whose values vicinity_at_point needs. */
void vicinity_mark(const struct vicinity *v, int point, bool *wanted);

/* A cell is cut into simplices of its centre and, in 3D, the mean of a face with one of its edges (a face of three
 * points is taken whole), in 2D the edge that a face is, in 1D a face. Nodes are numbered through: points, cells'
 * centres, means of faces. vicinity_cut calls take with each simplex, dim + 1 nodes, of the cell; it stops at an
 * error. */
typedef status vicinity_taker(void *context, int cell, const long node[4]);
status vicinity_cut(const struct vicinity *v, int cell, vicinity_taker *take, void *context);
/* Sets x to the place of a node (m); along empty axes it is the place of the centre of `cell`. */
void vicinity_place(const struct vicinity *v, int cell, long node, double x[3]);
/* Returns the value at a node: of a cell's centre its value, of a face's mean that of its points' values. */
double vicinity_at_node(const struct vicinity_field *f, long node);
/* Marks the cells whose values vicinity_at_node needs. */
void vicinity_mark_node(const struct vicinity *v, long node, bool *wanted);
/* Sets node[] and weight[], which sum to 1, to the corners of the simplex of the cell that holds x, or is nearest to
 * holding it; a value at x is the sum of the corners' values with these weights. Returns the number of corners. */
int vicinity_locate(const struct vicinity *v, int cell, const double x[3], long node[4], double weight[4]);

#endif
