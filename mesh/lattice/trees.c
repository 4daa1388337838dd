/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the trees of a forest (the lattice cut into tiles, one p4est tree per tile; trees.h) with p4est in one or two
 * dimensions, with p8est in three. */
#include "mesh/lattice/trees.h"

#include <stdlib.h>

enum { PARTS = 16 }; /* of the largest tile, in which tiles are weighed */

static long cells_of(const struct trees_tile *t) {
    return (long)t->n[0] * t->n[1] * t->n[2];
}

long trees_largest(const struct trees_tile *all, int nall) {
    long largest = 1;
    for (int t = 0; t < nall; t++)
        if (cells_of(&all[t]) > largest) largest = cells_of(&all[t]);
    return largest;
}

int trees_weight(const struct trees_tile *tile, long largest) {
    const int weight = (int)((PARTS * cells_of(tile) + largest / 2) / largest);
    return weight > 1 ? weight : 1;
}

void trees_deal(const struct trees_tile *all, int nall, int ranks, int *start) {
    const long largest = trees_largest(all, nall);
    long whole = 0, before = 0;
    int rank = 0;
    for (int t = 0; t < nall; t++) whole += trees_weight(&all[t], largest);
    for (int t = 0; t < nall; t++) {
        for (; rank < ranks && before >= (long)((double)whole * rank / ranks); rank++) start[rank] = t;
        before += trees_weight(&all[t], largest);
    }
    while (rank <= ranks) start[rank++] = nall;
}

/* Deals the tiles without p4est, which needs all ranks, and MPI. */
static status deal_alone(struct trees *t, const struct comm *c, const struct trees_tile *all, int nall) {
    const int rank = comm_rank(c);
    TRY(allocate(&t->start, comm_size(c) + 1L, sizeof *t->start, "the first tiles of the ranks"));
    trees_deal(all, nall, comm_size(c), t->start);
    t->first = t->start[rank];
    t->count = t->start[rank + 1] - t->first;
    return OK;
}

status trees_make(const struct comm *c, int dim, const struct trees_tile *all, int nall, struct trees **out) {
    struct trees *t = NULL;
    *out = NULL;
    TRY(comm_agree(c, allocate(&t, 1, sizeof *t, "the trees of the forest")));
    if (comm_size(c) > 1 && !comm_pretends(c)) t->engine = dim < 3 ? &trees_flat : &trees_solid;
    status s = t->engine ? t->engine->start(t, c, all, nall) : deal_alone(t, c, all, nall);
    if (s) {
        trees_free(t);
        return status_up(s, __FILE__, __LINE__);
    }
    *out = t;
    return OK;
}

void trees_free(struct trees *t) {
    if (!t) return;
    if (t->engine) t->engine->stop(t);
    free(t->start);
    free(t);
}
