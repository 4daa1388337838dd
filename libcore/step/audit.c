/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps the budget of mass, momentum and energy (audit.h): totals are taken behind every part of a step, and
 * differences are booked under causes. */
#include "libcore/step/audit.h"

#include "libcore/gas/gas_private.h"

#include <stdlib.h>

struct account {
    double totals[MAX_VAR];              /* mass, momentum, energy behind the last part */
    double gained[GAS_CAUSES];           /* J: energy by cause */
    double sourced[SOURCE_MOST];         /* J: energy by source */
    double pushed[SOURCE_MOST][MAX_DIM]; /* N s: momentum by source */
};
struct warm { /* context of warm_row */
    const struct gas *g;
    const struct state *from;
};
struct audit {
    bool known[GAS_CAUSES];           /* may the cause change the gas? Else its changes are unaccounted */
    struct account now, start, mark;  /* of this attempt; at the start of the step; noted by audit_mark */
    double weight;                    /* J: energy since the last look from gravity in the stages */
    double work;                      /* J: energy since the last look from sources that have a formula */
    bool kicks;                       /* are the sources gravity's kicks beside a bed? */
    double beside[MAX_VAR];           /* mass, momentum, energy beside a bed, before gravity's kick there */
    int measured;                     /* row of the source since then that has none; -1: there is none */
    int pusher;                       /* row of the source since then that changes momentum; -1: there is none */
    double first[MAX_VAR], floors[2]; /* totals at the start; mass (kg) and energy (J) of the floors by then */
    double given[MAX_DIM];            /* N s: by the density floor */
    double *rubbed;                   /* [places of struct floors] J/m^3 by friction in this attempt; NULL: none */
    double *through;                  /* [GAS_EDGES][components][blocks] N s: what left through patches */
    status failed;                    /* error of an attempt's sums, which ends the step */
};

static void floors_of(const struct gas *g, double floors[2]) {
    floors[0] = g->counts.now.fill[0];
    floors[1] = g->counts.now.fill[1] + g->counts.now.energy + g->counts.now.lift;
}

static void find_causes(const struct gas *g, bool known[GAS_CAUSES]) {
    known[GAS_FLOORS] = true;
    known[GAS_CONTACTS] = gas_rubs(&g->models);
    known[GAS_DILATION] = g->diffusion.terms.dilation;
    for (int p = 0; p < g->patches.n; p++) {
        const struct patch_rules *r = &g->patches.rules[p];
        if (!r->velocity.type) continue;
        const bool open = !patch_is_wall(r), viscous = g->models.transport != NULL;
        known[GAS_FLOW] |= open;
        known[GAS_FRICTION] |= viscous && (open || wall_works(r));
        known[GAS_HEAT] |= viscous && (open || wall_conducts(r));
    }
}

/* Allocates what the gas itself notes for the budget. */
static status make_notes(struct gas *g, struct audit *a) {
    TRY(allocate(&a->through, (long)GAS_EDGES * g->components * grid_blocks(g), sizeof(double), "the budget"));
    if (gas_rubs(&g->models)) TRY(allocate(&a->rubbed, g->floors.places, sizeof(double), "the budget"));
    if (g->falling.dropped) TRY(allocate(&g->falling.denser, g->floors.places, sizeof(double), "the budget"));
    for (int k = 0; k < g->components && g->limits.least > 0; k++)
        TRY(allocate(&g->floors.given[k], g->floors.places, sizeof(double), "the budget"));
    return OK;
}

status gas_audit(struct gas *g) {
    struct audit *a = g->books.audit;
    if (!a) {
        TRY(gas_tally(g));
        TRY(allocate(&a, 1, sizeof *a, "the budget"));
        g->books.audit = a;
        TRY(make_notes(g, a));
    }
    *a = (struct audit){.failed = a->failed, .rubbed = a->rubbed, .through = a->through};
    memset(a->through, 0, (size_t)GAS_EDGES * (size_t)g->components * (size_t)grid_blocks(g) * sizeof(double));
    find_causes(g, a->known);
    floors_of(g, a->floors);
    TRY(gas_totals(g, a->now.totals));
    a->start = a->now;
    memcpy(a->first, a->now.totals, sizeof a->first);
    return OK;
}

