/* Shared by forest.c (my tiles), forest_cut.c (all tiles), forest_fill.c (ghost layers), forest_cells.c (values). */
#ifndef MESH_FOREST_PRIVATE_H
#define MESH_FOREST_PRIVATE_H

#include "mesh/lattice/forest.h"
#include "mesh/lattice/trees.h"

struct copy {      /* a box of cells from one block to another */
    int to, from;  /* tiles of this rank */
    int side;      /* of the tile whose ghosts these are */
    int beyond;    /* so many layers beyond it */
    int link;      /* in place of one of them: the message to or from another rank, or -1 */
    int n[3];      /* cells along each axis */
    long to_start; /* offset of its first cell in the block, or of the box in the message of one layer and variable */
    long from_start;
};
struct copies {
    int n;
    struct copy *item;
};
struct forest_private {
    int n[3];      /* cells of the lattice */
    int pieces[3]; /* the tile grid */
    int *start[3]; /* [pieces + 1] lattice position of the pieces' first cells, and n */
    int *id;       /* [pieces0*pieces1*pieces2] tile id, -1 in a hole */
    int nall;
    struct trees_tile *all; /* [nall] by id */
    struct trees *trees;
    int *cell;  /* what tile[].cell points into */
    int *face;  /* what tile[].side[].face points into */
    int *order; /* root: [ncells_all] polyMesh cell, tile by tile; NULL elsewhere */

    struct copies fill, pack; /* into ghost layers, tile by tile; into messages */
    int *fill_start;          /* [ntiles + 1] where the copies for a tile begin */
    int nlinks;
    struct comm_link *link; /* [ranks] one per neighbour rank */
    long *arriving;         /* [ranks] while the plan is made: doubles of a link's incoming message so far */
    struct comm_exchange *exchange;
    int layers, nvar; /* of the fill under way */
    bool derivatives;
    double *const *data;
};

/* Cuts the lattice into the tiles of all ranks: n, pieces, start, id, nall, all. patch_of[f - ninternal] is the patch
 * of boundary face f, or -1 on a cyclic patch. The same on every rank, without communication. */
status cut_make(struct forest_private *h, const struct lattice *l, const struct polymesh *m, const int *patch_of,
                int tile_size);
void cut_free(struct forest_private *h);

/* Builds the copy lists and buffers of f->hidden, and sets tile[].remote. */
status fill_make(struct forest *f);
void fill_free(struct forest_private *h);

#endif
