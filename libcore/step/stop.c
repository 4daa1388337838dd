/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Ends a run that cannot go on: its errors say when, where and in which state, which input feeds the trouble, and what
 * can be done. Finds out, too, whether somebody has asked to leave a step. */
#include "libcore/gas/gas_private.h"

#define PACKED_AT_LAST 0.9 /* fraction of alphaMax that a collapse has reached where it is */

bool gas_can_collapse(const struct gas *g) {
    return source_cools(&g->models.source, &g->models.material) && g->models.material.threshold == 0;
}

struct look { /* context of look_row */
    const struct gas *g;
    struct gas_cell *cell; /* of `place`; out: its state, -HUGE_VAL if this rank has not got it */
};

static void look_row(void *look, const struct row *row) {
    struct look *l = look;
    const double *rho = l->g->U.block[row->block] + row->at, per = packing_per_density(&l->g->models.material);
    double T[BATCH], c[BATCH], here[3], *const speed[3] = {c, NULL, NULL};
    temperature_row(l->g, row->n, rho, T);
    for (int i = 0; i < row->n; i++) {
        l->g->engine->state.place(l->g, row->block, row->at + i, here);
        if (memcmp(here, l->cell->place, sizeof here) != 0) continue;
        field_row(l->g, GAS_C, row->n, l->g->size, rho, speed);
        l->cell->alpha = per * rho[i];
        l->cell->T = T[i];
        l->cell->c = c[i];
    }
}

void look_at(struct gas *g, struct gas_cell *cell) {
    struct look l = {g, cell};
    cell->alpha = cell->T = cell->c = -HUGE_VAL;
    g->engine->state.rows(g, EVERY_CELL, &g->U, look_row, &l);
    double all[] = {cell->alpha, cell->T, cell->c};
    comm_max(g->comm, all, 3);
    cell->alpha = all[0];
    cell->T = all[1];
    cell->c = all[2];
}

void gas_fastest_cell(struct gas *g, const struct gas_speed *speed, struct gas_cell *out) {
    gas_fastest_place(g, speed, out->place);
    look_at(g, out);
}

/* Returns what feeds the gas without a bound through an open patch that gives one part of the state and leaves another
 * to the gas; NULL: nothing does. */
static const char *fed_by(const struct gas *g) {
    const char *found = NULL;
    for (int p = 0; p < g->patches.n; p++) {
        const struct patch_rules *r = &g->patches.rules[p];
        if (!r->velocity.type || patch_is_wall(r)) continue;
        const bool rho = rule_holds(&r->density), u = rule_holds(&r->velocity), T = rule_holds(&r->temperature);
        if (rho && !T) return "gives the density and leaves T free, so that nothing bounds T there: give T (or p), too";
        if (u && !T) return "gives the velocity and leaves T free, so that nothing bounds T there: give T (or p), too";
        if (T && !(rho && u)) found = "leaves the density or the velocity free, so that nothing bounds what flows in";
        if (!rho && !u && !T && !found)
            found = "is zeroGradient: where gas flows in, give values (inletOutlet), and beyond packed gas a void "
                    "(fixedValue 1e-6 of alpha)";
    }
    return found;
}

/* Returns what feeds a time step that falls and falls, as far as the gas can tell, in two parts. */
struct cause {
    const char *lead, *text;
};
static struct cause cause_of(const struct gas *g) {
    const struct gas_counts c = gas_counts(g);
    const char *fed = fed_by(g);
    if (fed) return (struct cause){"\n  a boundary ", fed};
    if (c.filled > 0 || c.floored > 0)
        return (struct cause){"\n  floors have added mass or energy on the way (see the log): ",
                              "what they add may be what is seen here"};
    return (struct cause){"", ""};
}

/* Has a gas that can collapse come near packing where it has the largest rate of wave speeds? Finds that cell. */
static bool collapses(struct gas *g, const struct gas_speed *speed, struct gas_cell *cell) {
    const double limit = g->models.material.alpha_max;
    gas_fastest_cell(g, speed, cell);
    return gas_can_collapse(g) && limit > 0 && cell->alpha > PACKED_AT_LAST * limit;
}

