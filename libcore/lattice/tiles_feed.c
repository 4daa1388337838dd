/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Faces of patches that give the mass that flows in (libcore/gas/patch.h). */
#include "libcore/gas/patch.h"
#include "libcore/lattice/tiles.h"

bool tiles_fed(const struct gas *g, int tile, int side) {
    const int patch = g->patches.fed ? g->forest->tile[tile].side[side].patch : -1;
    return patch >= 0 && patch_feeds(&g->patches.rules[patch]);
}

/* The face within the patch at a side of a tile that the cell at `offset` has. */
static int face_of(const struct forest *f, const struct tile *t, int side, long offset) {
    const int across = side < 2 ? 1 : 0, deep = side < 4 ? 2 : 1;
    long rest = offset - f->first, at[3] = {0, 0, 0};
    for (int k = f->dim - 1; k >= 0; k--) {
        at[k] = rest / f->stride[k];
        rest -= at[k] * f->stride[k];
    }
    return t->side[side].face[at[deep] * t->n[across] + at[across]];
}

/* Feeds n faces of a strip from face `first` on, at one side of the tile. */
static void feed(const struct gas *g, const double *U, const struct strip *s, int side, int first, int n,
                 double (*out)[BATCH], int column) {
    const struct forest *f = g->forest;
    const struct tile *t = &f->tile[s->tile];
    const struct patch_rules *r = &g->patches.rules[t->side[side].patch];
    const double sign = side % 2 ? -1 : 1; /* of what flows in */
    const long step = f->stride[s->axis];
    double inner[MAX_VAR][BATCH], ghost[MAX_VAR][BATCH], flux[MAX_VAR][BATCH], into[BATCH] = {0};
    int face[BATCH] = {0};
    for (int i = 0; i < n; i++) {
        const long left = s->offset + first + i, in = side % 2 ? left : left + step,
                   beyond = side % 2 ? left + step : left;
        face[i] = face_of(f, t, side, in);
        into[i] = sign * patch_feed(r, g->components, face[i], s->axis);
        for (int v = 0; v < g->nvar; v++) {
            inner[v][i] = U[v * f->size + in];
            ghost[v][i] = U[v * f->size + beyond];
            flux[v][i] = sign * out[v][column + first + i];
        }
    }
    feed_fluxes(g, r, n, face, into, inner, ghost, flux);
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < n; i++) out[v][column + first + i] = sign * flux[v][i];
}

void tiles_feed(const struct gas *g, const double *U, const struct strip *s, double (*out)[BATCH], int column) {
    for (int high = 0; high < 2; high++) {
        const int side = 2 * s->axis + high;
        const int place = (high ? g->forest->tile[s->tile].n[s->axis] - 1 : -1) - s->from; /* of the left cells */
        if (!tiles_fed(g, s->tile, side)) continue;
        if (s->axis == 0 && place >= 0 && place < s->n)
            feed(g, U, s, side, place, 1, out, column);
        else if (s->axis > 0 && place == 0)
            feed(g, U, s, side, 0, s->n, out, column);
    }
}
