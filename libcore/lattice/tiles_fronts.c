/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the fronts of shocks on a lattice, once a step (docs/physics.md 6.12): the speed S_b of a cell along axis b is
 * the largest front_speed of its two faces there. A face along another axis gets the larger S_b of its two cells as the
 * floor of struct faces. S is a function of the state at the start of the step alone, so that restarts, ranks, tiles
 * and steps that are done again keep their bits. Faces of patches are no fronts.
 *
 * Few cells are at fronts, and the others are not to pay: where the wave speeds are found, all primitives of a tile are
 * in hand, and the fronts between its cells are found there, after its last stage of the step. Those at its sides
 * follow at the start of the next step, by the pressures of the layers inside the sides. Spans of rows tell where S may
 * be above 0. A step that is done again finds S again. */
#include "libcore/lattice/tiles.h"
#include "libcore/schemes/flux_rules.h"

#include <stdlib.h>

struct fronts {
    double **speed;    /* [ntiles] of [dim][size] m/s: S, with one layer of ghosts; 0 outside of `row` */
    struct span **row; /* [ntiles] of [dim][rows of activity_row], the columns where S may be above 0 */
    bool *found;       /* [ntiles] is any S of the tile's cells above 0? */
    bool *near;        /* [ntiles] may any be, of its cells or of ghosts? */
    bool remote;       /* has any tile ghosts from other ranks? */
    /* Of the state whose wave speeds were found last: its blocks, [ntiles] extremes of p, [ntiles][6] p in the layers
     * inside the sides, lower axis fastest, unless all cells of the tile are equal */
    double *const *noted;
    struct range *p;
    double *(*layer)[6];
    ALIGNED double floor[BATCH]; /* of the faces in hand */
};

static long cells_of_side(const struct tile *t, int side) {
    return (long)t->n[(side / 2 + 1) % 3] * t->n[(side / 2 + 2) % 3];
}

static status lines_make(const struct gas *g, int tile, struct fronts *x) {
    const struct activity *a = &g->tiles->activity;
    TRY(allocate(&x->speed[tile], g->dim * g->forest->size + SLACK, sizeof(double), "fronts"));
    TRY(allocate(&x->row[tile], (long)g->dim * a->nspans, sizeof *x->row[tile], "fronts"));
    for (int i = 0; i < g->dim * a->nspans; i++) x->row[tile][i] = SPAN_EMPTY;
    for (int side = 0; side < 2 * g->dim; side++)
        TRY(allocate(&x->layer[tile][side], cells_of_side(&g->forest->tile[tile], side), sizeof(double), "fronts"));
    return OK;
}

status fronts_make(struct gas *g) {
    const struct forest *f = g->forest;
    const bool wanted = rules_of(g->models.flux, &g->models.flux_params, true, false).fronts;
    struct fronts *x;
    if (!wanted || g->dim < 2) return OK;
    TRY(allocate(&x, 1, sizeof *x, "fronts"));
    g->tiles->fronts = x;
    TRY(allocate(&x->speed, f->ntiles, sizeof *x->speed, "fronts"));
    TRY(allocate(&x->row, f->ntiles, sizeof *x->row, "fronts"));
    TRY(allocate(&x->found, f->ntiles, sizeof *x->found, "fronts"));
    TRY(allocate(&x->near, f->ntiles, sizeof *x->near, "fronts"));
    TRY(allocate(&x->p, f->ntiles, sizeof *x->p, "fronts"));
    TRY(allocate(&x->layer, f->ntiles, sizeof *x->layer, "fronts"));
    for (int t = 0; t < f->ntiles; t++) {
        x->remote |= f->tile[t].remote;
        TRY(lines_make(g, t, x));
    }
    return OK;
}

void fronts_free(struct gas *g) {
    struct fronts *x = g->tiles->fronts;
    if (!x) return;
    blocks_free(g->forest, x->speed);
    for (int t = 0; t < g->forest->ntiles; t++) {
        if (x->row) free(x->row[t]);
        for (int side = 0; x->layer && side < 6; side++) free(x->layer[t][side]);
    }
    free(x->row);
    free(x->found);
    free(x->near);
    free(x->p);
    free(x->layer);
    free(x);
}

