/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cells in which grains find their neighbours (struct grain_cells in grains_private.h): their layout, and grains
 * that enter, leave and cross them. */
#include "libcore/grains/grains_private.h"

/* Divides axis k into cells at least `width` wide, at most `most` of them. */
static void divide(struct grain_cells *c, int k, double width, int most) {
    double count = floor((c->high[k] - c->low[k]) / width * (1 - 1e-12));
    c->n[k] = (int)fmax(1, fmin(count, most));
    c->width[k] = (c->high[k] - c->low[k]) / c->n[k];
    c->bits[k] = 0;
    while ((1 << c->bits[k]) < c->n[k]) c->bits[k]++;
}

/* Finds the cells in which a grain can touch a wall. */
static void set_reach(struct grains *g, int k, double diameter) {
    struct grain_cells *c = &g->cells;
    double far = (is_shaken(&g->box, k) ? 2 * fabs(g->box.shake[k]) : 0) + 0.5 * diameter;
    far *= 1 + 1e-9;
    c->reach[k][0] = -1;
    c->reach[k][1] = c->n[k];
    if (g->box.periodic[k] || g->box.facets) return;
    while (c->reach[k][0] + 1 < c->n[k] && grains_cell_edge(c, k, c->reach[k][0] + 1) <= c->low[k] + far)
        c->reach[k][0]++;
    while (c->reach[k][1] > 0 && grains_cell_edge(c, k, c->reach[k][1]) >= c->high[k] - far) c->reach[k][1]--;
}

static bool too_many(const struct grains *g) {
    const struct grain_cells *c = &g->cells;
    double total = (double)c->n[0] * c->n[1] * c->n[2];
    return total > 8. * g->n + 1000 || c->bits[0] + c->bits[1] + c->bits[2] > 30;
}

/* Chooses cells for grains of the diameter; grains that grow get a tenth more. Returns false if a periodic axis has no
 * room for three. */
static bool choose(struct grains *g, double diameter) {
    struct grain_cells *c = &g->cells;
    for (double width = diameter * (g->law.growth > 0 ? 1.1 : 1);; width *= 1.1) {
        for (int k = 0; k < 3; k++) divide(c, k, width, k < g->dim ? 1 << 20 : 1);
        if (!too_many(g)) break;
    }
    double least = HUGE_VAL;
    for (int k = 0; k < g->dim; k++) {
        if (g->box.periodic[k] && c->n[k] < 3) divide(c, k, (c->high[k] - c->low[k]) / 3.5, 3);
        if (g->box.periodic[k] && c->width[k] < diameter) return false;
        least = fmin(least, c->n[k] > 1 ? c->width[k] : HUGE_VAL);
    }
    for (int k = 0; k < g->dim; k++) set_reach(g, k, g->law.growth > 0 ? fmin(least, c->width[k]) : diameter);
    g->outgrown = g->law.growth > 0 ? g->start + (least - g->law.diameter) / g->law.growth : HUGE_VAL;
    return true;
}

/* Returns what a place along axis k adds to the index. Cells lie in memory by cubes of 2, these by cubes of 4 (in 2D
 * squares), so that the neighbours of a cell are in few lines of the cache. */
static int32_t index_part(int place, int k, int dim, int32_t stride) {
    return (place & 1) << k | (place >> 1 & 1) << (dim + k) | (place >> 2) * stride;
}

static void set_rows(struct grains *g) {
    struct grain_cells *c = &g->cells;
    int32_t stride = 1 << 2 * g->dim;
    c->planes = g->dim > 2 ? 3 : 1;
    for (int k = 0; k < g->dim; k++) {
        int n = c->n[k], beyond = !g->box.periodic[k]; /* layers of cells before the first */
        for (int q = 0; q < n; q++) {
            struct grain_row *r = &c->row[k][q];
            for (int side = -1; side <= 1; side++) {
                int place = beyond ? q + side + 1 : (q + side + n) % n;
                r->around[side + 1] = index_part(place, k, g->dim, stride);
            }
            /* with few cells the nearest image may lie behind others */
            r->wraps = !beyond && (n < 5 || q == 0 || q == n - 1);
            r->edge[0] = beyond && q == 0 ? -HUGE_VAL : grains_cell_edge(c, k, q);
            r->edge[1] = beyond && q == n - 1 ? HUGE_VAL : grains_cell_edge(c, k, q + 1);
        }
        stride *= (n + 2 * beyond + 3) / 4;
    }
    c->all = stride;
}

bool grains_cells_widen(struct grains *g) {
    if (!choose(g, grains_diameter(g, g->time) * (1 + 1e-9))) return false;
    set_rows(g);
    for (int i = 0; i < g->n; i++) g->event[i].cell = grains_cell_of(g, g->grain[i].x);
    grains_cells_fill(g);
    return !grains_facets_make(g);
}

status grains_cells_make(struct grains *g) {
    struct grain_cells *c = &g->cells;
    for (int k = 0; k < 3; k++) {
        bool solved = k < g->dim;
        double more = solved && is_shaken(&g->box, k) ? fabs(g->box.shake[k]) : 0;
        c->low[k] = solved ? g->box.low[k] - more : -1;
        c->high[k] = solved ? g->box.high[k] + more : 1;
    }
    choose(g, g->law.diameter);
    for (int k = 0; k < 3; k++) TRY(allocate(&c->row[k], c->n[k], sizeof *c->row[k], "cells"));
    set_rows(g);
    TRY(allocate(&c->slot, (long)c->all * SLOTS, sizeof *c->slot, "cells"));
    TRY(allocate(&c->next, g->n, sizeof *c->next, "cells"));
    return grains_facets_make(g);
}