void audit_free(struct audit *a) {
    if (!a) return;
    status_free(a->failed);
    free(a->through);
    free(a->rubbed);
    free(a);
}

void audit_begin(struct gas *g) {
    if (!g->books.audit) return;
    g->books.audit->now = g->books.audit->start;
    g->books.audit->weight = 0;
}

void audit_mark(struct gas *g, bool back) {
    struct audit *a = g->books.audit;
    if (a && back) a->now = a->mark;
    if (a) a->mark = a->now;
}

/* Keeps the first error. */
static void note_status(struct audit *a, status e) {
    if (a->failed)
        status_free(e);
    else
        a->failed = e;
}

/* Takes the totals of a state; returns the change of energy since the last look. */
static double look(struct gas *g, const struct state *now) {
    struct audit *a = g->books.audit;
    const double before = a->now.totals[energy_at(g)];
    note_status(a, state_totals(g, now, a->now.totals));
    return a->now.totals[energy_at(g)] - before;
}

void audit_part(struct gas *g, enum gas_cause cause, const struct state *now) {
    struct audit *a = g->books.audit;
    if (!a) return;
    a->now.gained[cause] += look(g, now) - a->weight;
    a->weight = 0;
}

/* Writes the warm cells' part of a row to the scratch W, zero for cold ones. */
static void warm_row(void *gas, const struct row *row) {
    const struct warm *w = gas;
    const struct gas *g = w->g;
    const double *falls = g->falling.cells[row->block] + row->at;
    const double *part = g->step.hybrid ? g->dense->part[row->block] + row->at : NULL;
    for (int v = 0; v < g->nvar; v++) {
        const long at = v * g->size + row->at;
        const double *from = w->from->block[row->block] + at;
        double *to = g->W.block[row->block] + at;
        for (int i = 0; i < row->n; i++) to[i] = falls[i] > 0 || (part && part[i] > 0) ? 0 : from[i];
    }
}

/* Writes the cells beside a bed to the scratch W, zero for the bed's. */
static void beside_row(void *gas, const struct row *row) {
    const struct warm *w = gas;
    const struct gas *g = w->g;
    const double *part = g->dense->part[row->block] + row->at;
    for (int v = 0; v < g->nvar; v++) {
        const long at = v * g->size + row->at;
        const double *from = w->from->block[row->block] + at;
        double *to = g->W.block[row->block] + at;
        for (int i = 0; i < row->n; i++) to[i] = part[i] > 0 ? 0 : from[i];
    }
}

/* Totals of W, which is given back the frozen cells of a bed: stages read them there, and do not write them. */
static void totals_of_scratch(struct gas *g, const struct state *from, double totals[MAX_VAR]) {
    spans_keep_as(g, from, &g->W);
    note_status(g->books.audit, state_totals(g, &g->W, totals));
    if (g->step.hybrid) (void)dense_put(g, &g->W);
}

static void find_beside(struct gas *g, const struct state *s, double totals[MAX_VAR]) {
    g->engine->state.rows(g, EACH_STATE, s, beside_row, &(struct warm){g, s});
    totals_of_scratch(g, s, totals);
}

static void book_weight(struct gas *g, double work) {
    g->books.audit->weight += work;
    g->books.audit->now.sourced[source_gravity_row()] += work;
}

/* Books the momentum that gravity gives to so much mass times time (kg s). */
static void book_fall(struct gas *g, double mass) {
    double *pushed = g->books.audit->now.pushed[source_gravity_row()];
    for (int k = 0; k < g->components; k++) pushed[k] += mass * g->falling.gravity[k];
}

void audit_weight(struct gas *g, const struct state *from, double part) {
    double totals[MAX_VAR], work = 0;
    if (!g->books.audit || !g->falling.cells) return;
    g->engine->state.rows(g, EACH_STATE, from, warm_row, &(struct warm){g, from});
    totals_of_scratch(g, from, totals);
    for (int k = 0; k < g->components; k++) work += part * g->falling.gravity[k] * totals[k + 1];
    book_weight(g, work);
    book_fall(g, part * totals[0]);
}

