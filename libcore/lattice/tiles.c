/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The gas on a lattice: the memory of its tiles, state in and out, rows of cells, fields, wave speeds, totals; and the
 * table of the engine's hooks. */
#include "libcore/lattice/tiles.h"
#include "libcore/schemes/flux_rules.h"

#include <stdlib.h>

_Static_assert((int)MAX_VAR <= (int)FILL_VARIABLES && 2 * (MAX_DIM - 1) <= (int)FILL_VARIABLES,
               "a ghost fill of the forest has no room for the state or for derivatives");

status blocks_make(const struct forest *f, int nvar, double ***out) {
    TRY(allocate(out, f->ntiles, sizeof(double *), "tiles"));
    for (int t = 0; t < f->ntiles; t++) {
        TRY(allocate(&(*out)[t], nvar * f->size + SLACK, sizeof(double), "the state of a tile"));
        for (long i = 0; i < f->size; i++) (*out)[t][i] = (*out)[t][(nvar - 1) * f->size + i] = nvar > 1;
    }
    return OK;
}

void blocks_free(const struct forest *f, double **blocks) {
    for (int t = 0; blocks && t < f->ntiles; t++) free(blocks[t]);
    free(blocks);
}

static status make_axis(struct gas *g, int axis) {
    const struct forest *f = g->forest;
    struct axis_lines *l = &g->tiles->work.along[axis];
    const long length = (axis + 1 < g->dim ? f->first + f->stride[axis + 1] : f->size) + SLACK;
    double **const balance[] = {&l->rise, &l->on, &l->face, &l->base[0], &l->base[1]};
    for (int v = 1; v < g->nvar; v++) TRY(allocate(&l->flux[v], length, sizeof(double), "scratch"));
    if (!balance_acts(g, axis)) return OK;
    for (int i = 0; i < 5; i++) TRY(allocate(balance[i], length, sizeof(double), "scratch"));
    return allocate(&l->taken, g->tiles->activity.nspans, sizeof(bool), "scratch");
}

static status make_work(struct gas *g) {
    struct work *w = &g->tiles->work;
    double **single[] = {&w->eps, &w->p, &w->c, &w->gruneisen};
    for (int i = 0; i < 4; i++) TRY(allocate(single[i], g->forest->size + SLACK, sizeof(double), "scratch"));
    for (int k = 0; k < g->components; k++)
        TRY(allocate(&w->velocity[k], g->forest->size + SLACK, sizeof(double), "scratch"));
    for (int k = 0; k < g->dim; k++) TRY(make_axis(g, k));
    TRY(allocate(&w->density, g->tiles->activity.nspans, sizeof *w->density, "scratch"));
    for (int i = 0; i < 2 && g->dim > 2; i++)
        TRY(allocate(&w->planes[i], g->tiles->activity.rows, sizeof *w->planes[i], "scratch"));
    return OK;
}

/* The cells on either side that the fluxes of a cell read: those of the reconstruction of its faces. A flux with rules
 * for single faces looks at six cells. */
static int reach_of(const struct gas *g) {
    const struct wanted_rules on = rules_of(g->models.flux, &g->models.flux_params, true, false);
    const bool ruled = on.shocks || on.expansions || on.contacts;
    return ruled ? GHOSTS : g->models.reconstruct->reach + 1;
}

static status make_activity(struct gas *g) {
    struct activity *a = &g->tiles->activity;
    int rows[2] = {0, 0};
    for (int t = 0; t < g->forest->ntiles; t++)
        for (int k = 0; k < 2; k++)
            if (g->forest->tile[t].n[k + 1] > rows[k]) rows[k] = g->forest->tile[t].n[k + 1];
    a->rows = rows[0] + 2 * GHOSTS;
    a->planes = g->dim > 2 ? GHOSTS : 0;
    a->nspans = a->rows * (rows[1] + 2 * a->planes);
    a->reach = reach_of(g);
    struct span **spans[] = {&a->differ, &a->active, &a->needed, &a->crossed};
    for (int i = 0; i < 4; i++) TRY(allocate(spans[i], a->nspans, sizeof(struct span), "spans"));
    return allocate(&a->quiet, 6L * g->forest->ntiles, sizeof(bool), "tiles");
}

static status make_state(const struct gas *g, struct state *s) {
    const struct forest *f = g->forest;
    TRY(blocks_make(f, g->nvar, &s->block));
    s->nspans = g->tiles->activity.nspans;
    TRY(allocate(&s->varied, f->ntiles, sizeof(struct span *), "tiles"));
    TRY(allocate(&s->narrow, f->ntiles, sizeof *s->narrow, "tiles"));
    TRY(allocate(&s->calm, f->ntiles, sizeof *s->calm, "tiles"));
    for (int t = 0; t < f->ntiles; t++) TRY(allocate(&s->varied[t], s->nspans, sizeof(struct span), "spans"));
    activity_reset(g, s);
    return OK;
}

static void free_state(const struct forest *f, struct state *s) {
    blocks_free(f, s->block);
    for (int t = 0; s->varied && t < f->ntiles; t++) free(s->varied[t]);
    free(s->varied);
    free(s->narrow);
    free(s->calm);
}

