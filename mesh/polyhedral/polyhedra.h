/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A polyhedral mesh as one rank sees it, made ready for finite volumes: cells with centres, moments and stencils, faces
 * with quadrature points, the halo. Any polyMesh in 1D to 3D will do; where a mesh has `empty` patches only the solved
 * axes are kept, and volumes and areas are per thickness. All vectors are in computational axes (axis[]).
 *
 * Numbering on a rank: cells 0 <= i < nown are mine, breadth first from the end of their longest axis, whatever the
 * order of the polyMesh, so that cells that share a face stand near each other; those from ninner on read values of
 * other ranks in a stage. Then come ghosts, cells of other ranks: first those across my faces (< nnear), whose
 * polynomials this rank computes, too, then those that only stencils read (< ncells). Then come mirror cells (< size),
 * whose values the boundary conditions give: one per boundary face of my cells, then one per boundary face of near
 * ghosts, whose stencils need them. A rank may have no cells. Lists within a cell or face are in an order that does
 * not depend on the ranks, so the results do not either. Arrays of components are [component][size or so], each
 * component in one line. */
#ifndef MESH_POLYHEDRA_H
#define MESH_POLYHEDRA_H

#include "mesh/base/comm.h"
#include "mesh/base/pool.h"
#include "mesh/format/polymesh.h"

enum {
    POLYHEDRA_MOMENTS = 6,
    POLYHEDRA_VARIABLES = 8 /* most variables of one fill */
};

struct polyhedra_faces { /* internal and cut faces first, then boundary faces: patch by patch, mirrors in the same order
                          */
    int n, ninternal;
    int nlocal; /* faces between two inner cells, which come first, in the order of the higher one of the two: they can
                 * be computed before polyhedra_fill_finish, and cell by cell */
    int *left, *right;     /* [n] cells of this rank; right: a mirror at the boundary */
    int *patch, *place;    /* [n - ninternal] patch of the polyMesh and face within it; the mirrors' arrays, borrowed */
    double *area;          /* [n] m^(dim-1) */
    double *normal[3];     /* [dim][n] unit, from left to right; area times normal sums to zero over a cell's faces */
    double *tangent[2][3]; /* [dim - 1][dim][n] make with the normal an orthonormal, right-handed frame */
    double *shift[3];      /* [dim][n] m, to be added to positions in the right cell (cyclic patches), else 0 */
    int *point_start;      /* [n + 1] into the arrays of struct polyhedra_points */
};
/* Quadrature points on faces: one at the centre (order 1), or a rule exact for quadratic functions (order 3). */
struct polyhedra_points {
    int n;
    int *face;         /* [n] */
    double *weight;    /* [n] sum to 1 over a face */
    double *arm[2][3]; /* [left or right][dim][n] from the centre of the cell on that side, m */
};
/* The points on those faces of near ghosts that are not among the faces of this rank: with them a rank has all points
 * of each cell whose polynomial it computes. */
struct polyhedra_rims {
    int *start;     /* [nnear - nown + 1] */
    double *arm[3]; /* [dim][start[nnear - nown]] from the centre of the ghost, m */
};
/* Mirror i is cell ncells + i; the first face.n - face.ninternal mirrors belong to faces of my cells. */
struct polyhedra_mirrors {
    int n;
    int *cell;             /* [n] the cell inside: mine, then near ghosts */
    int *patch, *place;    /* [n] */
    double *normal[3];     /* [dim][n] unit, out of the cell; the frame is the face's */
    double *tangent[2][3]; /* [dim - 1][dim][n] */
};
#define NO_RADIUS 1e-100 /* m: a smaller one is that of a face on the axis */
/* Of a body of revolution (struct revolution of mesh/format/polymesh.h). Averages over cells and faces are weighted by
 * the radius r, exactly: volumes are the integrals of r over the cells in the plane, areas those over the faces,
 * centres, moments and points of faces those of that weight; `thickness` is that of a full turn. A face on the axis has
 * an area so small that it counts nothing, and a normal. */
