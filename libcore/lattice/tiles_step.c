/* One time step's parts on a forest of tiles: sources, stages, and the flags of cells to be limited. */
#include "libcore/gas/state.h"

struct half_step {
    const struct gas *g;
    const double *from;
    double *to, dt, kick[MAX_DIM];
    long bad;
};

static void source_visit(void *context, long offset, int n) {
    struct half_step *h = context;
    const struct gas *g = h->g;
    double *U[MAX_VAR];
    for (int v = 0; v < g->nvar; v++) {
        U[v] = h->to + v * g->forest->size + offset;
        if (h->from != h->to) memcpy(U[v], h->from + v * g->forest->size + offset, (size_t)n * sizeof(double));
    }
    source_apply(&g->models.source, g->models.eos, &g->models.material, n, g->dim, h->dt, h->kick, U);
    h->bad += row_inadmissible(g, h->to, offset, n, NULL);
}

static void sources_of_tile(struct gas *g, int tile, struct half_step *h, const struct state *from,
                            const struct state *to) {
    h->from = from->block[tile];
    h->to = to->block[tile];
    if (activity_find(g, tile, from)) source_visit(h, 0, 1); /* the background */
    spans_visit(g, tile, from->varied[tile], 0, source_visit, h);
    if (to->varied != from->varied)
        memcpy(to->varied[tile], from->varied[tile], (size_t)g->activity.nspans * sizeof(struct span));
}

long tiles_sources(struct gas *g, double dt, const double kick[MAX_DIM], const struct state *from,
                   const struct state *to) {
    struct half_step h = {.g = g, .dt = dt};
    memcpy(h.kick, kick, sizeof h.kick);
    for (int i = 0; i < g->forest->ntiles; i++) sources_of_tile(g, i, &h, from, to);
    return h.bad;
}

struct census { /* of the flags of tiles */
    const double *flag;
    long count;
};

static void census_visit(void *context, long offset, int n) {
    struct census *c = context;
    for (int i = 0; i < n; i++) c->count += c->flag[offset + i] > 0;
}

/* Finds the tiles that the flags touch, too. */
long tiles_share_flags(struct gas *g) {
    struct census own = {0};
    for (int t = 0; t < g->forest->ntiles; t++) {
        own.flag = g->flag[t];
        rows_visit(g->forest, &g->forest->tile[t], 0, census_visit, &own);
    }
    comm_sum_long(g->comm, &own.count, 1);
    forest_fill(g->forest, 1, g->flag);
    for (int t = 0; t < g->forest->ntiles; t++) {
        struct census near = {.flag = g->flag[t]};
        rows_visit(g->forest, &g->forest->tile[t], 1, census_visit, &near);
        g->flagged[t] = near.count > 0;
    }
    return own.count;
}

struct noting { /* flags in the field `limited` */
    const struct gas *g;
    int tile;
    struct first_place first;
};

static void note_visit(void *context, long offset, int n) {
    struct noting *c = context;
    const double *flag = c->g->flag[c->tile];
    for (int i = 0; i < n; i++) {
        double here[3];
        if (flag[offset + i] == 0) continue;
        c->g->limited[c->tile][offset + i] += 1;
        cell_place(c->g, &c->g->forest->tile[c->tile], offset + i, here);
        first_place_offer(&c->first, here);
    }
}

void tiles_note_limited(struct gas *g, double place[3]) {
    struct noting c = {.g = g, .first.order = HUGE_VAL};
    for (c.tile = 0; c.tile < g->forest->ntiles; c.tile++)
        if (g->flagged[c.tile]) rows_visit(g->forest, &g->forest->tile[c.tile], 0, note_visit, &c);
    first_place_share(g, &c.first, place);
}

void tiles_clear_flags(struct gas *g) {
    for (int t = 0; t < g->forest->ntiles; t++) {
        memset(g->flag[t], 0, (size_t)g->forest->size * sizeof(double));
        g->flagged[t] = false;
    }
}

void tiles_redo(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                double dt) {
    g->faces = 0;
    for (int t = 0; t < g->forest->ntiles; t++)
        if (g->flagged[t]) (void)stage_of_tile(g, t, U0, from, to, a, dt);
}

