/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bed of implicit acoustics (libcore/gas/dense.c) as two parts of a step: what it exchanges with the other cells, and
 * the bed itself. */
#include "libcore/step/step_parts.h"

static bool has_bed(const struct gas *g, const struct attempt *a) {
    (void)a;
    return g->step.hybrid;
}

/* Lists the bed in the state from which the stages start. */
static bool border_begin(struct gas *g, struct attempt *a) {
    if (any_rank(g, a->bad)) return false;
    renew_patches(g, a->t + a->dt); /* the bed's step is implicit */
    g->dense->failed = dense_begin(g, a->now);
    if (g->dense->failed) return false;
    sources_kick(g, a, false, a->now);
    return true;
}

static bool border_stage(struct gas *g, struct attempt *a, const struct stage_now *s) {
    dense_keep(g, s->share);
    (void)a;
    return true;
}

static bool border_end(struct gas *g, struct attempt *a) {
    sources_kick(g, a, true, &g->V);
    return true;
}

const struct part border_part = {"border of the bed", has_bed, border_begin, border_stage, border_end, GAS_FLOW, false};

static bool bed_end(struct gas *g, struct attempt *a) {
    dense_take(g, &g->V);
    if (!dense_advance(g, a->t, a->dt, a->guarded, &g->V)) return false;
    books_bed(g, a->dt);
    return true;
}

/* ---- friction in an explicit step ---- */

static bool rubs(const struct gas *g, const struct attempt *a) {
    (void)a;
    return g->dense && g->dense->rubs && !g->step.hybrid;
}

static bool friction_end(struct gas *g, struct attempt *a) {
    if (dense_rub(g, a->t, a->dt, &g->V))
        books_friction(g, a->dt);
    else if (a->guarded || g->dense->failed)
        return false;
    else
        a->bad++; /* an unguarded step goes on to its end, where the ranks ask each other */
    return true;
}

const struct part friction_part = {"friction", rubs, NULL, NULL, friction_end, GAS_FLOW, false};

const struct part bed_part = {"bed", has_bed, NULL, NULL, bed_end, GAS_FLOW, false};
