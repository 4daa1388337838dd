/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Time integration of viscous stress and heat conduction (docs/physics.md 8.1), and their part of a step.
 *
 * Coefficients are frozen over a half step: in the first half of a step at its start, in the second half at its end,
 * where T is extrapolated from the first half. Both choices have errors of first order, which cancel. With the
 * coefficients of the start in both halves the step is of first order, which over a Faraday run costs four times the
 * steps (cases/faraday).
 *
 * With frozen coefficients the stress does not depend on T, so it goes first; then heat is conducted with the rise of T
 * by friction as a source that is constant over the half step, so that nothing is split between friction and
 * conduction. If they were split, thin gas would keep its frictional heat for a whole flow step, expand and empty.
 *
 * The heat flux -cross grad rho (transport.h) is constant over a half step, as rho is, and so are the heat that it
 * brings and dilation div u, with the mean of the velocities before and after the stress. They count as friction, so
 * that conduction meets them as they come, and thin gas stays sound however long the step is.
 *
 * Cooling enters conduction in the same way. In the first half of a step, where cooling comes before diffusion, heat is
 * conducted from the T before cooling with the loss as a constant sink. In the second half, where cooling comes last,
 * conduction has the sink of the first half, and the loss is given back to T at the end. The sink takes T of the cell
 * at most: below zero T would draw heat from walls that take it in proportion to T. The step is symmetric in time, so
 * any sink used in both halves keeps second order; with this one, conduction and cooling that balance each other do so
 * in each half step, also at walls that hold T. Other sources that change T count with cooling: the sink is what all of
 * them took together, and where a thermostat gave more than the others took, it is negative.
 *
 * A step with a bed is of first order anyway. It does all its diffusion before the stages, in 0.7 times as many stages
 * as two halves, with the sink of both. Its coefficients are those before the sources: where friction heats a bed as
 * fast as it cools, that T is the mean over diffusion; after the sources it lacks half of what cooling takes.
 *
 * T stays positive where the schemes are monotone and the stress on a face follows the jump across it (diffusion.h).
 * That does not cover tangential derivatives in the stress, super steps, which are no means of Euler steps, and the
 * sink of cooling. If conduction leaves T below zero, it is done again in parts. If a cell is inadmissible in the end,
 * diffusion is done again without tangential derivatives on that cell's faces, without cross there, without the sink,
 * and with dilation before conduction, which conserves as well; then in ever smaller super steps; if all that does not
 * help, the time step is halved.
 */
#include "libcore/gas/gas_private.h"

enum {
    MOST_PARTS = 64, /* most parts that a half step is cut into before the time step is halved */
    ASK_EVERY = 64   /* stages after which the ranks ask each other whether to leave the step */
};

/* RKL2 (super time stepping, docs/physics.md 8.2). Whatever its number of stages, a super step of it leaves 1 - b_s,
 * about half, of the stiffest modes: a thin hot cell that loses mass would keep its heat, and empty. Four super steps
 * leave a sixteenth (cases/faraday). */
static long plan_rkl2(double ratio, int *stages) {
    const long parts = ratio > 50 ? 4 : 1;
    int s = (int)ceil(0.5 * (sqrt(9 + 16 * ratio / (double)parts) - 1)); /* ratio <= (s^2 + s - 2)/4 */
    *stages = s < 3 ? 3 : s + 1 - s % 2; /* odd: the highest modes are damped, not flipped */
    return parts;
}

static double rkl2_b(int j) {
    return j < 2 ? 1. / 3 : (double)(j * j + j - 2) / (2. * j * (j + 1));
}

/* Sets the coefficients of RKL2: Meyer, Balsara & Aslam (2014), (16)-(17). */
static void stage_rkl2(int stages, int j, double out[4]) {
    const double s = stages, w = 4 / (s * s + s - 2);
    out[0] = out[1] = out[3] = 0;
    out[2] = w / 3;
    if (j == 1) return;
    out[0] = (2. * j - 1) / j * rkl2_b(j) / rkl2_b(j - 1);
    out[1] = -(j - 1.) / j * rkl2_b(j) / rkl2_b(j - 2);
    out[2] = out[0] * w;
    out[3] = -(1 - rkl2_b(j - 1)) * out[2];
}

