/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tells the accounts of a step what its parts do (books.h). */
#include "libcore/gas/books.h"

#include "libcore/gas/gas_private.h"
#include "libcore/step/audit.h"

void books_begin(struct gas *g) {
    audit_begin(g);
    tally_begin(g);
}

void books_part(struct gas *g, enum gas_cause cause, const struct state *now) {
    audit_part(g, cause, now);
}

void books_sources(struct gas *g, const struct source_plan *plan, const struct state *from) {
    audit_sources(g, plan, from, &g->W);
}

void books_sourced(struct gas *g, const struct state *now) {
    audit_sourced(g, now);
}

void books_stage(struct gas *g, const struct state *from, double weight) {
    audit_weight(g, from, weight);
}

void books_staged(struct gas *g, double weight) {
    double force[MAX_DIM] = {0};
    const status failed = tally_stage(g, weight, g->books.audit ? force : NULL);
    audit_rest(g, weight, force, failed);
}

void books_limited(struct gas *g, double share) {
    audit_dropped(g, share);
}

void books_bed(struct gas *g, double dt) {
    tally_bed(g, dt);
    audit_bed(g);
}

void books_friction(struct gas *g, double dt) {
    tally_bed(g, dt);
    audit_friction(g);
}

void books_mark(struct gas *g, bool back) {
    audit_mark(g, back);
    tally_mark(g, back);
}

void books_mark_heat(struct gas *g, bool back) {
    tally_mark_heat(g, back);
}

status books_floors(struct gas *g) {
    return audit_filled(g);
}

status books_keep(struct gas *g, double dt) {
    tally_keep(g, dt);
    return audit_keep(g);
}

void books_free(struct gas *g) {
    audit_free(g->books.audit);
    tally_free(g->books.tally);
}
