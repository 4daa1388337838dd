/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files that number the cells and faces of a rank: polyhedra.c, and polyhedra_spread.c where no rank has
 * the whole mesh. */
#ifndef MESH_POLYHEDRA_MAKE_PRIVATE_H
#define MESH_POLYHEDRA_MAKE_PRIVATE_H

#include "mesh/polyhedral/polyhedra_private.h"

struct ghost {
    int kind, rank, cell; /* kind is NEAR or FAR; `rank` has the cell of the links */
};
struct work {         /* scratch while a struct polyhedra is made; lists are by cell of the links, or by link */
    struct pool pool; /* has all but `cut` and `mine` */
    struct links links;
    const struct spread *spread; /* of a mesh that is spread over the ranks; else NULL */
    struct mesh_part *part;      /* my cells, those around them, and those of their stencils; NULL: the whole mesh */
    struct cut cut;
    struct grower grower;
    int *mine;     /* [nown] cells, block by block: by numbers in the whole mesh until the links are there */
    int *block_of; /* [cells] */
    int *local;    /* [cells] number on this rank, or a mark of polyhedra.c */
    int *members;  /* [cells] members of the cell's stencil */
    bool *waits;   /* [cells] does the cell's stencil hold ghosts? */
    bool sized;    /* do cells stand in the order of their size? */
    int nghosts;
    struct ghost *ghost;
    int *ghost_rank;          /* [ghosts] rank that has the ghost */
    int *face_of, *mirror_of; /* [links] number of the face, of the mirror, on this rank, or -1 */
    int *link_of;             /* [faces] link of a face */
    int *mirror_link;         /* [mirrors] link of a mirror */
};

/* Takes the blocks of this rank: block[n][2] are pairs of block and cell, which it sorts. */
status work_blocks(struct polyhedra *m, struct work *w, long n, int (*block)[2]);
/* Lists the ghosts, and what the stencils take. */
status work_cells(struct polyhedra *m, struct work *w, int rings);
/* Numbers cells and faces, and computes their geometry and stencils. */
status work_local(struct polyhedra *m, struct work *w, int rings);
/* Does all of it for a mesh that is spread. Collective. */
status work_spread(struct polyhedra *m, const struct polymesh *all, struct work *w, int rings);

#endif
