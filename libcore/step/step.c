/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One time step: sources, diffusion, Runge-Kutta stages in the order of docs/physics.md 7.2, the limiting that keeps
 * the state admissible, rejection.
 *
 * A stage is computed at high order. If a cell is inadmissible after it, or denser and all but packed, the cell is
 * flagged and the stage is done again with the fluxes through flagged cells' faces limited (libcore/schemes/limit.h).
 * That may spoil a neighbour, which is then flagged, too; flags only grow, so this ends. Then flagged cells are
 * admissible by the theorem of limit.h, and the others were checked. Smooth flow pays nothing and keeps its order and
 * its bits. If the theorem's Courant number was exceeded and a flagged cell is inadmissible all the same, the step is
 * rejected and done again with half of dt or less. */
#include "libcore/gas/gas_private.h"

enum {
    GUARDED = 16, /* steps that are guarded after one that found an inadmissible cell */
    SLOW = 50,    /* a collapse: after so many consecutive tiny steps dt falls by half within as many more */
    STUCK = 500   /* a collapse: so many consecutive tiny steps; dense gas that hits a wall needs some and recovers */
};
/* A rejected step is shortened at most by this factor at once, as the shorter step heats less. */
static const double LEAST_SHARE = 1. / 16;
/* A step that is no longer than so many last digits of t is the end: t would be off by a hundredth of it. */
static const double DIGITS = 64;

/* Cells are cold below so many squares of the velocity that gravity gives in a step: an Euler step of a warm cell takes
 * half of that square from its eps, so that at most 1/8 of eps is lost. */
static const double WARM = 4;

/* Returns the fraction of dt at which a stage begins: the sum of the stages before it, for dU/dt = 1. */
static double part_of(const struct stepper *s, int stage) {
    double start = 0, state = 0, next = 0;
    for (int i = 0; i < stage; i++) {
        state += s->b[i];
        state += s->a[i] * (start - state);
        if (i + 1 != s->exchange) continue;
        stepper_exchange(start, &next, &state);
        start = next;
    }
    return state;
}

/* Gives the patches their values at the time of a stage. */
static void set_time(struct gas *g, double t, double dt, int stage) {
    if (g->patches.renew) renew_patches(g, t + part_of(g->models.stepper, stage) * dt);
}

/* Returns the eps above which cells are warm. */
static double warm_of(const struct gas *g, double t, double dt) {
    double gravity[MAX_DIM], square = 0;
    source_gravity(&g->models.source, t, dt, gravity);
    for (int k = 0; k < g->components; k++) {
        const double gained = dt * gravity[k];
        square += gained * gained;
    }
    return WARM * square;
}

/* Plans the sources over the first half of a step of dt from t on, or over the second half, in which they act
 * backwards. */
static void plan_all(const struct gas *g, double t, double dt, bool second, struct source_plan *out) {
    const struct gas_models *m = &g->models;
    source_plan(&m->source, m->eos, &m->material, g->components, second ? t + 0.5 * dt : t, 0.5 * dt, second, out);
}

/* In a step with a bed gravity is not among the sources. */
static void plan_sources(const struct gas *g, double t, double dt, bool second, struct source_plan *out) {
    plan_all(g, t, dt, second, out);
    if (g->step.hybrid) source_plan_part(out, false);
}

/* No cell falls any more. */
static void forget_falling(struct gas *g) {
    const int blocks = g->forest ? g->forest->ntiles : 1;
    const long cells = g->forest ? g->size : g->floors.step * (long)g->floors.places;
    for (int b = 0; b < blocks; b++)
        if (g->falling.blocks[b]) {
            memset(g->falling.cells[b], 0, (size_t)cells * sizeof *g->falling.cells[b]);
            g->falling.blocks[b] = false;
        }
}

/* Applies half the sources of a step to `from`, into `to`; returns this rank's number of inadmissible cells. W is
 * scratch. */
