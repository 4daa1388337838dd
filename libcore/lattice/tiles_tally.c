/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fluxes through the faces of patches on a lattice (libcore/gas/tally.h), per area. A face that is not computed,
 * because its cells and their neighbours are the background, has the background's own flux. */
#include "libcore/lattice/tiles_diffuser.h"

/* The number of the first face of an edge. */
static int place_of(const struct gas *g, int tile, const struct edge *e) {
    const int side = 2 * e->normal + (e->to > e->from);
    return g->tiles->edge[6 * tile + side] + (int)(e->face - g->forest->tile[tile].side[side].face);
}

void tiles_tally_begin(struct gas *g, int tile, const double *U) {
    const struct forest *f = g->forest;
    const struct work *w = &g->tiles->work;
    const int *n = f->tile[tile].n;
    primitives_of_row(g, U, 0, 1);
    for (int side = 0; side < 2 * g->dim; side++) {
        const int axis = side / 2, first = g->tiles->edge[6 * tile + side];
        const double u = w->velocity[axis][0], p = w->p[0];
        for (int v = 0; v < g->nvar && first >= 0; v++) {
            double flux = U[v * f->size] * u + (v == axis + 1 ? p : v == energy_at(g) ? p * u : 0);
            if (side % 2 == 0) flux = -flux;
            for (int i = 0; i < n[0] * n[1] * n[2] / n[axis]; i++) g->books.tally->stage[v][first + i] = flux;
        }
    }
}

void tiles_tally(struct gas *g, const struct strip *s, double (*out)[BATCH], int column) {
    struct edge e;
    for (int high = 0, first; high < 2; high++) {
        if (!edge_of_strip(g, s, high, &e, &first)) continue;
        double *const *to = g->books.tally->stage;
        const int place = place_of(g, s->tile, &e), from = column + first;
        for (int v = 0; v < g->nvar; v++)
            for (int i = 0; i < e.n; i++) to[v][place + i] = high ? out[v][from + i] : -out[v][from + i];
    }
}

void tiles_tally_stress(struct gas *g, int tile, int side, long inner, int n, double per, const double *lines,
                        int length) {
    if (g->tiles->edge[6 * tile + side] < 0) return;
    const int to = g->tiles->edge[6 * tile + side] + face_at_side(g->forest, tile, side, inner);
    const double h = side % 2 ? -g->forest->width[side / 2] : g->forest->width[side / 2];
    for (int v = 0; v <= g->components; v++)
        for (int i = 0; i < n; i++)
            g->books.tally->passed[v][to + i] += (v < g->components ? h : per * h) * lines[v * length + i];
}

void tiles_tally_friction(struct gas *g, int tile, const struct edge *e, int i, double gain) {
    g->books.tally->passed[g->nvar - 2][place_of(g, tile, e) + i] -= g->forest->width[e->normal] * gain;
}

/* Adds what a line at the faces below cells, times `per`, brings to the cells beside patches. */
static void add_heat(struct gas *g, int tile, const struct edge *e, double per, const double *gain) {
    const bool high = e->to > e->from;
    const double h = g->forest->width[e->normal];
    const int to = place_of(g, tile, e);
    for (int i = 0; i < e->n; i++)
        g->books.tally->passed[energy_at(g)][to + i] += (high ? -per * h : per * h) * gain[i];
}

static void heat_edge(struct gas *g, int tile, const struct edge *e, const void *context) {
    const struct diffuser *d = g->tiles->diffuser;
    const double *S = d->sum[g->diffusion.last][tile];
    const long size = g->forest->size, face = e->to > e->from ? e->to : e->from, step = g->forest->stride[e->normal];
    const double *coefficient = d->face[tile] + (FACE_LINES * e->normal + CONDUCTION) * size;
    double gain[BATCH] = {0};
    (void)context;
    for (int i = 0; i < e->n; i++) {
        const long at = face + i * e->step;
        gain[i] = coefficient[at] * (S[at] - S[at - step]);
    }
    add_heat(g, tile, e, 1, gain);
}

void tiles_tally_heat(struct gas *g) {
    for (int t = 0; t < g->forest->ntiles; t++) edges_visit(g, t, heat_edge, NULL);
}

static void cross_edge(struct gas *g, int tile, const struct edge *e, const void *context) {
    const double *dt = context, *cross = g->tiles->diffuser->cross[tile] + e->normal * g->forest->size;
    const long face = e->to > e->from ? e->to : e->from;
    double gain[BATCH] = {0};
    for (int i = 0; i < e->n; i++) gain[i] = cross[face + i * e->step];
    add_heat(g, tile, e, *dt, gain);
}

void tiles_tally_cross(struct gas *g, double dt) {
    for (int t = 0; t < g->forest->ntiles; t++) edges_visit(g, t, cross_edge, &dt);
}