status stop_of_collapse(struct gas *g, double t, double dt, const struct gas_speed *speed) {
    struct gas_cell q;
    const bool collapse = collapses(g, speed, &q);
    const struct cause cause = cause_of(g);
    const struct gas_counts c = gas_counts(g);
    const bool noisy = c.cells > 1000 && !g->models.flux->ruled;
    if (!collapse)
        return fail(ERR_STATE,
                    "time step of %.3g s at t = %.10g, (%.6g %.6g %.6g), alpha = %.6g, T = %.6g: less than is allowed; "
                    "the last good state is kept%s%s",
                    dt, t, q.place[0], q.place[1], q.place[2], q.alpha, q.T, cause.lead, cause.text);
    return fail(
        ERR_STATE,
        "inelastic collapse at t = %.10g, (%.6g %.6g %.6g), alpha = %.10g, T = %.6g: the time step falls to %.3g s "
        "there, as it does when the gas reaches close packing; the exact problem ends here, the last good state is "
        "kept\n"
        "  a way through: thresholdSpeed in `grain` of constant/granularProperties, say a tenth of sqrt(T) around\n"
        "  so far %ld faces of %ld cells were limited, %ld steps rejected%s",
        t, q.place[0], q.place[1], q.place[2], q.alpha, q.T, dt, c.faces, c.cells, c.rejected,
        noisy ? ": this number points at a noisy flux; compare with fluxScheme common" : "");
}

status stop_of_speed(struct gas *g, double t, const struct gas_speed *speed) {
    struct gas_cell q;
    gas_fastest_cell(g, speed, &q);
    return fail(ERR_STATE,
                "the speed of sound is without bound at t = %.10g, (%.6g %.6g %.6g), alpha = %.17g, T = %.6g: no time "
                "step is short enough; the last good state is kept\n"
                "  alpha = alphaMax, to the last digits, has no finite pressure: start below it",
                t, q.place[0], q.place[1], q.place[2], q.alpha, q.T);
}

status stop_of_diffusion(struct gas *g, double t) {
    const struct stiff *s = &g->diffusion.stiff;
    struct gas_cell q;
    memcpy(q.place, s->place, sizeof q.place);
    look_at(g, &q);
    return fail(ERR_STATE,
                "%s is too stiff at t = %.10g, in the cell at (%.6g %.6g %.6g), alpha = %.6g, T = %.6g: its rate of "
                "%.3g 1/s times half a step of %.3g s is %.3g, for %.3g stages of %s; %.0e and %d are the most; the "
                "last good state is kept\n"
                "  the cell is far smaller than the others (checkCase names such a cell: make the mesh even) or than a "
                "grain, or its gas conducts almost without bound (thin and hot: alphaMin or knudsenCut of `transport`, "
                "alphaFloor); `diffusion` RKJ2 or implicit and a lower maxCo or maxDeltaT want fewer stages",
                s->what == HEAT ? "heat conduction" : "viscous stress", t, q.place[0], q.place[1], q.place[2], q.alpha,
                q.T, s->rate, s->dt, s->rate * s->dt, s->stages, g->models.diffusion->model.name, MOST_RATIO,
                MOST_STAGES);
}

bool asked_to_leave(struct gas *g) {
    double asked = g->step.asked && g->step.asked();
    if (g->step.asked) comm_max(g->comm, &asked, 1);
    return g->step.left |= asked > 0;
}

status stop_of_time(struct gas *g, double t, double dt, const struct gas_speed *speed) {
    struct gas_cell q;
    const struct cause cause = cause_of(g);
    const bool packing =
        speed->rate > 10 * speed->loose; /* else all gas is as fast, and it is no packing that makes it so */
    if (collapses(g, speed, &q) && packing) return stop_of_collapse(g, t, dt, speed);
    return fail(
        ERR_STATE,
        "time stands still at t = %.10g: a step of %.3g s is less than some last digits of t; the fastest gas is "
        "at (%.6g %.6g %.6g), alpha = %.6g, T = %.6g, with %.3g crossings of a cell a second; the last good "
        "state is kept%s%s",
        t, dt, q.place[0], q.place[1], q.place[2], q.alpha, q.T, speed->rate, cause.lead, cause.text);
}
