/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of the parts of a step, and the loop over it (step_parts.h). A further part is a row here and a file. */
#include "libcore/step/step_parts.h"

extern const struct part floors_part, friction_part, bed_part, sources_part, diffusion_part, border_part, stages_part;

/* The order of docs/physics.md 7.2 and 9.2: floors begin first and end last, stages begin last and end first. */
static const struct part *const table[] = {
    &carried_part,   /* sums up the mass that crosses the faces */
    &floors_part,    /* forget what they added; at the end they mend what the sources left */
    &friction_part,  /* of packed gas in an explicit step; a bed has its own */
    &bed_part,       /* dense cells, implicit: last, as the sources would put their pressure out of balance */
    &sources_part,   /* half a step, and half a step backwards */
    &diffusion_part, /* half a step, and half a step; beside a bed all of it at once */
    &border_part,    /* of the bed: its lists, the fluxes through it, gravity on cells that fall beside it */
    &stages_part,
};
enum { PARTS = sizeof table / sizeof *table };
_Static_assert((int)PARTS <= (int)PARTS_TIMED, "g->counts.seconds has a place for each part");

int gas_seconds(const struct gas *g, struct part_seconds out[PARTS_TIMED]) {
    for (int i = 0; i < PARTS; i++) out[i] = (struct part_seconds){table[i]->name, g->counts.seconds[i]};
    return PARTS;
}

long any_rank(const struct gas *g, long mine) {
    double value = (double)mine;
    comm_max(g->comm, &value, 1);
    return (long)value;
}

void parts_add_seconds(struct gas *g, const struct part *p, double seconds) {
    for (int i = 0; i < PARTS; i++)
        if (table[i] == p) g->counts.seconds[i] += seconds;
}

struct walk { /* through the table */
    struct gas *g;
    struct attempt *a;
    double clock; /* s: up to here seconds belong to parts before */
    bool active[PARTS];
};

static bool pass(struct walk *w, int part, bool goes_on) {
    const double now = clock_now();
    w->g->counts.seconds[part] += now - w->clock;
    w->clock = now;
    return goes_on;
}

static bool begin_all(struct walk *w) {
    for (int i = 0; i < PARTS; i++)
        if (w->active[i] && table[i]->begin && !pass(w, i, table[i]->begin(w->g, w->a))) return false;
    return true;
}

static bool stage_all(struct walk *w) {
    const int stages = w->g->step.hybrid && w->g->dense->alone ? 0 : w->a->stepper->stages;
    for (int number = 0; number < stages; number++) {
        const struct stage_now s = stages_next(w->g, w->a, number);
        for (int i = PARTS - 1; i >= 0; i--)
            if (w->active[i] && table[i]->stage && !pass(w, i, table[i]->stage(w->g, w->a, &s))) return false;
        stages_pass(w->g, w->a, number);
    }
    return true;
}

static bool end_all(struct walk *w) {
    for (int i = PARTS - 1; i >= 0; i--) {
        if (!w->active[i] || !table[i]->end) continue;
        const bool goes_on = table[i]->end(w->g, w->a);
        if (goes_on && table[i]->cause != BOOKS_ITSELF) books_part(w->g, (enum gas_cause)table[i]->cause, &w->g->V);
        if (!pass(w, i, goes_on)) return false;
    }
    return true;
}

/* Ends a step that was not guarded. Only here do the ranks ask each other whether all cells are admissible, so that no
 * rank waits for all others at every stage. Returns false if some were not: then V is of no use, and the step must be
 * done again from its start, guarded. */
static bool end_unguarded(struct gas *g, const struct attempt *a) {
    if (!speed_agree(g, &a->ending.speed, a->bad > 0)) {
        g->step.guarded = GUARDED;
        flags_clear(g);
        return false;
    }
    g->step.speed_known = a->at_once;
    return true;
}

bool parts_try(struct gas *g, struct attempt *a) {
    struct walk w = {.g = g, .a = a, .clock = clock_now()};
    a->now = &g->U;
    books_begin(g);
    a->at_once = g->engine->stage.ends && !g->books.audit && !sources_ask(g);
    for (int i = 0; i < PARTS; i++) {
        w.active[i] = table[i]->active(g, a);
        a->at_once &= !w.active[i] || !table[i]->end || table[i]->folds;
    }
    if (!begin_all(&w) || !stage_all(&w) || !end_all(&w)) return false;
    return a->guarded || g->step.hybrid || end_unguarded(g, a);
}

static bool are_guarded(const struct gas *g, const struct attempt *a) {
    (void)g;
    return a->guarded;
}

static bool floors_first(struct gas *g, struct attempt *a) {
    (void)a;
    floors_begin(g);
    return true;
}

/* Mends the cells that the second halves of other parts left inadmissible. */
static bool floors_last(struct gas *g, struct attempt *a) {
    if (g->step.hybrid) return true; /* the bed has called the floors */
    g->floors.share = 1;
    long bad = any_rank(g, a->bad);
    if (bad) bad = any_rank(g, floors_apply(g, &g->V));
    return bad == 0;
}

const struct part floors_part = {"floors", are_guarded, floors_first, NULL, floors_last, GAS_FLOORS, false};

static bool has_transport(const struct gas *g, const struct attempt *a) {
    (void)a;
    return g->models.transport != NULL;
}

/* Does the diffusion of a part of the step. Notes the mean acceleration by the sources: it pulls the gas onto walls,
 * whose pressure then exceeds that of the cells beside them. */
static bool diffuse_part(struct gas *g, const struct attempt *a, const struct state *to, enum lapse_of part) {
    const struct gas_models *m = &g->models;
    const double t = part == SECOND_HALF ? a->t + 0.5 * a->dt : a->t, dt = part == WHOLE_STEP ? a->dt : 0.5 * a->dt;
    source_pull(&m->source, m->eos, &m->material, g->components, t, dt, g->diffusion.pull);
    return diffuse(g, a->now, to, t, dt, part, a->bad);
}

/* A step with a bed is of first order anyway: all its diffusion comes first, for halves have 1.4 times its stages. */
static bool diffusion_first(struct gas *g, struct attempt *a) {
    if (!diffuse_part(g, a, &g->U0, g->step.hybrid ? WHOLE_STEP : FIRST_HALF)) return false;
    a->now = &g->U0;
    return true;
}

/* An unguarded explicit step goes on to its end, where the ranks ask each other. */
static bool diffusion_last(struct gas *g, struct attempt *a) {
    if (g->step.hybrid) return true;
    if (diffuse_part(g, a, &g->W, SECOND_HALF))
        swap_states(&g->V, &g->W);
    else if (a->guarded)
        return false;
    else
        a->bad++;
    return true;
}

const struct part diffusion_part = {"diffusion",  has_transport, diffusion_first, NULL, diffusion_last,
                                    BOOKS_ITSELF, false};
