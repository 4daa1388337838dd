/* One time step's parts on a forest of tiles: sources, stages, and the flags of the safety net. */
#include "libcore/state.h"

struct half_step {
    const struct gas *g;
    const double *from;
    double *to, dt, kick[MAX_DIM];
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

void tiles_sources(struct gas *g, double dt, const double kick[MAX_DIM], const struct state *from,
                   const struct state *to) {
    struct half_step h = {.g = g, .dt = dt};
    memcpy(h.kick, kick, sizeof h.kick);
    for (int i = 0; i < g->forest->ntiles; i++) sources_of_tile(g, i, &h, from, to);
}

struct census { /* of the flags of one tile */
    struct gas *g;
    const double *flag;
    long count[3]; /* cells at level 1, 2, beyond */
    bool any;
};

static void census_visit(void *context, long offset, int n) {
    struct census *c = context;
    for (int i = 0; i < n; i++) {
        int level = (int)c->flag[offset + i];
        c->any |= level > 0;
        if (level > 0) c->count[level > LEVEL_RUSANOV ? 2 : level - 1]++;
    }
}

/* Finds the tiles that the flags touch, too. */
void tiles_share_flags(struct gas *g, long count[3]) {
    for (int i = 0; i < 3; i++) count[i] = 0;
    for (int t = 0; t < g->forest->ntiles; t++) {
        struct census c = {.g = g, .flag = g->flag[t]};
        rows_visit(g->forest, &g->forest->tile[t], 0, census_visit, &c);
        for (int i = 0; i < 3; i++) count[i] += c.count[i];
    }
    comm_sum_long(g->forest->comm, count, 3);
    forest_fill(g->forest, 1, g->flag);
    for (int t = 0; t < g->forest->ntiles; t++) {
        struct census c = {.g = g, .flag = g->flag[t]};
        rows_visit(g->forest, &g->forest->tile[t], 1, census_visit, &c);
        g->flagged[t] = c.any;
    }
}

void tiles_clear_flags(struct gas *g) {
    for (int t = 0; t < g->forest->ntiles; t++) {
        memset(g->flag[t], 0, (size_t)g->forest->size * sizeof(double));
        g->flagged[t] = false;
    }
}

long tiles_redo(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                double dt) {
    long bad = 0;
    for (int t = 0; t < g->forest->ntiles; t++)
        if (g->flagged[t]) bad += stage_of_tile(g, t, U0, from, to, a, dt);
    return bad;
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
    return bad;
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