static struct span *row_of(const struct gas *g, int tile, int axis, int j, int k) {
    const struct activity *a = &g->tiles->activity;
    return activity_row(a, g->tiles->fronts->row[tile] + axis * a->nspans, j, k);
}

static void add(struct span *to, struct span s) {
    *to = span_join(*to, s);
}

static long offset_of(const struct forest *f, int i, int j, int k) {
    return f->first + i + j * f->stride[1] + k * f->stride[2];
}

/* Do the pressures of n cells and of those beside them differ as at a front, for any of them? */
KERNEL static bool look_steep(int n, const double *restrict p, const double *restrict q) {
    int any = 0;
    for (int i = 0; i < n; i++) any |= exceeds(FRONT, p[i], q[i]);
    return any != 0;
}

/* The span of those among n cells. */
static struct span steep_span(int n, const double *p, const double *q) {
    struct span of = {0, n};
    if (!look_steep(n, p, q)) return SPAN_EMPTY;
    while (!exceeds(FRONT, p[of.low], q[of.low])) of.low++;
    while (!exceeds(FRONT, p[of.high - 1], q[of.high - 1])) of.high--;
    return of;
}

struct side_of_faces { /* the cells on one side of a line of faces */
    const double *rho, *u, *c, *p;
};

/* Finds front_speed of n faces; returns whether any is above 0. */
KERNEL static bool find_speeds(int n, const struct side_of_faces *l, const struct side_of_faces *r,
                               double *restrict speed) {
    uint64_t any = 0;
    EACH_ALONE
    for (int i = 0; i < n; i++) {
        const double impedance[2] = {l->rho[i] * l->c[i], r->rho[i] * r->c[i]};
        speed[i] = front_speed(l->u[i] - r->u[i], l->c[i], r->c[i], impedance, l->p[i], r->p[i]);
        any |= bits_of(speed[i]);
    }
    return any != 0;
}

KERNEL static void raise_row(int n, const double *restrict speed, double *restrict S) {
    for (int i = 0; i < n; i++) S[i] = larger(S[i], speed[i]);
}

struct front_line { /* of cells of a tile */
    ALIGNED double rho[BATCH], u[BATCH], c[BATCH], p[BATCH];
};

/* Takes the primitives of the columns `s` of a row, of which those outside of `varied` are the background's. */
static struct side_of_faces take_row(const struct work *w, const double *rho, int axis, long row, struct span s,
                                     struct span varied, struct front_line *l) {
    for (int i = s.low; i < s.high; i++) {
        const long at = i >= varied.low && i < varied.high ? row + i : 0;
        l->rho[i - s.low] = rho[at];
        l->u[i - s.low] = w->velocity[axis][at];
        l->c[i - s.low] = w->c[at];
        l->p[i - s.low] = w->p[at];
    }
    return (struct side_of_faces){l->rho, l->u, l->c, l->p};
}

/* Gives the cells on both sides of n faces along an axis, the left ones from column `low` of row (j, k) on, their
 * speeds. */
static void raise_both(const struct gas *g, int tile, int axis, int low, int n, int j, int k, const double *speed) {
    const struct forest *f = g->forest;
    double *S = g->tiles->fronts->speed[tile] + axis * f->size + offset_of(f, low, j, k);
    const struct span s = {low, low + n + (axis == 0)};
    raise_row(n, speed, S);
    raise_row(n, speed, S + f->stride[axis]);
    add(row_of(g, tile, axis, j, k), s);
    add(row_of(g, tile, axis, j + (axis == 1), k + (axis == 2)), s);
}

/* Finds the fronts between the cells of a row and the next ones along an axis; returns whether there are any. Cells
 * that equal the background have none between them. */
