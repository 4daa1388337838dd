/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inside of the multigrid, which its files share: levels, the direct solver, tables of the blocks of all ranks. */
#ifndef LIBCORE_MULTIGRID_PRIVATE_H
#define LIBCORE_MULTIGRID_PRIVATE_H

#include "libcore/models/kernel.h"
#include "libcore/multigrid/arrays.h"
#include "libcore/multigrid/multigrid.h"

enum {
    SPREAD_LEVELS = 3, /* the most levels that have their rows on their ranks; coarser ones have all on every rank */
    MOST_LEVELS = 24,
    MOST_SUMS = 8
};
enum { INSIDE = -1, DROPPED = -2 }; /* links and rows that the coarser matrix does not have */

/* A matrix as another is made from it: row i has the links first[stride i] to first[stride (i + 1)] - 1. */
struct matrix {
    int rows, ghosts, blocks, stride;
    const int *block, *first, *link; /* block: [blocks + 1] first rows */
    const double *weight, *excess;   /* excess: sums of the rows, >= 0 */
};

/* Links of row i: from first[3 i] on those to lower rows of its block, from first[3 i + 1] on those to higher ones,
 * from first[3 i + 2] on those to other blocks. */
struct level {
    int rows, ghosts, blocks, links, edges;
    int *block, *first, *link;    /* [blocks + 1], [3 rows + 1], [links] */
    double *weight, *excess;      /* [links], [rows] */
    double *diagonal, *inverse;   /* [rows] A's; the smoother's, inverted */
    int *edge;                    /* [edges] rows with links to other blocks */
    double *damp, *kept;          /* [edges] what the smoother's diagonal has more than A's; right sides */
    int *map;                     /* [links of the finer matrix] their place here, INSIDE or DROPPED */
    int *aggregate;               /* [rows + ghosts] its row of the next level, or DROPPED */
    int *member_first, *member;   /* [rows of the next level + 1], [rows] */
    double *r, *x, *c, *v;        /* [rows + ghosts] right side, result of a cycle, correction, its image */
    int sent, *send;              /* [sent] rows that other ranks' rows are linked to: all ranks get their values */
    int *from;                    /* [ghosts] places in what is shared */
    int *told_count, *told_first; /* [ranks], [ranks + 1] values that each rank tells all others */
    double *mine, *shared;        /* [sent], [all that is shared] */
    int *name;                    /* [ghosts] the row that each is in the order of all rows */
    bool spread;                  /* are the rows on their ranks? else all are on every rank */
    int *marks, *groups;          /* scratch of multigrid_lay and multigrid_aggregate */
    double *masses;
    const struct multigrid_rows *own; /* of the finest level: who fills ghosts; else NULL */
    struct arrays arrays;
};

/* L L' = A inside the envelope: row i has the columns low[i] to i - 1, from entry[start[i]] on. */
struct direct {
    int rows, *low;
    long *start;
    double *entry, *inverse; /* inverse: one over L's diagonal; 0 where A is singular */
    struct arrays arrays;
};

/* Tables of the blocks and rows of all ranks, which each rank has if there are several. Index j counts blocks in the
 * order of the ranks. */
struct world {
    int blocks;                   /* of all ranks */
    int *count, *first;           /* [ranks], [ranks + 1] blocks of each rank */
    int *order;                   /* [blocks] j of the blocks in the order of their numbers */
    int *rows, *base;             /* [blocks], [blocks + 1] rows of block j; its first row in the order of numbers */
    int *row_count, *row_first;   /* [ranks], [ranks + 1] rows of each rank */
    int *sum_count, *sum_first;   /* [ranks], [ranks + 1] sums of blocks of each rank */
    int *pack_count, *pack_first; /* [ranks], [ranks + 1] numbers that each rank packs, 1 + links for each row */
    double *mine, *sums;          /* [blocks of this rank][sums], [blocks][sums] */
    double *pack, *packed;        /* excess and weights of each row: of this rank, of all */
    double *residual;             /* [rows of all] in the order of the ranks */
    int *at;                      /* [rows of all] where each row begins in what is packed */
    int *first_link, *link;       /* [rows of all + 1], [links of all]: the matrix of all rows */
    double *weight, *excess;
    struct arrays arrays;
};

struct multigrid {
    const struct comm *comm;
    int ranks, levels, spread; /* the first `spread` levels have their rows on their ranks */
    long total;                /* rows of all ranks on the level that was made last */
    bool prepared;
    struct level level[MOST_LEVELS]; /* from level[spread] on all rows are on every rank */
    struct level local;              /* this rank's rows of level[spread] */
    struct direct direct;            /* of the coarsest level */
    struct world world;
    int *block;     /* [blocks + 1] of the caller's rows */
    double *excess; /* [rows] of the caller's matrix */
    double *p, *q;  /* [rows + ghosts] of the conjugate gradients: direction, its image */
    struct arrays arrays;
};

/* multigrid_levels.c. aggregate NULL: each row is its own. multigrid_lay lays out the matrix of the sums over
 * aggregates, whose rows, ghosts and blocks are known; multigrid_sum computes it. */
struct matrix multigrid_matrix(const struct level *l);
status multigrid_lay(const struct matrix *a, const struct level *fine, struct level *to);
void multigrid_sum(const struct matrix *a, const int *aggregate, struct level *to);
void multigrid_smoother(struct level *l, const double *diagonal); /* NULL: of excess and weights */
status multigrid_vectors(struct level *l);

/* multigrid_aggregate.c: finds aggregate[rows] and the members; rows and blocks of `to`. */
status multigrid_aggregate(struct level *l, int passes, struct level *to);

/* multigrid_direct.c */
status multigrid_direct_lay(const struct level *l, struct direct *d);
void multigrid_factor(const struct level *l, struct direct *d);
void multigrid_direct_solve(const struct direct *d, const double *r, double *x);

/* multigrid_ranks.c. Collective all of them; with one rank they send nothing. */
status multigrid_meet(struct multigrid *m, const struct multigrid_rows *rows); /* learns of the blocks of all ranks */
status multigrid_count(struct multigrid *m, const struct level *l);            /* rows of all blocks: world, total */
bool multigrid_narrow(struct multigrid *m, const struct multigrid_rows *rows, double *name); /* are factors short? */
status multigrid_name_ghosts(struct multigrid *m, struct level *fine, struct level *to);
status multigrid_links_lay(struct multigrid *m,
                           struct level *l);      /* what ranks share of a level that is not the finest */
status multigrid_gather_lay(struct multigrid *m); /* the matrix of all rows from `local` */
struct matrix multigrid_gather(struct multigrid *m, int *block); /* its numbers; block: [2] */
/* Copy x from rows to ghosts; between send and receive x[rows] may be read. Levels that are on every rank have none. */
void multigrid_send(const struct multigrid *m, const struct level *l, const double *x);
void multigrid_receive(const struct multigrid *m, const struct level *l, double *x);
void multigrid_gather_residual(struct multigrid *m); /* local.r -> level[spread].r */
void multigrid_take_correction(struct multigrid *m); /* level[spread].c -> local.c, of rows and ghosts */
/* Finds the sums of a level from the n <= MOST_SUMS sums of each block of this rank, which are in world.mine. */
void multigrid_add(const struct multigrid *m, const struct level *l, int n, double *sum);
void multigrid_dots(const struct multigrid *m, const struct level *l, int n, const double *const a[],
                    const double *const b[], double *sum);

#endif
