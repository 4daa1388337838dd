/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the fronts of shocks on a lattice, once a step (docs/physics.md 6.12): the speed S_b of a cell along axis b is
 * the largest front_speed of its two faces there. A face along another axis gets the larger S_b of its two cells as the
 * floor of struct faces. S is a function of the state at the start of the step alone, so that restarts, ranks, tiles
 * and steps that are done again keep their bits. Faces of patches are no fronts. A tile is looked at only if the
 * pressures in it and in those beside it allow a front: smooth flow pays for their extremes, which the wave speeds
 * yield. */
#include "libcore/lattice/tiles.h"
#include "libcore/schemes/flux_rules.h"

#include <stdlib.h>

struct fronts {
    double **speed;              /* [ntiles] of [dim][size] m/s: S, with one layer of ghosts; 0 beyond patches */
    bool *found;                 /* [ntiles] is any S of the tile's cells above 0? */
    bool *near;                  /* [ntiles] may any be, of its cells or of ghosts? */
    struct pressures *p;         /* [ntiles] of the state whose wave speeds were found last */
    ALIGNED double floor[BATCH]; /* of the faces in hand */
};

status fronts_make(struct gas *g) {
    const struct forest *f = g->forest;
    const bool wanted = rules_wanted(&g->models.flux_params, true, false).fronts;
    struct fronts *x;
    if (!wanted || g->dim < 2 || strcmp(g->models.flux->model.name, "common") != 0) return OK;
    TRY(allocate(&x, 1, sizeof *x, "fronts"));
    g->tiles->fronts = x;
    TRY(allocate(&x->speed, f->ntiles, sizeof *x->speed, "fronts"));
    TRY(allocate(&x->found, f->ntiles, sizeof *x->found, "fronts"));
    TRY(allocate(&x->near, f->ntiles, sizeof *x->near, "fronts"));
    TRY(allocate(&x->p, f->ntiles, sizeof *x->p, "fronts"));
    for (int t = 0; t < f->ntiles; t++) TRY(allocate(&x->speed[t], g->dim * f->size + SLACK, sizeof(double), "fronts"));
    return OK;
}

void fronts_free(struct gas *g) {
    struct fronts *x = g->tiles->fronts;
    if (!x) return;
    blocks_free(g->forest, x->speed);
    free(x->found);
    free(x->near);
    free(x->p);
    free(x);
}

KERNEL static void widen_row(int n, const double *restrict p, struct pressures *restrict of) {
    double low[8], high[8];
    int i = 0;
    for (int j = 0; j < 8; j++) {
        low[j] = of->low;
        high[j] = of->high;
    }
    for (; i + 8 <= n; i += 8)
        for (int j = 0; j < 8; j++) {
            low[j] = smaller(low[j], p[i + j]);
            high[j] = larger(high[j], p[i + j]);
        }
    for (; i < n; i++) {
        low[0] = smaller(low[0], p[i]);
        high[0] = larger(high[0], p[i]);
    }
    for (int j = 0; j < 8; j++) {
        of->low = smaller(of->low, low[j]);
        of->high = larger(of->high, high[j]);
    }
}

void pressures_widen(struct pressures *of, int n, const double *p) {
    widen_row(n, p, of);
}

static void join(struct pressures *a, const struct pressures *b) {
    a->low = smaller(a->low, b->low);
    a->high = larger(a->high, b->high);
}

void fronts_note(struct gas *g, int tile, const struct pressures *of) {
    if (g->tiles->fronts) g->tiles->fronts->p[tile] = *of;
}

void fronts_speed(const struct gas *g, struct gas_speed *speed) {
    struct pressures all = NO_PRESSURES;
    for (int t = 0; t < g->forest->ntiles && g->tiles->fronts; t++) join(&all, &g->tiles->fronts->p[t]);
    speed->low = all.low;
    speed->high = all.high;
}

/* May there be a front in a tile or at its sides? What lies on other ranks is not known. */
static bool may_hold(const struct gas *g, int tile) {
    const struct tile *t = &g->forest->tile[tile];
    struct pressures near = g->tiles->fronts->p[tile];
    for (int side = 0; side < 2 * g->dim; side++)
        if (t->side[side].neighbour >= 0) join(&near, &g->tiles->fronts->p[t->side[side].neighbour]);
    return t->remote || exceeds(FRONT, near.low, near.high);
}

struct looking { /* at a tile of the state U */
    struct gas *g;
    const double *U;
    int tile;
};

static void look_visit(void *context, long offset, int n) {
    const struct looking *l = context;
    primitives_of_row(l->g, l->U, offset, n);
}

/* Writes out the cells of a tile that are not kept up, and the first layer of its ghosts. */
static void complete(struct gas *g, int tile) {
    const struct activity *a = &g->tiles->activity;
    const int *n = g->forest->tile[tile].n, reach1 = 1, reach2 = g->dim > 2 ? 1 : 0;
    for (int k = -reach2; k < n[2] + reach2; k++)
        for (int j = -reach1; j < n[1] + reach1; j++) {
            const bool inside = j >= 0 && j < n[1] && k >= 0 && k < n[2];
            *activity_row(a, a->needed, j, k) = inside ? (struct span){-1, n[0] + 1} : (struct span){0, n[0]};
        }
    forest_fill_tile(g->forest, tile, a->quiet + 6 * tile);
    activity_store(g, tile, &g->U, a->needed, 1);
}