static bool look_above(const struct gas *g, int tile, const struct state *U, int axis, int j, int k) {
    const struct forest *f = g->forest;
    const struct work *w = &g->tiles->work;
    const struct activity *a = &g->tiles->activity;
    const int *n = f->tile[tile].n, up = axis == 1, far = axis == 2;
    if (j + up == n[1] || k + far == n[2]) return false;
    const struct span here = *activity_row(a, U->varied[tile], j, k);
    const struct span above = *activity_row(a, U->varied[tile], j + up, k + far);
    const long row = offset_of(f, 0, j, k);
    struct span s = span_join(here, above);
    if (axis == 0) s = (struct span){s.low > 0 ? s.low - 1 : 0, s.high < n[0] ? s.high : n[0] - 1};
    if (span_empty(s)) return false;
    const double *p = w->p + row + s.low;
    const struct span of = steep_span(s.high - s.low, p, p + f->stride[axis]);
    if (span_empty(of)) return false;
    struct front_line line[2];
    double speed[BATCH];
    s = (struct span){s.low + of.low, s.low + of.high};
    const struct side_of_faces l = take_row(w, U->block[tile], axis, row, s, here, &line[0]);
    const struct span next = axis == 0 ? (struct span){s.low + 1, s.high + 1} : s;
    const struct side_of_faces r =
        take_row(w, U->block[tile], axis, offset_of(f, 0, j + up, k + far), next, above, &line[1]);
    if (!find_speeds(s.high - s.low, &l, &r, speed)) return false;
    raise_both(g, tile, axis, s.low, s.high - s.low, j, k, speed);
    return true;
}

/* Finds the fronts between the cells of a tile. */
static void look_inside(const struct gas *g, int tile, const struct state *U) {
    struct fronts *x = g->tiles->fronts;
    const int *n = g->forest->tile[tile].n;
    bool found = false;
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++)
            for (int axis = 0; axis < g->dim; axis++) found |= look_above(g, tile, U, axis, j, k);
    x->found[tile] = x->near[tile] = found;
}

/* Gives the cells of a tile that equal its background, if it has any, their pressure. */
static void level_background(const struct gas *g, int tile, const struct state *s) {
    const int *n = g->forest->tile[tile].n;
    double *p = g->tiles->work.p;
    if (!activity_has_background(g, tile, s)) return;
    primitives_of_row(g, s->block[tile], 0, 1);
    const double level = p[0];
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++) {
            const struct span varied = *activity_row(&g->tiles->activity, s->varied[tile], j, k);
            double *row = p + offset_of(g->forest, 0, j, k);
            for (int i = 0; i < n[0] && i < varied.low; i++) row[i] = level;
            for (int i = varied.high > 0 ? varied.high : 0; i < n[0]; i++) row[i] = level;
        }
}

/* The cells of the layer beyond a side (1), or inside it (0). */
struct box {
    int low[3], high[3];
};
static struct box box_at(const struct tile *t, int side, int beyond) {
    struct box b = {.high = {t->n[0], t->n[1], t->n[2]}};
    const int axis = side / 2;
    b.low[axis] = side % 2 ? t->n[axis] - 1 + beyond : -beyond;
    b.high[axis] = b.low[axis] + 1;
    return b;
}

/* Keeps the pressures in the layer inside a side. */
static void keep_layer(const struct gas *g, int tile, int side) {
    const struct box b = box_at(&g->forest->tile[tile], side, 0);
    double *to = g->tiles->fronts->layer[tile][side];
    for (int k = b.low[2]; k < b.high[2]; k++)
        for (int j = b.low[1]; j < b.high[1]; j++) {
            const double *p = g->tiles->work.p + offset_of(g->forest, 0, j, k);
            for (int i = b.low[0]; i < b.high[0]; i++) *to++ = p[i];
        }
}

/* Forgets the fronts of a tile and of its ghosts along an axis. */
static void forget(const struct gas *g, int tile, int axis) {
    const struct forest *f = g->forest;
    const int *n = f->tile[tile].n, beyond = g->dim > 2 ? 1 : 0;
    double *S = g->tiles->fronts->speed[tile] + axis * f->size;
    for (int k = -beyond; k < n[2] + beyond; k++)
        for (int j = -1; j <= n[1]; j++) {
            struct span *s = row_of(g, tile, axis, j, k);
            if (span_empty(*s)) continue;
            memset(S + offset_of(f, s->low, j, k), 0, (size_t)(s->high - s->low) * sizeof *S);
            *s = SPAN_EMPTY;
        }
}

