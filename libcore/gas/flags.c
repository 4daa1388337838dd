/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The flags of cells whose faces are to be limited (libcore/schemes/limit.h): counts them, sends them to the
 * neighbours, notes them in the field `limited`. */
#include "libcore/gas/gas_private.h"

struct census { /* context of count_row */
    const struct gas *g;
    bool note; /* is g->limits.flags.blocks set in blocks with a flag? */
    long count;
};

static void count_row(void *census, const struct row *row) {
    struct census *c = census;
    const double *flag = c->g->limits.flags.cells[row->block] + row->at;
    const long before = c->count;
    for (int i = 0; i < row->n; i++) c->count += flag[i] > 0;
    if (c->note && c->count > before) c->g->limits.flags.blocks[row->block] = true;
}

long flags_send(struct gas *g) {
    struct census own = {.g = g}, near = {.g = g, .note = true};
    g->engine->state.rows(g, EVERY_CELL, NULL, count_row, &own);
    comm_sum_long(g->comm, &own.count, 1);
    g->engine->state.fill(g, GHOSTS, 1, g->limits.flags.cells);
    memset(g->limits.flags.blocks, 0, (size_t)g->blocks.n * sizeof *g->limits.flags.blocks);
    g->engine->state.rows(g, NEAR_CELLS, NULL, count_row, &near);
    return own.count;
}

struct noting { /* context of note_row */
    const struct gas *g;
    struct first_place first;
};

static void note_row(void *noting, const struct row *row) {
    struct noting *c = noting;
    const struct gas *g = c->g;
    const struct polyhedra *m = g->blocks.grid ? g->blocks.grid->polyhedra : NULL;
    for (int i = 0; i < row->n && g->limits.flags.blocks[row->block]; i++) {
        const long at = row->at + i;
        double here[3] = {0, 0, 0};
        if (g->limits.flags.cells[row->block][at] == 0) continue;
        g->limits.flags.limited[row->block][at] += 1;
        for (int k = 0; m && k < g->dim; k++) here[m->axis[k]] = m->centre[k][at];
        if (!m) g->engine->state.place(g, row->block, at, here);
        first_place_offer(&c->first, here);
    }
}

void flags_note(struct gas *g, double place[3]) {
    struct noting c = {.g = g, .first.order = HUGE_VAL};
    g->engine->state.rows(g, EVERY_CELL, NULL, note_row, &c);
    first_place_agree(g, &c.first, place);
}

void flags_hold(struct gas *g, bool back) {
    double **limited = g->limits.flags.limited, **kept = g->limits.flags.kept;
    for (int b = 0; b < g->blocks.n; b++)
        memcpy((back ? limited : kept)[b], (back ? kept : limited)[b], (size_t)g->size * sizeof(double));
}

void flags_clear(struct gas *g) {
    for (int b = 0; b < g->blocks.n; b++) memset(g->limits.flags.cells[b], 0, (size_t)g->size * sizeof(double));
    memset(g->limits.flags.blocks, 0, (size_t)g->blocks.n * sizeof *g->limits.flags.blocks);
}

long flags_of_marks(struct gas *g, bool keep) {
    for (int b = 0; b < g->blocks.n && g->limits.flags.marked; b++) {
        for (long i = 0; keep && i < g->size; i++) g->limits.flags.cells[b][i] += g->limits.flags.mark[b][i];
        memset(g->limits.flags.mark[b], 0, (size_t)g->size * sizeof(double));
    }
    g->limits.flags.marked = false;
    if (!keep) return 0;
    g->diffusion.plain = true;
    return flags_send(g);
}
