/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the trees of a forest (the lattice cut into tiles, one p4est tree per tile; trees.h) with p4est in one or two
 * dimensions, with p8est in three. */
#include "mesh/lattice/trees.h"

#include <stdlib.h>

status trees_make(const struct comm *c, int dim, const struct trees_tile *all, int nall, struct trees **out) {
    struct trees *t = NULL;
    *out = NULL;
    TRY(comm_agree(c, allocate(&t, 1, sizeof *t, "the trees of the forest")));
    t->engine = dim < 3 ? &trees_flat : &trees_solid;
    status s = t->engine->start(t, c, all, nall);
    if (s) {
        trees_free(t);
        return status_up(s, __FILE__, __LINE__);
    }
    *out = t;
    return OK;
}

void trees_free(struct trees *t) {
    if (!t) return;
    t->engine->stop(t);
    free(t->start);
    free(t);
}
