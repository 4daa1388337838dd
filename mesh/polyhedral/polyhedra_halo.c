/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exchanges the ghosts of a polyhedral mesh: one message per neighbour rank fills them. */
#include <stdlib.h>
#include <string.h>

#include "mesh/polyhedral/polyhedra_private.h"

/* ---- the plan ---------------------------------------------------------------------------------------------------- */

struct name { /* a cell of this rank */
    int cell, local;
};

static int by_name(const void *a, const void *b) {
    const struct name *p = a, *q = b;
    return (p->cell > q->cell) - (p->cell < q->cell);
}

/* Replaces cells by their numbers on this rank. */
static status find_cells(const struct polyhedra *m, int n, int *cell) {
    struct name *name;
    TRY(allocate(&name, m->nown, sizeof *name, "the exchange of ghosts"));
    for (int i = 0; i < m->nown; i++) name[i] = (struct name){m->cell[i], i};
    if (m->nown) qsort(name, (size_t)m->nown, sizeof *name, by_name);
    for (int i = 0; i < n; i++) {
        const struct name wanted = {cell[i], 0},
                          *found = bsearch(&wanted, name, (size_t)m->nown, sizeof *name, by_name);
        cell[i] = found->local; /* its rank was asked for it */
    }
    free(name);
    return OK;
}

/* Plans link by link which cells leave (in the order of the receiver's ghosts) and which arrive. */
static status plan(struct polyhedra *m, const struct delivery *wanted) {
    struct polyhedra_private *h = m->hidden;
    const int ranks = comm_size(m->comm), nghosts = m->ncells - m->nown, *count = wanted->count;
    int sent = 0, received = 0;
    TRY(pool_take(&m->pool, &h->link, ranks, sizeof *h->link, "the exchange of ghosts"));
    TRY(pool_take(&m->pool, &h->send_start, ranks + 1L, sizeof *h->send_start, "the exchange of ghosts"));
    TRY(pool_take(&m->pool, &h->receive_start, ranks + 1L, sizeof *h->receive_start, "the exchange of ghosts"));
    TRY(pool_take(&m->pool, &h->receive, nghosts, sizeof *h->receive, "the exchange of ghosts"));
    TRY(pool_take(&m->pool, &h->send, wanted->arrived, sizeof *h->send, "the exchange of ghosts"));
    for (int i = 0; i < nghosts; i++) h->receive[i] = m->nown + wanted->order[i];
    for (int r = 0; r < ranks; r++) {
        const int leaving = wanted->arriving[r];
        if (leaving == 0 && count[r] == 0) continue;
        h->link[h->nlinks++] = (struct comm_link){.rank = r, .n = leaving > count[r] ? leaving : count[r]};
        h->send_start[h->nlinks] = sent += leaving;
        h->receive_start[h->nlinks] = received += count[r];
    }
    if (sent) memcpy(h->send, wanted->in, (size_t)sent * sizeof *h->send);
    return find_cells(m, sent, h->send);
}

static status make_buffers(struct polyhedra *m) {
    struct polyhedra_private *h = m->hidden;
    for (int i = 0; i < h->nlinks; i++) {
        long n = h->link[i].n * POLYHEDRA_VARIABLES;
        TRY(pool_take(&m->pool, &h->link[i].out, n, sizeof *h->link[i].out, "the exchange of ghosts"));
        TRY(pool_take(&m->pool, &h->link[i].in, n, sizeof *h->link[i].in, "the exchange of ghosts"));
    }
    return comm_exchange_make(m->comm, h->nlinks, h->link, &h->exchange);
}

/* Each rank tells the others which of their cells are ghosts here. */
status halo_make(struct polyhedra *m, const int *rank) {
    const long n = m->ncells - m->nown;
    struct delivery wanted;
    status s = delivery_begin(m->comm, n, 1, "the exchange of ghosts", &wanted);
    if (!s && n) memcpy(wanted.rank, rank, (size_t)n * sizeof *rank);
    if (!s && n) memcpy(wanted.record, m->cell + m->nown, (size_t)n * sizeof *m->cell);
    if (!s) s = delivery_send(&wanted);
    if (!s) {
        s = plan(m, &wanted);
        if (!s) s = make_buffers(m);
        s = comm_agree(m->comm, s);
    }
    delivery_free(&wanted);
    return s;
}

void polyhedra_fill_start(struct polyhedra *m, int nvar, double *const *data) {
    struct polyhedra_private *h = m->hidden;
    h->nvar = nvar;
    h->data = data;
    for (int i = 0; i < h->nlinks; i++) {
        const int *cell = h->send + h->send_start[i], n = h->send_start[i + 1] - h->send_start[i];
        for (int v = 0; v < nvar; v++)
            for (int j = 0; j < n; j++) h->link[i].out[v * h->link[i].n + j] = data[v][cell[j]];
    }
    comm_exchange_start(h->exchange, nvar);
}

void polyhedra_fill_finish(struct polyhedra *m) {
    struct polyhedra_private *h = m->hidden;
    comm_exchange_finish(h->exchange);
    for (int i = 0; i < h->nlinks; i++) {
        const int *ghost = h->receive + h->receive_start[i], n = h->receive_start[i + 1] - h->receive_start[i];
        for (int v = 0; v < h->nvar; v++)
            for (int j = 0; j < n; j++) h->data[v][ghost[j]] = h->link[i].in[v * h->link[i].n + j];
    }
}

/* In a message an int has the room of a double. */
void polyhedra_fill_int(struct polyhedra *m, int *data) {
    struct polyhedra_private *h = m->hidden;
    for (int i = 0; i < h->nlinks; i++)
        for (int j = h->send_start[i]; j < h->send_start[i + 1]; j++)
            ((int *)h->link[i].out)[j - h->send_start[i]] = data[h->send[j]];
    comm_exchange_start(h->exchange, 1);
    comm_exchange_finish(h->exchange);
    for (int i = 0; i < h->nlinks; i++)
        for (int j = h->receive_start[i]; j < h->receive_start[i + 1]; j++)
            data[h->receive[j]] = ((int *)h->link[i].in)[j - h->receive_start[i]];
}