void audit_rest(struct gas *g, double part, const double force[MAX_DIM], status failed) {
    if (!g->books.audit) return;
    note_status(g->books.audit, failed);
    for (int k = 0; k < g->dim; k++) g->books.audit->now.pushed[source_gravity_row()][k] += part * force[k];
}

void audit_dropped(struct gas *g, double part) {
    double sum = 0;
    if (!g->books.audit || !g->falling.cells) return;
    note_status(g->books.audit, sum_raised(g, g->falling.dropped, &sum));
    book_weight(g, part * sum);
    note_status(g->books.audit, sum_raised(g, g->falling.denser, &sum));
    book_fall(g, part * sum);
}

void audit_friction(struct gas *g) {
    double sum = 0;
    if (!g->books.audit || !g->dense->bed.rub) return;
    dense_spread(g, g->dense->bed.home->rubbed, g->books.audit->rubbed);
    note_status(g->books.audit, sum_raised(g, g->books.audit->rubbed, &sum));
    g->books.audit->weight += sum;
    g->books.audit->now.gained[GAS_CONTACTS] += sum;
}

void audit_bed(struct gas *g) {
    double sum = 0;
    audit_friction(g);
    if (!g->books.audit || !g->falling.cells) return;
    dense_spread(g, g->dense->bed.home->work, g->falling.dropped);
    note_status(g->books.audit, sum_raised(g, g->falling.dropped, &sum));
    book_weight(g, sum);
    for (int k = 0; k < g->components; k++) {
        bed_push(&g->dense->bed, g->step.dt, g->dense->kick, k);
        dense_spread(g, g->dense->bed.home->pushed, g->falling.dropped);
        note_status(g->books.audit, sum_raised(g, g->falling.dropped, &sum));
        g->books.audit->now.pushed[source_gravity_row()][k] += sum;
    }
}

/* Is a plan that of gravity's kicks of cells that fall beside a bed? Else gravity is not among the sources of a step
 * with a bed. */
static bool kicks_beside_bed(const struct gas *g, const struct source_plan *plan) {
    return g->step.hybrid && plan->n == 1 && plan->step[0].row == &source_table[source_gravity_row()];
}

/* Prepares the account for the sources of a plan. Formulas take mass and momentum from the last look at the totals. So
 * there is a new look before a source that pushes if another has pushed since, and before a second source without a
 * formula. */
void audit_sources(struct gas *g, const struct source_plan *plan, const struct state *from,
                   const struct state *scratch) {
    struct audit *a = g->books.audit;
    bool pushed = false;
    if (!a) return;
    a->work = 0;
    a->measured = a->pusher = -1;
    a->kicks = kicks_beside_bed(g, plan);
    if (a->kicks) find_beside(g, from, a->beside);
    for (int i = 0; i < plan->n; i++) {
        const struct source_step *s = &plan->step[i];
        const int row = (int)(s->row - source_table);
        if ((pushed && s->row->pushes) || (!s->row->gained && a->measured >= 0)) {
            struct source_plan before = *plan;
            before.n = i;
            (void)sources_apply(g, &before, from, scratch);
            audit_sourced(g, scratch);
            pushed = false;
        }
        const double work = s->row->gained ? s->row->gained(s, a->now.totals) : 0;
        a->now.sourced[row] += work;
        a->work += work;
        if (!s->row->gained) a->measured = row;
        if (s->row->pushes) a->pusher = row;
        pushed |= s->row->pushes;
    }
}

/* Books what gravity's kick did beside a bed, whose own cells get their start back; energy: its change anywhere. */
static void book_kick(struct gas *g, const struct state *now, double energy) {
    struct audit *a = g->books.audit;
    double after[MAX_VAR];
    find_beside(g, now, after);
    book_weight(g, (after[energy_at(g)] - a->beside[energy_at(g)]) - energy);
    for (int k = 0; k < g->components; k++) a->now.pushed[source_gravity_row()][k] += after[k + 1] - a->beside[k + 1];
}

