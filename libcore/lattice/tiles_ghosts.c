/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ghost cells of a tile at its sides that are patches. */
#include "libcore/gas/patch.h"
#include "libcore/lattice/tiles.h"

struct line { /* a run of cells along a side of a tile, and their ghosts in one layer */
    struct patch_line patch;
    long step;        /* from cell to cell */
    long first, from; /* offsets of the first cell inside and of the cell that the ghost is made from */
    long ghost;
    long inward;  /* from cell to cell into the tile; 0: it has one cell there */
    int layer;    /* of the ghosts: 1, 2, .. */
    double out;   /* +1 at the high side, -1 at the low side */
    bool on_axis; /* of a body of revolution? There swirl changes its sign */
};

static void fill_line(const struct gas *g, const struct patch_rules *r, struct line *l, double *U) {
    const long size = g->forest->size;
    double inner[MAX_VAR][BATCH], next[MAX_VAR][BATCH], ghost[MAX_VAR][BATCH], outflow[BATCH];
    int n = l->patch.n;
    if (patch_needs_values(r)) {
        const double *rho = U + l->first, *mom = U + (l->patch.normal + 1) * size + l->first;
        for (int i = 0; i < n; i++) outflow[i] = l->out * (mom[i * l->step] / rho[i * l->step]);
        l->patch.outflow = outflow;
    }
    if (g->patches.renew && l->inward && patch_needs_values(r)) {
        for (int v = 0; v < g->nvar; v++)
            for (int i = 0; i < n; i++) next[v][i] = U[v * size + l->first + l->inward + i * l->step];
        l->patch.next = next;
        l->patch.layer = l->layer;
    }
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < n; i++) inner[v][i] = U[v * size + l->from + i * l->step];
    patch_ghosts(g, r, &l->patch, inner, ghost);
    for (int i = 0; i < n && l->on_axis; i++) ghost[g->models.swirl + 1][i] = -ghost[g->models.swirl + 1][i];
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < n; i++) U[v * size + l->ghost + i * l->step] = ghost[v][i];
}

/* The cell, counted from the side, whose image is ghost layer m = 1, 2, ..: mirrored again by a side closer than m. */
static int image(int m, int n) {
    int at = (m - 1) % (2 * n);
    return at < n ? at : 2 * n - 1 - at;
}

static void side_ghosts(const struct gas *g, const struct tile *t, int axis, int high, int layers, double *U) {
    const struct forest *f = g->forest;
    const struct side *side = &t->side[2 * axis + high];
    const struct patch_rules *r = &g->patches.rules[side->patch];
    int across = axis == 0 ? 1 : 0, deep = axis == 2 ? 1 : 2; /* the other axes */
    long inward = high ? -f->stride[axis] : f->stride[axis];
    for (int k = 0; k < t->n[deep]; k++)
        for (int start = 0; start < t->n[across]; start += BATCH)
            for (int m = 1; m <= layers; m++) {
                struct line l = {
                    .step = f->stride[across], .out = high ? 1 : -1, .layer = m, .patch = {.normal = axis}};
                l.on_axis = g->models.swirl && f->radial == axis && !high && f->inner == 0 && t->low[axis] == 0;
                l.inward = t->n[axis] > 1 ? inward : 0;
                l.patch.n = t->n[across] - start < BATCH ? t->n[across] - start : BATCH;
                l.first = f->first + (high ? (t->n[axis] - 1) * f->stride[axis] : 0) + k * f->stride[deep] +
                          start * f->stride[across];
                l.from = l.first + (patch_is_wall(r) ? image(m, t->n[axis]) : 0) * inward;
                l.ghost = l.first - m * inward;
                l.patch.face = side->face + (long)k * t->n[across] + start;
                fill_line(g, r, &l, U);
            }
}

void ghosts_of_patches(const struct gas *g, int tile, double *U, int layers, const bool *leave) {
    const struct tile *t = &g->forest->tile[tile];
    for (int axis = 0; axis < g->dim; axis++)
        for (int high = 0; high < 2; high++)
            if (t->side[2 * axis + high].patch >= 0 && !(leave && leave[2 * axis + high]))
                side_ghosts(g, t, axis, high, layers, U);
}
