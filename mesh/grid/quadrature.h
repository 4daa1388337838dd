/* Points and weights for means over the cells of any polyMesh: the cell in simplices, each with a symmetric rule of
 * positive weights, exact for polynomials of degree 5 (1D, 3D) or 4 (2D). */
#ifndef MESH_QUADRATURE_H
#define MESH_QUADRATURE_H

#include "mesh/format/polymesh.h"

struct quadrature {
    int most;       /* points of a cell */
    int most_faces; /* of a cell */
    const struct polymesh *mesh;
    const double *centre; /* [ncells][3] */
    int dim, axis[3];
    int *cell_start, *cell_face; /* [ncells + 1] */
    double *face_centre, *face_area;
    int *list; /* [most_faces] for the cell at hand */
};
/* mesh, centre (of the cells) and the axes (polymesh_axes) must outlive it. */
status quadrature_make(const struct polymesh *m, const double *centre, int dim, const int axis[3],
                       struct quadrature **out);
void quadrature_free(struct quadrature *q);

/* Points x (in the empty axes: the cell's centre) and weights, which sum to 1, of a cell; returns how many. */
int quadrature_cell(const struct quadrature *q, int cell, double (*x)[3], double *weight);

#endif
