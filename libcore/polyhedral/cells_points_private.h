/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Batches of face points, which the stages and the local steps on polyhedra share (cells_points.c). */
#ifndef LIBCORE_CELLS_POINTS_PRIVATE_H
#define LIBCORE_CELLS_POINTS_PRIVATE_H

#include "libcore/polyhedral/cells.h"

enum { STENCIL = 6, LEFT = 2, RIGHT = 3 }; /* of struct faces: m = -2 .. 3 */

struct points { /* a batch of points, or of states on both sides of faces; normal component first */
    int n;
    int face[BATCH];
    double axis[MAX_DIM][MAX_DIM][BATCH]; /* of the frames of the faces: the normal, then the tangents */
    double state[MAX_VAR][STENCIL][BATCH], flux[MAX_VAR][STENCIL][BATCH];
    double velocity[MAX_DIM][STENCIL][BATCH];
    double eps[STENCIL][BATCH], p[STENCIL][BATCH], c[STENCIL][BATCH], gruneisen[STENCIL][BATCH];
    bool ruled; /* does any face follow a rule of its own? Then rule says which. */
    unsigned char rule[BATCH];
    double floor[BATCH]; /* beside fronts */
    double pace[BATCH];  /* for fluxes that are paced */
    double out[MAX_VAR][BATCH];
};

struct point_states { /* one point of each of some faces, on one side of them */
    int point[BATCH];
    double weight[BATCH];
    double at[MAX_VAR][BATCH], velocity[MAX_DIM][BATCH], eps[BATCH], p[BATCH], c2[BATCH], gruneisen[BATCH];
};
struct point_means { /* over the points of faces, on one side of them */
    double state[MAX_VAR][BATCH], flux[MAX_VAR][BATCH], eps[BATCH], c2[BATCH], gruneisen[BATCH];
};

/* out[n] <- the values of a line at n places; cell[n] <- the cells on one side (left or right) of n faces */
void points_gather(int n, const int *index, const double *q, double *out);
void points_cells(int n, const int *face, const int *side, int *cell);
/* Finds the frames of the faces of p; turns states q[variables][BATCH] into them, or out of them. */
void points_frames(const struct polyhedra *m, struct points *p);
void points_into_frames(const struct gas *g, struct points *p, double (*q)[BATCH]);
void points_out_of_frames(const struct gas *g, struct points *p, double (*q)[BATCH]);
/* Lists point k of each of the faces first <= i < last, with its weight: of faces with fewer points the last one, with
 * weight 0. */
void points_list(const struct polyhedra *m, int first, int last, int k, struct point_states *s);
/* Adds the states `at` of listed points, their fluxes and primitives to the means; `first`: these begin with them. */
void points_add(const struct gas *g, const struct points *p, bool first, struct point_states *s,
                struct point_means *sum);
/* At the faces of packed cells the averages stand in for the polynomials, as in the tiles
 * (libcore/lattice/tiles_stage.c): rho of all cells, averages and states of a side. */
void points_flatten(const struct gas *g, const struct points *p, const double *rho, const double (*average)[BATCH],
                    double (*at)[BATCH]);
/* Does the patch of the faces of p make the states beyond of those at the points, and not of averages? */
bool points_reflect(const struct gas *g, const struct points *p);
/* The states that the rules of a patch make of the states `inner`, in the frames of the faces. At a reflecting wall
 * these are the own ones of the points, elsewhere averages, as what flows in must not come from what the cell
 * extrapolates to. */
void points_beyond(const struct gas *g, double (*inner)[BATCH], struct points *p);
/* Computes primitives and nodal fluxes of the states on both sides. Returns the batch of faces that a flux sees. */
struct faces points_primitives(const struct gas *g, struct points *p);
/* The same of the means over the points of faces, which it turns into the frames of the faces. */
struct faces points_of_means(const struct gas *g, struct point_means mean[2], struct points *p);
/* Gives the fluxes flux[nvar][n], per area and out of the gas, through faces of a patch the mass that it gives
 * (libcore/gas/patch.h). U: a state with its mirrors, g->size apart. */
void points_feed(const struct gas *g, int n, const int *face, const double *U, double (*flux)[BATCH]);
/* Gives the batch the floors of its faces. */
void points_floors(struct points *p, struct faces *faces);

#endif
