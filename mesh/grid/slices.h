/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Surfaces through a polyMesh, as polygons: what a plane cuts out of its cells, and where a field has a value. Their
 * corners lie on lines between nodes (vicinity.h), those on one line are one corner, so that surfaces have no gaps. */
#ifndef MESH_SLICES_H
#define MESH_SLICES_H

#include "mesh/grid/vicinity.h"

struct slice_corner { /* at (1 - share) a + share b, where a < b; at a where share = 0 */
    long a, b;        /* nodes */
    double share;
};
struct slice { /* {0} is an empty one */
    int ncorners, npolygons;
    struct slice_corner *corner; /* [ncorners] */
    double (*x)[3];              /* [ncorners] m */
    int *start;                  /* [npolygons + 1] into around */
    int *around;                 /* corners of each polygon, right-handed about its normal */
    int *cell;                   /* [npolygons] the cell that it lies in */
    int corner_room, start_room, around_room, cell_room, x_room;
};
void slice_free(struct slice *s);

/* Adds what the plane through a point cuts out of the cells: one polygon for a convex cell, its normal that of the
 * plane. A plane along faces has the cells on its lower side. */
status slice_plane(const struct vicinity *v, const double point[3], const double normal[3], struct slice *out);
/* Adds where the field, linear in the simplices of the cells, has a value; normals point to lower values. Where an axis
 * is empty, the surface goes from one end of the mesh to the other along it. */
status slice_level(const struct vicinity_field *f, double level, struct slice *out);
/* Returns a field's value at a corner. */
double slice_value(const struct vicinity_field *f, const struct slice_corner *c);

/* The distance of the points from a plane of unit normal, malloc'd; 0 where it is below 1e-10 of the mesh's size. */
status slice_distances(const struct polymesh *m, const double point[3], const double normal[3], double **out);
struct slice_segment {  /* in which a plane crosses a face: between edges given by their ends */
    int down[2], up[2]; /* down: from a point on the plane or above to one below; up: back */
};
/* Finds the next segment of a face from place *at of its outline on, 0 at first; going around the face, its inner side
 * lies below the plane. Returns false behind the last one. */
bool slice_face(const struct polymesh *m, const double *distance, int face, int *at, struct slice_segment *out);

#endif
