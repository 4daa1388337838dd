/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The trees of a forest (the lattice cut into tiles, one p4est tree per tile; forest.h): p4est deals the tiles, in the
 * order of their ids, to the ranks, so that all ranks get about the same number of cells. Private to forest*.c. */
#ifndef MESH_TREES_H
#define MESH_TREES_H

#include "mesh/base/comm.h"

struct trees_tile {   /* one tile; every rank has the list of all */
    int low[3], n[3]; /* lattice position and cells */
    int neighbour[6]; /* tile id beyond side 2*k + (0 low, 1 high), itself for its own periodic image; -1: a patch */
};
struct trees_engine;
struct trees {
    const struct trees_engine *engine; /* NULL: this rank is alone, or the others are not there (comm_pretend) */
    int first, count;                  /* my tiles: ids first .. first + count - 1 */
    int *start;                        /* [ranks + 1] the first tile of each rank */
    struct trees_state *state;
};
struct trees_engine { /* p4est in two dimensions (and one), p8est in three */
    status (*start)(struct trees *t, const struct comm *c, const struct trees_tile *all, int nall);
    void (*stop)(struct trees *t);
};
extern const struct trees_engine trees_flat, trees_solid;

/* Returns the cells of the largest tile, and the weight of a tile beside it: its cells in sixteenths of that, rounded.
 * Tiles that differ by a row of cells so weigh as much; by their cells, six tiles of which the first has one row less
 * would be dealt as 4 and 2, since the first three lack a few cells of half of all. */
long trees_largest(const struct trees_tile *all, int nall);
int trees_weight(const struct trees_tile *tile, long largest);
/* Deals the tiles to `ranks` as p4est_partition does: a rank begins with the first tile before which at least its share
 * of all weight lies. start: [ranks + 1] */
void trees_deal(const struct trees_tile *all, int nall, int ranks, int *start);
status trees_make(const struct comm *c, int dim, const struct trees_tile *all, int nall, struct trees **out);
void trees_free(struct trees *t);

#endif