void audit_sourced(struct gas *g, const struct state *now) {
    struct audit *a = g->books.audit;
    double before[MAX_VAR];
    if (!a) return;
    memcpy(before, a->now.totals, sizeof before);
    const double energy = look(g, now) - a->work;
    if (a->measured >= 0) a->now.sourced[a->measured] += energy;
    for (int k = 0; k < g->components && a->pusher >= 0 && !a->kicks; k++)
        a->now.pushed[a->pusher][k] += a->now.totals[k + 1] - before[k + 1];
    if (a->kicks) book_kick(g, now, energy);
    a->kicks = false;
    a->work = 0;
    a->measured = a->pusher = -1;
}

status audit_filled(struct gas *g) {
    double sum;
    for (int k = 0; k < g->components && g->books.audit && g->floors.given[k]; k++) {
        TRY(sum_raised(g, g->floors.given[k], &sum));
        g->books.audit->given[k] += sum;
    }
    return OK;
}

struct leaving { /* context of leave_face: a block's place in audit.through */
    const struct gas *g;
    double *through;
    int blocks;
};

static void leave_face(void *leaving, const struct gas_face *face) {
    const struct leaving *l = leaving;
    const int edge = patch_is_wall(&l->g->patches.rules[face->patch]) ? GAS_WALLS : GAS_OPEN;
    for (int k = 0; k < l->g->components; k++)
        l->through[(long)(edge * l->g->components + k) * l->blocks] +=
            l->g->books.tally->dt * (face->pressure[k] + face->viscous[k]);
}

status audit_keep(struct gas *g) {
    struct audit *a = g->books.audit;
    if (!a) return OK;
    a->start = a->now;
    for (int b = 0; b < grid_blocks(g); b++)
        gas_tally_faces(g, b, leave_face, &(struct leaving){g, a->through + b, grid_blocks(g)});
    const status e = a->failed;
    a->failed = OK;
    return e;
}

/* Finds the momentum by cause. */
static status find_momentum(const struct gas *g, const double totals[MAX_VAR], struct gas_budget *out) {
    const struct audit *a = g->books.audit;
    for (int k = 0; k < g->components; k++) {
        out->momentum[k] = totals[k + 1];
        out->given[k] = a->given[k];
        out->strayed[k] = a->first[k + 1] + a->given[k] - totals[k + 1];
        for (int i = 0; i < source_count; i++) out->strayed[k] += out->pushed[i][k] = a->start.pushed[i][k];
        for (int edge = 0; edge < GAS_EDGES; edge++) {
            TRY(sum_blocks(g, a->through + (long)(edge * g->components + k) * grid_blocks(g), &out->through[edge][k]));
            out->strayed[k] += out->through[edge][k] = -out->through[edge][k];
        }
    }
    return OK;
}

status gas_budget(const struct gas *g, struct gas_budget *out) {
    const struct audit *a = g->books.audit;
    double totals[MAX_VAR], floors[2];
    *out = (struct gas_budget){0};
    TRY(gas_totals(g, totals));
    floors_of(g, floors);
    const double now[2] = {totals[0], totals[energy_at(g)]};
    for (int i = 0; i < GAS_CAUSES; i++) out->gained[i] = a->known[i] ? a->start.gained[i] : 0;
    /* the energy booked under the stages contains the energy that floors added in them */
    const double seen = a->start.gained[GAS_FLOORS], all = floors[1] - a->floors[1];
    out->gained[GAS_FLOORS] = all;
    if (a->known[GAS_FLOW]) out->gained[GAS_FLOW] -= all - seen;
    out->mass = now[0];
    out->energy = now[1];
    out->filled = floors[0] - a->floors[0];
    out->flowed = a->known[GAS_FLOW] ? now[0] - a->first[0] - out->filled : 0;
    out->lost[0] = a->first[0] + out->flowed + out->filled - now[0];
    out->lost[1] = a->first[energy_at(g)] - now[1];
    for (int i = 0; i < source_count; i++) out->lost[1] += out->sourced[i] = a->start.sourced[i];
    for (int i = 0; i < GAS_CAUSES; i++) out->lost[1] += out->gained[i];
    return find_momentum(g, totals, out);
}