static long half_sources(struct gas *g, double t, double dt, bool second, const struct state *from,
                         const struct state *to) {
    struct source_plan plan;
    plan_sources(g, t, dt, second, &plan);
    if (g->falling.cells && !second && !g->step.hybrid) {
        plan.warm = warm_of(g, t, dt);
        forget_falling(g);
    }
    audit_sources(g, &plan, from, &g->W);
    const long bad = sources_apply(g, &plan, from, to);
    audit_sourced(g, to);
    return bad;
}

/* Returns the largest over the ranks of each rank's number. */
static long any_rank(const struct gas *g, long mine) {
    double value = (double)mine;
    comm_max(g->comm, &value, 1);
    return (long)value;
}

/* Returns the fraction of an amount added after a stage that the result of the step holds: later stages are linear in
 * it. */
static double share_of(const struct stepper *s, int added) {
    double start = 0, state = 0, next = 0;
    for (int stage = 0; stage < s->stages; stage++) {
        state += s->a[stage] * (start - state);
        if (stage == added) state += 1;
        if (stage + 1 != s->exchange) continue;
        stepper_exchange(start, &next, &state);
        start = next;
    }
    return state;
}

/* Does a stage again with limited fluxes until no further cell must be flagged, then applies the floors. Returns false
 * if a cell of any rank is inadmissible all the same. */
static bool mend_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to,
                       double a, double dt) {
    long cells, before = 0;
    for (; (cells = g->engine->stage.share_flags(g)) > before && !asked_to_leave(g); before = cells)
        g->engine->stage.redo(g, U0, from, to, a, dt);
    audit_dropped(g, (1 - a) * g->floors.share);
    long count[2] = {g->limits.faces, floors_apply(g, to)};
    comm_sum_long(g->comm, count, 2);
    g->counts.now.cells += cells;
    g->counts.now.faces += count[0];
    if (g->step.asked && !g->step.held) g->engine->stage.hold_limited(g, false);
    g->step.held = g->step.asked;
    g->engine->stage.note_limited(g, g->counts.now.place);
    g->engine->stage.clear_flags(g);
    return count[1] == 0 && !g->step.left;
}

static void swap(struct state *a, struct state *b) {
    struct state c = *a;
    *a = *b;
    *b = c;
}

struct exchange { /* of struct stepper, on the rows of three states */
    const struct gas *g;
    const struct state *start, *next, *state;
};

static void exchange_row(void *exchange, const struct row *row) {
    const struct exchange *x = exchange;
    for (int v = 0; v < x->g->nvar; v++) {
        const long at = v * x->g->size + row->at;
        const double *start = x->start->block[row->block] + at;
        double *next = x->next->block[row->block] + at, *state = x->state->block[row->block] + at;
        for (int i = 0; i < row->n; i++) stepper_exchange(start[i], &next[i], &state[i]);
    }
}

/* next = 0.1 start + 0.9 state, state = 0.6 start + 0.4 state; next may be start. */
static void exchange(struct gas *g, const struct state *start, const struct state *next, const struct state *state) {
    const struct state_hooks *hooks = &g->engine->state;
    if (hooks->join) hooks->join(g, start, state);
    hooks->rows(g, KEPT_STATES, state, exchange_row, &(struct exchange){g, start, next, state});
    if (hooks->keep_as) hooks->keep_as(g, state, next);
}

/* Moves the stage's result from W to V, where the next stage starts; returns the next stage's U0. */
static const struct state *after_stage(struct gas *g, const struct state *U0, int stage) {
    swap(&g->V, &g->W);
    if (stage + 1 != g->models.stepper->exchange) return U0;
    exchange(g, U0, &g->U0, &g->V);
    return &g->U0;
}

bool speed_share(struct gas *g, const struct gas_speed *mine, bool is_void) {
    double all[] = {is_void,       mine->rate,    mine->calm, mine->axis[0],
                    mine->axis[1], mine->axis[2], -mine->low, mine->high};
    comm_max(g->comm, all, 8);
    g->step.speed = (struct gas_speed){
        .rate = all[1], .calm = all[2], .axis = {all[3], all[4], all[5]}, .low = -all[6], .high = all[7]};
    g->step.speed_known = all[0] == 0;
    return g->step.speed_known;
}

