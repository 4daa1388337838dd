/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The spans of states (struct state of libcore/gas/engine.h): they follow the rows that are written, and backgrounds
 * become cells. On polyhedra there are none. */
#include "libcore/gas/gas_private.h"

static void ignore_row(void *context, const struct row *row) {
    (void)context;
    (void)row;
}

void spans_write_out(const struct gas *g, const struct state *s) {
    if (s->varied) g->engine->state.rows(g, EVERY_CELL, s, ignore_row, NULL);
}

void spans_keep_as(const struct gas *g, const struct state *from, const struct state *to) {
    for (int b = 0; b < g->blocks.n && to->varied != from->varied; b++) {
        memcpy(to->varied[b], from->varied[b], (size_t)from->nspans * sizeof(struct span));
        to->narrow[b] = from->narrow[b];
        to->calm[b] = from->calm[b];
    }
}

void spans_join(const struct gas *g, const struct state *a, const struct state *b) {
    spans_write_out(g, a);
    spans_write_out(g, b);
    for (int t = 0; t < g->blocks.n && a->varied; t++) {
        a->narrow[t] = b->narrow[t] = a->calm[t] = b->calm[t] = false;
        for (int i = 0; i < a->nspans; i++)
            a->varied[t][i] = b->varied[t][i] = span_join(a->varied[t][i], b->varied[t][i]);
    }
}

void spans_unfold(struct gas *g, const struct state *s, const bool *blocks) {
    for (int b = 0; b < g->blocks.n && s->varied; b++)
        if (!blocks || blocks[b]) g->engine->state.unfold(g, b, s);
}

void spans_unfold_bad(struct gas *g, const struct state *s) {
    for (int b = 0; b < g->blocks.n && s->varied; b++)
        if (row_inadmissible(g, s->block[b], 0, 1, NULL)) g->engine->state.unfold(g, b, s);
}
