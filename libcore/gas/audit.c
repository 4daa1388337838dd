/* Keeps the budget of mass and energy (audit.h): totals are taken behind every part of a step, and differences are
 * booked under causes. */
#include "libcore/gas/audit.h"

#include "libcore/gas/gas_private.h"

#include <stdlib.h>

struct account {
    double totals[MAX_VAR];      /* mass, momentum, energy behind the last part */
    double gained[GAS_CAUSES];   /* J: energy by cause */
    double sourced[SOURCE_MOST]; /* J: energy by source */
};
struct warm { /* context of warm_row */
    const struct gas *g;
    const struct state *from;
};
struct audit {
    bool known[GAS_CAUSES];          /* may the cause change the gas? Else its changes are unaccounted */
    struct account now, start, mark; /* of this attempt; at the start of the step; noted by audit_mark */
    double weight;                   /* J: energy since the last look from gravity in the stages */
    double work;                     /* J: energy since the last look from sources that have a formula */
    bool kicks;                      /* are the sources gravity's kicks beside a bed? */
    double beside;                   /* J: energy beside a bed, before gravity's kick there */
    int measured;                    /* row of the source since then that has none; -1: there is none */
    double first[2], floors[2]; /* mass (kg) and energy (J) at the start; those that the floors had added by then */
    status failed;              /* error of an attempt's sums, which ends the step */
};

static void floors_of(const struct gas *g, double floors[2]) {
    floors[0] = g->counts.fill[0];
    floors[1] = g->counts.fill[1] + g->counts.energy + g->counts.lift;
}

static void find_causes(const struct gas *g, bool known[GAS_CAUSES]) {
    known[GAS_FLOORS] = true;
    known[GAS_DILATION] = g->terms.dilation;
    for (int p = 0; p < g->npatches; p++) {
        const struct patch_rules *r = &g->rules[p];
        if (!r->velocity.type) continue;
        const bool open = !patch_is_wall(r), viscous = g->models.transport != NULL;
        known[GAS_FLOW] |= open;
        known[GAS_FRICTION] |= viscous && (open || wall_works(r));
        known[GAS_HEAT] |= viscous && (open || wall_conducts(r));
    }
}

status gas_audit(struct gas *g) {
    struct audit *a = g->audit;
    if (!a) {
        TRY(allocate(&a, 1, sizeof *a, "the budget"));
        g->audit = a;
    }
    *a = (struct audit){.failed = a->failed};
    find_causes(g, a->known);
    floors_of(g, a->floors);
    TRY(gas_totals(g, a->now.totals));
    a->start = a->now;
    a->first[0] = a->now.totals[0];
    a->first[1] = a->now.totals[g->components + 1];
    return OK;
}

void audit_free(struct audit *a) {
    if (a) status_free(a->failed);
    free(a);
}

void audit_begin(struct gas *g) {
    if (!g->audit) return;
    g->audit->now = g->audit->start;
    g->audit->weight = 0;
}

void audit_mark(struct gas *g, bool back) {
    struct audit *a = g->audit;
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
    struct audit *a = g->audit;
    const double before = a->now.totals[g->components + 1];
    note_status(a, g->engine->state.totals(g, now, a->now.totals));
    return a->now.totals[g->components + 1] - before;
}

void audit_part(struct gas *g, enum gas_cause cause, const struct state *now) {
    struct audit *a = g->audit;
    if (!a) return;
    a->now.gained[cause] += look(g, now) - a->weight;
    a->weight = 0;
}

/* Writes the warm cells' part of a row to the scratch W, zero for cold ones. */
static void warm_row(void *gas, const struct row *row) {
    const struct warm *w = gas;
    const struct gas *g = w->g;
    const double *falls = g->falls[row->block] + row->at;
    const double *part = g->hybrid ? g->dense->part[row->block] + row->at : NULL;
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
    if (g->engine->state.keep_as) g->engine->state.keep_as(g, from, &g->W);
    note_status(g->audit, g->engine->state.totals(g, &g->W, totals));
    if (g->hybrid) (void)g->engine->bed.put(g, &g->W);
}

static double energy_beside(struct gas *g, const struct state *s) {
    double totals[MAX_VAR];
    g->engine->state.rows(g, EACH_STATE, s, beside_row, &(struct warm){g, s});
    totals_of_scratch(g, s, totals);
    return totals[g->components + 1];
}