/* Does the diffusion over dt/2 from t on. Notes the mean acceleration by the sources: it pulls the gas onto walls,
 * whose pressure then exceeds that of the cells beside them. */
static bool diffuse_half(struct gas *g, const struct state *from, const struct state *to, double t, double dt,
                         bool second, long bad) {
    const struct gas_models *m = &g->models;
    source_pull(&m->source, m->eos, &m->material, g->components, t, 0.5 * dt, g->diffusion.pull);
    return diffuse(g, from, to, t, 0.5 * dt, second, bad);
}

/* Does the second half of the diffusion on V. Returns false, on all ranks, if a state was or is not admissible. */
static bool second_diffusion(struct gas *g, double t, double dt, long bad) {
    if (!diffuse_half(g, &g->V, &g->W, t + 0.5 * dt, dt, true, bad)) return false;
    swap(&g->V, &g->W);
    return true;
}

/* Does the first halves of sources and diffusion. Returns the state that the stages start from, with *bad inadmissible
 * cells on this rank; or NULL, on all ranks, if diffusion failed. In a guarded step the floors mend the cells that the
 * sources left inadmissible. */
static const struct state *first_halves(struct gas *g, double t, double dt, bool sources, bool guarded, long *bad) {
    const struct state *U0 = &g->U, *before = g->models.transport ? &g->V : &g->U0;
    *bad = 0;
    if (guarded) floors_begin(g);
    if (sources) {
        *bad = half_sources(g, t, dt, false, &g->U, before);
        if (guarded) {
            *bad = floors_apply(g, before);
            audit_part(g, GAS_FLOORS, before);
        }
        U0 = before;
        if (g->models.transport && source_thermal(&g->models.source)) note_cooled(g, &g->U, before);
    }
    if (!g->models.transport) return U0;
    return diffuse_half(g, U0, &g->U0, t, dt, false, *bad) ? &g->U0 : NULL;
}

/* Ends a step that was not guarded. Only here do the ranks ask each other whether all cells are admissible, so that no
 * rank waits for all others at every stage. Returns false if some were not: then V is of no use, and the step must be
 * done again from its start, guarded. */
static bool end_unguarded(struct gas *g, const struct ending *ending, long bad, bool at_once) {
    if (!speed_share(g, &ending->speed, bad > 0)) {
        g->step.guarded = GUARDED;
        g->engine->stage.clear_flags(g);
        return false;
    }
    g->step.speed_known = at_once;
    return true;
}

/* Ends a guarded step, in which the second half of the sources left `bad` cells inadmissible; the floors may mend them.
 * Returns false if some remain inadmissible. */
static bool end_guarded(struct gas *g, long bad) {
    g->floors.share = 1;
    bad = any_rank(g, bad);
    if (bad) bad = any_rank(g, floors_apply(g, &g->V));
    audit_part(g, GAS_FLOORS, &g->V);
    return !bad;
}

/* Mends a stage that left cells of some rank inadmissible; returns false if it cannot. */
static bool guard_stage(struct gas *g, int stage, const struct state *U0, const struct state *from, double a,
                        double dt) {
    g->step.guarded = GUARDED;
    g->floors.share = share_of(g->models.stepper, stage);
    return mend_stage(g, U0, from, &g->W, a, dt);
}

/* Gravity's half step on cells that fall freely, beside a bed: in the first half these are found. */
static void kick_falling(struct gas *g, double t, double dt, bool second, const struct state *s) {
    struct source_plan plan;
    if (!g->falling.cells || g->dense->alone) return;
    plan_all(g, t, dt, second, &plan);
    source_plan_part(&plan, true);
    if (!second) forget_falling(g);
    find_falling(g, second ? -1 : warm_of(g, t, dt), s);
    if (second) audit_part(g, GAS_FLOW, s);
    audit_sources(g, &plan, s, &g->W);
    (void)sources_apply(g, &plan, s, s);
    audit_sourced(g, s);
}

