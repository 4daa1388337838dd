/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Looks up the sites of a lattice (sites.h): places of cells, cells at places, faces on patches. */
#include "mesh/format/sites.h"

#include <stdlib.h>

void sites_drop(struct sites *s) {
    free(s->place);
    free(s->cell);
    s->place = NULL;
    s->cell = NULL;
}

void sites_free(struct sites *s) {
    if (!s) return;
    sites_drop(s);
    free(s->face);
    free(s);
}

static int by_place(const void *a, const void *b) {
    const struct site_face *p = a, *q = b;
    return p->place != q->place ? (p->place > q->place) - (p->place < q->place) : p->side - q->side;
}

void sites_sort(struct sites *s) {
    qsort(s->face, (size_t)s->nfaces, sizeof *s->face, by_place);
}

long sites_place(const struct sites *s, const int at[3]) {
    return at[0] + s->n[0] * (at[1] + (long)s->n[1] * at[2]);
}

void sites_at(const struct sites *s, long place, int at[3]) {
    at[0] = (int)(place % s->n[0]);
    at[1] = (int)(place / s->n[0] % s->n[1]);
    at[2] = (int)(place / s->n[0] / s->n[1]);
}

void sites_centre(const struct sites *s, long cell, double x[3]) {
    int at[3];
    sites_at(s, s->place[cell - s->cells.first], at);
    for (int k = 0; k < 3; k++) x[k] = s->closed[k] ? s->middle[k] : s->low[k] + s->width[k] * (at[k] + 0.5);
}

int sites_patch(const struct sites *s, const int at[3], int side, long *face) {
    const struct site_face key = {.place = (int)sites_place(s, at), .side = (short)side},
                           *found = bsearch(&key, s->face, (size_t)s->nfaces, sizeof key, by_place);
    *face = found ? found->face : -1;
    return found ? found->patch : -1;
}

enum { ROUND = 1 << 16 };

status sites_name(const struct sites *s, long n, int *place) {
    double *cell = NULL, longest = (double)n;
    const struct comm *c = s->places.comm;
    TRY(comm_agree(c, allocate(&cell, n < ROUND ? n : ROUND, sizeof *cell, "cells of a lattice")));
    comm_max(c, &longest, 1);
    status e = OK;
    for (long at = 0; !e && (double)at < longest; at += ROUND) {
        const long left = n - at, now = left < 0 ? 0 : left < ROUND ? left : ROUND;
        e = share_fetch(&s->places, 1, s->cell, now, place + (now ? at : 0), cell);
        for (long i = 0; !e && i < now; i++) place[at + i] = (int)cell[i];
    }
    free(cell);
    return e;
}
