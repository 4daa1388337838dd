/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sorts grains so that those near each other in space lie near each other in memory: into the order of a Z-curve
 * through the cells when they are made, and again each time there were IMPACTS pair impacts per grain. That moment
 * follows from the counts alone, and the order is saved, so it is the same in whatever pieces a run is made. */
#include "libcore/grains/grains_private.h"

#include <stdlib.h>

enum { FEW = 2000, IMPACTS = 8 /* pair impacts per grain */ }; /* FEW grains fit into a cache in any order */

/* Returns the place of a cell on the curve: the bits of its numbers in turn. */
static uint64_t curve(const struct grain_cells *c, int32_t cell) {
    uint64_t code = 0;
    int to = 0;
    for (int bit = 0; bit < 31; bit++)
        for (int k = 0; k < 3; k++)
            if (bit < c->bits[k]) code |= (uint64_t)((cell_number(c, cell, k) >> bit) & 1) << to++;
    return code;
}

static int by_key(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Moves grain order[p] to p, cycle by cycle; order becomes the identity. */
static void permute(struct grains *g, uint64_t *order) {
    for (int p = 0; p < g->n; p++) {
        struct grain grain = g->grain[p];
        struct grain_event event = g->event[p];
        int32_t id = g->id[p];
        uint8_t kind = g->kind ? g->kind[p] : 0;
        int to = p;
        for (int from = (int)order[p]; from != p; from = (int)order[to]) {
            g->grain[to] = g->grain[from];
            g->event[to] = g->event[from];
            g->id[to] = g->id[from];
            if (g->kind) g->kind[to] = g->kind[from];
            order[to] = (uint64_t)to;
            to = from;
        }
        g->grain[to] = grain;
        g->event[to] = event;
        g->id[to] = id;
        if (g->kind) g->kind[to] = kind;
        order[to] = (uint64_t)to;
    }
}

void grains_set_kinds(struct grains *g) {
    const struct grain_kinds *all = &g->law.kinds;
    for (int i = 0; g->kind && i < g->n; i++) {
        int k = 0;
        while (k < all->n - 1 && g->id[i] >= all->first[k + 1]) k++;
        g->kind[i] = (uint8_t)k;
    }
}

void grains_set_sorting(struct grains *g) {
    int64_t every = (int64_t)IMPACTS * g->n;
    g->sort_at = g->n > FEW ? (g->counts.pairs / every + 1) * every : -1;
}

void grains_sort(struct grains *g) {
    const uint64_t index = ((uint64_t)1 << 32) - 1;
    int32_t *place = g->cells.next; /* free until the cells are filled again */
    grains_set_sorting(g);
    if (g->n <= FEW) return;
    for (int i = 0; i < g->n; i++) g->order[i] = curve(&g->cells, g->event[i].cell) << 32 | (uint64_t)i;
    qsort(g->order, (size_t)g->n, sizeof *g->order, by_key);
    for (int p = 0; p < g->n; p++) {
        g->order[p] &= index;
        place[g->order[p]] = p;
    }
    for (int i = 0; i < g->n; i++)
        if (g->event[i].partner >= 0) g->event[i].partner = place[g->event[i].partner];
    permute(g, g->order);
    grains_cells_fill(g);
    grains_vacant_find(g);
}