/* Prepares the stages of a step with a bed from the state U0 after its first halves. Returns whether it can be made. */
static bool start_bed(struct gas *g, const struct state *U0, double t, double dt, long bad) {
    if (any_rank(g, bad)) return false;
    renew_patches(g, t + dt); /* the bed's step is implicit */
    g->dense->failed = dense_begin(g, U0);
    if (g->dense->failed) return false;
    kick_falling(g, t, dt, false, U0);
    return true;
}

/* Ends a step with a bed, whose stages left V and `bad` inadmissible cells on this rank. The bed is given back its
 * start, so that it takes part in the second halves, and is advanced last: they would leave its pressure out of
 * balance. */
static bool end_bed(struct gas *g, double t, double dt, bool sources, bool guarded, long bad) {
    if (any_rank(g, bad)) {
        g->engine->stage.clear_flags(g);
        return false;
    }
    (void)g->engine->bed.put(g, &g->V);
    kick_falling(g, t, dt, true, &g->V);
    audit_part(g, GAS_FLOW, &g->V);
    if (g->models.transport && !second_diffusion(g, t, dt, 0)) return false;
    if (sources && any_rank(g, half_sources(g, t, dt, true, &g->V, &g->V))) return false;
    g->engine->bed.take(g, &g->V, true);
    if (!dense_advance(g, t, dt, guarded, &g->V)) return false;
    tally_bed(g, dt);
    audit_bed(g);
    audit_part(g, GAS_FLOW, &g->V);
    return true;
}

/* Does the Runge-Kutta stages from U0 to V, and the second halves of diffusion and sources. bad: cells of this rank
 * that the first halves left inadmissible. In a guarded step every stage is looked at, and its inadmissible cells are
 * mended at once; where there are none, the bits are those of a step that is not guarded. Returns false if V is of no
 * use. */
static bool do_stages(struct gas *g, const struct state *U0, double t, double dt, bool sources, bool guarded,
                      long bad) {
    const struct stepper *s = g->models.stepper;
    struct source_plan plan;
    struct ending ending = {.sources = sources ? &plan : NULL};
    const bool at_once =
        !guarded && g->engine->stage.last_stage && !g->models.transport && !g->audit && !g->step.hybrid;
    g->step.dt = dt;
    if (g->falling.cells) source_gravity(&g->models.source, t, dt, g->falling.gravity);
    if (guarded && sources && !g->step.hybrid && any_rank(g, bad)) return false;
    plan_sources(g, t, dt, true, &plan);
    const int stages = g->step.hybrid && g->dense->alone ? 0 : s->stages;
    for (int stage = 0; stage < stages; stage++) {
        const struct state *from = stage ? &g->V : U0;
        const double a = s->a[stage], b = s->b[stage] * dt;
        set_time(g, t, dt, stage);
        audit_weight(g, from, (1 - a) * share_of(s, stage) * b);
        const long found = at_once && stage + 1 == s->stages
                               ? g->engine->stage.last_stage(g, U0, from, &g->W, a, b, &ending)
                               : g->engine->stage.stage(g, U0, from, &g->W, a, b);
        if (!guarded)
            bad += found;
        else if (any_rank(g, found) && !guard_stage(g, stage, U0, from, a, b))
            return false;
        tally_stage(g, (1 - a) * share_of(s, stage) * b);
        audit_rest(g, (1 - a) * share_of(s, stage) * b);
        if (g->step.hybrid) dense_keep(g, (1 - a) * share_of(s, stage) * s->b[stage]);
        U0 = after_stage(g, U0, stage);
    }
    if (guarded) bad = 0;
    if (g->step.hybrid) return end_bed(g, t, dt, sources, guarded, bad);
    audit_part(g, GAS_FLOW, &g->V);
    if (g->models.transport && !second_diffusion(g, t, dt, bad)) {
        if (guarded) return false;
        bad++;
    }
    if (sources && !at_once) bad += half_sources(g, t, dt, true, &g->V, &g->V);
    return !guarded ? end_unguarded(g, &ending, bad, at_once) : !sources || end_guarded(g, bad);
}

/* Returns the largest rate of wave speeds (1/s), over all ranks, in U0, from which the stages start. */
static double rate_of_start(struct gas *g) {
    struct gas_speed after;
    swap(&g->U, &g->U0);
    g->engine->state.speed(g, &after);
    swap(&g->U, &g->U0);
    comm_max(g->comm, &after.rate, 1);
    return after.rate;
}

