/* The forest of tiles: a lattice cut into boxes of cells ("tiles"), one p4est tree each, dealt to the ranks along the
 * space-filling curve. Every tile has the same memory layout, with ghost layers on the axes the mesh has, so that a
 * sweep sees full rows only; everything special happens in the ghost fill. Knows no physics: a variable is a number. */
#ifndef MESH_FOREST_H
#define MESH_FOREST_H

#include "mesh/base/comm.h"
#include "mesh/lattice/lattice.h"

enum {
    GHOSTS = 3,        /* layers: the six-point stencil of a fifth-order face value */
    FILL_VARIABLES = 8 /* at most, in one ghost fill */
};

struct side {        /* of a tile: wholly one neighbour tile or wholly one patch */
    int patch;       /* patch of the polyMesh, or -1: a neighbour tile (periodic images included) */
    int neighbour;   /* that tile, if it is mine; else -1 */
    const int *face; /* [cells of the side] face within the patch, lower axis fastest; NULL for a neighbour */
};
struct tile {
    int id;              /* place along the curve, over all ranks */
    int low[3];          /* lattice position of its first cell */
    int n[3];            /* cells along each computational axis; 1 for k >= dim */
    struct side side[6]; /* 2*k + (0 low, 1 high), k < dim */
    const int *cell;     /* [n0*n1*n2], axis 0 fastest: polyMesh cell */
    bool remote;         /* a ghost layer comes from another rank */
};
struct forest {
    int dim;
    int axis[3];      /* as in struct lattice */
    double width[3];  /* m */
    double origin[3]; /* m */
    double volume;    /* of a cell, m^3 */
    /* memory layout of one variable of one tile, the same for all: cell (i, j, k), ghosts at -GHOSTS and n .. n+2 */
    long stride[3]; /* doubles: stride[0] = 1; rows are padded so that `first` and stride[1] are multiples of 8 */
    long first;     /* offset of cell (0, 0, 0) */
    long size;      /* doubles per variable, a multiple of 8 */
    int ntiles;     /* mine */
    struct tile *tile;
    int ntiles_all;
    int ncells_all;
    const struct comm *comm;
    struct forest_private *hidden; /* p4est, exchange plan */
};

/* tile_size: cells a side aimed at (1D, 2D, 3D differ); cuts fall on every plane where the boundary or its patch
 * changes. Refuses (input error) a mesh with a passage of fewer than GHOSTS cells between two such planes where a
 * neighbour tile would need them. */
status forest_make(const struct lattice *l, const struct polymesh *m, const struct comm *c, int tile_size,
                   struct forest **out);
void forest_free(struct forest *f);

/* Fills ghost layers (not the corners) of `nvar` <= FILL_VARIABLES variables from neighbour tiles, periodic images and
 * other ranks. data[t] is tile t's block, variable v at data[t] + v*size. Sides with a patch are left alone.
 * start sends what other ranks need; fill_tile fills the layers of one tile, as often as wanted until the next start:
 * tiles that are not remote at once, the others after finish. data and its cells must stay until then. Sides between my
 * tiles where leave[side] is set (leave may be NULL) are left alone, too.
 * forest_fill does all of it; forest_fill_layers only for the first layers (1 .. GHOSTS) beyond each side.
 * forest_fill_derivatives does it for one layer of dim * dim variables, of which those at k dim + c are derivatives
 * along axis k: these stay as they are beyond the sides of that axis. */
void forest_fill_start(struct forest *f, int nvar, double *const *data);
void forest_fill_finish(struct forest *f);
void forest_fill_tile(const struct forest *f, int t, const bool *leave);
void forest_fill(struct forest *f, int nvar, double *const *data);
void forest_fill_layers(struct forest *f, int layers, int nvar, double *const *data);
void forest_fill_derivatives(struct forest *f, double *const *data);

/* Moves values of cells between tiles and the polyMesh's order. gather: root's all[ncells_all] <- every tile's cells
 * (others: NULL). scatter: from an array [ncells_all] that every rank holds; local. */
status forest_gather(const struct forest *f, const double *const *data, int variable, double *all);
void forest_scatter(const struct forest *f, const double *all, int variable, double *const *data);

/* Sum over all ranks of one number per tile, in the order of the tiles' ids: the same bits for any number of ranks. */
status forest_sum(const struct forest *f, const double *per_tile, double *sum);

/* The tile and cell offset (from the block's start, one variable) that hold a point, or tile -1: not on this rank.
 * Between cells the upper one holds it, at an upper edge of the domain the lower one: one rank has it. */
void forest_locate(const struct forest *f, const double point[3], int *tile, long *offset);

#endif
