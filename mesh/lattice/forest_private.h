/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the forest (the lattice cut into tiles, forest.h): forest.c (my tiles), forest_cut.c (all
 * tiles), forest_fill.c (ghost layers), forest_cells.c (values). */
#ifndef MESH_FOREST_PRIVATE_H
#define MESH_FOREST_PRIVATE_H

#include "mesh/base/pool.h"
#include "mesh/lattice/forest.h"
#include "mesh/lattice/trees.h"

struct copy {      /* a box of cells from one block to another */
    int to, from;  /* tiles of this rank */
    int side;      /* side of the tile whose ghosts these are */
    int beyond;    /* layers between that side and the box */
    int link;      /* the message that stands for the tile on another rank, or -1: both are here */
    int n[3];      /* cells along each axis */
    long to_start; /* offset of the box's first cell in a block, or of the box in a message of one layer and variable */
    long from_start;
};
struct copies {
    int n;
    struct copy *item;
};
struct cut_block { /* one block; every rank has the list of all */
    int id, tile;  /* places along the curve: of the block, and of the tile that holds its values */
    int low[3], n[3];
};
struct forest_private {
    struct pool pool; /* has all lists, those of struct forest, too */
    int n[3];         /* cells of the lattice along each axis */
    int pieces[3];    /* pieces along each axis: the grid of blocks */
    int *start[3];    /* [pieces + 1] lattice position of each piece's first cell, and n at the end */
    int *id;          /* [pieces0*pieces1*pieces2] block id, -1 in a hole */
    int nblocks;
    struct cut_block *block; /* [nblocks] all blocks, tile by tile, and by id within a tile */
    int nall;
    struct trees_tile *all; /* [nall] all tiles, by id */
    struct trees *trees;
    long ncells; /* of this rank's blocks */
    int *cell;   /* [ncells] the array that block[].cell points into */
    int *face;   /* the array that tile[].side[].face points into */

    struct copies fill, pack; /* copies into ghost layers, tile by tile; copies into messages */
    int *fill_start;          /* [ntiles + 1] where the copies for a tile begin */
    int nlinks;
    struct comm_link *link; /* [ranks] one per neighbour rank */
    long *arriving;         /* [ranks] while the plan is made: doubles of a link's incoming message so far */
    struct comm_exchange *exchange;
    int layers, nvar; /* layers and variables of the fill under way */
    double *const *data;
};

/* Cuts the lattice into the tiles of all ranks: sets n, pieces, start, id, nblocks, block, nall, all, the same on every
 * rank and without communication. */
status cut_make(struct forest_private *h, const struct lattice *l, const struct polymesh *m, int tile_size);

/* Builds the copy lists and buffers of f->hidden, and sets tile[].remote. */
status fill_make(struct forest *f);

#endif
