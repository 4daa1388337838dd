/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lattice cut into boxes of cells ("tiles"): the forest, with one p4est tree per tile, dealt to the ranks along the
 * space-filling curve. Every tile has the same memory layout, with ghost layers on the axes the mesh has, so that a
 * sweep sees full rows only; everything special happens in the ghost fill. The forest knows no physics: a variable is a
 * number. */
#ifndef MESH_FOREST_H
#define MESH_FOREST_H

#include "mesh/base/comm.h"
#include "mesh/lattice/lattice.h"

enum {
    GHOSTS = 3,        /* layers of ghost cells: the six-point stencil of a fifth-order face value */
    FILL_VARIABLES = 8 /* most variables of one ghost fill */
};

struct side {        /* one side of a tile: wholly one neighbour tile or wholly one patch */
    int patch;       /* patch of the polyMesh, or -1: a neighbour tile (periodic images included) */
    int neighbour;   /* index in tile[] of that neighbour tile if this rank has it, else -1 */
    const int *face; /* [cells of the side] face within the patch, lower axis fastest; NULL for a neighbour */
};
struct tile {
    int id;              /* place along the curve among the tiles of all ranks */
    int low[3];          /* lattice position of its first cell */
    int n[3];            /* cells along each computational axis; 1 for k >= dim */
    struct side side[6]; /* 2*k + (0 low, 1 high), k < dim */
    bool remote;         /* does a ghost layer come from another rank? */
};
/* What a tile stands for: itself or, where an axis is uniform, also its images along that axis, cut as tiles would be.
 * Values go in and out by blocks, so no other code sees which axes are uniform. */
struct forest_block {
    int id;          /* place along the curve among the blocks of all ranks */
    int tile;        /* index in tile[] of the tile that holds its values */
    int low[3];      /* lattice position of its first cell */
    int n[3];        /* cells along each computational axis; 1 for k >= dim */
    const int *cell; /* [n0*n1*n2], axis 0 fastest: polyMesh cell; the list of the next block follows */
};
struct forest {
    int dim;
    int axis[3];      /* [dim] physical axis (0 x, 1 y, 2 z) of computational axis k */
    double width[3];  /* m */
    double origin[3]; /* m */
    double volume;    /* m^3, of one cell, with the thickness of empty axes; if round, m^2: times the cell's radius */
    int radial;       /* computational axis along the radius; -1: the mesh is not round (struct revolution) */
    double inner;     /* m: radius of the origin; 0 on the axis, to the bit */
    /* memory layout of one variable of one tile, the same for all: cell (i, j, k), ghosts at -GHOSTS and n .. n+2 */
    long stride[3]; /* doubles: stride[0] = 1; rows are padded so that `first` and stride[1] are multiples of 8 */
    long first;     /* offset of cell (0, 0, 0) */
    long size;      /* doubles per variable, a multiple of 8 */
    long step[3];   /* doubles from cell to cell of a block: stride, or 0 along uniform axes */
    long sheet;     /* cells of the largest side of a tile, a multiple of 8 */
    long images;    /* cells of the mesh that each cell of a tile stands for: 1 unless an axis is uniform */
    int ntiles;     /* tiles of this rank */
    struct tile *tile;
    int ntiles_all;
    int nblocks; /* blocks of this rank, tile by tile */
    struct forest_block *block;
    int nblocks_all;
    int ncells_all;
    const struct comm *comm;
    struct forest_private *hidden; /* the trees, the plan of the ghost exchange */
};

/* The radius (m) of a place of a round lattice: cell i has its centre at i + 0.5. */
static inline double forest_radius(const struct forest *f, double place) {
    return f->inner + place * f->width[f->radial];
}
/* That of cell i of a block, axis 0 fastest. */
static inline double forest_block_radius(const struct forest *f, const struct forest_block *b, int i) {
    const int at = f->radial == 0 ? i % b->n[0] : i / b->n[0] % b->n[1];
    return forest_radius(f, b->low[f->radial] + at + 0.5);
}

/* The place along computational axis k of the cell at `offset` of a tile, in the lattice. */
static inline int forest_place_along(const struct forest *f, int tile, long offset, int k) {
    long at[3] = {0}, remains = offset - f->first;
    for (int a = f->dim - 1; a >= 0; a--) {
        at[a] = remains / f->stride[a];
        remains -= at[a] * f->stride[a];
    }
    return f->tile[tile].low[k] + (int)at[k];
}

/* Cuts lattice l of mesh m into tiles of about tile_size cells a side; cuts also fall on every plane where the boundary
 * or its patch changes. Refuses (ERR_INPUT) a mesh with a passage of fewer than GHOSTS cells between two such planes
 * where a neighbour tile would need them. The lattice must outlive the forest. Collective. */
status forest_make(const struct lattice *l, const struct polymesh *m, const struct comm *c, int tile_size,
                   struct forest **out);
void forest_free(struct forest *f);

/* Fill the ghost layers (not the corners) of `nvar` <= FILL_VARIABLES variables from neighbour tiles, periodic images
 * and other ranks. data[t] is tile t's block, variable v at data[t] + v*size. Sides with a patch are left alone.
 * forest_fill_start sends the cells that other ranks need, of the first `layers` (1 .. GHOSTS) beyond each side.
 * forest_fill_tile fills the layers of one tile, as often as wanted until the next start: at once if the tile is not
 * remote, after forest_fill_finish if it is. data and its cells must stay as they are until then. forest_fill_tile
 * leaves out sides towards tiles of this rank where leave[side] is set (leave may be NULL). forest_fill does all of
 * this for all tiles and layers, forest_fill_layers for the first `layers` alone. */
void forest_fill_start(struct forest *f, int layers, int nvar, double *const *data);
void forest_fill_finish(struct forest *f);
void forest_fill_tile(const struct forest *f, int t, const bool *leave);
void forest_fill(struct forest *f, int nvar, double *const *data);
void forest_fill_layers(struct forest *f, int layers, int nvar, double *const *data);
void forest_fill_int(struct forest *f, int *const *data); /* one layer of one variable of ints */

/* Sheets of a tile hold `lines` <= FILL_VARIABLES lines of the cells along each side s, lower axis fastest. Line v
 * stands at forest_sheet(f, s, lines, v); what lies beyond the side stands at the sheet 2 dim + s. forest_fill_sheets
 * sets the latter but at patches. */
static inline long forest_sheet(const struct forest *f, int s, int lines, int v) {
    return (s * lines + v) * f->sheet;
}
void forest_fill_sheets(struct forest *f, int lines, double *const *data);

/* Gathers values of this rank's cells, one block after the other in the order of their cells, in the root's
 * all[ncells_all], in polyMesh order; all is NULL on the other ranks. Collective. */
status forest_gather(const struct forest *f, const double *values, double *all);

/* Sums one number per block over all ranks in the order of the blocks' ids: *sum has the same bits for any number of
 * ranks. Collective. */
status forest_sum(const struct forest *f, const double *per_block, double *sum);

/* Sets the solved axes of x (m) to the centre of a cell, which any rank may have. Collective. */
void forest_place(const struct forest *f, long cell, double x[3]);

/* Finds the block of this rank and the cell in it that hold a point (x, y, z in m); *block is -1 if another rank or
 * none has the point. A point between two cells belongs to the upper one, at an upper edge of the domain to the lower
 * one: one rank has it. */
void forest_locate(const struct forest *f, const double point[3], int *block, int *cell);

#endif
