/* The cells that find neighbours. */
#include "libcore/grains_private.h"

/* Cells along k: at least `width` wide; a periodic axis keeps three. */
static void divide(struct grain_cells *c, int k, double width, int most) {
    double count = floor((c->high[k] - c->low[k]) / width * (1 - 1e-12));
    c->n[k] = (int)fmax(1, fmin(count, most));
    c->width[k] = (c->high[k] - c->low[k]) / c->n[k];
    c->bits[k] = 0;
    while ((1 << c->bits[k]) < c->n[k]) c->bits[k]++;
}

double grains_cell_edge(const struct grain_cells *c, int k, int number) {
    return number == c->n[k] ? c->high[k] : c->low[k] + number * c->width[k];
}

/* Which cells a wall's contact may lie in. */
static void set_reach(struct grains *g, int k, double diameter) {
    struct grain_cells *c = &g->cells;
    double far = (is_shaken(&g->box, k) ? 2 * fabs(g->box.shake[k]) : 0) + 0.5 * diameter;
    far *= 1 + 1e-9;
    c->reach[k][0] = -1;
    c->reach[k][1] = c->n[k];
    if (g->box.periodic[k]) return;
    while (c->reach[k][0] + 1 < c->n[k] && grains_cell_edge(c, k, c->reach[k][0] + 1) <= c->low[k] + far)
        c->reach[k][0]++;
    while (c->reach[k][1] > 0 && grains_cell_edge(c, k, c->reach[k][1]) >= c->high[k] - far) c->reach[k][1]--;
}

static bool too_many(const struct grains *g) {
    const struct grain_cells *c = &g->cells;
    double total = (double)c->n[0] * c->n[1] * c->n[2];
    return total > 8. * g->n + 1000 || c->bits[0] + c->bits[1] + c->bits[2] > 30;
}

/* Cells for grains of the diameter; those that grow get a tenth more. False: a periodic axis has not three. */
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

static void fill(struct grains *g) {
    struct grain_cells *c = &g->cells;
    for (long q = 0; q < (long)c->n[0] * c->n[1] * c->n[2]; q++) c->count[q] = 0;
    for (int i = 0; i < g->n; i++) {
        g->grain[i].cell = grains_cell_of(g, g->grain[i].x);
        grains_cell_enter(g, i);
    }
}

bool grains_cells_widen(struct grains *g) {
    if (!choose(g, grains_diameter(g, g->time) * (1 + 1e-9))) return false;
    fill(g);
    return true;
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
    long cells = (long)c->n[0] * c->n[1] * c->n[2];
    c->slots = g->dim == 2 ? SLOTS_2D : SLOTS_3D;
    TRY(allocate(&c->count, cells, sizeof *c->count, "cells"));
    TRY(allocate(&c->slot, cells * c->slots, sizeof *c->slot, "cells"));
    return allocate(&c->next, g->n, sizeof *c->next, "cells");
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

void grains_cell_enter(struct grains *g, int i) {
    struct grain_cells *c = &g->cells;
    int32_t q = cell_index(c, g->grain[i].cell), *slot = c->slot + (long)q * c->slots, count = c->count[q]++;
    if (count < c->slots) {
        slot[count] = i;
        return;
    }
    int last = c->slots - 1;
    if (count == c->slots) c->next[slot[last]] = -1;
    c->next[i] = slot[last];
    slot[last] = i;
}

/* The first of a chain, or what stands in the last slot in use, takes its place. */
static void leave(struct grains *g, int i) {
    struct grain_cells *c = &g->cells;
    int32_t q = cell_index(c, g->grain[i].cell), *slot = c->slot + (long)q * c->slots, count = c->count[q]--;
    int last = (count < c->slots ? count : c->slots) - 1, at = 0;
    while (at < last && slot[at] != i) at++;
    if (count <= c->slots) {
        slot[at] = slot[last];
        return;
    }
    int32_t first = slot[last], *link = &slot[last];
    slot[last] = c->next[first];
    if (at < last) {
        slot[at] = first;
        return;
    }
    if (first == i) return;
    while (*link != i) link = &c->next[*link];
    *link = first;
    c->next[first] = c->next[i];
}

void grains_cell_cross(struct grains *g, int i, int exit) {
    struct grain_cells *c = &g->cells;
    struct grain *p = &g->grain[i];
    int k = exit / 2, up = exit & 1, number = cell_number(c, p->cell, k), to = number + (up ? 1 : -1);
    leave(g, i);
    if (to < 0) to = c->n[k] - 1;
    if (to == c->n[k]) to = 0;
    p->x[k] = grains_cell_edge(c, k, up ? to : to + 1);
    int shift = k > 0 ? (k > 1 ? c->bits[0] + c->bits[1] : c->bits[0]) : 0;
    p->cell += (to - number) * (1 << shift);
    grains_cell_enter(g, i);
}

struct grain_block grains_block(const struct grain_cells *c, const bool periodic[3], int32_t cell, int exit) {
    struct grain_block b = {{0}, {{0}}};
    int32_t stride = 1;
    for (int k = 0; k < 3; k++) {
        int number = cell_number(c, cell, k), from = -1, to = 1;
        if (exit != STAYS && exit / 2 == k) from = to = exit & 1 ? 1 : -1;
        for (int q = number + from; q <= number + to; q++) {
            int at = q;
            if (at < 0 || at >= c->n[k]) {
                if (!periodic[k]) continue;
                at += at < 0 ? c->n[k] : -c->n[k];
            }
            b.start[k][b.n[k]++] = at * stride;
        }
        stride *= c->n[k];
    }
    return b;
}

int grains_occupants(const struct grain_cells *c, const struct grain_block *b, int32_t *list) {
    int m = 0, slots = c->slots;
    for (int z = 0; z < b->n[2]; z++)
        for (int y = 0; y < b->n[1]; y++)
            for (int x = 0; x < b->n[0]; x++) {
                int32_t q = b->start[0][x] + b->start[1][y] + b->start[2][z], count = c->count[q];
                const int32_t *slot = c->slot + (long)q * slots;
                if (slots == SLOTS_3D)
                    memcpy(list + m, slot, SLOTS_3D * sizeof *list); /* all of them: no branches */
                else
                    memcpy(list + m, slot, SLOTS_2D * sizeof *list);
                m += count < slots ? count : slots;
                if (count > slots)
                    for (int32_t i = c->next[slot[slots - 1]]; i >= 0; i = c->next[i]) list[m++] = i;
            }
    return m;
}
