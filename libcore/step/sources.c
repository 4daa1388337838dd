/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sources as a part of a step: exact, over half a step and, backwards, over its other half. */
#include "libcore/step/step_parts.h"

/* Cells are cold below this number of squares of the velocity that gravity gives in a step: an Euler step of a warm
 * cell takes half of that square from its eps, so that at most 1/8 of eps is lost. */
static const double WARM = 4;

/* Returns the eps above which cells are warm: local steps cool none that fall. */
static double warm_of(const struct gas *g, const struct attempt *a) {
    double gravity[MAX_DIM], square = 0;
    if (a->stepper->local) return 0;
    source_gravity(&g->models.source, a->t, a->dt, gravity);
    for (int k = 0; k < g->components; k++) {
        const double gained = a->dt * gravity[k];
        square += gained * gained;
    }
    return WARM * square;
}

static void plan_all(const struct gas *g, const struct attempt *a, bool second, struct source_plan *out) {
    const struct gas_models *m = &g->models;
    source_plan(&m->source, m->eos, &m->material, g->components, second ? a->t + 0.5 * a->dt : a->t, 0.5 * a->dt,
                second, out);
}

void sources_plan(const struct gas *g, const struct attempt *a, bool second, struct source_plan *out) {
    plan_all(g, a, second, out);
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

/* Applies a plan to `from`, into `to`; returns this rank's number of inadmissible cells. W is scratch. */
static long apply_plan(struct gas *g, const struct source_plan *plan, const struct state *from,
                       const struct state *to) {
    books_sources(g, plan, from);
    const long bad = sources_apply(g, plan, from, to);
    books_sourced(g, to);
    return bad;
}

/* Finds the shear rate of a state, at the start or the end of the step, if a law of the sources asks for it. */
static void see_shear_rate(struct gas *g, const struct state *s, double t) {
    if (!sources_ask(g)) return;
    renew_patches(g, t);
    g->engine->state.shear_rate(g, s);
}

static bool are_there(const struct gas *g, const struct attempt *a) {
    (void)g;
    return a->sources;
}

/* In a guarded step the floors mend the cells that are inadmissible now. */
static bool sources_begin(struct gas *g, struct attempt *a) {
    const struct state *to = g->models.transport ? &g->V : &g->U0;
    struct source_plan plan;
    sources_plan(g, a, false, &plan);
    if (g->falling.cells && !g->step.hybrid) {
        plan.warm = warm_of(g, a);
        forget_falling(g);
    }
    see_shear_rate(g, a->now, a->t);
    a->bad = apply_plan(g, &plan, a->now, to);
    if (a->guarded) {
        a->bad = floors_apply(g, to);
        books_part(g, GAS_FLOORS, to);
    }
    if (g->models.transport && source_thermal(&g->models.source)) note_cooled(g, a->now, to);
    a->now = to;
    return true;
}

static bool sources_end(struct gas *g, struct attempt *a) {
    struct source_plan plan;
    if (a->at_once) return true;
    sources_plan(g, a, true, &plan);
    see_shear_rate(g, &g->V, a->t + a->dt);
    a->bad += apply_plan(g, &plan, &g->V, &g->V);
    return !g->step.hybrid || any_rank(g, a->bad) == 0;
}

const struct part sources_part = {"sources", are_there, sources_begin, NULL, sources_end, BOOKS_ITSELF, true};

void sources_kick(struct gas *g, const struct attempt *a, bool second, const struct state *s) {
    struct source_plan plan;
    if (!g->falling.cells || (g->dense && g->dense->alone)) return;
    plan_all(g, a, second, &plan);
    source_plan_part(&plan, true);
    if (!second) forget_falling(g);
    find_falling(g, second ? -1 : warm_of(g, a), s);
    (void)apply_plan(g, &plan, s, s);
    if (second && !g->dense) forget_falling(g);
}
