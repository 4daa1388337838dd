/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The stages as a part of a step (docs/physics.md 7.1, 7.2), and the limiting that keeps the state admissible.
 *
 * A stage is computed at high order. If a cell is inadmissible after it, or denser and all but packed, the cell is
 * flagged and the stage is done again with the fluxes through flagged cells' faces limited (libcore/schemes/limit.h).
 * That may spoil a neighbour, which is then flagged, too; flags only grow, so this ends. Then flagged cells are
 * admissible by the theorem of limit.h, and the others were checked. Smooth flow pays nothing and keeps its order and
 * its bits. If the theorem's Courant number was exceeded and a flagged cell is inadmissible all the same, the step is
 * rejected and done again with half of dt or less, beside a bed first by SSPRK43 (libcore/step/step.c). Local time
 * steps are one stage, which other ones replace if a cell is inadmissible after it. */
#include "libcore/step/step_parts.h"

/* More short steps than these in one of local steps are a collapse. */
static const double MOST_STEPS = 10000;

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

struct stage_now stages_next(const struct gas *g, const struct attempt *a, int number) {
    const struct stepper *s = a->stepper;
    const double part = (1 - s->a[number]) * share_of(s, number);
    return (struct stage_now){.number = number,
                              .is_last = number + 1 == s->stages,
                              .from = number ? &g->V : a->U0,
                              .a = s->a[number],
                              .dt = s->b[number] * a->dt,
                              .part = part,
                              .share = part * s->b[number]};
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
    spans_join(g, start, state);
    g->engine->state.rows(g, KEPT_STATES, state, exchange_row, &(struct exchange){g, start, next, state});
    spans_keep_as(g, state, next);
}

void stages_pass(struct gas *g, struct attempt *a, int number) {
    swap_states(&g->V, &g->W);
    if (number + 1 != a->stepper->exchange) return;
    exchange(g, a->U0, &g->U0, &g->V);
    a->U0 = &g->U0;
}

/* Did sources make the gas so hot that a step of dt, which was chosen by the wave speeds before, is far too long? In
 * cold gas dt is long, and a thermostat would heat the gas a great deal before it first moves. */
static bool overheated(struct gas *g, const struct attempt *a) {
    if (!source_heats(&g->models.source)) return false;
    const double rate = rate_of_start(g);
    g->engine->stage.fronts(g, a->speed); /* those that came with the speeds of U0 are of another state */
    return rate > 2 * a->speed->rate && a->dt * rate > 2 * a->maxCo;
}

static bool are_due(const struct gas *g, const struct attempt *a) {
    (void)g;
    (void)a;
    return true;
}

static bool stages_begin(struct gas *g, struct attempt *a) {
    a->U0 = a->now;
    a->hot = !g->step.hybrid && overheated(g, a);
    if (a->hot) return false;
    g->step.dt = a->dt;
    g->step.t = a->t;
    g->step.courant = larger(a->maxCo, a->dt * a->speed->rate); /* a fixed dt may go beyond maxCo */
    if (g->falling.cells) source_gravity(&g->models.source, a->t, a->dt, g->falling.gravity);
    if (a->guarded && !g->step.hybrid && any_rank(g, a->bad)) return false;
    if (a->at_once && a->sources) {
        sources_plan(g, a, true, &a->last);
        a->ending.sources = &a->last;
    }
    return true;
}

/* Does a stage again with limited fluxes until no further cell must be flagged, then applies the floors. Returns false
 * if a cell of any rank is inadmissible all the same. */
static bool mend_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to,
                       double a, double dt) {
    long cells, before = 0;
    for (; (cells = flags_send(g)) > before && !asked_to_leave(g); before = cells)
        g->engine->stage.redo(g, U0, from, to, a, dt);
    books_limited(g, (1 - a) * g->floors.share);
    long count[2] = {g->limits.faces, floors_apply(g, to)};
    comm_sum_long(g->comm, count, 2);
    g->counts.now.cells += cells;
    g->counts.now.faces += count[0];
    if (g->step.asked && !g->step.held) flags_hold(g, false);
    g->step.held = g->step.asked;
    flags_note(g, g->counts.now.place);
    flags_clear(g);
    return count[1] == 0 && !g->step.left;
}