struct polyhedra_round {
    int radial;     /* computational axis along the radius */
    double at;      /* m: where the axis lies along it */
    double *radius; /* [size] m: mean radius, the volume over that of the cell in the plane */
    double *reach;  /* [faces] m: mean radius of the face, the area over that in the plane */
    double *rim;    /* [mirrors] m: that of the faces before mirrors */
    double *lag[3]; /* [dim][nown] m: from the centre to that of the cell in the plane */
};
struct polyhedra {
    int dim, axis[3];
    double thickness; /* product of the extents of the empty axes, m^(3-dim) */
    int ncells_all;
    int ninner, nown, nnear, ncells, size;
    int *cell;                         /* [ncells] polyMesh cell; mirrors have none */
    double (*middle)[3], *extent;      /* [nown] m along x, y, z; m^3: centre and volume by polymesh_cell_geometry */
    double *volume;                    /* [size] m^dim */
    struct polyhedra_round round;      /* radial -1: the mesh is not round */
    double *centre[3];                 /* [dim][size] m; a ghost across a cyclic patch has its own place */
    double *moment[POLYHEDRA_MOMENTS]; /* [dim (dim+1)/2][size] mean of (x-c)_a (x-c)_b, a <= b: xx xy yy or xx xy xz yy
                                          .. */
    /* [nown + 1] into face_of_cell: the cell's faces, ~face where the cell is on the right, in global order */
    int *face_start, *face_of_cell;
    struct polyhedra_faces face;
    struct polyhedra_points point;
    struct polyhedra_rims rim;
    /* a mirror's centre, volume, moments are the cell's, reflected in the plane of the face */
    struct polyhedra_mirrors mirror;

    /* Stencils of cells < nnear. Members stand in this order: first the cells across the cell's faces, in the order of
     * its faces (mirrors count; a cell that shares two faces stands once), then ring by ring, each ring by polyMesh
     * number (mirrors only in the first ring). In a short periodic domain a cell may be a member twice, at different
     * offsets. An offset points from the cell's centre to the member's and includes cyclic shifts; a member's moments
     * are those of cell stencil[]. */
    int *stencil_start; /* [nnear + 1] */
    int *stencil;
    double *offset[3]; /* [dim][stencil_start[nnear]] */
    int *ring;         /* [stencil_start[nnear]] 1, 2, .. */
    /* Corners of cells < nnear: which of the cell's first-ring members share each vertex (dim members, seldom more). */
    int *corner_start;  /* [nnear + 1] into corner_first */
    int *corner_first;  /* [corners + 1] into corner_member */
    int *corner_member; /* index into the cell's stencil */

    /* Blocks: a space-filling curve is cut into blocks of about 500 cells, the same for any number of ranks; METIS
     * deals them. */
    int nblocks, nblocks_all;
    int *block_id;    /* [nblocks] */
    int *block_start; /* [nblocks + 1] into block_cell */
    int *block_cell;  /* [nown] my cells, block by block */

    const struct comm *comm;
    struct pool pool;                 /* has all lists but those of the corners */
    struct polyhedra_private *hidden; /* the plan of the ghost exchange */
};

/* Makes the polyhedra of mesh m, which every rank holds, with stencils of 1 or 2 rings. A stencil grows by further
 * rings until it has 2 (rings 1) or 1.5 (rings 2) times as many members as a polynomial of degree `rings` has
 * coefficients (without the constant), or the mesh ends. Quadrature is of order 1 for rings 1, 3 for rings 2. Refuses
 * (ERR_INPUT, with cell or face and place) a mesh that finite volumes cannot use. Collective. */
status polyhedra_make(const struct polymesh *m, const struct comm *c, int rings, struct polyhedra **out);
/* Makes the same with the cells from the largest to the smallest, inner ones first, for local time steps: cells of
 * about one size stand in the order of above. Collective. */
status polyhedra_make_sized(const struct polymesh *m, const struct comm *c, int rings, struct polyhedra **out);
/* Makes the same of a mesh that is spread over the ranks; m is its outline. *part gets the cells of this rank and those
 * around them that stencils take; the caller frees it, also after an error. sized: as polyhedra_make_sized.
 * Collective. */
struct spread;
struct mesh_part;
status polyhedra_make_spread(const struct polymesh *m, const struct spread *spread, int rings, bool sized,
                             struct mesh_part *part, struct polyhedra **out);
void polyhedra_free(struct polyhedra *m);
/* The arm of the angular momentum of an own cell of a body of revolution, m: the integral of r^3 over that of r^2. */
double polyhedra_arm(const struct polyhedra *m, int cell);
/* Tells all ranks the centre (middle[]) of a cell of the polyMesh; HUGE_VAL if there is no such cell. Collective. */
void polyhedra_place(const struct polyhedra *m, long cell, double place[3]);

/* Fill the ghosts (not the mirrors) of nvar <= POLYHEDRA_VARIABLES lines data[v][size] from other ranks.
 * polyhedra_fill_start sends, polyhedra_fill_finish waits and receives; the cells must not change in between, but other
 * work there hides the time. */
void polyhedra_fill_start(struct polyhedra *m, int nvar, double *const *data);
void polyhedra_fill_finish(struct polyhedra *m);
void polyhedra_fill_int(struct polyhedra *m, int *data); /* one variable of ints, data[ncells] */

#endif