static long plan_explicit(double ratio, int *stages) {
    *stages = 2;
    return ratio < 1 ? 1 : (long)ceil(ratio);
}

static void stage_explicit(int stages, int j, double out[4]) { /* Heun's method, the mean of q_0 and two Euler steps */
    (void)stages;
    out[0] = j == 1 ? 0 : 0.5;
    out[1] = out[3] = 0;
    out[2] = j == 1 ? 1 : 0.5;
}

/* RKJ2, super time stepping (docs/physics.md 8.2). Up to a ratio of 1/2 two stages of Heun's method do, whose every T
 * is a mean of temperatures. Beyond, RKJ2 multiplies a mode by R(z) = (1 + z/2 + b z^2) P(1 + w z), z = -dt times the
 * mode's rate. P is the Jacobi polynomial of s - 2 stages for (4, -1/2), 1 at 1; it falls faster than the quadratic
 * factor grows, so that |R| < 0.11 from z = -8 to the end -2/w. Half of the first order comes from P; b makes the
 * second order right. The quadratic factor comes first, and P damps its round-off. */
static const double ALPHA = 4, BETA = -0.5;

static long plan_rkj2(double ratio, int *stages) { /* 2 ratio <= 2/w */
    const double s = ALPHA + BETA + 1;
    if (ratio <= 0.5) return plan_explicit(ratio, stages);
    *stages = 2 + (int)ceil(larger(2, 0.5 * (sqrt(s * s + 4 * (ALPHA + 1) * ratio) - s)));
    return 1;
}

static void stage_rkj2(int stages, int j, double out[4]) {
    if (stages == 2) {
        stage_explicit(stages, j, out);
        return;
    }
    const double m = stages - 2, s = ALPHA + BETA, w = (ALPHA + 1) / (m * (m + s + 1)); /* P'(1) w = 1/2 */
    const double b = 0.25 - 0.125 * (ALPHA + 1) / (ALPHA + 2) * (m - 1) * (m + s + 2) / (m * (m + s + 1));
    const double root = sqrt(b), n = j - 2;
    out[0] = 1;
    out[1] = out[3] = 0;
    out[2] = j < 3 ? root : 0.5 * w * (s + 2) / (ALPHA + 1);
    if (j == 2) out[0] = 0.5 / root - 1;
    if (j < 4) return;
    out[1] = -(n + BETA - 1) * (n - 1) * (2 * n + s) / ((n + ALPHA) * (n + s) * (2 * n + s - 2));
    out[0] = 1 - out[1];
    out[2] = 0.5 * w * (2 * n + s - 1) * (2 * n + s) / ((n + s) * (n + ALPHA));
}

/* The implicit schemes (docs/physics.md 8.3) have no plan: implicit.c does their steps. */
const struct diffusion diffusion_table[] = {
    {MODEL("RKJ2", "super time stepping, second order, that leaves a tenth of the stiffest modes"), .plan = plan_rkj2,
     .stage = stage_rkj2},
    {MODEL("RKL2", "super time stepping, second order (Meyer, Balsara & Aslam 2014)"), .plan = plan_rkl2,
     .stage = stage_rkl2},
    {MODEL("explicit", "as many steps of Heun's method as stability wants"), .plan = plan_explicit,
     .stage = stage_explicit},
    {MODEL("implicit", "L-stable, second order (SDIRK of two stages), solved by PETSc"), .implicit = BY_SDIRK},
    {MODEL("implicitMidpoint", "A-stable, second order, flips stiff modes; solved by PETSc"), .implicit = BY_MIDPOINT},
    {MODEL("gaussLegendre", "A-stable, fourth order (two stages), keeps stiff modes; solved by PETSc"),
     .implicit = BY_GAUSS},
};
const int diffusion_count = sizeof diffusion_table / sizeof *diffusion_table;

const struct diffusion *diffusion_find(const char *name) {
    return model_find(diffusion_table, sizeof *diffusion_table, diffusion_count, name);
}

struct rise { /* context of rise_row, which compares T in two states */
    struct gas *g;
    const struct state *from, *to;
    bool friction; /* true: g->diffusion.friction is set; false: g->diffusion.cooled */
    double least;  /* lower bound of g->diffusion.cooled */
};