static status tiles_make(struct gas *g) {
    for (int i = 0; i < g->forest->ntiles; i++)
        if (g->forest->tile[i].n[0] >= BATCH)
            return fail(ERR_SYSTEM, "a tile has rows of %d cells; at most %d fit a batch: choose smaller tiles",
                        g->forest->tile[i].n[0], BATCH - 1);
    struct state *states[] = {&g->U, &g->U0, &g->V, &g->W};
    TRY(allocate(&g->tiles, 1, sizeof *g->tiles, "the gas"));
    TRY(make_activity(g));
    for (int i = 0; i < 4; i++) TRY(make_state(g, states[i]));
    TRY(make_work(g));
    TRY(seams_make(g));
    TRY(fronts_make(g));
    TRY(tiles_edges_make(g));
    if (g->models.ncarried) TRY(blocks_make(g->forest, 1 + g->dim, &g->tiles->slope));
    for (int t = 0; t < g->forest->ntiles && g->tiles->slope; t++) /* they stay 0 beyond patches */
        memset(g->tiles->slope[t], 0, (size_t)((1 + g->dim) * g->forest->size) * sizeof(double));
    if (g->dense) TRY(comm_agree(g->comm, tiles_bed_make(g)));
    return g->models.transport ? tiles_diffuser_make(g) : OK;
}

static void free_work(struct work *w) {
    void *single[] = {w->eps, w->p, w->c, w->gruneisen, w->density, w->planes[0], w->planes[1]};
    for (size_t i = 0; i < sizeof single / sizeof *single; i++) free(single[i]);
    for (int k = 0; k < MAX_DIM; k++) {
        struct axis_lines *l = &w->along[k];
        void *lines[] = {l->rise, l->on, l->face, l->base[0], l->base[1], l->taken, w->velocity[k]};
        for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) free(lines[i]);
        for (int v = 0; v < MAX_VAR; v++) free(l->flux[v]);
    }
}

static void tiles_free(struct gas *g) {
    struct state *states[] = {&g->U, &g->U0, &g->V, &g->W};
    struct tiles *x = g->tiles;
    for (int i = 0; i < 4; i++) free_state(g->forest, states[i]);
    if (!x) return;
    tiles_diffuser_free(g);
    free_work(&x->work);
    seams_free(g);
    fronts_free(g);
    blocks_free(g->forest, x->slope);
    void *single[] = {
        x->activity.differ, x->activity.active, x->activity.needed, x->activity.crossed, x->activity.quiet, x->edge, x};
    for (size_t i = 0; i < sizeof single / sizeof *single; i++) free(single[i]);
}

static void tiles_cells(const struct gas *g, int block, const struct state *s, struct block_cells *out) {
    const struct forest *f = g->forest;
    const struct forest_block *b = &f->block[block];
    const struct activity *a = &g->tiles->activity;
    *out = (struct block_cells){
        .block = b->tile, .first = f->first, .row = {f->step[1] > 0, f->step[2] > 0 ? a->rows : 0}};
    memcpy(out->n, b->n, sizeof out->n);
    memcpy(out->step, f->step, sizeof out->step);
    if (s && s->varied) out->varied = activity_row(a, s->varied[b->tile], 0, 0);
}

struct hand_over { /* hands runs of a tile's cells to a visitor of rows */
    row_visitor *visit;
    void *context;
    int tile;
};

static void hand_over(void *context, long offset, int n) {
    const struct hand_over *h = context;
    h->visit(h->context, &(struct row){h->tile, offset, n});
}

static void tiles_rows(const struct gas *g, enum extent extent, const struct state *s, row_visitor *visit,
                       void *context) {
    struct hand_over h = {.visit = visit, .context = context};
    for (h.tile = 0; h.tile < g->forest->ntiles; h.tile++) {
        if (extent == EVERY_CELL || extent == NEAR_CELLS) {
            if (s) activity_store_all(g, h.tile, s);
            runs_visit(g->forest, &g->forest->tile[h.tile], extent == NEAR_CELLS, hand_over, &h);
            continue;
        }
        if ((extent == EACH_STATE && activity_find(g, h.tile, s)) ||
            (extent == KEPT_STATES && activity_has_background(g, h.tile, s)))
            hand_over(&h, 0, 1); /* the background */
        varied_visit(g, h.tile, s, hand_over, &h);
    }
}

static void tiles_fill(const struct gas *g, int layers, int n, double *const *block) {
    forest_fill_layers(g->forest, layers, n, block);
}

void tiles_place(const struct gas *g, int tile, long offset, double place[3]) {
    const struct forest *f = g->forest;
    const struct tile *t = &f->tile[tile];
    long remains = offset - f->first, at[3] = {0, 0, 0};
    for (int k = 2; k >= 0; k--) {
        if (t->n[k] == 1 && k >= g->dim) continue;
        at[k] = remains / f->stride[k];
        remains -= at[k] * f->stride[k];
    }
    for (int k = 0; k < 3; k++) place[k] = 0;
    for (int k = 0; k < g->dim; k++)
        place[f->axis[k]] = f->origin[k] + f->width[k] * ((double)(t->low[k] + at[k]) + 0.5);
}

