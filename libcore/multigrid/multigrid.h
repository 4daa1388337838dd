/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves A x = b on cells of a mesh: A is a symmetric M-matrix, A = diag(d) - w with links w >= 0 and row sums d_i -
 * sum w >= 0, which may be next to nothing (Poisson's equation). Conjugate gradients are preconditioned by one cycle of
 * a multigrid of aggregates; few rows, and those whose factors are short (lines of cells), are solved directly.
 *
 * The same bits on any number of ranks: rows belong to blocks, which no rank shares. Aggregates lie inside blocks,
 * smoothing takes other blocks' values from before the sweep, sums go block by block in the order of the blocks'
 * numbers, and coarse levels are computed alike by every rank. With one rank no message is sent. */
#ifndef LIBCORE_MULTIGRID_H
#define LIBCORE_MULTIGRID_H

#include "mesh/base/comm.h"

/* This rank's rows of the finest system; borrowed, and may change from call to call. */
struct multigrid_rows {
    int blocks;                   /* blocks of this rank; a block without rows is allowed */
    const int *first;             /* [blocks + 1] first row of each block; rows of a block follow one another */
    const int *number;            /* [blocks] numbers of the blocks over all ranks, each once, ascending */
    int rows, ghosts;             /* unknowns: rows of this rank, then ghosts, which are rows of other ranks */
    const int *link_first, *link; /* [rows + 1], [links] columns of row i, never i; a column may occur twice. Their
                                     order must not depend on the ranks; A's pattern is symmetric. */
    const double *weight;         /* [links] w >= 0: minus the entry */
    const double *diagonal;       /* [rows] d > 0 */
    /* Together they copy x[rows + ghosts] from owners to ghosts, send before receive; meanwhile x[rows] may be read,
     * and nothing else is sent. Collective; only more than one rank call them. */
    void (*send)(void *context, const double *x);
    void (*receive)(void *context, double *x);
    void *context;
};

struct multigrid; /* aggregates, coarse matrices and memory, which grows by need and stays */
status multigrid_make(const struct comm *c, struct multigrid **out);
void multigrid_free(struct multigrid *m);

/* Prepares for a matrix. `same_links`: only weight and diagonal have changed since the last call, on every rank; then
 * the aggregates stay, which is cheaper, and good while the weights have not changed much. The last bits of a
 * result then depend on an earlier matrix. Pass false at the start of each step if a restart must have the same bits.
 * Collective. Fails with ERR_SYSTEM, on all ranks, if there is no memory. */
status multigrid_setup(struct multigrid *m, const struct multigrid_rows *rows, bool same_links);

/* Does the last set-up solve directly? Then a set-up with the same links has the bits of a new one. */
bool multigrid_is_direct(const struct multigrid *m);

/* Solves A x = b for the matrix of the last set-up from x = 0, until sqrt(r' r/d) has fallen by `reduction`; x[rows]
 * and b[rows]. *iterations: those that were made, at most `most`; 1 for a direct solution, 0 if b = 0. Less than
 * `reduction` may be reached if *iterations = most, or if round-off allows no more. Collective. */
status multigrid_solve(struct multigrid *m, const struct multigrid_rows *rows, const double *b, double reduction,
                       int most, double *x, int *iterations);

/* Sums n <= 8 numbers of each of this rank's blocks, [blocks][n], over all blocks in the order of their numbers, after
 * a set-up with these blocks. Collective. */
void multigrid_sum_blocks(struct multigrid *m, int blocks, int n, const double *per_block, double *sum);

#endif
