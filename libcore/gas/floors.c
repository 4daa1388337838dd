/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Applies the floors of density and of energy (libcore/schemes/limit.h; docs/physics.md 7.3) to the whole state, and
 * keeps account of what they add. */
#include "libcore/gas/gas_private.h"

#include <stdlib.h>

status floors_make(struct gas *g) {
    TRY(allocate(&g->floors.raised, g->floors.places, sizeof(double), "the floors"));
    for (int v = 0; v < 2 && g->limits.least > 0; v++)
        TRY(allocate(&g->floors.fill[v], g->floors.places, sizeof(double), "the floors"));
    return OK;
}

void floors_free(struct gas *g) {
    free(g->floors.raised);
    for (int v = 0; v < 2; v++) free(g->floors.fill[v]);
    for (int k = 0; k < MAX_DIM; k++) free(g->floors.given[k]);
    free(g->falling.denser);
}

void floors_begin(struct gas *g) {
    g->floors.floored = g->floors.filled = 0;
    g->floors.share = 1;
    if (g->dense) g->dense->begun = false;
    memset(g->floors.raised, 0, (size_t)g->floors.places * sizeof *g->floors.raised);
    for (int v = 0; v < 2 && g->limits.least > 0; v++)
        memset(g->floors.fill[v], 0, (size_t)g->floors.places * sizeof *g->floors.fill[v]);
    for (int k = 0; k < MAX_DIM && g->floors.given[k]; k++)
        memset(g->floors.given[k], 0, (size_t)g->floors.places * sizeof *g->floors.given[k]);
}

struct flooring { /* context of floor_row */
    struct gas *g;
    const struct state *s;
    long bad; /* cells that are not admissible all the same */
};

/* Raises cells of a bed in the stages, whose results there are given up: nothing is counted. */
static void floor_bed_row(const struct gas *g, double *U, const double *part, int n) {
    double bad[BATCH], raised, added[2][BATCH];
    for (int i = 0; i < n; i++) {
        if (part[i] == 0 || !find_bad(1, g->components, g->size, g->limits.least, g->limits.most, U + i, bad)) continue;
        if (g->limits.least > 0)
            (void)raise_density(1, g->components, g->size, g->limits.least, g->limits.most, U + i, bad, added);
        (void)raise_energy(1, g->components, g->size, g->limits.least, g->limits.most, U + i, bad, &raised);
    }
}

/* Adds a share of the momentum of a row to g->floors.given, the momentum that the density floor gave. */
static void give(const struct gas *g, const struct row *row, const double *U, double share) {
    const int step = g->floors.step, place = row->block + step * (int)row->at;
    double room[BATCH];
    const double *weight = row_radius(g, row->block, row->at, row->n, room);
    for (int k = 0; k < g->components && g->floors.given[k]; k++)
        for (int i = 0; i < row->n; i++)
            g->floors.given[k][place + i * step] += share * (weight ? weight[i] : 1) * U[(k + 1) * g->size + i];
}

static void floor_row(void *flooring, const struct row *row) {
    struct flooring *f = flooring;
    struct gas *g = f->g;
    double *U = f->s->block[row->block] + row->at, bad[BATCH], raised[BATCH], added[2][BATCH], room[BATCH];
    const int n = row->n, step = g->floors.step, place = row->block + step * (int)row->at;
    if (!find_bad(n, g->components, g->size, g->limits.least, g->limits.most, U, bad)) return;
    if (g->step.hybrid && g->dense->begun) {
        floor_bed_row(g, U, g->dense->part[row->block] + row->at, n);
        if (!find_bad(n, g->components, g->size, g->limits.least, g->limits.most, U, bad)) return;
    }
    const double *weight = row_radius(g, row->block, row->at, n, room);
    if (g->limits.least > 0) {
        give(g, row, U, -g->floors.share);
        g->floors.filled += raise_density(n, g->components, g->size, g->limits.least, g->limits.most, U, bad, added);
        give(g, row, U, g->floors.share);
        for (int v = 0; v < 2; v++)
            for (int i = 0; i < n; i++)
                g->floors.fill[v][place + i * step] +=
                    g->floors.share * (weight ? weight[i] * added[v][i] : added[v][i]);
    }
    g->floors.floored += raise_energy(n, g->components, g->size, g->limits.least, g->limits.most, U, bad, raised);
    for (int i = 0; i < n; i++) {
        g->floors.raised[place + i * step] += weight ? weight[i] * raised[i] : raised[i];
        f->bad += bad[i] > 0;
    }
}

long floors_apply(struct gas *g, const struct state *s) {
    struct flooring f = {.g = g, .s = s};
    spans_unfold_bad(g, s);
    g->engine->state.rows(g, VARIED_CELLS, s, floor_row, &f);
    return f.bad;
}

static status count_fill(struct gas *g) {
    double sum;
    if (!(g->limits.least > 0)) return OK;
    comm_sum_long(g->comm, &g->floors.filled, 1);
    if (!g->floors.filled) return OK;
    for (int v = 0; v < 2; v++) {
        TRY(sum_raised(g, g->floors.fill[v], &sum));
        g->counts.now.fill[v] += sum;
    }
    g->counts.now.filled += g->floors.filled;
    return books_floors(g);
}

status floors_count(struct gas *g) {
    double energy;
    TRY(count_fill(g));
    comm_sum_long(g->comm, &g->floors.floored, 1);
    if (!g->floors.floored) return OK;
    TRY(sum_raised(g, g->floors.raised, &energy));
    g->counts.now.floored += g->floors.floored;
    g->counts.now.energy += energy;
    return OK;
}