struct flooring {
    struct gas *g;
    int tile;
    double *U; /* its block */
    long bad;
};

static void floor_visit(void *context, long offset, int n) {
    struct flooring *f = context;
    f->bad += floors_apply(f->g, n, f->g->forest->size, f->U + offset, f->tile, 0);
}

/* A background that needs the floor becomes cells as all others, so that each of them is counted. */
long tiles_floor(struct gas *g, const struct state *s) {
    struct flooring f = {.g = g};
    for (int t = 0; t < g->forest->ntiles; t++) {
        f.U = s->block[t];
        f.tile = t;
        if (row_inadmissible(g, f.U, 0, 1, NULL)) activity_unfold(g, t, s);
        spans_visit(g, t, s->varied[t], 0, floor_visit, &f);
    }
    return f.bad;
}

status tiles_sum_raised(const struct gas *g, double *raised, double *sum) {
    TRY(forest_sum(g->forest, raised, sum));
    *sum *= g->forest->volume;
    return OK;
}

struct finish { /* sources and wave speeds of a row at once */
    bool sources;
    struct half_step half;
    struct speeds speeds;
};

static void finish_visit(void *context, long offset, int n) {
    struct finish *f = context;
    if (f->sources) source_visit(&f->half, offset, n);
    speed_visit(&f->speeds, offset, n);
}

static void finish_tile(struct gas *g, int tile, const struct state *s, struct finish *f) {
    f->half.from = f->half.to = f->speeds.U = s->block[tile];
    if (activity_find(g, tile, s)) finish_visit(f, 0, 1); /* the background */
    spans_visit(g, tile, s->varied[tile], 0, finish_visit, f);
}

/* Ghosts travel while tiles that need none are computed. */
static long do_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                     double dt, struct finish *finish) {
    struct forest *f = g->forest;
    long bad = 0;
    activity_prepare(g, from);
    forest_fill_start(f, g->nvar, from->block);
    for (int remote = 0; remote < 2; remote++) {
        if (remote) forest_fill_finish(f);
        for (int t = 0; t < f->ntiles; t++) {
            if (f->tile[t].remote != (remote > 0)) continue;
            forest_fill_tile(f, t, g->activity.quiet + 6 * t);
            ghosts_of_patches(g, t, from->block[t]);
            bad += stage_of_tile(g, t, U0, from, to, a, dt);
            if (finish) finish_tile(g, t, to, finish);
        }
    }
    return bad;
}

long tiles_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                 double dt) {
    return do_stage(g, U0, from, to, a, dt, NULL);
}

long tiles_last_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                      double dt, struct ending *ending) {
    struct finish f = {.sources = ending->sources, .half = {.g = g, .dt = ending->dt}, .speeds = {.g = g, .found = -1}};
    memcpy(f.half.kick, ending->kick, sizeof f.half.kick);
    long bad = do_stage(g, U0, from, to, a, dt, &f);
    ending->speed = f.speeds.most;
    return bad + f.half.bad;
}

struct exchange {
    long size;
    int nvar;
    const double *start;
    double *next, *state;
};

static void exchange_visit(void *context, long offset, int n) {
    const struct exchange *x = context;
    for (int v = 0; v < x->nvar; v++)
        for (long i = v * x->size + offset; i < v * x->size + offset + n; i++)
            stepper_exchange(x->start[i], &x->next[i], &x->state[i]);
}

void tiles_exchange(struct gas *g, const struct state *start, const struct state *next, const struct state *state) {
    for (int t = 0; t < g->forest->ntiles; t++) {
        struct exchange x = {g->forest->size, g->nvar, start->block[t], next->block[t], state->block[t]};
        activity_store_all(g, t, start);
        activity_store_all(g, t, state);
        rows_visit(g->forest, &g->forest->tile[t], 0, exchange_visit, &x);
        exchange_visit(&x, 0, 1); /* the background */
        for (int i = 0; i < g->activity.nspans; i++)
            next->varied[t][i] = state->varied[t][i] = span_join(start->varied[t][i], state->varied[t][i]);
    }
}