static void rise_row(void *rise, const struct row *row) {
    const struct rise *r = rise;
    double before[BATCH], after[BATCH];
    double *friction = r->g->diffusion.friction[row->block] + row->at,
           *cooled = r->g->diffusion.cooled[row->block] + row->at;
    temperature_row(r->g, row->n, r->from->block[row->block] + row->at, before);
    temperature_row(r->g, row->n, r->to->block[row->block] + row->at, after);
    if (!r->friction) {
        for (int i = 0; i < row->n; i++) cooled[i] = larger(before[i] - after[i], r->least);
        return;
    }
    /* where a part before this one has failed, T may be below 0, and `cooled` of gas that no source cools must stay 0
     */
    for (int i = 0; i < row->n && r->g->diffusion.late; i++) cooled[i] = smaller(cooled[i], larger(before[i], 0));
    const double sinks = r->g->diffusion.whole ? 2 : 1;
    if (r->g->engine->diffusion.cooled_first)
        for (int i = 0; i < row->n; i++) friction[i] = after[i] - (before[i] + sinks * cooled[i]);
    else
        for (int i = 0; i < row->n; i++) friction[i] = after[i] - before[i] - sinks * cooled[i];
}

void note_cooled(struct gas *g, const struct state *from, const struct state *to) {
    /* 0: if no source heats, a rise of T is round-off */
    const double least = source_heats(&g->models.source) ? -HUGE_VAL : 0;
    g->engine->state.rows(g, EVERY_CELL, to, rise_row, &(struct rise){g, from, to, false, least});
}

static void note_friction(struct gas *g, const struct state *from, const struct state *to) {
    g->engine->state.rows(g, EVERY_CELL, to, rise_row, &(struct rise){g, from, to, true, 0});
}

static void forget_row(void *gas, const struct row *row) {
    const struct gas *g = gas;
    memset(g->diffusion.cooled[row->block] + row->at, 0, (size_t)row->n * sizeof(double));
}

/* Sets g->diffusion.cooled to 0, so that conduction has no sink from here on. */
static void forget_cooled(struct gas *g) {
    g->engine->state.rows(g, EVERY_CELL, &g->U, forget_row, g);
}

/* Is the step to be left? The ranks ask each other only now and then, in steps that are long. */
static bool leaves(struct gas *g) {
    if (++g->diffusion.unasked < ASK_EVERY) return g->step.left;
    g->diffusion.unasked = 0;
    return asked_to_leave(g);
}

/* Does one super step of stress or heat from Y0 to `to`, which may be Y0; returns this rank's number of inadmissible
 * cells, or 1 if the step is left. Walls that change in time have in S_j their values at one time, its centroid:
 * S_j is an integral of q over the time weight[0], and `moment` is what it would be if q were the time since the start,
 * as q_j is the time weight[0] of S_j if dq/dt = 1. The error is of third order in dt, as that of the scheme. Other
 * patches keep the value of the middle. */
static long super_step(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to,
                       const struct lapse *l, int stages) {
    double c[5], weight[2] = {0, 0}; /* values of S_j and S_(j-1) if q were 1 throughout */
    double moment[2] = {0, 0};
    g->models.diffusion->stage(stages, 1, c);
    weight[0] = c[2] * l->dt;
    renew_patches(g, l->t + 0.5 * l->dt);
    g->engine->diffusion.begin(g, what, Y0, weight[0], l->pending);
    for (int j = 2; j <= stages; j++) {
        g->models.diffusion->stage(stages, j, c);
        if (j == 2) c[1] = 0; /* S_0 = 0 */
        c[2] *= l->dt;
        c[3] *= l->dt;
        c[4] = c[2] * l->part * weight[0] / l->dt;
        renew_patches(g, l->t + moment[0] / weight[0]);
        g->engine->diffusion.stage(g, what, Y0, c, weight[0]);
        const double next = c[0] * weight[0] + c[1] * weight[1] + c[2] + c[3];
        const double later = c[0] * moment[0] + c[1] * moment[1] + c[2] * weight[0];
        weight[1] = weight[0];
        weight[0] = next;
        moment[1] = moment[0];
        moment[0] = later;
        if (leaves(g)) return 1;
    }
    g->counts.now.stages[what] += stages;
    renew_patches(g, l->t + moment[0] / weight[0]);
    return g->engine->diffusion.end(g, what, Y0, to, l->dt, weight[0]);
}

