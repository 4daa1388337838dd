/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exchanges the outer layers of slabs (slab.h). */
#include "libcore/segregation/slab.h"

#include <stdlib.h>
#include <string.h>

status slab_make(const struct comm *c, bool cyclic, long layer, struct slab *out) {
    *out = (struct slab){.layer = layer};
    if (!c || comm_size(c) == 1) return OK;
    const int rank = comm_rank(c), size = comm_size(c);
    out->comm = c;
    out->low = cyclic || rank > 0;
    out->high = cyclic || rank < size - 1;
    status e = allocate(&out->below, 4 * layer, sizeof(double), "layers of other ranks");
    TRY(comm_agree(c, e));
    out->above = out->below + layer;
    out->first = out->below + 2 * layer;
    out->last = out->below + 3 * layer;
    int n = 0;
    if (out->low) out->link[n++] = (struct comm_link){(rank + size - 1) % size, layer, out->first, out->below};
    if (out->high) out->link[n++] = (struct comm_link){(rank + 1) % size, layer, out->last, out->above};
    if (n == 2 && out->link[0].rank == out->link[1].rank) { /* the other rank sends its first layer first, too */
        out->link[0].in = out->above;
        out->link[1].in = out->below;
    }
    return comm_agree(c, comm_exchange_make(c, n, out->link, &out->exchange));
}

void slab_free(struct slab *s) {
    free(s->below);
    comm_exchange_free(s->exchange);
    *s = (struct slab){0};
}

void slab_swap(struct slab *s, const double *first, const double *last) {
    if (!s->comm) return;
    memcpy(s->first, first, (size_t)s->layer * sizeof *first);
    memcpy(s->last, last, (size_t)s->layer * sizeof *last);
    comm_exchange_start(s->exchange, 1);
    comm_exchange_finish(s->exchange);
}

void slab_max(const struct slab *s, double *value, int n) {
    if (s->comm) comm_max(s->comm, value, n);
}
void slab_take_turn(const struct slab *s, double *value, int n) {
    if (s->comm) comm_take_turn(s->comm, value, n);
}
void slab_end_turn(const struct slab *s, double *value, int n) {
    if (s->comm) comm_end_turn(s->comm, value, n);
}
