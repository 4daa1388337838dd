/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The messages of a bed: what its faces towards cells of other ranks need, and nothing else. A rank that has no such
 * face sends no message. */
#include "libcore/acoustics/bed_private.h"

#include <stdlib.h>

struct parcel {    /* one number on its way */
    int rank;      /* the other one */
    int of, local; /* the cell, as the rank that owns it counts its cells; its place here */
};

struct bed_halo {
    const int *first; /* [ranks + 1] numbers of the ranks' first cells over all ranks */
    int parcels;      /* that go out; as many come in */
    struct parcel *out, *in;
    int links, *start; /* [links + 1] first parcels of each link, alike in `out` and `in` */
    struct comm_link *link;
    double *numbers; /* [2 * parcels * lines] of all links */
    struct comm_exchange *exchange;
};

static int by_rank(const void *a, const void *b) {
    const struct parcel *x = a, *y = b;
    if (x->rank != y->rank) return x->rank < y->rank ? -1 : 1;
    if (x->of != y->of) return x->of < y->of ? -1 : 1;
    return (x->local > y->local) - (x->local < y->local);
}

static void forget(struct bed_halo *h) {
    comm_exchange_free(h->exchange);
    free(h->out);
    free(h->start);
    free(h->link);
    free(h->numbers);
    h->exchange = NULL;
    h->out = NULL;
    h->start = NULL;
    h->link = NULL;
    h->numbers = NULL;
    h->parcels = h->links = 0;
}

void bed_halo_free(struct bed_halo *h) {
    if (!h) return;
    forget(h);
    free(h);
}

static int owner_of(const struct bed_halo *h, int ranks, int number) {
    int low = 0, high = ranks;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (h->first[middle] <= number)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* Lists a parcel each way for each face between a cell and a ghost. Links are mutual: what a rank sends to another by
 * the numbers of its own cells is what that one expects by the numbers of its ghosts. */
static void list_parcels(const struct bed *b, const int *number) {
    struct bed_halo *h = b->halo;
    const int ranks = comm_size(b->comm);
    h->parcels = 0;
    for (int f = 0; f < b->set.faces; f++) {
        const bool left = b->set.left[f] >= b->set.cells;
        const int ghost = left ? b->set.left[f] : b->set.right[f], cell = left ? b->set.right[f] : b->set.left[f];
        if (ghost < b->set.cells) continue;
        const int name = number[ghost - b->set.cells], owner = owner_of(h, ranks, name);
        h->out[h->parcels] = (struct parcel){owner, cell, cell};
        h->in[h->parcels++] = (struct parcel){owner, name - h->first[owner], ghost};
    }
    qsort(h->out, (size_t)h->parcels, sizeof *h->out, by_rank);
    qsort(h->in, (size_t)h->parcels, sizeof *h->in, by_rank);
}

static int count_faces(const struct bed *b) {
    int n = 0;
    for (int f = 0; f < b->set.faces; f++) n += b->set.left[f] >= b->set.cells || b->set.right[f] >= b->set.cells;
    return n;
}

status bed_halo_link(struct bed *b, const int *first, const int *number) {
    const int n = count_faces(b), lines = b->components + 2;
    if (!b->halo) TRY(allocate(&b->halo, 1, sizeof *b->halo, "the bed"));
    struct bed_halo *h = b->halo;
    forget(h);
    h->first = first;
    TRY(allocate(&h->out, 2L * n, sizeof *h->out, "the bed"));
    TRY(allocate(&h->start, n + 1L, sizeof *h->start, "the bed"));
    TRY(allocate(&h->link, n, sizeof *h->link, "the bed"));
    TRY(allocate(&h->numbers, 2L * n * lines, sizeof(double), "the bed"));
    h->in = h->out + n;
    list_parcels(b, number);
    for (int i = 0; i < n; i++)
        if (i == 0 || h->in[i].rank != h->in[i - 1].rank) h->start[h->links++] = i;
    h->start[h->links] = n;
    for (int l = 0; l < h->links; l++) {
        double *mine = h->numbers + (long)lines * h->start[l];
        h->link[l] =
            (struct comm_link){h->in[h->start[l]].rank, h->start[l + 1] - h->start[l], mine, mine + (long)lines * n};
    }
    return comm_exchange_make(b->comm, h->links, h->link, &h->exchange);
}

void bed_fill_send(const struct bed *b, int n, const double *const *line) {
    const struct bed_halo *h = b->halo;
    if (!h) return;
    for (int l = 0; l < h->links; l++) {
        double *to = h->link[l].out;
        for (int v = 0; v < n; v++)
            for (int i = h->start[l]; i < h->start[l + 1]; i++) *to++ = line[v][h->out[i].local];
    }
    comm_exchange_start(h->exchange, n);
}

void bed_fill_receive(const struct bed *b, int n, double *const *line) {
    const struct bed_halo *h = b->halo;
    if (!h) return;
    comm_exchange_finish(h->exchange);
    for (int l = 0; l < h->links; l++) {
        const double *from = h->link[l].in;
        for (int v = 0; v < n; v++)
            for (int i = h->start[l]; i < h->start[l + 1]; i++) line[v][h->in[i].local] = *from++;
    }
}

void bed_fill(const struct bed *b, int n, double *const *line) {
    bed_fill_send(b, n, (const double *const *)line);
    bed_fill_receive(b, n, line);
}
