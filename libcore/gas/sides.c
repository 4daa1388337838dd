/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The list of this rank's faces on patches (struct patch_side), by the engine's view of the sides of cells. */
#include "libcore/gas/gas_private.h"

static void count_row(void *gas, const struct row *row) {
    struct gas *g = gas;
    struct sides s;
    for (int k = 0; g->engine->state.sides(g, row, k, &s); k++)
        for (int i = 0; i < row->n; i++) g->patches.sides += s.edge[i] >= 0;
}

static void list_row(void *gas, const struct row *row) {
    struct gas *g = gas;
    struct sides s;
    for (int k = 0; g->engine->state.sides(g, row, k, &s); k++)
        for (int i = 0; i < row->n; i++) {
            const bool right = s.face[i] < 0;
            if (s.edge[i] < 0) continue;
            g->patches.side[s.edge[i]] = (struct patch_side){.block = row->block,
                                                             .face = right ? ~s.face[i] : s.face[i],
                                                             .inside = (int)row->at + i,
                                                             .beyond = s.across[i],
                                                             .out = right ? -1 : 1,
                                                             .patch = s.patch[i]};
        }
}

status sides_make(struct gas *g) {
    g->engine->state.rows(g, EVERY_CELL, NULL, count_row, g);
    TRY(allocate(&g->patches.side, g->patches.sides, sizeof *g->patches.side, "the faces of patches"));
    g->engine->state.rows(g, EVERY_CELL, NULL, list_row, g);
    return OK;
}
