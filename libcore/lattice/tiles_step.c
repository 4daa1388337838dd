/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A time step's parts on a lattice: stages over all tiles, the closing of a step. */
#include "libcore/lattice/tiles.h"

void tiles_redo(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                double dt) {
    g->limits.faces = 0;
    drop_begin(g);
    for (int t = 0; t < g->forest->ntiles; t++)
        if (g->limits.flags.blocks[t]) {
            to->calm[t] = false;
            (void)stage_of_tile(g, t, U0, from, to, a, dt);
        }
}

struct closing { /* the second half of the sources and the wave speeds of a row at once */
    int tile;
    struct half_step half;
    struct speeds speeds;
};

static void close_visit(void *context, long offset, int n) {
    struct closing *c = context;
    if (c->half.plan) source_row(&c->half, &(struct row){c->tile, offset, n});
    speed_visit(&c->speeds, offset, n);
}

static void close_tile(struct gas *g, int tile, const struct state *s, struct closing *c) {
    c->tile = tile;
    c->half.from = c->half.to = s;
    c->speeds.U = s->block[tile];
    c->speeds.p = RANGE_EMPTY;
    if (activity_find(g, tile, s)) {
        if (c->half.plan) source_row(&c->half, &(struct row){tile, 0, 1});
        speed_of_background(&c->speeds);
    }
    varied_visit(g, tile, s, close_visit, c);
    fronts_note(g, tile, s, &c->speeds.p);
}

struct settled { /* the background that was advanced last, which many tiles have in common */
    int tile;    /* -1: there is none */
    double to[MAX_VAR];
};

/* Advances the background of a calm tile, a cell whose residual is that of gravity alone, or takes the last one. */
static void settle_tile(struct gas *g, int tile, const struct state *U0, const struct state *from,
                        const struct state *to, double a, double dt, struct settled *last) {
    const double none[MAX_VAR] = {0},
                 *falls = g->falling.cells && g->falling.blocks[tile] ? g->falling.cells[tile] : NULL;
    const struct advance s = {U0->block[tile], from->block[tile], none, 1, to->block[tile], a, dt, NULL};
    const int *n = g->forest->tile[tile].n;
    if (last->tile < 0 || falls || !same_background(g, s.U0, U0->block[last->tile]) ||
        !same_background(g, s.from, from->block[last->tile])) {
        advance_row(g, 1, &s, falls, NULL);
        last->tile = falls ? -1 : tile;
        for (int v = 0; v < g->nvar; v++) last->to[v] = s.to[v * g->size];
    }
    for (int v = 0; v < g->nvar; v++) s.to[v * g->size] = last->to[v];
    if (g->books.tally) tiles_tally_begin(g, tile, s.from);
    if (g->carried) tiles_carry_begin(g, tile, s.from);
    activity_empty(g, tile, to);
    g->counts.all += (long)n[0] * n[1] * n[2];
}

/* One stage of all tiles: ghosts travel while the tiles that need none from other ranks are computed. */
static long do_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                     double dt, struct closing *closing) {
    struct forest *f = g->forest;
    const int reach = g->tiles->activity.reach;
    long bad = 0;
    struct settled last = {.tile = -1};
    activity_prepare(g, from);
    seams_begin(g);
    forest_fill_start(f, reach, g->nvar, from->block);
    for (int remote = 0; remote < 2; remote++) {
        if (remote) forest_fill_finish(f);
        for (int t = 0; t < f->ntiles; t++) {
            if (f->tile[t].remote != (remote > 0)) continue;
            const bool *quiet = g->tiles->activity.quiet + 6 * t;
            if (activity_calm(g, t, U0, from)) {
                settle_tile(g, t, U0, from, to, a, dt, &last);
            } else {
                forest_fill_tile(f, t, quiet);
                ghosts_of_patches(g, t, from->block[t], reach, quiet);
                to->calm[t] = false;
                bad += stage_of_tile(g, t, U0, from, to, a, dt);
            }
            if (closing) close_tile(g, t, to, closing);
        }
    }
    return bad;
}

long tiles_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                 double dt, struct ending *ending) {
    if (!ending) return do_stage(g, U0, from, to, a, dt, NULL);
    struct closing c = {.half = {.g = g, .plan = ending->sources}, .speeds = {.g = g}};
    long bad = do_stage(g, U0, from, to, a, dt, &c);
    ending->speed = c.speeds.most;
    fronts_speed(g, &ending->speed);
    return bad + c.half.bad;
}