/* Mends a stage that left cells of some rank inadmissible; returns false if it cannot. */
static bool guard_stage(struct gas *g, const struct attempt *a, const struct stage_now *s) {
    g->step.guarded = GUARDED;
    g->floors.share = share_of(a->stepper, s->number);
    return mend_stage(g, a->U0, s->from, &g->W, s->a, s->dt);
}

/* In a guarded step every stage is looked at, and its inadmissible cells are mended at once; where there are none, the
 * bits are those of a step that is not guarded. */
static bool runge_kutta(struct gas *g, struct attempt *a, const struct stage_now *s) {
    if (g->patches.renew) renew_patches(g, a->t + part_of(a->stepper, s->number) * a->dt);
    books_stage(g, s->from, s->part * s->dt);
    struct ending *ending = a->at_once && s->is_last ? &a->ending : NULL;
    const long found = g->engine->stage.stage(g, a->U0, s->from, &g->W, s->a, s->dt, ending);
    if (!a->guarded)
        a->bad += found;
    else if (any_rank(g, found) && !guard_stage(g, a, s)) {
        a->spoilt = true;
        return false;
    }
    books_staged(g, s->part * s->dt);
    return true;
}

/* The largest rate of a state, over all ranks, however long the steps of single cells are; the levels of the next local
 * step follow from that state. */
static double rate_of(struct gas *g, const struct state *state) {
    struct gas_speed speed;
    const bool moved = state == &g->U0;
    if (moved) swap_states(&g->U, &g->U0);
    g->engine->state.speed(g, &speed);
    if (moved) swap_states(&g->U, &g->U0);
    comm_max(g->comm, &speed.rate, 1);
    return ldexp(speed.rate, speed.levels);
}

/* Does the stages of a step from a->U0 to V. */
static bool short_step(struct gas *g, struct attempt *a) {
    g->step.dt = a->dt;
    for (int number = 0; number < a->stepper->stages; number++) {
        const struct stage_now s = stages_next(g, a, number);
        if (!runge_kutta(g, a, &s)) return false;
        stages_pass(g, a, number);
    }
    return true;
}

/* Computes in W what local steps left inadmissible, by as many guarded steps of stages as maxCo wants. */
static bool by_stages(struct gas *g, const struct attempt *a) {
    struct attempt part = *a;
    part.stepper = stepper_instead;
    g->counts.now.staged++;
    for (double left = a->dt, n = 2; n > 1; left -= part.dt) {
        n = ceil(left * rate_of(g, part.U0) / a->maxCo);
        if (!(n < MOST_STEPS)) return false;
        part.dt = n > 1 ? left / n : left;
        sources_kick(g, &part, false, part.U0);
        if (!short_step(g, &part)) return false;
        books_part(g, GAS_FLOW, &g->V);
        sources_kick(g, &part, true, &g->V);
        part.t += part.dt;
        swap_states(&g->U0, &g->V);
        part.U0 = &g->U0;
    }
    swap_states(&g->U0, &g->W);
    return true;
}

/* A step in which each cell takes its own ones is looked at when it ends. If cells are inadmissible then, an unguarded
 * step is done again, and a guarded one by stages. So the bits do not depend on the guard. If the stages fail, too, a
 * shorter step follows. */
static bool local_steps(struct gas *g, struct attempt *a, const struct stage_now *s) {
    const long found = g->engine->stage.local(g, s->from, &g->W, s->dt);
    if (!a->guarded)
        a->bad += found;
    else if (any_rank(g, found)) {
        flags_clear(g);
        return by_stages(g, a);
    }
    books_limited(g, 1);
    books_staged(g, s->part * s->dt);
    return true;
}

static bool stages_stage(struct gas *g, struct attempt *a, const struct stage_now *s) {
    return (a->stepper->local ? local_steps : runge_kutta)(g, a, s);
}

/* A bed is given back its start, so that it takes part in the second halves of other parts. */
static bool stages_end(struct gas *g, struct attempt *a) {
    a->now = &g->V;
    if (a->guarded) a->bad = 0;
    if (!g->step.hybrid) return true;
    if (any_rank(g, a->bad)) {
        flags_clear(g);
        return false;
    }
    (void)dense_put(g, &g->V);
    return true;
}

const struct part stages_part = {"stages", are_due, stages_begin, stages_stage, stages_end, GAS_FLOW, true};