/* Gives the ghosts beyond the patches of a tile the pressure inside, so that there is no front. */
static void level_patches(const struct gas *g, int tile) {
    const struct tile *t = &g->forest->tile[tile];
    const long *stride = g->forest->stride;
    double *p = g->tiles->work.p + g->forest->first;
    for (int side = 0; side < 2 * g->dim; side++) {
        const int axis = side / 2, a = axis == 0, b = axis == 2 ? 1 : 2; /* a, b: the other axes */
        double *inside = p + (side % 2 ? (t->n[axis] - 1) * stride[axis] : 0);
        const long out = side % 2 ? stride[axis] : -stride[axis];
        for (int k = 0; k < t->n[b] && t->side[side].patch >= 0; k++)
            for (int i = 0; i < t->n[a]; i++) {
                double *at = inside + i * stride[a] + k * stride[b];
                at[out] = *at;
            }
    }
}

KERNEL static bool look_steep(int n, long s, const double *restrict p) {
    int any = 0;
    for (int i = 0; i < n; i++) any |= exceeds(FRONT, p[i - s], p[i]) | exceeds(FRONT, p[i], p[i + s]);
    return any != 0;
}

/* Finds S of n cells along the axis whose neighbours are `s` apart; returns whether any is above 0. */
KERNEL static bool front_row(int n, long s, const double *restrict rho, const double *restrict u,
                             const double *restrict c, const double *restrict p, double *restrict S) {
    uint64_t any = 0;
    EACH_ALONE
    for (int i = 0; i < n; i++) {
        const double low[2] = {rho[i - s] * c[i - s], rho[i] * c[i]}, high[2] = {low[1], rho[i + s] * c[i + s]};
        S[i] = larger(front_speed(u[i - s] - u[i], c[i - s], c[i], low, p[i - s], p[i]),
                      front_speed(u[i] - u[i + s], c[i], c[i + s], high, p[i], p[i + s]));
        any |= bits_of(S[i]);
    }
    return any != 0;
}

static bool find_row(const struct looking *l, int axis, int j, int k) {
    const struct forest *f = l->g->forest;
    const struct work *w = &l->g->tiles->work;
    const long s = f->stride[axis], at = f->first + j * f->stride[1] + k * f->stride[2];
    const int n = f->tile[l->tile].n[0];
    double *S = l->g->tiles->fronts->speed[l->tile] + axis * f->size + at;
    if (look_steep(n, s, w->p + at)) return front_row(n, s, l->U + at, w->velocity[axis] + at, w->c + at, w->p + at, S);
    memset(S, 0, (size_t)n * sizeof *S);
    return false;
}

static void look(struct gas *g, int tile) {
    struct fronts *x = g->tiles->fronts;
    const struct tile *t = &g->forest->tile[tile];
    struct looking l = {g, g->U.block[tile], tile};
    if (!may_hold(g, tile)) {
        if (x->found[tile]) memset(x->speed[tile], 0, (size_t)(g->dim * g->forest->size) * sizeof(double));
        x->found[tile] = false;
        return;
    }
    complete(g, tile);
    runs_visit(g->forest, t, 1, look_visit, &l);
    level_patches(g, tile);
    x->found[tile] = false;
    for (int axis = 0; axis < g->dim; axis++)
        for (int k = 0; k < t->n[2]; k++)
            for (int j = 0; j < t->n[1]; j++) x->found[tile] |= find_row(&l, axis, j, k);
}

static bool is_near(const struct gas *g, int tile) {
    const struct tile *t = &g->forest->tile[tile];
    const bool *found = g->tiles->fronts->found;
    bool near = t->remote || found[tile];
    for (int side = 0; side < 2 * g->dim; side++)
        near |= t->side[side].neighbour >= 0 && found[t->side[side].neighbour];
    return near;
}

void tiles_fronts(struct gas *g, const struct gas_speed *speed) {
    struct fronts *x = g->tiles->fronts;
    struct forest *f = g->forest;
    if (!x) return;
    memset(x->near, 0, (size_t)f->ntiles * sizeof *x->near);
    if (!exceeds(FRONT, speed->low, speed->high)) return;
    activity_prepare(g, &g->U);
    forest_fill_start(f, 1, g->nvar, g->U.block);
    forest_fill_finish(f);
    for (int t = 0; t < f->ntiles; t++) look(g, t);
    forest_fill_layers(f, 1, g->dim, x->speed);
    for (int t = 0; t < f->ntiles; t++) x->near[t] = is_near(g, t);
}

/* Raises floors to S of the two cells of n faces; returns bits that are all 0 if no floor of them is above 0. */
KERNEL static uint64_t raise_row(int n, long s, const double *restrict S, double *restrict floor) {
    uint64_t any = 0;
    for (int i = 0; i < n; i++) {
        floor[i] = larger(floor[i], larger(S[i], S[i + s]));
        any |= bits_of(floor[i]);
    }
    return any;
}

const double *fronts_floor(const struct gas *g, const struct strip *s) {
    const struct forest *f = g->forest;
    struct fronts *x = g->tiles->fronts;
    uint64_t any = 0;
    if (!x || !x->near[s->tile]) return NULL;
    memset(x->floor, 0, sizeof x->floor);
    for (int axis = 0; axis < g->dim; axis++)
        if (axis != s->axis)
            any |= raise_row(whole_vectors(s->n), f->stride[s->axis], x->speed[s->tile] + axis * f->size + s->offset,
                             x->floor);
    return any ? x->floor : NULL;
}