/* Returns dt of the attempt after a rejected one: half of it, or less if the first half of diffusion or of sources that
 * heat made the gas so much hotter that its wave speeds demand it: dt was chosen by the state before that. Only
 * rejected steps are shortened in this way, because a restart does not know which steps were guarded. */
static double shorter(struct gas *g, const struct state *U0, double dt, double maxCo) {
    if (!(g->models.transport || source_heats(&g->models.source)) || !U0) return 0.5 * dt;
    const double share = maxCo / (dt * rate_of_start(g));
    return dt * (share < LEAST_SHARE ? LEAST_SHARE : share < 0.5 ? share : 0.5);
}

/* Did sources make the gas so hot that a step of dt, which was chosen by the wave speeds before, is far too long? In
 * cold gas dt is long, and a thermostat would heat the gas a great deal before it first moves. */
static bool overheated(struct gas *g, double dt, double maxCo, const struct gas_speed *speed) {
    if (!source_heats(&g->models.source)) return false;
    const double rate = rate_of_start(g);
    g->engine->stage.fronts(g, speed); /* those that came with the speeds of U0 are of another state */
    return rate > 2 * speed->rate && dt * rate > 2 * maxCo;
}

static void attempt_begin(struct gas *g) {
    g->diffusion.stiff.found = g->step.left = false;
    g->diffusion.unasked = 0;
    audit_begin(g);
    tally_begin(g);
}

/* Ends a step that is left: the state is still that at its start, and so become the counts. */
static status leave(struct gas *g, const struct gas_counts *start, double *dt) {
    if (g->step.held) g->engine->stage.hold_limited(g, true);
    g->counts.now = *start;
    g->engine->stage.clear_flags(g);
    *dt = 0;
    return OK;
}

/* Is diffusion too stiff in the state that the step starts from? If a source has heated the gas a great deal in the
 * first half, or the stages have, a shorter step is not. */
static bool hopeless(const struct gas *g) {
    return g->diffusion.stiff.found && !g->diffusion.stiff.second && !source_heats(&g->models.source);
}

struct attempt {            /* at a step */
    bool guarded, hot;      /* hot: sources heated the gas too much */
    const struct state *U0; /* the start of the stages; NULL: diffusion, or the making of a bed, failed */
};

/* Is a step of dt one with implicit acoustics? allowed: the explicit step. */
static bool takes_bed(const struct gas *g, double dt, double allowed) {
    return g->dense && g->dense->longest > 0 && dt > allowed;
}

/* Tries a step of dt from g->U to g->V; returns whether V is of use. */
static bool try_step(struct gas *g, double t, double dt, double maxCo, const struct gas_speed *speed,
                     struct attempt *a) {
    const bool sources = source_active(&g->models.source, &g->models.material);
    long bad;
    *a = (struct attempt){.guarded = g->step.guarded > 0};
    attempt_begin(g);
    g->step.hybrid = takes_bed(g, dt, maxCo / speed->rate);
    a->U0 = first_halves(g, t, dt, sources, a->guarded, &bad);
    if (a->U0 && g->step.hybrid && !start_bed(g, a->U0, t, dt, bad)) a->U0 = NULL;
    a->hot = a->U0 && !g->step.hybrid && overheated(g, dt, maxCo, speed);
    return a->U0 && !a->hot && do_stages(g, a->U0, t, dt, sources, a->guarded, bad);
}

/* Returns the error because of which a bed could not be made or advanced at any dt; OK: there was none. */
static status bed_failure(struct gas *g) {
    status s = OK;
    if (!g->dense) return s;
    s = g->dense->failed;
    g->dense->failed = OK;
    return s;
}

/* Returns the error of values of patches that could not be renewed in an attempt; OK: there was none. */
static status renewal_failure(struct gas *g) {
    const status s = g->patches.failed;
    g->patches.failed = OK;
    return s;
}

