/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lets grains come in at inlets, through open facets (grains.h; docs/physics.md 10.6), and makes
 * room for more of them. */
#include "libcore/grains/grains_private.h"

#include <string.h>

enum { BITS = 64 };

status grains_vacant_make(struct grains *g) {
    TRY(allocate(&g->vacant, g->n / BITS + 1, sizeof *g->vacant, "grains"));
    grains_vacant_find(g);
    return OK;
}

void grains_vacant_find(struct grains *g) {
    if (!g->vacant) return;
    memset(g->vacant, 0, ((size_t)g->n / BITS + 1) * sizeof *g->vacant);
    for (int i = 0; i < g->n; i++)
        if (is_gone(g, i)) g->vacant[i / BITS] |= (uint64_t)1 << i % BITS;
}

/* Returns the first index whose grain has left, so that the choice follows from the state alone; -1: there is none. */
static int first_vacant(const struct grains *g) {
    for (int q = 0; q <= g->n / BITS; q++)
        if (g->vacant[q]) return q * BITS + __builtin_ctzll(g->vacant[q]);
    return -1;
}

bool grains_is_full(const struct grains *g) {
    return first_vacant(g) < 0;
}

/* Returns a grain that a sphere of diameter `own` (over that of the law) about x (m, frame at rest) would cut at the
 * time reached, with all diameters times `wide`; -1: there is none. */
static int nearer(const struct grains *g, int32_t cell, const double x[3], double own, double wide) {
    struct grain_block b;
    grains_block(&g->cells, cell, STAYS, &b);
    for (int q = grains_occupants(&g->cells, &b, g->list) - 1; q >= 0; q--) {
        double y[3], u[3], square = 0;
        const int j = (int)g->list[q];
        const double least = 0.5 * (grains_size(g, j) + own) * (g->law.diameter * wide);
        fly(g, &g->grain[j], g->time, y, u);
        for (int k = 0; k < 3; k++) {
            const double r = nearest(g, k, y[k] - x[k]);
            square += r * r;
        }
        if (square < least * least) return j;
    }
    return -1;
}

/* Is there room for a grain of that size at x (m, frame at rest) at the time reached? */
static bool has_room(const struct grains *g, int32_t cell, const double x[3], double size) {
    const double wide = 1 + 1e-9;
    double at[3];
    if (nearer(g, cell, x, size, wide) >= 0) return false;
    for (int k = 0; k < 3; k++) at[k] = x[k] - grains_swing(&g->box, k, g->time).s;
    return !(facet_cells_nearest(g->box.facets, &g->walls, at, false) < 0.5 * size * (g->law.diameter * wide));
}

/* Moves x and u from the frame of the box to that at rest (way 1) or back (way -1). */
static void change_frame(const struct grains *g, double way, double x[3], double u[3]) {
    for (int k = 0; k < g->dim; k++) {
        const struct swing w = grains_swing(&g->box, k, g->time);
        x[k] += way * w.s;
        u[k] += way * w.v;
        if (g->box.periodic[k]) x[k] = grains_wrap(&g->box, k, x[k]);
    }
}

/* Counts momentum and energy that grain i got from beyond a wall. */
static void count(struct grains *g, int i, int wall, const double before[3], const double after[3]) {
    double *momentum = g->impulse[wall], *came = g->impulse[2 * g->box.facets->space.walls + wall];
    const double mass = grains_mass(g, i);
    for (int k = 0; k < g->dim; k++) {
        momentum[k] -= mass * (after[k] - before[k]);
        came[1] += 0.5 * mass * (after[k] - before[k]) * (after[k] + before[k]);
    }
}

bool grains_enter(struct grains *g, const double x[3], const double u[3], int kind, int wall) {
    struct grain p = {.t = g->time, .impact = HUGE_VAL};
    const int i = first_vacant(g);
    double *came = g->impulse[2 * g->box.facets->space.walls + wall];
    memcpy(p.x, x, sizeof p.x);
    memcpy(p.u, u, sizeof p.u);
    change_frame(g, 1, p.x, p.u);
    const int32_t cell = grains_cell_of(g, p.x);
    if (i < 0 || !has_room(g, cell, p.x, g->kind ? g->law.kinds.size[kind] : 1)) return false;
    g->grain[i] = p;
    if (g->kind) g->kind[i] = (uint8_t)kind;
    g->event[i].cell = cell;
    g->event[i].partner = NO_PARTNER;
    g->event[i].changes++;
    g->vacant[i / BITS] &= ~((uint64_t)1 << i % BITS);
    grains_cell_enter(g, i);
    came[0]++;
    for (int k = 0; k < g->dim; k++) came[2] -= grains_mass(g, i) * g->law.gravity[k] * p.x[k];
    count(g, i, wall, (const double[3]){0}, p.u);
    grains_predict(g, i, g->time);
    return true;
}

int grains_covering(const struct grains *g, const double x[3], double at[3], double u[3]) {
    double point[3] = {x[0], x[1], x[2]}, none[3] = {0};
    change_frame(g, 1, point, none);
    const int i = nearer(g, grains_cell_of(g, point), point, 0, 1);
    if (i < 0) return i;
    fly(g, &g->grain[i], g->time, at, u);
    change_frame(g, -1, at, u);
    return i;
}

void grains_push(struct grains *g, int i, const double du[3], int wall) {
    struct grain *p = &g->grain[i];
    bring(g, p, g->time);
    const double before[3] = {p->u[0], p->u[1], p->u[2]};
    for (int k = 0; k < g->dim; k++) p->u[k] += du[k];
    count(g, i, wall, before, p->u);
    g->event[i].changes++;
    grains_predict(g, i, g->time);
}

/* Copies grains, brought to the time reached, which other cells than before will hold; the rest has left. */
static void copy_grains(const struct grains *old, struct grains *g) {
    for (int i = 0; i < g->n; i++) {
        const bool gone = i >= old->n || is_gone(old, i);
        if (i < old->n) {
            g->grain[i] = old->grain[i];
            g->event[i] = old->event[i];
        }
        g->id[i] = i < old->n ? old->id[i] : i;
        if (g->kind) g->kind[i] = (uint8_t)(i < old->n ? grains_kind_of(old, i) : 0);
        if (!gone) bring(g, &g->grain[i], g->time);
        if (gone) g->grain[i].t = g->time;
        g->grain[i].impact = HUGE_VAL;
        g->event[i].partner = gone ? GONE : NO_PARTNER;
        g->event[i].cell = gone ? 0 : grains_cell_of(g, g->grain[i].x);
    }
}

status grains_grow(struct grains **grains, int n) {
    struct grains *old = *grains, *g = NULL;
    const status e = grains_make_empty(&old->box, &old->law, n, old->time, &g);
    if (e) {
        grains_free(g);
        return e;
    }
    copy_grains(old, g);
    g->counts = old->counts;
    memcpy(g->impulse, old->impulse, (size_t)grains_rows(&g->box) * sizeof *g->impulse);
    grains_set_sorting(g);
    grains_cells_fill(g);
    grains_vacant_find(g);
    grains_predict_all(g);
    grains_free(old);
    *grains = g;
    return OK;
}
