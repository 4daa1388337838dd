/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps the lines of tally.h over the parts of a step; the engines fill them. */
#include "libcore/gas/gas_private.h"

#include <stdlib.h>

static status make_lines(double *line[MAX_VAR], int n, int faces) {
    for (int v = 0; v < n; v++) TRY(allocate(&line[v], faces, sizeof(double), "the fluxes through patches"));
    return OK;
}

static void free_lines(double *const line[MAX_VAR]) {
    for (int v = 0; v < MAX_VAR; v++) free(line[v]);
}

static status make(struct gas *g, struct tally *t) {
    TRY(g->engine->tally.make(g, t));
    if (!t->borrowed) TRY(make_lines(t->stage, g->nvar, t->faces));
    TRY(make_lines(t->flow, g->nvar, t->faces));
    TRY(make_lines(t->last[0], g->nvar, t->faces));
    if (!g->models.transport) return OK;
    TRY(make_lines(t->passed, g->nvar, t->faces));
    TRY(make_lines(t->mark, g->nvar, t->faces));
    TRY(make_lines(t->last[1], g->nvar, t->faces));
    return allocate(&t->warm, t->faces, sizeof *t->warm, "the fluxes through patches");
}

status gas_tally(struct gas *g) {
    struct tally *t = NULL;
    if (g->books.tally) return OK;
    status s = allocate(&t, 1, sizeof *t, "the fluxes through patches");
    if (!s) s = make(g, t);
    s = comm_agree(g->comm, s);
    if (s)
        tally_free(t);
    else
        g->books.tally = t;
    return s;
}

void tally_free(struct tally *t) {
    if (!t) return;
    double *const *const all[] = {t->stage, t->flow, t->passed, t->mark, t->last[0], t->last[1]};
    for (size_t i = t->borrowed; i < sizeof all / sizeof *all; i++) free_lines(all[i]);
    free(t->first);
    free(t->warm);
    free(t);
}

static void copy_lines(const struct gas *g, double *const *from, double *const *to) {
    for (int v = 0; v < g->nvar && from[0]; v++) memcpy(to[v], from[v], (size_t)g->books.tally->faces * sizeof(double));
}

void tally_begin(struct gas *g) {
    const struct tally *t = g->books.tally;
    if (!t) return;
    for (int v = 0; v < g->nvar; v++) {
        memset(t->flow[v], 0, (size_t)t->faces * sizeof(double));
        if (t->passed[v]) memset(t->passed[v], 0, (size_t)t->faces * sizeof(double));
    }
}

void tally_add(const struct tally *t, double weight, const double *flux, double *to) {
    for (int i = 0; i < t->faces; i++) to[i] += weight * flux[i];
}

void tally_stage(struct gas *g, double weight) {
    const struct tally *t = g->books.tally;
    if (!t) return;
    for (int v = 0; v < g->nvar; v++) tally_add(t, weight, t->stage[v], t->flow[v]);
    if (g->engine->tally.still) g->engine->tally.still(g, weight);
}

void tally_bed(struct gas *g, double dt) {
    if (g->books.tally) g->engine->tally.bed(g, dt);
}

void tally_mark(struct gas *g, bool back) {
    const struct tally *t = g->books.tally;
    if (t) copy_lines(g, back ? t->mark : t->passed, back ? t->passed : t->mark);
}

void tally_mark_heat(struct gas *g, bool back) {
    const struct tally *t = g->books.tally;
    if (!t) return;
    double *const heat = t->passed[energy_at(g)];
    memcpy(back ? heat : t->warm, back ? t->warm : heat, (size_t)t->faces * sizeof(double));
}

void tally_keep(struct gas *g, double dt) {
    struct tally *t = g->books.tally;
    if (!t) return;
    copy_lines(g, t->flow, t->last[0]);
    copy_lines(g, t->passed, t->last[1]);
    t->dt = dt;
}

void tally_face(const struct gas *g, int i, double scale, struct gas_face *out) {
    const struct tally *t = g->books.tally;
    const double per = t->dt > 0 ? scale / t->dt : 0;
    out->mass = per * t->last[0][0][i];
    for (int k = 0; k < g->components; k++) {
        out->pressure[k] = per * t->last[0][k + 1][i];
        out->viscous[k] = t->last[1][0] ? per * t->last[1][k][i] : 0;
    }
    out->energy = per * t->last[0][energy_at(g)][i];
    out->work = t->last[1][0] ? per * t->last[1][g->nvar - 2][i] : 0;
    out->heat = t->last[1][0] ? per * t->last[1][energy_at(g)][i] : 0;
}

double gas_tally_step(const struct gas *g) {
    return g->books.tally ? g->books.tally->dt : 0;
}

void gas_tally_faces(const struct gas *g, int block, gas_face_visitor *visit, void *context) {
    if (g->books.tally) g->engine->tally.visit(g, block, visit, context);
}
