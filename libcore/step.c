/* One time step: sources, Runge-Kutta stages with their safety net, rejection. */
#include "libcore/state.h"

/* to = the sources applied to from, over dt from t on */
static void apply_sources(struct gas *g, double t, double dt, const struct state *from, const struct state *to) {
    double kick[MAX_DIM];
    source_kick(&g->models.source, t, dt, kick);
    g->engine->sources(g, dt, kick, from, to);
}

/* The largest of one number over the ranks. */
static long any_rank(const struct gas *g, long mine) {
    double value = (double)mine;
    comm_max(g->comm, &value, 1);
    return (long)value;
}

/* Redoes what stage left inadmissible, first with first-order faces, then with Rusanov's; false: not to be mended. */
static bool mend_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to,
                       double a, double dt) {
    long count[3], before[3] = {0, 0, 0}, bad = 1;
    while (bad) {
        g->engine->share_flags(g, count);
        if (count[2]) return false;
        g->counts.first_order += count[0] + count[1] - before[0] - before[1];
        g->counts.rusanov += count[1] - before[1];
        memcpy(before, count, sizeof before);
        bad = any_rank(g, g->engine->redo(g, U0, from, to, a, dt));
    }
    return true;
}

static bool do_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                     double dt) {
    if (!any_rank(g, g->engine->stage(g, U0, from, to, a, dt))) return true;
    bool mended = mend_stage(g, U0, from, to, a, dt);
    g->engine->clear_flags(g);
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
        g->engine->exchange(g, U0, &g->U0, &g->V);
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
    comm_sum_long(g->comm, count, 2);
    return count[1] ? (double)count[0] / (double)count[1] : 1;
}