int32_t grains_cell_of(const struct grains *g, const double x[3]) {
    const struct grain_cells *c = &g->cells;
    int32_t cell = 0;
    for (int k = 2; k >= 0; k--) {
        double q = floor((x[k] - c->low[k]) / c->width[k]);
        cell = (int32_t)(((uint32_t)cell << c->bits[k]) | (uint32_t)fmax(0, fmin(q, c->n[k] - 1)));
    }
    return cell;
}

static const uint32_t INDEX = ((uint32_t)1 << SLOT_BITS) - 1, SLOTS_FULL = (uint32_t)SLOTS << SLOT_BITS;

static uint32_t *slots_of(struct grain_cells *c, int32_t cell) {
    long q = 0;
    for (int k = 0; k < 3; k++) q += cell_row(c, cell, k)->around[1];
    return c->slot + q * SLOTS;
}

/* Takes the count out of the slots, so that all of them hold indices until put_count puts it back. */
static int take_count(uint32_t *slot) {
    uint32_t count = slot[SLOTS - 1] >> SLOT_BITS;
    slot[SLOTS - 1] &= INDEX;
    return (int)count;
}
static void put_count(uint32_t *slot, int count) {
    slot[SLOTS - 1] |= (uint32_t)count << SLOT_BITS;
}

void grains_cell_enter(struct grains *g, int i) {
    struct grain_cells *c = &g->cells;
    uint32_t *slot = slots_of(c, g->event[i].cell);
    int count = take_count(slot);
    if (count < SLOTS) {
        slot[count++] = (uint32_t)i;
    } else {
        c->next[i] =
            count == SLOTS ? (c->next[slot[SLOTS - 1]] = -1, (int32_t)slot[SLOTS - 1]) : (int32_t)slot[SLOTS - 1];
        slot[SLOTS - 1] = (uint32_t)i;
        count = CHAINED;
    }
    put_count(slot, count);
}

void grains_cells_fill(struct grains *g) {
    struct grain_cells *c = &g->cells;
    for (long q = 0; q < c->all; q++) c->slot[q * SLOTS + SLOTS - 1] = 0;
    for (int i = 0; i < g->n; i++)
        if (!is_gone(g, i)) grains_cell_enter(g, i);
}

/* Takes grain i out of its cell: the last grain in the slots (in a chain: the first of the chain) takes its place. */
void grains_cell_leave(struct grains *g, int i) {
    struct grain_cells *c = &g->cells;
    uint32_t *slot = slots_of(c, g->event[i].cell);
    int count = take_count(slot), last = (count == CHAINED ? SLOTS : count) - 1, at = 0;
    while (at < last && slot[at] != (uint32_t)i) at++;
    int32_t moved = (int32_t)slot[last];
    if (count < CHAINED) {
        slot[at] = (uint32_t)moved;
        put_count(slot, count - 1);
        return;
    }
    slot[last] = (uint32_t)c->next[moved];
    if (at < last) {
        slot[at] = (uint32_t)moved;
    } else if (moved != i) {
        int32_t before = (int32_t)slot[last];
        if (before == i) {
            slot[last] = (uint32_t)moved;
            c->next[moved] = c->next[i];
        } else {
            while (c->next[before] != i) before = c->next[before];
            c->next[before] = moved;
            c->next[moved] = c->next[i];
        }
    }
    put_count(slot, c->next[slot[last]] < 0 ? SLOTS : CHAINED);
}

void grains_cell_cross(struct grains *g, int i, int exit) {
    struct grain_cells *c = &g->cells;
    struct grain *p = &g->grain[i];
    int32_t *cell = &g->event[i].cell;
    int k = exit / 2, up = exit & 1, number = cell_number(c, *cell, k), to = number + (up ? 1 : -1);
    grains_cell_leave(g, i);
    const bool through = to < 0 || to == c->n[k];
    if (to < 0) to = c->n[k] - 1;
    if (to == c->n[k]) to = 0;
    p->x[k] = grains_cell_edge(c, k, up ? to : to + 1);
    int shift = k > 0 ? (k > 1 ? c->bits[0] + c->bits[1] : c->bits[0]) : 0;
    *cell += (to - number) * (1 << shift);
    if (through && k == 1 && g->box.shear != 0) grains_shear_wrap(g, i, up);
    grains_cell_enter(g, i);
}

/* Adds the grains of one cell at the end of the list; returns the new end. */
static inline uint32_t *add_occupants(const uint32_t *slot, const int32_t *next, uint32_t *end) {
    uint32_t last = slot[SLOTS - 1];
    memcpy(end, slot, SLOTS * sizeof *end); /* all slots, so that nothing branches */
    if (last < SLOTS_FULL) return end + (last >> SLOT_BITS);
    end += SLOTS;
    end[-1] = last & INDEX;
    if (last >> SLOT_BITS == CHAINED)
        for (int32_t i = next[last & INDEX]; i >= 0; i = next[i]) *end++ = (uint32_t)i;
    return end;
}

int grains_occupants(const struct grain_cells *c, const struct grain_block *b, uint32_t *list) {
    const int32_t *next = c->next;
    uint32_t *end = list;
    long x[3];
    int width = b->to[0] - b->from[0];
    for (int k = 0; k < width; k++) x[k] = (long)b->around[0][b->from[0] + k] * SLOTS;
    for (int z = b->from[2]; z < b->to[2]; z++)
        for (int y = b->from[1]; y < b->to[1]; y++) {
            const uint32_t *row = c->slot + (long)(b->around[2][z] + b->around[1][y]) * SLOTS;
            end = add_occupants(row + x[0], next, end);
            if (width == 1) continue;
            end = add_occupants(row + x[1], next, end);
            end = add_occupants(row + x[2], next, end);
        }
    return (int)(end - list);
}
