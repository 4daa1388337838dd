/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sorts records by their ranks and sends them (delivery.h). */
#include "mesh/base/delivery.h"

#include <stdlib.h>
#include <string.h>

status delivery_begin(const struct comm *c, long n, int ints, const char *what, struct delivery *out) {
    *out = (struct delivery){.comm = c, .what = what, .ints = ints, .n = n};
    status e = allocate(&out->rank, n, sizeof *out->rank, what);
    if (!e) e = allocate(&out->record, ints * n, sizeof *out->record, what);
    return comm_agree(c, e);
}

/* Sorts the records by the ranks that they are for. */
static status sort(struct delivery *d, int **sorted) {
    const int ranks = comm_size(d->comm), ints = d->ints;
    long *next;
    TRY(allocate(&d->order, d->n, sizeof *d->order, d->what));
    TRY(allocate(&d->count, ranks, sizeof *d->count, d->what));
    TRY(allocate(&d->arriving, ranks, sizeof *d->arriving, d->what));
    TRY(allocate(sorted, ints * d->n, sizeof **sorted, d->what));
    TRY(allocate(&next, ranks + 1L, sizeof *next, d->what));
    for (long i = 0; i < d->n; i++) d->count[d->rank[i]] += ints;
    for (int r = 0; r < ranks; r++) next[r + 1] = next[r] + d->count[r] / ints;
    for (long i = 0; i < d->n; i++) d->order[next[d->rank[i]]++] = (int)i;
    free(next);
    for (long i = 0; i < d->n; i++)
        memcpy(*sorted + ints * i, d->record + (long)ints * d->order[i], (size_t)ints * sizeof **sorted);
    return OK;
}

status delivery_send(struct delivery *d) {
    int *sorted = NULL;
    status e = comm_agree(d->comm, sort(d, &sorted));
    free(d->rank);
    free(d->record);
    d->rank = d->record = NULL;
    if (!e) e = comm_deliver_int(d->comm, sorted, d->count, &d->in, d->arriving);
    for (int r = 0; !e && r < comm_size(d->comm); r++) d->arrived += d->arriving[r] / d->ints;
    free(sorted);
    return e;
}

void delivery_free(struct delivery *d) {
    int *const all[] = {d->rank, d->record, d->order, d->count, d->arriving, d->in};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
}