/* Counts a step that stands. */
static status count_step(struct gas *g) {
    if (g->step.guarded > 0) {
        TRY(floors_count(g));
        if (g->floors.filled || g->floors.floored) g->step.guarded = GUARDED;
        g->step.guarded--;
    }
    if (g->step.hybrid) TRY(dense_count(g));
    g->step.hybrid = false;
    return OK;
}

status gas_step(struct gas *g, double t, double *dt, double maxCo, double least, double fraction,
                const struct gas_speed *speed) {
    struct attempt tried;
    if (!isfinite(speed->rate)) return stop_of_speed(g, t, speed);
    const double allowed = maxCo / speed->rate, asked = *dt;
    const struct gas_counts start = g->counts.now;
    const bool creeps = !g->dense || g->dense->longest == 0;
    const double calm = creeps && gas_can_collapse(g) && speed->calm > 0 ? fraction * (maxCo / speed->calm) : 0;
    if ((creeps && allowed < least) || (allowed < calm && g->step.slow < 0))
        return stop_of_collapse(g, t, allowed, speed);
    if (g->step.slow >= STUCK || (g->step.slow >= 2 * SLOW && g->step.slow_dt[1] < 0.5 * g->step.slow_dt[0]))
        return stop_of_collapse(g, t, g->step.slow_dt[1], speed);
    for (int k = 0; k < g->dim; k++) g->step.fastest[k] = speed->axis[k];
    g->step.speed_known = g->step.held = false;
    g->step.hybrid = takes_bed(g, *dt, allowed); /* whose dense tiles are written out, and remain so */
    for (;;) {
        if (t + *dt / DIGITS == t) return stop_of_time(g, t, *dt, speed);
        g->engine->stage.fronts(g, speed);
        const bool stands = try_step(g, t, *dt, maxCo, speed, &tried);
        TRY(renewal_failure(g));
        if (stands) break;
        TRY(bed_failure(g));
        if (dense_refused(g, dt)) return gas_step(g, t, dt, maxCo, least, fraction, speed);
        if (asked_to_leave(g)) return leave(g, &start, dt);
        if (hopeless(g) && !g->step.hybrid) return stop_of_diffusion(g, t);
        if (!tried.guarded && !tried.hot) {
            g->step.guarded = GUARDED;
            continue;
        }
        g->counts.now.rejected++;
        *dt = g->step.hybrid ? 0.5 * *dt : shorter(g, tried.U0, *dt, maxCo);
        if (*dt < smaller(least, asked) || *dt < 1e-12 * asked)
            return g->diffusion.stiff.found ? stop_of_diffusion(g, t) : stop_of_collapse(g, t, *dt, speed);
    }
    bool tiny = *dt < calm && (allowed < calm || *dt < fraction * asked);
    g->step.slow = !tiny ? 0 : g->step.slow > 0 ? g->step.slow + 1 : 1;
    if (g->step.slow % SLOW == 1) g->step.slow_dt[0] = *dt;
    g->step.slow_dt[1] = *dt;
    TRY(count_step(g));
    dense_pass(g, *dt);
    swap(&g->U, &g->V);
    tally_keep(g, *dt);
    return audit_keep(g);
}

struct gas_counts gas_counts(const struct gas *g) {
    struct gas_counts c = g->counts.now;
    long *const cells[] = {&c.cells, &c.faces, &c.floored, &c.filled, &c.plain};
    for (int i = 0; i < 5; i++) *cells[i] *= g->counts.images;
    const struct gas_counts *b = &g->counts.before;
    const long before[] = {b->cells, b->faces, b->floored, b->filled, b->plain};
    for (int i = 0; i < 5; i++) *cells[i] += before[i];
    c.rejected += b->rejected;
    c.repeated += b->repeated;
    c.pause[0] = g->dense ? g->dense->pause : 0;
    c.pause[1] = g->dense ? g->dense->paused : 0;
    return c;
}

double gas_computed_share(const struct gas *g) {
    long count[2] = {g->counts.computed, g->counts.all};
    comm_sum_long(g->comm, count, 2);
    return count[1] ? (double)count[0] / (double)(count[1] * g->counts.images) : 1;
}