/* Returns the number of super steps, and sets their stages, no more than the engine's operator bears. */
static long plan_steps(const struct gas *g, double ratio, int *stages) {
    const int most = g->engine->diffusion.most_stages[g->dim];
    for (long parts = 1;; parts *= 2) {
        const long steps = g->models.diffusion->plan(ratio / (double)parts, stages);
        if (most == 0 || *stages <= most) return parts * steps;
    }
}

/* Would a half step over dt from a state never get through? Notes that in g->diffusion.stiff, with a scratch state. */
static bool too_stiff(struct gas *g, const struct state *from, const struct state *scratch, double dt,
                      const double rate[2]) {
    for (int what = 0; what < 2; what++) {
        const double ratio = smaller(dt * rate[what], MOST_RATIO);
        int each = 0;
        const long stages = g->models.diffusion->plan ? plan_steps(g, ratio, &each) * each : 0;
        if (ratio < MOST_RATIO && stages <= MOST_STAGES) continue;
        g->diffusion.stiff =
            (struct stiff){true, g->diffusion.late, (enum diffusing)what, rate[what], dt, (double)stages, {0}};
        g->engine->diffusion.rates(g, from, (double[2]){0}, scratch);
        place_of_value(g, scratch, what, rate[what], g->diffusion.stiff.place);
        return true;
    }
    return false;
}

/* Returns the i-th of `parts` equal parts of a lapse. */
static struct lapse part_of(const struct lapse *l, long i, long parts) {
    const double n = (double)parts;
    return (struct lapse){l->t + l->dt * (double)i / n, l->dt / n, l->pending - l->part * (double)i / n, l->part / n};
}

/* Covers a lapse by super steps, or by an implicit step; returns this rank's number of inadmissible cells. */
static long cover(struct gas *g, enum diffusing what, const struct state *from, const struct state *to,
                  const struct lapse *all, double rate, bool monotone) {
    int stages;
    if (!g->models.diffusion->plan) return implicit_step(g, what, from, to, all, monotone);
    const long steps = plan_steps(g, all->dt * rate, &stages);
    long bad = 0;
    for (long i = 0; i < steps && !g->step.left; i++) {
        const struct lapse one = part_of(all, i, steps);
        bad = super_step(g, what, i ? to : from, to, &one, stages);
    }
    return bad;
}

/* Conducts heat from `from` to `to`, another state, in as many parts as it takes until all cells are admissible: super
 * steps are not monotone, so a hot thin gas on a cold dense one may end at a hundredth of its T, of either sign. */
static long conduct(struct gas *g, const struct state *from, const struct state *to, double t, double dt, double rate) {
    const struct lapse whole = {t, dt, 1, 1};
    books_mark_heat(g, false);
    for (int parts = 1;; parts *= parts > 1 ? 4 : 2) {
        long bad = 0;
        for (int i = 0; i < parts && !g->step.left; i++) {
            const struct lapse part = part_of(&whole, i, parts);
            bad = cover(g, HEAT, i ? to : from, to, &part, rate, parts > 1);
        }
        double most = (double)bad;
        comm_max(g->comm, &most, 1);
        if (g->step.left) return 1;
        if (most == 0 || 4 * parts > MOST_PARTS) {
            books_part(g, GAS_HEAT, to);
            return bad;
        }
        g->counts.now.repeated++;
        books_mark_heat(g, true);
        (void)flags_of_marks(g, false);
    }
}

struct between { /* context of visitors of rows: two states, a time apart */
    struct gas *g;
    const struct state *from, *to;
    double dt;
};

static void dilate_visit(void *between, const struct row *row) {
    const struct between *b = between;
    struct gas *g = b->g;
    double spread[BATCH], *to = b->to->block[row->block] + row->at;
    g->engine->diffusion.spread(g, b->from, b->to, row, spread);
    dilate_row(g, row->n, b->dt, g->diffusion.dilation[row->block] + row->at, spread,
               b->from->block[row->block] + row->at, to + energy_at(g) * g->size);
}

