/* A polyhedral mesh made ready for finite volumes: cells with centres, moments and stencils, faces with quadrature
 * points, the halo. Any polyMesh in 1D to 3D; of a mesh with `empty` patches only the solved axes are kept, volumes and
 * areas are then per thickness. All vectors are in computational axes (axis[]).
 *
 * Numbering on a rank: cells 0 <= i < nown are mine, those from ninner on read values of other ranks in a stage; then
 * ghosts, cells of other ranks: first those across my faces (< nnear), whose polynomials this rank computes, too, then
 * those that only stencils read (< ncells); then mirror cells (< size), whose values the boundary conditions give: one
 * per boundary face of my cells, then one per boundary face of near ghosts, whose stencils need them. A rank may have
 * no cells. Lists within a cell or face are in an order that does not depend on the ranks, so the results do not
 * either. Arrays of components are [component][size or so], each component in one line. */
#ifndef MESH_POLYHEDRA_H
#define MESH_POLYHEDRA_H

#include "mesh/base/comm.h"
#include "mesh/format/polymesh.h"

enum {
    POLYHEDRA_MOMENTS = 6,
    POLYHEDRA_VARIABLES = 8 /* at most, in one fill */
};

struct polyhedra_faces { /* internal and cut faces first, then boundary faces: patch by patch, mirrors in the same order
                          */
    int n, ninternal;
    int nlocal; /* internal ones whose two cells are inner cells come first: they can be computed before finish */
    int *left, *right;     /* [n] cells of this rank; right: a mirror at the boundary */
    int *patch, *place;    /* [n - ninternal] of the polyMesh, and the face within the patch: those of the mirrors */
    double *area;          /* [n] m^(dim-1) */
    double *normal[3];     /* [dim][n] unit, from left to right, one a face: areas times normals close every cell */
    double *tangent[2][3]; /* [dim - 1][dim][n] with the normal an orthonormal, right-handed frame */
    double *shift[3];      /* [dim][n] to be added to positions of the right cell (cyclic patches), else 0 */
    int *point_start;      /* [n + 1] quadrature points; those of one order are below */
};
struct polyhedra_points { /* on faces; order 1: one at the centre; order 3: exact for quadratic functions */
    int n;
    int *face;         /* [n] */
    double *weight;    /* [n] sums to 1 over a face */
    double *arm[2][3]; /* [left or right][dim][n] from the centre of the cell on that side, m */
};
struct polyhedra_mirrors { /* mirror i is cell ncells + i; the first face.n - face.ninternal are those of my faces */
    int n;
    int *cell;             /* [n] the cell inside: mine, then near ghosts */
    int *patch, *place;    /* [n] */
    double *normal[3];     /* [dim][n] unit, out of the cell; the frame is the face's */
    double *tangent[2][3]; /* [dim - 1][dim][n] */
};
struct polyhedra {
    int dim, axis[3];
    double thickness; /* product of the extents of the empty axes */
    int ncells_all;
    int ninner, nown, nnear, ncells, size;
    int *cell;                         /* [ncells] polyMesh cell; mirrors have none */
    double *volume;                    /* [size] m^dim */
    double *centre[3];                 /* [dim][size] m; of ghosts across a cyclic patch: their own place */
    double *moment[POLYHEDRA_MOMENTS]; /* [dim (dim+1)/2][size] mean of (x-c)_a (x-c)_b, a <= b: xx xy yy or xx xy xz yy
                                          .. */
    int *face_start, *face_of_cell;    /* [nown + 1], -> faces; ~face where the cell is on the right; global order */
    struct polyhedra_faces face;
    struct polyhedra_points point;
    struct polyhedra_mirrors mirror; /* centre, volume, moments: the cell's, reflected in the plane of the face */

    /* Stencils of cells < nnear: first the cells across its faces in the order of its faces (mirrors count; a cell that
     * shares two faces once), then ring by ring, each ring by polyMesh number (mirrors only in the first ring). In a
     * short periodic domain a cell may be a member twice, at different offsets. offset: from the cell's centre to the
     * member's, cyclic shifts taken in; moments of a member are those of the cell `stencil` says. */
    int *stencil_start; /* [nnear + 1] */
    int *stencil;
    double *offset[3]; /* [dim][stencil_start[nnear]] */
    int *ring;         /* [stencil_start[nnear]] 1, 2, .. */
    /* Corners of cells < nnear: which of its first-ring members share each vertex (dim of them, seldom more). */
    int *corner_start;  /* [nnear + 1] into corner_first */
    int *corner_first;  /* [corners + 1] into corner_member */
    int *corner_member; /* index into the cell's stencil */

    /* Blocks: METIS cuts the mesh into blocks of about 500 cells, then the graph of blocks into ranks. */
    int nblocks, nblocks_all;
    int *block_id;    /* [nblocks] */
    int *block_start; /* [nblocks + 1] into block_cell */
    int *block_cell;  /* [nown] my cells, block by block */

    const struct comm *comm;
    struct polyhedra_private *hidden; /* exchange plan */
};

/* Collective; every rank holds the whole polyMesh. rings: of stencils, 1 or 2; a stencil grows by further rings until
 * it has 2 (rings 1) or 1.5 (rings 2) times as many members as a polynomial of degree `rings` has coefficients (without
 * the constant), or the mesh ends. Quadrature of order 1 for rings 1, 3 for rings 2. Refuses (ERR_INPUT, with cell or
 * face and place) what no finite volume can use. */
status polyhedra_make(const struct polymesh *m, const struct comm *c, int rings, struct polyhedra **out);
void polyhedra_free(struct polyhedra *m);

/* Fills the ghosts (not the mirrors) of nvar <= POLYHEDRA_VARIABLES lines data[v][size] from other ranks. start sends;
 * between the two the cells that are sent must stay. Local work in between hides the time. */
void polyhedra_fill_start(struct polyhedra *m, int nvar, double *const *data);
void polyhedra_fill_finish(struct polyhedra *m);

#endif
