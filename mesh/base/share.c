/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moves values between slices and lists of cells (share.h), in rounds of as many cells a rank as keep messages
 * small. */
#include "mesh/base/share.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const char SENT[] = "cells sent between ranks";
enum { ROUND = 1 << 15, ALL_ROUND = 1 << 25 }; /* cells of a round: of a rank, of all ranks */

static long first_of(const struct share *s, int rank) {
    const long size = comm_size(s->comm), each = s->n / size, rest = s->n % size;
    return each * rank + (rank < rest ? rank : rest);
}

struct share share_at_rank(const struct share *s, int rank) {
    return (struct share){s->comm, s->n, first_of(s, rank), first_of(s, rank + 1)};
}

struct share share_make(const struct comm *c, long n) {
    return share_at_rank(&(struct share){.comm = c, .n = n}, comm_rank(c));
}

/* The first `rest` slices have one cell more than the others. */
int share_rank(const struct share *s, long cell) {
    const long size = comm_size(s->comm), each = s->n / size, rest = s->n % size;
    const long longer = rest * (each + 1);
    return (int)(cell < longer ? cell / (each + 1) : rest + (cell - longer) / each);
}

status share_deliver(const struct share *s, long n, int ints, const int *record, const char *what,
                     struct delivery *out) {
    TRY(delivery_begin(s->comm, n, ints, what, out));
    for (long i = 0; i < n; i++) out->rank[i] = share_rank(s, record[ints * i]);
    if (n) memcpy(out->record, record, (size_t)(ints * n) * sizeof *record);
    return delivery_send(out);
}

struct errand { /* what is to be moved */
    const struct share *share;
    bool store;           /* from the list into the slices? */
    size_t values;        /* of a cell */
    double *slice, *list; /* [cells][values]; the one that is moved from is only read */
};
struct round { /* the cells that a rank lists in one round, and those of its slice that the others list */
    struct delivery cells;
    int *count, *count_others;  /* [ranks] values of the cells listed; of those that the others list */
    double *room, *room_others; /* these values */
};

static void round_free(struct round *r) {
    delivery_free(&r->cells);
    free(r->count);
    free(r->room);
    free(r->room_others);
}

/* Tells the ranks which cells of their slices are listed, and makes room for the values. */
static status round_make(const struct errand *x, int n, const int *cell, struct round *r) {
    const struct comm *c = x->share->comm;
    const int size = comm_size(c), values = (int)x->values;
    TRY(share_deliver(x->share, n, 1, cell, SENT, &r->cells));
    status e = allocate(&r->count, 2L * size, sizeof *r->count, SENT);
    if (!e) e = allocate(&r->room, n * (long)values, sizeof *r->room, SENT);
    if (!e) e = allocate(&r->room_others, r->cells.arrived * values, sizeof *r->room_others, SENT);
    TRY(comm_agree(c, e));
    r->count_others = r->count + size;
    for (int k = 0; k < size; k++) {
        r->count[k] = r->cells.count[k] * values;
        r->count_others[k] = r->cells.arriving[k] * values;
    }
    return OK;
}

/* Copies the values of a cell to `other` or, if not `there`, back. */
static void copy(const struct errand *x, bool there, double *values, double *other) {
    memcpy(there ? other : values, there ? values : other, x->values * sizeof(double));
}

/* Moves the values of the cells listed in one round, the first of which is number `at` of the list. */
static void move_round(const struct errand *x, long at, long n, const struct round *r) {
    const struct comm *c = x->share->comm;
    const size_t m = x->values;
    for (int way = 0; way < 2; way++) { /* first out of the list or the slice, then into the other one */
        const bool out_of = way == 0;
        for (long i = 0; x->store == out_of && i < n; i++)
            copy(x, out_of, x->list + (size_t)(at + r->cells.order[i]) * m, r->room + (size_t)i * m);
        for (long i = 0; x->store != out_of && i < r->cells.arrived; i++)
            copy(x, out_of, x->slice + (size_t)(r->cells.in[i] - x->share->first) * m, r->room_others + (size_t)i * m);
        if (out_of && x->store)
            comm_trade(c, r->room, r->count, r->room_others, r->count_others);
        else if (out_of)
            comm_trade(c, r->room_others, r->count_others, r->room, r->count);
    }
}

static status move(const struct errand *x, long n, const int *cell) {
    const struct comm *c = x->share->comm;
    const int size = comm_size(c);
    const long most = size > ALL_ROUND / ROUND ? ALL_ROUND / size : ROUND;
    double longest = (double)n;
    for (long i = 0; size == 1 && i < n; i++)
        copy(x, x->store, x->list + (size_t)i * x->values, x->slice + (size_t)cell[i] * x->values);
    if (size == 1) return OK;
    comm_max(c, &longest, 1);
    for (long at = 0; (double)at < longest; at += most) {
        const long left = n - at, now = left < 0 ? 0 : left < most ? left : most;
        struct round r = {0};
        const status e = round_make(x, (int)now, cell + (now ? at : 0), &r);
        if (!e) move_round(x, at, now, &r);
        round_free(&r);
        TRY(e);
    }
    return OK;
}

/* Lets an errand name what is only read beside what is written. */
static double *plain(const double *values) {
    return (double *)(uintptr_t)values;
}

status share_fetch(const struct share *s, int components, const double *slice, long n, const int *cell, double *out) {
    const struct errand x = {s, false, (size_t)components, plain(slice), out};
    return move(&x, n, cell);
}

status share_store(const struct share *s, int components, long n, const int *cell, const double *values,
                   double *slice) {
    const struct errand x = {s, true, (size_t)components, slice, plain(values)};
    return move(&x, n, cell);
}

void share_collect(const struct share *s, int components, const double *slice, double *all) {
    const long bytes = components * (long)sizeof(double);
    const int rank = comm_rank(s->comm);
    if (rank > 0) {
        comm_to_root(s->comm, rank, plain(slice), (s->end - s->first) * bytes);
        return;
    }
    memcpy(all, slice, (size_t)(s->end * bytes));
    for (int r = 1; r < comm_size(s->comm); r++)
        comm_to_root(s->comm, r, all + first_of(s, r) * components, (first_of(s, r + 1) - first_of(s, r)) * bytes);
}

status share_gather(const struct share *s, int components, long n, const int *cell, const double *values, double *all) {
    double *slice = NULL;
    if (comm_size(s->comm) == 1) return share_store(s, components, n, cell, values, all);
    status e = allocate(&slice, (s->end - s->first) * components, sizeof *slice, "a slice of a field");
    e = comm_agree(s->comm, e);
    if (!e) e = share_store(s, components, n, cell, values, slice);
    if (!e) share_collect(s, components, slice, all);
    free(slice);
    return e;
}
