/* A mesh made ready for a run, of either kind: a forest of tiles or polyhedra. What both tell those who
 * read fields: this rank's cells, in blocks that do not depend on the number of ranks. */
#ifndef MESH_GRID_H
#define MESH_GRID_H

#include "mesh/lattice/forest.h"
#include "mesh/polyhedral/polyhedra.h"

struct grid_block { /* a tile, or a block of polyhedra */
    int id;         /* over all ranks, 0 .. nblocks_all - 1 */
    int ncells;
    const int *cell; /* [ncells] polyMesh cells, in the order in which the gas gives values of a block */
};
struct grid {
    int dim;     /* axes that are solved */
    int axis[3]; /* [dim] physical axis (0 x, 1 y, 2 z) of computational axis k */
    int ncells_all, nblocks_all;
    int nblocks; /* of this rank */
    struct grid_block *block;
    const double *volume; /* [ncells_all] m^3, polyMesh order; borrowed */
    const double *centre; /* [ncells_all][3] m; borrowed */
    const struct polymesh *mesh;
    const struct comm *comm;
    struct forest *forest; /* one of the two, the other NULL; the grid's own */
    struct polyhedra *polyhedra;
    struct grid_private *hidden; /* where gathered values belong, the search by place */
};

/* Collective. With a lattice a forest, with lattice NULL polyhedra of the given rings (struct polyhedra). */
status grid_make(const struct lattice *l, const struct polymesh *m, const double *centre, const double *volume,
                 const struct comm *c, int rings, struct grid **out);
void grid_free(struct grid *g);

/* Root's all[ncells_all] <- values[block][cell of the block]; all is NULL on the other ranks. */
status grid_gather(const struct grid *g, const double *const *values, double *all);

/* Sum over all ranks of one number per block, in the order of the blocks' ids: the same bits for any number of ranks.
 */
status grid_sum(const struct grid *g, const double *per_block, double *sum);

/* The block and the cell within it that hold a point, or block -1: outside, or not on this rank. A point between
 * cells belongs to one of them, the same for any number of ranks. Only the solved axes count. */
void grid_locate(const struct grid *g, const double point[3], int *block, int *cell);

#endif
