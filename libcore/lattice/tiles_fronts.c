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
    double **speed;    /* [ntiles] of [dim][size] m/s: S, with one layer of ghosts; 0 beyond patches */
    bool *found;       /* [ntiles] is any S of the tile's cells above 0? */
    bool *near, **row; /* [ntiles] may any be, of its cells or of ghosts? [rows of activity_row] in that row? */
    /* Of the state whose wave speeds were found last: [ntiles] extremes in the tile, [ntiles][6] in the layer inside
     * each side, [ntiles] may there be a front between two cells of the tile? */
    struct pressures *p, (*side)[6];
    bool *steep;
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
    TRY(allocate(&x->side, f->ntiles, sizeof *x->side, "fronts"));
    TRY(allocate(&x->steep, f->ntiles, sizeof *x->steep, "fronts"));
    for (int t = 0; t < f->ntiles; t++) TRY(allocate(&x->speed[t], g->dim * f->size + SLACK, sizeof(double), "fronts"));
    TRY(allocate(&x->row, f->ntiles, sizeof *x->row, "fronts"));
    for (int t = 0; t < f->ntiles; t++)
        TRY(allocate(&x->row[t], g->tiles->activity.nspans, sizeof *x->row[t], "fronts"));
    return OK;
}

void fronts_free(struct gas *g) {
    struct fronts *x = g->tiles->fronts;
    if (!x) return;
    blocks_free(g->forest, x->speed);
    for (int t = 0; x->row && t < g->forest->ntiles; t++) free(x->row[t]);
    free(x->row);
    free(x->found);
    free(x->near);
    free(x->p);
    free(x->side);
    free(x->steep);
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

/* Do the pressures of n cells and of those `s` further differ as at a front, for any of them? */
KERNEL static bool look_steep(int n, long s, const double *restrict p) {
    int any = 0;
    for (int i = 0; i < n; i++) any |= exceeds(FRONT, p[i], p[i + s]);
    return any != 0;
}

/* Do those of neighbours within a tile whose primitives are there? */
static bool is_steep(const struct gas *g, const int n[3]) {
    const struct forest *f = g->forest;
    bool steep = false;
    for (int k = 0; k < n[2] && !steep; k++)
        for (int j = 0; j < n[1] && !steep; j++) {
            const double *p = g->tiles->work.p + f->first + j * f->stride[1] + k * f->stride[2];
            steep = look_steep(n[0] - 1, 1, p) || (j + 1 < n[1] && look_steep(n[0], f->stride[1], p)) ||
                    (k + 1 < n[2] && look_steep(n[0], f->stride[2], p));
        }
    return steep;
}

/* Finds the extremes of the layer inside a side. */
static struct pressures side_pressures(const struct gas *g, const int n[3], int side) {
    const struct forest *f = g->forest;
    const int axis = side / 2;
    int low[3] = {0, 0, 0}, high[3] = {n[0], n[1], n[2]};
    struct pressures of = NO_PRESSURES;
    if (side % 2)
        low[axis] = n[axis] - 1;
    else
        high[axis] = 1;
    for (int k = low[2]; k < high[2]; k++)
        for (int j = low[1]; j < high[1]; j++)
            widen_row(high[0] - low[0], g->tiles->work.p + f->first + low[0] + j * f->stride[1] + k * f->stride[2],
                      &of);
    return of;
}

void fronts_note(struct gas *g, int tile, const struct state *s, const struct pressures *of) {
    struct fronts *x = g->tiles->fronts;
    const int *n = g->forest->tile[tile].n;
    if (!x) return;
    const bool may = exceeds(FRONT, of->low, of->high), whole = may && !activity_has_background(g, tile, s);
    x->p[tile] = *of;
    x->steep[tile] = may && !(whole && !is_steep(g, n));
    for (int side = 0; side < 2 * g->dim; side++) x->side[tile][side] = whole ? side_pressures(g, n, side) : *of;
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
    const struct fronts *x = g->tiles->fronts;
    bool may = t->remote || x->steep[tile];
    for (int side = 0; side < 2 * g->dim && !may; side++) {
        struct pressures both = x->side[tile][side];
        if (t->side[side].neighbour < 0) continue;
        join(&both, &x->side[t->side[side].neighbour][side ^ 1]);
        may = exceeds(FRONT, both.low, both.high);
    }
    return may;
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

/* Finds S of n cells along the axis whose neighbours are `s` apart; returns whether any is above 0. */
KERNEL static bool front_row(int n, long s, const double *restrict rho, const double *restrict u,
                             const double *restrict c, const double *restrict p, double *restrict S) {
    uint64_t any = 0;
    EACH_ALONE
    for (int i = 0; i < n; i++) {
        const double low[2] = {rho[i - s] * c[i - s], rho[i] * c[i]}, high[2] = {low[1], rho[i + s] * c[i + s]};
        S[i] = larger(front_speed(FRONT, u[i - s] - u[i], c[i - s], c[i], low, p[i - s], p[i]),
                      front_speed(FRONT, u[i] - u[i + s], c[i], c[i + s], high, p[i], p[i + s]));
        any |= bits_of(S[i]);
    }
    return any != 0;
}

static bool *row_flag(const struct gas *g, int tile, int j, int k) {
    const struct activity *a = &g->tiles->activity;
    return g->tiles->fronts->row[tile] + (activity_row(a, a->active, j, k) - a->active);
}

/* Finds S of a row; it is 0 outside of the active span, as there cells and their neighbours are equal. */
static bool find_row(const struct looking *l, int axis, int j, int k) {
    const struct gas *g = l->g;
    const struct forest *f = g->forest;
    const struct activity *a = &g->tiles->activity;
    const struct work *w = &g->tiles->work;
    const struct span span = *activity_row(a, a->active, j, k);
    const long s = f->stride[axis], row = f->first + j * f->stride[1] + k * f->stride[2], at = row + span.low;
    const int n = span.high - span.low;
    double *S = g->tiles->fronts->speed[l->tile] + axis * f->size;
    memset(S + row, 0, (size_t)f->tile[l->tile].n[0] * sizeof *S);
    if (span_empty(span) || !(look_steep(n, s, w->p + at) || look_steep(n, s, w->p + at - s))) return false;
    const bool found = front_row(n, s, l->U + at, w->velocity[axis] + at, w->c + at, w->p + at, S + at);
    *row_flag(g, l->tile, j, k) |= found;
    return found;
}

/* Looks at the cells of a tile that differ from its background and at those beside, as a stage would. */
static void look(struct gas *g, int tile) {
    struct fronts *x = g->tiles->fronts;
    const struct tile *t = &g->forest->tile[tile];
    struct activity *a = &g->tiles->activity;
    struct looking l = {g, g->U.block[tile], tile};
    bool may = may_hold(g, tile);
    memset(x->row[tile], 0, (size_t)a->nspans * sizeof *x->row[tile]);
    if (may) {
        forest_fill_tile(g->forest, tile, a->quiet + 6 * tile);
        may = activity_spread(g, tile, &g->U, &g->U);
    }
    if (!may) {
        if (x->found[tile]) memset(x->speed[tile], 0, (size_t)(g->dim * g->forest->size) * sizeof(double));
        x->found[tile] = false;
        return;
    }
    activity_store(g, tile, &g->U, a->needed, 1);
    spans_visit(g, tile, a->needed, 1, look_visit, &l);
    level_patches(g, tile);
    x->found[tile] = false;
    for (int axis = 0; axis < g->dim; axis++)
        for (int k = 0; k < t->n[2]; k++)
            for (int j = 0; j < t->n[1]; j++) x->found[tile] |= find_row(&l, axis, j, k);
}

/* May any tile hold a front? If none may that needs another rank, nothing is sent to one. */
static bool any_may_hold(const struct gas *g) {
    bool may = false;
    for (int t = 0; t < g->forest->ntiles && !may; t++) may = may_hold(g, t);
    return may;
}

/* Notes where a tile may see fronts, once all of them are found: those of a tile beside it in any row of ghosts, and in
 * any row at its ends along axis 0. */
static void find_near(const struct gas *g, int tile) {
    struct fronts *x = g->tiles->fronts;
    const struct tile *t = &g->forest->tile[tile];
    const int reach2 = g->dim > 2 ? 1 : 0;
    bool beside = t->remote, end = t->remote;
    for (int side = 0; side < 2 * g->dim; side++) {
        const bool found = t->side[side].neighbour >= 0 && x->found[t->side[side].neighbour];
        beside |= found;
        end |= found && side < 2;
    }
    x->near[tile] = beside || x->found[tile];
    for (int k = -reach2; k < t->n[2] + reach2 && beside; k++)
        for (int j = -1; j <= t->n[1]; j++)
            if (end || j < 0 || j == t->n[1] || k < 0 || k == t->n[2]) *row_flag(g, tile, j, k) = true;
}

void tiles_fronts(struct gas *g, const struct gas_speed *speed) {
    struct fronts *x = g->tiles->fronts;
    struct forest *f = g->forest;
    if (!x) return;
    memset(x->near, 0, (size_t)f->ntiles * sizeof *x->near);
    if (!exceeds(FRONT, speed->low, speed->high) || !any_may_hold(g)) return;
    activity_prepare(g, &g->U);
    forest_fill_start(f, 1, g->nvar, g->U.block);
    forest_fill_finish(f);
    for (int t = 0; t < f->ntiles; t++) look(g, t);
    forest_fill_layers(f, 1, g->dim, x->speed);
    for (int t = 0; t < f->ntiles; t++) find_near(g, t);
}

/* Returns bits that are all 0 if S of the two cells of n faces is 0. */
KERNEL static uint64_t look_row(int n, long s, const double *restrict S) {
    uint64_t any = 0;
    for (int i = 0; i < n; i++) any |= bits_of(S[i]) | bits_of(S[i + s]);
    return any;
}

/* Raises floors to S of the two cells of n faces. */
KERNEL static void raise_row(int n, long s, const double *restrict S, double *restrict floor) {
    for (int i = 0; i < n; i++) floor[i] = larger(floor[i], larger(S[i], S[i + s]));
}

const double *fronts_floor(const struct gas *g, const struct strip *s) {
    const struct forest *f = g->forest;
    struct fronts *x = g->tiles->fronts;
    const int up = s->axis == 1 ? 1 : s->axis == 2 ? g->tiles->activity.rows : 0; /* to the row of the right cells */
    bool any = false;
    if (!x || !x->near[s->tile] || !(x->row[s->tile][s->row] || x->row[s->tile][s->row + up])) return NULL;
    for (int axis = 0; axis < g->dim; axis++) {
        const double *S = x->speed[s->tile] + axis * f->size + s->offset;
        if (axis == s->axis || !look_row(whole_vectors(s->n), f->stride[s->axis], S)) continue;
        if (!any) memset(x->floor, 0, sizeof x->floor);
        raise_row(whole_vectors(s->n), f->stride[s->axis], S, x->floor);
        any = true;
    }
    return any ? x->floor : NULL;
}