KERNEL static void rate_row(int n, double inverse, const double *restrict u, const double *restrict c,
                            double *restrict rate) {
    for (int i = 0; i < n; i++) rate[i] += (fabs(u[i]) + c[i]) * inverse;
}

/* The largest of n numbers >= 0, eight lanes at a time; a maximum does not depend on the order. */
KERNEL static double largest(int n, const double *restrict a) {
    double lane[8] = {0}, most = 0;
    int i = 0;
    for (; i + 8 <= n; i += 8)
        for (int j = 0; j < 8; j++) lane[j] = a[i + j] > lane[j] ? a[i + j] : lane[j];
    for (; i < n; i++) most = a[i] > most ? a[i] : most;
    for (int j = 0; j < 8; j++) most = lane[j] > most ? lane[j] : most;
    return most;
}

KERNEL static void fast_row(int n, const double *restrict u, const double *restrict c, double *restrict fast) {
    for (int i = 0; i < n; i++) fast[i] = fabs(u[i]) + c[i];
}

KERNEL static void loose_row(int n, double limit, const double *restrict rho, double *restrict rate) {
    for (int i = 0; i < n; i++) rate[i] = rho[i] < limit ? rate[i] : 0;
}

void speed_visit(void *context, long offset, int n) {
    struct speeds *s = context;
    struct gas *g = s->g;
    const struct work *w = &g->tiles->work;
    double rate[BATCH] = {0}, fast[BATCH];
    primitives_of_row(g, s->U, offset, n);
    if (g->tiles->fronts) range_widen(&s->p, n, w->p + offset);
    for (int k = 0; k < g->dim; k++) {
        rate_row(n, 1 / g->forest->width[k], w->velocity[k] + offset, w->c + offset, rate);
        fast_row(n, w->velocity[k] + offset, w->c + offset, fast);
        s->most.axis[k] = larger(s->most.axis[k], largest(n, fast));
    }
    s->most.rate = larger(s->most.rate, largest(n, rate));
    loose_row(n, PACKED * g->limits.most, s->U + offset, rate);
    s->most.loose = larger(s->most.loose, largest(n, rate));
}

void speed_of_background(struct speeds *s) {
    if (!s->last || !same_background(s->g, s->last, s->U)) {
        speed_visit(s, 0, 1);
        s->background = s->p;
    }
    s->p = s->background;
    s->last = s->U;
}

static void tiles_speed(struct gas *g, struct gas_speed *speed) {
    struct speeds s = {.g = g};
    for (int t = 0; t < g->forest->ntiles; t++) {
        s.U = g->U.block[t];
        s.p = RANGE_EMPTY;
        if (activity_find(g, t, &g->U)) speed_of_background(&s);
        varied_visit(g, t, &g->U, speed_visit, &s);
        fronts_note(g, t, &g->U, &s.p);
    }
    *speed = s.most;
    fronts_speed(g, speed);
}

static void tiles_speeds(struct gas *g, const struct state *s, const struct row *row, struct row_speeds *out) {
    const struct work *w = &g->tiles->work;
    const size_t bytes = (size_t)row->n * sizeof(double);
    primitives_of_row(g, s->block[row->block], row->at, row->n);
    memcpy(out->eps, w->eps + row->at, bytes);
    memcpy(out->p, w->p + row->at, bytes);
    memset(out->thin, 0, bytes);
    memset(out->flow, 0, bytes);
    for (int k = 0; k < g->dim; k++) {
        const double inverse = 1 / g->forest->width[k], *u = w->velocity[k] + row->at;
        rate_row(row->n, inverse, u, w->c + row->at, out->thin);
        for (int i = 0; i < row->n; i++) out->flow[i] += fabs(u[i]) * inverse;
    }
    memcpy(out->rate, out->thin, bytes);
}

const struct engine engine_lattice = {
    .state = {.make = tiles_make,
              .free = tiles_free,
              .cells = tiles_cells,
              .rows = tiles_rows,
              .unfold = activity_unfold,
              .fill = tiles_fill,
              .place = tiles_place,
              .sides = tiles_sides,
              .edges = tiles_edges,
              .ghosts = tiles_near_ghosts,
              .speed = tiles_speed,
              .speeds = tiles_speeds,
              .shear_rate = tiles_shear_rate},
    .stage = {.fronts = tiles_fronts, .stage = tiles_stage, .ends = true, .redo = tiles_redo},
    .diffusion = {.rates = tiles_diffusion_rates,
                  .begin = tiles_diffusion_begin,
                  .stage = tiles_diffusion_stage,
                  .end = tiles_diffusion_end,
                  .cross = tiles_diffusion_cross,
                  .spread = tiles_diffusion_spread,
                  .weight = tiles_implicit_weight},
    .bed = {.blocks = tiles_bed_blocks},
    .carried = {.rise = tiles_carried_rise,
                .terms = tiles_carried_terms,
                .most_out = tiles_carried_most_out,
                .move = tiles_carried_move}};
