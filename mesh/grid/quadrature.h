/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Points and weights for means over the cells of any polyMesh: a cell is cut into simplices, each with a symmetric rule
 * of positive weights that is exact for polynomials of degree 5 (1D, 3D) or 4 (2D). */
#ifndef MESH_QUADRATURE_H
#define MESH_QUADRATURE_H

#include "mesh/format/polymesh.h"

struct quadrature {
    int most;       /* most points of a cell: the room that quadrature_cell needs */
    int most_faces; /* most faces of a cell */
    const struct polymesh *mesh;
    const double *centre; /* [ncells][3] m, borrowed */
    int dim, axis[3];
    int *cell_start, *cell_face; /* [ncells + 1], and the faces of the cells */
    double *face_centre, *face_area;
    int *list; /* [most_faces] scratch of quadrature_cell */
};
/* The mesh and the centres of its cells must outlive the quadrature. dim and axis come from polymesh_axes. */
status quadrature_make(const struct polymesh *m, const double *centre, int dim, const int axis[3],
                       struct quadrature **out);
void quadrature_free(struct quadrature *q);

/* Sets points x[] (m; the cell's centre along empty axes) and weights, which sum to 1, of a cell; returns how many. */
int quadrature_cell(const struct quadrature *q, int cell, double (*x)[3], double *weight);

#endif