/* Takes the heat dilation div u over dt from `mid`, the result of the stress on `from`, if the law has that term. */
static void dilate(struct gas *g, const struct state *from, const struct state *mid, double dt) {
    if (!g->diffusion.terms.dilation) return;
    books_part(g, GAS_HEAT, mid); /* the heat that cross grad rho has moved */
    g->engine->state.ghosts(g, from);
    g->engine->state.ghosts(g, mid);
    g->engine->state.rows(g, EVERY_CELL, NULL, dilate_visit, &(struct between){g, from, mid, dt});
    books_part(g, GAS_DILATION, mid);
}

/* The third state of diffusion, scratch. */
static const struct state *between_of(const struct gas *g, const struct state *to) {
    return to == &g->W ? &g->U0 : &g->W;
}

/* Applies the stress to `from`, then conducts heat, by way of a third state. again: the heat of dilation was taken
 * before, so that it is no source of conduction. */
static long diffuse_both(struct gas *g, const struct state *from, const struct state *to, double t, double dt,
                         const double rate[2], bool again) {
    const struct state *mid = between_of(g, to);
    const struct lapse stress = {t, dt, 0, 0};
    (void)cover(g, VISCOUS, from, mid, &stress, rate[VISCOUS], false);
    books_part(g, GAS_FRICTION, mid);
    if (!again) dilate(g, from, mid, dt);
    if (g->diffusion.terms.cross) g->engine->diffusion.cross(g, mid, dt);
    note_friction(g, from, mid);
    if (again) dilate(g, from, mid, dt);
    return conduct(g, mid, to, t, dt, rate[HEAT]);
}

static void ahead_row(void *between, const struct row *row) {
    const struct between *b = between;
    double T[BATCH], *warm = b->g->diffusion.warm[row->block] + row->at;
    temperature_row(b->g, row->n, b->to->block[row->block] + row->at, T);
    for (int i = 0; i < row->n; i++) warm[i] = smaller(larger(T[i] / warm[i], 1 / MOST_RISE), MOST_RISE);
}

bool diffuse(struct gas *g, const struct state *from, const struct state *to, double t, double dt, enum lapse_of part,
             long bad) {
    double rate[2], most[3] = {bad > 0, 0, 0};
    const struct state *seen = part == WHOLE_STEP ? &g->U : from;
    g->diffusion.ahead = g->diffusion.ahead && part == SECOND_HALF;
    g->diffusion.late = part != FIRST_HALF;
    g->diffusion.whole = part == WHOLE_STEP;
    renew_patches(g, part == SECOND_HALF ? t + dt : t);
    diffusion_sees(g, seen);
    g->diffusion.plain = false;
    g->engine->diffusion.rates(g, seen, rate, NULL);
    for (int i = 0; i < 2 && !bad; i++) most[1 + i] = rate[i];
    comm_max(g->comm, most, 3);
    if (most[0] > 0 || !isfinite(most[1] + most[2]) || too_stiff(g, seen, between_of(g, to), dt, most + 1))
        return false;
    g->diffusion.ahead = false;
    long repeats = 0, plain = 0;
    books_mark(g, false);
    for (int parts = 1; parts <= MOST_PARTS && !g->step.left; parts *= repeats > 1 ? 2 : 1) {
        for (int i = 0; i < parts && !g->step.left; i++)
            bad = diffuse_both(g, i ? to : from, to, t + i * (dt / parts), dt / parts, most + 1, repeats > 0);
        most[0] = (double)bad;
        comm_max(g->comm, most, 1);
        if (most[0] == 0) break;
        repeats++;
        if (source_thermal(&g->models.source)) forget_cooled(g);
        books_mark(g, true);
        plain = flags_of_marks(g, true);
    }
    (void)flags_of_marks(g, false);
    if (repeats) flags_clear(g);
    g->counts.now.halves += most[0] > 0 ? 0 : part == WHOLE_STEP ? 2 : 1;
    g->counts.now.repeated += repeats;
    g->counts.now.plain += plain;
    if (part == FIRST_HALF && most[0] == 0) {
        renew_patches(g, t + dt);
        g->engine->state.ghosts(g, to);
        g->engine->state.rows(g, NEAR_CELLS, NULL, ahead_row, &(struct between){.g = g, .to = to});
        diffusion_looks_ahead(g, to);
        g->diffusion.ahead = true;
    }
    return most[0] == 0;
}