void fronts_note(struct gas *g, int tile, const struct state *s, const struct range *of) {
    struct fronts *x = g->tiles->fronts;
    if (!x) return;
    for (int axis = 0; axis < g->dim && x->near[tile]; axis++) forget(g, tile, axis);
    x->found[tile] = x->near[tile] = false;
    x->noted = s->block;
    x->p[tile] = *of;
    if (of->low == of->high) return;
    level_background(g, tile, s);
    if (exceeds(FRONT, of->low, of->high)) look_inside(g, tile, s);
    for (int side = 0; side < 2 * g->dim; side++) keep_layer(g, tile, side);
}

void fronts_speed(const struct gas *g, struct gas_speed *speed) {
    struct range all = RANGE_EMPTY;
    for (int t = 0; t < g->forest->ntiles && g->tiles->fronts; t++) range_join(&all, &g->tiles->fronts->p[t]);
    speed->low = all.low;
    speed->high = all.high;
}

/* Sets the place of cell i of line m in the layer inside a side; returns its offset. */
static long place_of(const struct forest *f, int tile, int side, int m, int i, int at[3]) {
    const int axis = side / 2;
    at[axis == 0 ? 1 : 0] = i;
    at[axis == 2 ? 1 : 2] = m;
    at[axis] = side % 2 ? f->tile[tile].n[axis] - 1 : 0;
    return offset_of(f, at[0], at[1], at[2]);
}

struct front_cells { /* of a line, with all that is found on the way to their primitives */
    ALIGNED double U[MAX_VAR][BATCH], u[MAX_DIM][BATCH], eps[BATCH], p[BATCH], c[BATCH], gruneisen[BATCH];
};

/* Finds the primitives of the cells `s` of line m in the layer inside a side, or of the ghosts beyond it. */
static struct side_of_faces take_line(const struct gas *g, int tile, int side, bool beyond, int m, struct span s,
                                      struct front_cells *l) {
    const struct forest *f = g->forest;
    const long out = side % 2 ? f->stride[side / 2] : -f->stride[side / 2];
    const double *U = g->U.block[tile];
    double *u[MAX_DIM] = {l->u[0], l->u[1], l->u[2]};
    for (int i = s.low; i < s.high; i++) {
        int at[3];
        const long cell = place_of(f, tile, side, m, i, at);
        const struct span varied = *activity_row(&g->tiles->activity, g->U.varied[tile], at[1], at[2]);
        const long from = beyond ? cell + out : at[0] >= varied.low && at[0] < varied.high ? cell : 0;
        for (int v = 0; v < g->nvar; v++) l->U[v][i - s.low] = U[v * f->size + from];
    }
    velocity_row(s.high - s.low, g->components, BATCH, l->U[0], u, l->eps);
    g->models.eos->state(&g->models.material, s.high - s.low, l->U[0], l->eps, l->p, l->c, l->gruneisen);
    root_row(s.high - s.low, l->c);
    return (struct side_of_faces){l->U[0], l->u[side / 2], l->c, l->p};
}

/* Gives the cells `s` of a line at a side the speeds of their faces there, of which one is above 0. */
static void raise_line(const struct gas *g, int tile, int side, int m, struct span s, const double *speed) {
    struct fronts *x = g->tiles->fronts;
    for (int i = s.low; i < s.high; i++) {
        int at[3];
        double *S = x->speed[tile] + side / 2 * g->forest->size + place_of(g->forest, tile, side, m, i, at);
        if (speed[i - s.low] == 0) continue;
        *S = larger(*S, speed[i - s.low]);
        add(row_of(g, tile, side / 2, at[1], at[2]), (struct span){at[0], at[0] + 1});
    }
    x->found[tile] = x->near[tile] = true;
}

/* Returns the pressures in the layer inside a side. */
static const double *layer_of(const struct gas *g, int tile, int side) {
    const struct fronts *x = g->tiles->fronts;
    const struct range p = x->p[tile];
    const long n = p.low == p.high ? cells_of_side(&g->forest->tile[tile], side) : 0;
    for (long i = 0; i < n; i++) x->layer[tile][side][i] = p.low;
    return x->layer[tile][side];
}

