#include "libcore/gas/audit.h"

#include "libcore/gas/gas_private.h"

#include <stdlib.h>

struct account {
    double totals[MAX_VAR];    /* behind the last part */
    double gained[GAS_CAUSES]; /* energy */
};
struct audit {
    bool known[GAS_CAUSES]; /* is there such a cause? */
    struct account now, start, mark;
    double first[2], floors[2]; /* mass and energy at the start; what the floors had added then */
    status failed;              /* of an attempt: it ends the step */
};

static void floors_of(const struct gas *g, double floors[2]) {
    floors[0] = g->counts.fill[0];
    floors[1] = g->counts.fill[1] + g->counts.energy;
}

static void find_causes(const struct gas *g, bool known[GAS_CAUSES]) {
    known[GAS_COOLING] = source_cools(&g->models.source, &g->models.material);
    known[GAS_GRAVITY] = known[GAS_FLOORS] = true;
    for (int p = 0; p < g->npatches; p++) {
        const struct patch_rules *r = &g->rules[p];
        if (!r->velocity.type) continue;
        const bool open = !r->velocity.type->reflects, viscous = g->models.transport != NULL;
        known[GAS_FLOW] |= open;
        known[GAS_FRICTION] |= viscous && (open || r->velocity.type->value);
        known[GAS_HEAT] |= viscous && (open || r->temperature.type->value);
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
    a->first[1] = a->now.totals[g->dim + 1];
    return OK;
}

void audit_free(struct audit *a) {
    if (a) status_free(a->failed);
    free(a);
}

void audit_begin(struct gas *g) {
    if (g->audit) g->audit->now = g->audit->start;
}

void audit_mark(struct gas *g, bool back) {
    struct audit *a = g->audit;
    if (a && back) a->now = a->mark;
    if (a) a->mark = a->now;
}

static double look(struct gas *g, const struct state *now) {
    struct audit *a = g->audit;
    const double before = a->now.totals[g->dim + 1];
    status e = g->engine->state.totals(g, now, a->now.totals);
    if (a->failed)
        status_free(e);
    else
        a->failed = e;
    return a->now.totals[g->dim + 1] - before;
}

void audit_part(struct gas *g, enum gas_cause cause, const struct state *now) {
    if (g->audit) g->audit->now.gained[cause] += look(g, now);
}

void audit_sources(struct gas *g, const double kick[MAX_DIM], const struct state *now) {
    struct audit *a = g->audit;
    double work = 0;
    if (!a) return;
    for (int k = 0; k < g->dim; k++) work += kick[k] * (a->now.totals[1 + k] + 0.5 * kick[k] * a->now.totals[0]);
    a->now.gained[GAS_GRAVITY] += work;
    a->now.gained[GAS_COOLING] += look(g, now) - work;
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
    const double now[2] = {totals[0], totals[g->dim + 1]};
    for (int i = 0; i < GAS_CAUSES; i++) out->gained[i] = a->known[i] ? a->start.gained[i] : 0;
    /* The stages hold what the floors added in them. */
    const double seen = a->start.gained[GAS_FLOORS], all = floors[1] - a->floors[1];
    out->gained[GAS_FLOORS] = all;
    if (a->known[GAS_FLOW]) out->gained[GAS_FLOW] -= all - seen;
    out->mass = now[0];
    out->energy = now[1];
    out->filled = floors[0] - a->floors[0];
    out->flowed = a->known[GAS_FLOW] ? now[0] - a->first[0] - out->filled : 0;
    out->lost[0] = a->first[0] + out->flowed + out->filled - now[0];
    out->lost[1] = a->first[1] - now[1];
    for (int i = 0; i < GAS_CAUSES; i++) out->lost[1] += out->gained[i];
    return OK;
}
