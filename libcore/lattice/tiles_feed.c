/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The faces of strips that lie on patches; those that give the mass that flows in (libcore/gas/patch.h). */
#include "libcore/gas/patch.h"
#include "libcore/lattice/tiles.h"

int face_at_side(const struct forest *f, int tile, int side, long offset) {
    const int across = side < 2 ? 1 : 0, deep = side < 4 ? 2 : 1;
    long remains = offset - f->first, at[3] = {0, 0, 0};
    for (int k = f->dim - 1; k >= 0; k--) {
        at[k] = remains / f->stride[k];
        remains -= at[k] * f->stride[k];
    }
    return (int)(at[deep] * f->tile[tile].n[across] + at[across]);
}

bool edge_of_strip(const struct gas *g, const struct strip *s, bool high, struct edge *e, int *first) {
    const struct forest *f = g->forest;
    const struct tile *t = &f->tile[s->tile];
    const int axis = s->axis, side = 2 * axis + high;
    const int place = (high ? t->n[axis] - 1 : -1) - s->from; /* of the left cells */
    if (t->side[side].patch < 0 || (axis == 0 ? place < 0 || place >= s->n : place != 0)) return false;
    *first = axis == 0 ? place : 0;
    const long left = s->offset + *first, right = left + f->stride[axis];
    *e = (struct edge){.rules = &g->patches.rules[t->side[side].patch],
                       .normal = axis,
                       .n = axis == 0 ? 1 : s->n,
                       .from = high ? left : right,
                       .to = high ? right : left,
                       .step = 1};
    e->face = t->side[side].face + face_at_side(f, s->tile, side, e->from);
    return true;
}

bool tiles_fed(const struct gas *g, int tile, int side) {
    const int patch = g->patches.fed ? g->forest->tile[tile].side[side].patch : -1;
    return patch >= 0 && patch_feeds(&g->patches.rules[patch]);
}

static void feed(const struct gas *g, const double *U, const struct edge *e, double (*out)[BATCH], int column) {
    const double sign = e->to > e->from ? -1 : 1; /* of what flows in */
    double flux[MAX_VAR][BATCH], into[BATCH];
    int in[BATCH], beyond[BATCH];
    const struct fed_faces f = {e->n, e->face, into, U, in, beyond, flux};
    for (int i = 0; i < e->n; i++) {
        in[i] = (int)e->from + i;
        beyond[i] = (int)e->to + i;
        into[i] = sign * patch_feed(e->rules, g->components, e->face[i], e->normal);
        for (int v = 0; v < g->nvar; v++) flux[v][i] = sign * out[v][column + i];
    }
    feed_fluxes(g, e->rules, &f);
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < e->n; i++) out[v][column + i] = sign * flux[v][i];
}

void tiles_feed(const struct gas *g, const double *U, const struct strip *s, double (*out)[BATCH], int column) {
    struct edge e;
    for (int high = 0, first; high < 2; high++)
        if (edge_of_strip(g, s, high, &e, &first) && patch_feeds(e.rules)) feed(g, U, &e, out, column + first);
}