/* Finds the fronts at a side of a tile, and of the tile beyond it if that is on this rank. */
static void look_beyond(struct gas *g, int tile, int side) {
    const int *n = g->forest->tile[tile].n, other = g->forest->tile[tile].side[side].neighbour;
    const int line = n[side < 2 ? 1 : 0], lines = n[side < 4 ? 2 : 1];
    const double *p = other < 0 ? NULL : layer_of(g, tile, side);
    const double *q = other < 0 ? NULL : layer_of(g, other, side ^ 1);
    struct front_cells here, there;
    double speed[BATCH];
    for (int m = 0; m < lines; m++) {
        const struct span s = p ? steep_span(line, p + m * line, q + m * line) : (struct span){0, line};
        if (span_empty(s)) continue;
        const struct side_of_faces l = take_line(g, tile, side, false, m, s, &here);
        const struct side_of_faces r = other < 0 ? take_line(g, tile, side, true, m, s, &there)
                                                 : take_line(g, other, side ^ 1, false, m, s, &there);
        if (!find_speeds(s.high - s.low, side % 2 ? &l : &r, side % 2 ? &r : &l, speed)) continue;
        raise_line(g, tile, side, m, s, speed);
        if (other >= 0) raise_line(g, other, side ^ 1, m, s, speed);
    }
}

/* May there be a front at a side that is this tile's to look at? What lies on other ranks is not known. */
static bool may_be_front(const struct gas *g, int tile, int side) {
    const int other = g->forest->tile[tile].side[side].neighbour;
    const struct fronts *x = g->tiles->fronts;
    if (other < 0) return g->forest->tile[tile].side[side].patch < 0;
    struct range both = x->p[tile];
    range_join(&both, &x->p[other]);
    return side % 2 && exceeds(FRONT, both.low, both.high);
}

/* Notes which ghosts beyond a side, filled from another rank, hold fronts along an axis. */
static void note_ghosts(const struct gas *g, int tile, int side, int axis) {
    const struct forest *f = g->forest;
    const struct box b = box_at(&f->tile[tile], side, 1);
    struct fronts *x = g->tiles->fronts;
    for (int k = b.low[2]; k < b.high[2]; k++)
        for (int j = b.low[1]; j < b.high[1]; j++)
            for (int i = b.low[0]; i < b.high[0]; i++) {
                if (x->speed[tile][axis * f->size + offset_of(f, i, j, k)] == 0) continue;
                add(row_of(g, tile, axis, j, k), (struct span){i, i + 1});
                x->near[tile] = true;
            }
}

/* Fills the ghosts beyond a side from another tile of this rank. */
static void copy_ghosts(const struct gas *g, int tile, int side, int axis) {
    const struct forest *f = g->forest;
    const int other = f->tile[tile].side[side].neighbour;
    const struct box to = box_at(&f->tile[tile], side, 1), from = box_at(&f->tile[other], side ^ 1, 0);
    const int shift = to.low[0] - from.low[0];
    struct fronts *x = g->tiles->fronts;
    double *S = x->speed[tile] + axis * f->size, *T = x->speed[other] + axis * f->size;
    for (int k = 0; k < to.high[2] - to.low[2]; k++)
        for (int j = 0; j < to.high[1] - to.low[1]; j++) {
            struct span s = *row_of(g, other, axis, j + from.low[1], k + from.low[2]);
            s = (struct span){s.low > from.low[0] ? s.low : from.low[0], s.high < from.high[0] ? s.high : from.high[0]};
            if (span_empty(s)) continue;
            memcpy(S + offset_of(f, s.low + shift, j + to.low[1], k + to.low[2]),
                   T + offset_of(f, s.low, j + from.low[1], k + from.low[2]), (size_t)(s.high - s.low) * sizeof *S);
            add(row_of(g, tile, axis, j + to.low[1], k + to.low[2]), (struct span){s.low + shift, s.high + shift});
            x->near[tile] = true;
        }
}

static const bool every_side[6] = {true, true, true, true, true, true};

