/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Asks memory for what the next batch of a fit reads, part by part, while this one computes. A batch reads a few pieces
 * of some kB, which are too short for a processor to see streams in them; asked for at once, they would wait for each
 * other. No result depends on it. */
#include "libcore/schemes/polynomial_fit.h"

enum { PARTS = 16, LINE = 64 }; /* parts of a batch; bytes of a line of a cache */

static void add_piece(struct ahead *a, const void *data, size_t size, long from, long to) {
    if (from >= to) return;
    a->at[a->n] = (const char *)data + from * (long)size;
    a->left[a->n++] = ((to - from) * (long)size + LINE - 1) / LINE;
}
static void add_entries(struct ahead *a, const struct entries *r, int batch) {
    if (!r->start) return;
    const long from = r->start[batch] * (long)LANES, to = r->start[batch + 1] * (long)LANES;
    if (r->cell) add_piece(a, r->cell, sizeof *r->cell, from, to);
    add_piece(a, r->data, sizeof *r->data, from * r->width, to * r->width);
}

void ahead_list(const struct fit *f, int batch) {
    struct ahead *a = f->ahead;
    const struct sectors *s = &f->sector;
    long lines = 0;
    a->n = a->now = 0;
    if (batch >= f->nbatches) return;
    if (s->start) {
        const long from = s->start[batch], to = s->start[batch + 1], each = f->polyhedra->dim * LANES;
        add_piece(a, s->data, sizeof *s->data, s->first[from] * each, s->first[to] * each);
        add_piece(a, s->share, sizeof *s->share, from * LANES, to * LANES);
    }
    add_entries(a, &f->member, batch);
    add_entries(a, &f->halfway, batch);
    add_entries(a, &f->moment, batch);
    add_entries(a, &f->point, batch);
    for (int k = 0; k < a->n; k++) lines += a->left[k];
    a->part = lines / PARTS + 1;
}

void ahead_ask(const struct fit *f) {
    struct ahead *a = f->ahead;
    for (long left = a->part; left > 0 && a->now < a->n;) {
        const char *at = a->at[a->now];
        const long here = left < a->left[a->now] ? left : a->left[a->now];
        for (long i = 0; i < here; i++) __builtin_prefetch(at + i * LINE);
        a->at[a->now] += here * LINE;
        a->left[a->now] -= here;
        a->now += a->left[a->now] == 0;
        left -= here;
    }
}
