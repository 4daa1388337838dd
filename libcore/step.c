/* One time step: sources, Runge-Kutta stages with their safety net, rejection. */
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

/* to = the sources applied to from, over dt from t on */
static void apply_sources(struct gas *g, double t, double dt, const struct state *from, const struct state *to) {
    struct half_step h = {.g = g, .dt = dt};
    source_kick(&g->models.source, t, dt, h.kick);
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

/* Counts the flagged cells by level, sends the flags to the neighbours, and finds the tiles they touch. */
static void share_flags(struct gas *g, long count[3]) {
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

static void clear_flags(struct gas *g) {
    for (int t = 0; t < g->forest->ntiles; t++) {
        memset(g->flag[t], 0, (size_t)g->forest->size * sizeof(double));
        g->flagged[t] = false;
    }
}

/* The largest of one number over the ranks. */
static long any_rank(const struct gas *g, long mine) {
    double value = (double)mine;
    comm_max(g->forest->comm, &value, 1);
    return (long)value;
}

/* Redoes what stage left inadmissible, first with first-order faces, then with Rusanov's; false: not to be mended. */
static bool mend_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to,
                       double a, double dt) {
    long count[3], before[3] = {0, 0, 0}, bad = 1;
    while (bad) {
        share_flags(g, count);
        if (count[2]) return false;
        g->counts.first_order += count[0] + count[1] - before[0] - before[1];
        g->counts.rusanov += count[1] - before[1];
        memcpy(before, count, sizeof before);
        bad = 0;
        for (int t = 0; t < g->forest->ntiles; t++)
            if (g->flagged[t]) bad += stage_of_tile(g, t, U0, from, to, a, dt);
        bad = any_rank(g, bad);
    }
    return true;
}

/* to = the stage of from; ghosts travel while tiles that need none are computed. */
static bool do_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                     double dt) {
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
        }
    }
    if (!any_rank(g, bad)) return true;
    bool mended = mend_stage(g, U0, from, to, a, dt);
    clear_flags(g);
    return mended;
}

static void swap(struct state *a, struct state *b) {
    struct state c = *a;
    *a = *b;
    *b = c;
}

/* The stages from U0 (left as it is, if it is not g->U0) to V; false: some state could not be mended. */
static bool do_stages(struct gas *g, const struct state *U0, double dt) {
    const struct stepper *s = g->models.stepper;
    for (int stage = 0; stage < s->stages; stage++) {
        if (!do_stage(g, U0, stage ? &g->V : U0, &g->W, s->a[stage], s->b[stage] * dt)) return false;
        swap(&g->V, &g->W);
        if (stage + 1 != s->exchange) continue;
        stepper_exchange(g, U0, &g->U0, &g->V);
        U0 = &g->U0;
    }
    return true;
}

static status collapse(struct gas *g, double t, double dt, const struct gas_speed *speed) {
    double place[3];
    const struct gas_counts *c = &g->counts;
    gas_fastest_place(g, speed, place);
    return fail(
        ERR_STATE,
        "inelastic collapse at t = %.10g, (%.6g %.6g %.6g): the time step falls to %.3g s there, as it does when the "
        "gas reaches close packing; the exact problem ends here, the last good state is kept\n"
        "  so far the safety net redid %ld cells at first order, %ld with Rusanov's flux, and rejected %ld steps%s",
        t, place[0], place[1], place[2], dt, c->first_order, c->rusanov, c->rejected,
        c->first_order > 1000 ? ": so many point at a noisy flux; compare with fluxScheme common" : "");
}

status gas_step(struct gas *g, double t, double *dt, double maxCo, double least, double fraction,
                const struct gas_speed *speed) {
    const bool sources = source_active(&g->models.source, &g->models.material);
    double allowed = maxCo / speed->rate, floor = fraction * (speed->calm > 0 ? maxCo / speed->calm : 0);
    floor = larger(floor, least);
    if (allowed < floor) return collapse(g, t, allowed, speed);
    floor = smaller(floor, fraction * *dt);
    for (int k = 0; k < g->dim; k++) g->fastest[k] = speed->axis[k];
    for (;;) {
        if (sources) apply_sources(g, t, 0.5 * *dt, &g->U, &g->U0);
        if (do_stages(g, sources ? &g->U0 : &g->U, *dt)) break;
        g->counts.rejected++;
        *dt *= 0.5;
        if (*dt < floor) return collapse(g, t, *dt, speed);
    }
    if (sources) apply_sources(g, t + 0.5 * *dt, 0.5 * *dt, &g->V, &g->V);
    swap(&g->U, &g->V);
    return OK;
}

struct gas_counts gas_counts(const struct gas *g) {
    return g->counts;
}

double gas_computed_share(const struct gas *g) {
    long count[2] = {g->computed, g->all};
    comm_sum_long(g->forest->comm, count, 2);
    return count[1] ? (double)count[0] / (double)count[1] : 1;
}