/* Fills the ghosts of a tile with S, once all of them are found. */
static void take_ghosts(const struct gas *g, int tile) {
    const struct tile *t = &g->forest->tile[tile];
    if (t->remote) forest_fill_tile(g->forest, tile, every_side);
    for (int side = 0; side < 2 * g->dim; side++)
        for (int axis = 0; axis < g->dim; axis++) {
            const int other = t->side[side].neighbour;
            if (other >= 0 && g->tiles->fronts->found[other]) copy_ghosts(g, tile, side, axis);
            if (other < 0 && t->side[side].patch < 0) note_ghosts(g, tile, side, axis);
        }
}

/* Fills the ghosts of the state U that come from other ranks. */
static void take_remote(struct gas *g) {
    activity_prepare(g, &g->U);
    forest_fill_start(g->forest, 1, g->nvar, g->U.block);
    forest_fill_finish(g->forest);
    for (int t = 0; t < g->forest->ntiles; t++)
        if (g->forest->tile[t].remote) forest_fill_tile(g->forest, t, every_side);
}

void tiles_fronts(struct gas *g, const struct gas_speed *speed) {
    struct fronts *x = g->tiles->fronts;
    struct forest *f = g->forest;
    struct gas_speed again;
    bool any;
    if (!x) return;
    if (x->noted != g->U.block) g->engine->state.speed(g, &again);
    if (!exceeds(FRONT, speed->low, speed->high)) return;
    if (x->remote) take_remote(g);
    for (int t = 0; t < f->ntiles; t++)
        for (int side = 0; side < 2 * g->dim; side++)
            if (may_be_front(g, t, side)) look_beyond(g, t, side);
    any = x->remote;
    for (int t = 0; t < f->ntiles; t++) any |= x->found[t];
    if (!any) return;
    forest_fill_start(f, 1, g->dim, x->speed);
    forest_fill_finish(f);
    for (int t = 0; t < f->ntiles; t++) take_ghosts(g, t);
}

/* Sets floors to the larger S of the two cells of n faces, along two axes, which may be one; returns bits that are all
 * 0 if the floors are. */
KERNEL static uint64_t set_floors(int n, long s, const double *restrict S, const double *restrict T,
                                  double *restrict floor) {
    uint64_t any = 0;
    for (int i = 0; i < n; i++) {
        floor[i] = larger(larger(S[i], S[i + s]), larger(T[i], T[i + s]));
        any |= bits_of(floor[i]);
    }
    return any;
}

/* The columns of a strip's faces whose cells may hold fronts along an axis, in whole vectors: S is 0 around the spans.
 */
static struct span floor_span(const struct gas *g, const struct strip *s, int axis) {
    const struct activity *a = &g->tiles->activity;
    const int up = s->axis == 1 ? 1 : s->axis == 2 ? a->rows : 0, n = whole_vectors(s->n);
    const struct span *row = g->tiles->fronts->row[s->tile] + axis * a->nspans + s->row;
    const struct span both = span_join(row[0], row[up]);
    const int low = both.low - s->column - (s->axis == 0), high = both.high - s->column;
    if (span_empty(both)) return SPAN_EMPTY;
    return (struct span){low > 0 ? low / 8 * 8 : 0, high < n ? whole_vectors(high) : n};
}

const double *fronts_floor(const struct gas *g, const struct strip *s) {
    struct fronts *x = g->tiles->fronts;
    if (!x || !x->near[s->tile]) return NULL;
    const int one = s->axis == 0, two = g->dim < 3 ? one : s->axis == 2 ? 1 : 2; /* the other axes */
    const struct span of = span_join(floor_span(g, s, one), floor_span(g, s, two));
    if (span_empty(of)) return NULL;
    const double *S = x->speed[s->tile] + s->offset + of.low;
    const long size = g->forest->size;
    if (!set_floors(of.high - of.low, g->forest->stride[s->axis], S + one * size, S + two * size, x->floor + of.low))
        return NULL;
    memset(x->floor, 0, (size_t)of.low * sizeof *x->floor);
    memset(x->floor + of.high, 0, (size_t)(whole_vectors(s->n) - of.high) * sizeof *x->floor);
    return x->floor;
}
