/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A mesh that is a union of blocks of equal boxes along the axes, as system/blockMeshDict says it: blocks join at whole
 * sides, and each other side belongs wholly to a patch. Numbers of cells and of faces on patches follow from places by
 * arithmetic, in the order in which OpenFOAM's blockMesh numbers them, so that no array of cells or faces is needed. */
#ifndef MESH_BOXES_H
#define MESH_BOXES_H

#include "mesh/base/status.h"

struct polymesh;

struct brick_numbers { /* of the cells of a block, or of the faces on a side of it */
    long start;        /* the least of the numbers */
    int axis[3];       /* 0 x, 1 y, 2 z: the axes along which numbers rise, fastest first */
    bool down[3];      /* do they rise towards lower places along x, y, z? */
};
struct brick_side {
    int next;                  /* block beyond it; -1: a patch */
    int patch;                 /* -1: a block */
    struct brick_numbers face; /* numbers within the patch */
};
struct brick {        /* one block */
    int low[3], n[3]; /* place of its first cell on the lattice, and cells, along x, y, z */
    struct brick_numbers cell;
    struct brick_side side[6]; /* 2*axis + (0 low, 1 high) */
};
struct brick_name {
    int box, side;
};
struct boxes {
    int n[3];                         /* cells along x, y, z of the box around all */
    double low[3], high[3], width[3]; /* its corners; of a cell; m */
    int nboxes;
    struct brick *box; /* [nboxes] by the numbers of their cells */
    int nsides;
    struct brick_name *side; /* [nsides] those of patches, by patch and then by the numbers of their faces */
    int npatches;
    int *first; /* [npatches + 1] where a patch begins in side[] */
    long nfaces, ninternal;
};

/* What a dictionary says. */
struct boxes_block { /* hex (0 .. 7) (n0 n1 n2) */
    int vertex[8], n[3];
};
struct boxes_patch {
    const char *name, *type, *neighbour; /* neighbour: of cyclic patches, else NULL */
    int nfaces;
    int (*face)[4];     /* [nfaces] vertices */
    const char *groups; /* by inGroups, with blanks between, or NULL */
};
/* The vertices of side 2*axis + (0 low, 1 high) of a block, by its own axes. */
extern const int boxes_corner[6][4];

/* Puts blocks on their lattice. A block must be a box along the axes of cells as large as those of block 0, lie on no
 * other, and touch others at whole sides only; an error names the block, and *culprit is its number. vertex: [][3], m;
 * the blocks' labels are within it. */
status boxes_place(const double *vertex, int nblocks, const struct boxes_block *block, struct boxes **out,
                   int *culprit);
/* Gives the sides their patches, and makes the mesh, which then owns the boxes; it has no arrays of points and faces
 * until polymesh_complete. The last of the patches takes the sides that the others leave; without such a side it is
 * left out. Errors name the patch. If it fails, the boxes are still the caller's. */
status boxes_mesh(struct boxes *b, const struct boxes_block *block, int npatches, const struct boxes_patch *patch,
                  struct polymesh **out);
void boxes_free(struct boxes *b);

/* The block that has a place of the lattice (by x, y, z), or -1: a hole is there, or it lies outside. */
int boxes_find(const struct boxes *b, const int at[3]);
long boxes_cell(const struct boxes *b, const int at[3]); /* the number of the cell at a place, or -1 */
void boxes_at(const struct boxes *b, long cell, int at[3]);
void boxes_centre(const struct boxes *b, long cell, double x[3]); /* m */
/* The patch at a side of the cell at a place, with the face's number in it, or -1: another cell follows. */
int boxes_patch(const struct boxes *b, const int at[3], int side, long *face);
/* The place and side of face i of a patch. */
void boxes_face_at(const struct boxes *b, int patch, long i, int at[3], int *side);
double boxes_plane(const struct boxes *b, int axis, int i); /* coordinate of plane i across an axis, m */
/* The four corners [4][3] (m) of a side of the cell at a place, right-handed about the way out. */
void boxes_corners(const struct boxes *b, const int at[3], int side, double corner[4][3]);

/* Makes points, faces, owner and neighbour of a mesh from its boxes (polymesh_complete). Refuses more faces than labels
 * of 32 bits count. */
status boxes_complete(struct polymesh *m);

#endif
