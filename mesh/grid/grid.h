/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A mesh made ready for a run: a lattice, as a forest (the lattice cut into tiles, one p4est tree per tile; forest.h),
 * or a polyhedral mesh, as struct polyhedra (polyhedra.h). Readers and writers of fields see what both have: this
 * rank's cells, in blocks that do not depend on the number of ranks. */
#ifndef MESH_GRID_H
#define MESH_GRID_H

#include "mesh/lattice/forest.h"
#include "mesh/polyhedral/polyhedra.h"

struct grid_block { /* a block of a forest, or of polyhedral cells */
    int id;         /* number among the blocks of all ranks, 0 .. nblocks_all - 1 */
    int ncells;
    const int *cell; /* [ncells] polyMesh cells, in the order in which the gas gives values of a block; the list of the
                        next block follows */
};
struct grid {
    int dim;     /* number of solved axes */
    int axis[3]; /* [dim] physical axis (0 x, 1 y, 2 z) of computational axis k */
    int ncells_all, nblocks_all;
    int nblocks; /* blocks of this rank */
    struct grid_block *block;
    const struct polymesh *mesh;
    const struct comm *comm;
    struct forest *forest; /* forest of a lattice, polyhedra of any other mesh; NULL otherwise. The grid frees both */
    struct polyhedra *polyhedra;
    struct grid_private *hidden; /* the order of gathered values, the search for the cell of a point */
};

/* Makes a forest of the lattice l or, where l is NULL, polyhedra with stencils of `rings` rings (polyhedra_make; sized:
 * polyhedra_make_sized). m, centre ([ncells][3] m, of polyhedra) and c are borrowed. Collective. */
status grid_make(const struct lattice *l, const struct polymesh *m, const double *centre, const struct comm *c,
                 int rings, bool sized, struct grid **out);
/* Makes polyhedra of a mesh that is spread over the ranks; `spread` may be freed then. Collective. */
struct spread;
status grid_make_spread(const struct polymesh *m, const struct spread *spread, int rings, bool sized,
                        struct grid **out);
void grid_free(struct grid *g);
void grid_settle(struct grid *g); /* frees what grid_locate needs: no point is looked for any more */
int grid_tile_size(int dim);      /* most cells of a tile along an axis, of a lattice of dim axes */

double grid_volume(const struct grid *g, int block, int i); /* of cell i of a block of this rank, m^3 */
/* Sets x (m) to the centre of cell i of a block of this rank. */
void grid_centre(const struct grid *g, int block, int i, double x[3]);

/* Returns the cells of all blocks of this rank, one block after the other, and how many they are. */
const int *grid_cells(const struct grid *g, long *n);

/* Gathers values of this rank's cells, one block after the other, in the root's all[ncells_all], in polyMesh order; all
 * is NULL on the other ranks. Collective. */
status grid_gather(const struct grid *g, const double *values, double *all);

/* Sums one number per block over all ranks in the order of the blocks' ids: *sum has the same bits for any number of
 * ranks. Collective. */
status grid_sum(const struct grid *g, const double *per_block, double *sum);

/* Finds the block of this rank and the cell within it that hold a point (x, y, z in m; only the solved axes count);
 * *block is -1 if the point lies outside the mesh or on another rank. A point between cells belongs to one of them, the
 * same for any number of ranks. Collective. */
status grid_locate(const struct grid *g, const double point[3], int *block, int *cell);

#endif