static void book_weight(struct gas *g, double work) {
    g->audit->weight += work;
    g->audit->now.sourced[source_gravity_row()] += work;
}

void audit_weight(struct gas *g, const struct state *from, double part) {
    double totals[MAX_VAR], work = 0;
    if (!g->audit || !g->falls) return;
    g->engine->state.rows(g, EACH_STATE, from, warm_row, &(struct warm){g, from});
    totals_of_scratch(g, from, totals);
    for (int k = 0; k < g->components; k++) work += part * g->gravity[k] * totals[k + 1];
    book_weight(g, work);
}

void audit_dropped(struct gas *g, double part) {
    double sum = 0;
    if (!g->audit || !g->falls) return;
    note_status(g->audit, g->engine->stage.sum_raised(g, g->dropped, &sum));
    book_weight(g, part * sum);
}

void audit_bed(struct gas *g) {
    double sum = 0;
    if (!g->audit || !g->falls) return;
    g->engine->bed.spread(g, g->dense->bed.work, g->dropped);
    note_status(g->audit, g->engine->stage.sum_raised(g, g->dropped, &sum));
    book_weight(g, sum);
}

/* Is a plan that of gravity's kicks of cells that fall beside a bed? Else gravity is not among the sources of a step
 * with a bed. */
static bool kicks_beside_bed(const struct gas *g, const struct source_plan *plan) {
    return g->hybrid && plan->n == 1 && plan->step[0].row == &source_table[source_gravity_row()];
}

/* A formula sees the mass and the momentum of the last look. So totals are looked at before a source whose formula asks
 * for a momentum that has changed since, and before a second source without a formula. */
void audit_sources(struct gas *g, const struct source_plan *plan, const struct state *from,
                   const struct state *scratch) {
    struct audit *a = g->audit;
    bool pushed = false;
    if (!a) return;
    a->work = 0;
    a->measured = -1;
    a->kicks = kicks_beside_bed(g, plan);
    if (a->kicks) a->beside = energy_beside(g, from);
    for (int i = 0; i < plan->n; i++) {
        const struct source_step *s = &plan->step[i];
        const int row = (int)(s->row - source_table);
        if (s->row->gained ? pushed && s->row->pushes : a->measured >= 0) {
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
        pushed |= s->row->pushes;
    }
}

void audit_sourced(struct gas *g, const struct state *now) {
    struct audit *a = g->audit;
    if (!a) return;
    const double rest = look(g, now) - a->work;
    if (a->measured >= 0) a->now.sourced[a->measured] += rest;
    if (a->kicks) book_weight(g, (energy_beside(g, now) - a->beside) - rest); /* the bed's cells get their start back */
    a->kicks = false;
    a->work = 0;
    a->measured = -1;
}

status audit_keep(struct gas *g) {
    struct audit *a = g->audit;
    if (!a) return OK;
    a->start = a->now;
    const status e = a->failed;
    a->failed = OK;
    return e;
}

status gas_budget(const struct gas *g, struct gas_budget *out) {
    const struct audit *a = g->audit;
    double totals[MAX_VAR], floors[2];
    *out = (struct gas_budget){0};
    TRY(gas_totals(g, totals));
    floors_of(g, floors);
    const double now[2] = {totals[0], totals[g->components + 1]};
    for (int i = 0; i < GAS_CAUSES; i++) out->gained[i] = a->known[i] ? a->start.gained[i] : 0;
    /* the energy booked under the stages contains what the floors added in them */
    const double seen = a->start.gained[GAS_FLOORS], all = floors[1] - a->floors[1];
    out->gained[GAS_FLOORS] = all;
    if (a->known[GAS_FLOW]) out->gained[GAS_FLOW] -= all - seen;
    out->mass = now[0];
    out->energy = now[1];
    out->filled = floors[0] - a->floors[0];
    out->flowed = a->known[GAS_FLOW] ? now[0] - a->first[0] - out->filled : 0;
    out->lost[0] = a->first[0] + out->flowed + out->filled - now[0];
    out->lost[1] = a->first[1] - now[1];
    for (int i = 0; i < source_count; i++) out->lost[1] += out->sourced[i] = a->start.sourced[i];
    for (int i = 0; i < GAS_CAUSES; i++) out->lost[1] += out->gained[i];
    return OK;
}
