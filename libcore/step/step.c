/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One time step: it is tried (libcore/step/step_parts.c), rejected and tried again, until it stands or cannot. */
#include "libcore/gas/carried.h"
#include "libcore/step/step_parts.h"

enum {
    SLOW = 50, /* a collapse: after this number of consecutive tiny steps dt falls by half within as many more */
    STUCK =
        500 /* a collapse: this number of consecutive tiny steps; dense gas that hits a wall needs some and recovers */
};
/* A rejected step is shortened at most by this factor at once, as the shorter step heats less. */
static const double LEAST_SHARE = 1. / 16;
/* A step that is no longer than this number of last digits of t is the end: t would be off by a hundredth of it. */
static const double DIGITS = 64;

double rate_of_start(struct gas *g) {
    struct gas_speed after;
    swap_states(&g->U, &g->U0);
    g->engine->state.speed(g, &after);
    swap_states(&g->U, &g->U0);
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

/* Local steps follow from the rates that were found last: they are to be those of the state at the start. */
static void look_at_start(struct gas *g) {
    struct gas_speed speed;
    if (g->models.stepper->local) g->engine->state.speed(g, &speed);
}

/* Ends a step that is left: the state is still that at its start, and so become the counts. */
static status leave(struct gas *g, const struct gas_counts *start, double *dt) {
    if (g->step.held) flags_hold(g, true);
    g->counts.now = *start;
    flags_clear(g);
    *dt = 0;
    return OK;
}

/* Is diffusion too stiff in the state that the step starts from? If a source has heated the gas a great deal in the
 * first half, or the stages have, a shorter step is not. */
static bool hopeless(const struct gas *g) {
    return g->diffusion.stiff.found && !g->diffusion.stiff.second && !source_heats(&g->models.source);
}

/* Is a step of dt one with implicit acoustics? allowed: the explicit step. */
static bool takes_bed(const struct gas *g, double dt, double allowed) {
    return g->dense && g->dense->longest > 0 && dt > allowed;
}

/* The scheme of a step with a bed: one of few stages. If the limiter cannot mend these, SSPRK43 does the step: its
 * Euler steps are half as long. */
static const struct stepper *scheme_of_bed(const struct gas *g, double dt, bool spoilt) {
    const struct gas_models *m = &g->models;
    const bool damps = !g->forest || m->reconstruct->reach < 2;
    return spoilt ? stepper_instead : stepper_beside_bed(m->stepper, damps, g->dense->beside * dt);
}

static bool try_step(struct gas *g, struct attempt *a) {
    g->diffusion.stiff.found = g->step.left = false;
    g->diffusion.unasked = 0;
    a->guarded = g->step.guarded > 0;
    a->sources = source_active(&g->models.source, &g->models.material);
    g->step.hybrid = takes_bed(g, a->dt, a->maxCo / a->speed->rate);
    if (g->step.hybrid) a->stepper = scheme_of_bed(g, a->dt, a->spoilt);
    return parts_try(g, a);
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

/* Is a step to be tried again with the same dt? */
static bool again_at_once(struct gas *g, const struct attempt *tried) {
    if (!tried->guarded && !tried->hot) {
        g->step.guarded = GUARDED;
        return true;
    }
    g->counts.now.rejected++;
    return g->step.hybrid && tried->spoilt && tried->stepper != stepper_instead;
}

/* Counts a step that stands. */
static status count_step(struct gas *g) {
    if (g->step.guarded > 0) {
        TRY(floors_count(g));
        if (g->floors.filled || g->floors.floored) g->step.guarded = GUARDED;
        g->step.guarded--;
    }
    if (g->dense && g->dense->rubs) dense_keep_friction(g);
    if (g->step.hybrid) TRY(dense_count(g));
    g->step.hybrid = false;
    return OK;
}

/* Makes the result of a step the state. */
static status keep_step(struct gas *g, double t, double dt) {
    const double clock = clock_now();
    dense_pass(g, dt);
    swap_states(&g->U, &g->V);
    TRY(carried_move(g, t, dt));
    if (g->carried) parts_add_seconds(g, &carried_part, clock_now() - clock);
    return books_keep(g, dt);
}

status gas_step(struct gas *g, double t, double *dt, double maxCo, double least, double fraction,
                const struct gas_speed *speed) {
    struct attempt tried = {.spoilt = false};
    if (!isfinite(speed->rate)) return stop_of_speed(g, t, speed);
    const double allowed = maxCo / speed->rate, asked = *dt;
    const struct gas_counts start = g->counts.now;
    const bool creeps = !g->dense || g->dense->longest == 0;
    const double collapsed = creeps && gas_can_collapse(g) && speed->loose > 0 ? fraction * (maxCo / speed->loose) : 0;
    if ((creeps && allowed < least) || (allowed < collapsed && g->step.slow < 0))
        return stop_of_collapse(g, t, allowed, speed);
    if (g->step.slow >= STUCK || (g->step.slow >= 2 * SLOW && g->step.slow_dt[1] < 0.5 * g->step.slow_dt[0]))
        return stop_of_collapse(g, t, g->step.slow_dt[1], speed);
    for (int k = 0; k < g->dim; k++) g->step.fastest[k] = speed->axis[k];
    g->step.speed_known = g->step.held = false;
    g->step.hybrid = takes_bed(g, *dt, allowed); /* whose dense tiles are written out, and remain so */
    for (;;) {
        if (t + *dt / DIGITS == t) return stop_of_time(g, t, *dt, speed);
        g->engine->stage.fronts(g, speed);
        tried = (struct attempt){
            .t = t, .dt = *dt, .maxCo = maxCo, .stepper = g->models.stepper, .speed = speed, .spoilt = tried.spoilt};
        const bool stands = try_step(g, &tried);
        TRY(renewal_failure(g));
        if (stands) break;
        TRY(bed_failure(g));
        if (dense_refused(g, dt)) return gas_step(g, t, dt, maxCo, least, fraction, speed);
        if (asked_to_leave(g)) return leave(g, &start, dt);
        if (hopeless(g) && !g->step.hybrid) return stop_of_diffusion(g, t);
        if (again_at_once(g, &tried)) continue;
        *dt = g->step.hybrid ? 0.5 * *dt : shorter(g, tried.U0, *dt, maxCo);
        look_at_start(g);
        if (*dt < smaller(least, asked) || *dt < 1e-12 * asked)
            return g->diffusion.stiff.found ? stop_of_diffusion(g, t) : stop_of_collapse(g, t, *dt, speed);
    }
    bool tiny = *dt < collapsed && (allowed < collapsed || *dt < fraction * asked);
    g->step.slow = !tiny ? 0 : g->step.slow > 0 ? g->step.slow + 1 : 1;
    if (g->step.slow % SLOW == 1) g->step.slow_dt[0] = *dt;
    g->step.slow_dt[1] = *dt;
    TRY(count_step(g));
    return keep_step(g, t, *dt);
}
