/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Keeps the lines of tally.h over the parts of a step; the engines fill them. A bed is booked here. */
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
    t->faces = g->patches.sides;
    TRY(make_lines(t->stage, g->nvar, t->faces));
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
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free_lines(all[i]);
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

status tally_stage(struct gas *g, double weight, double *force) {
    const struct tally *t = g->books.tally;
    if (!t) return OK;
    for (int v = 0; v < g->nvar; v++) tally_add(t, weight, t->stage[v], t->flow[v]);
    return g->engine->tally.rest ? g->engine->tally.rest(g, weight, force) : OK;
}

/* Sets `flow` through the faces of cells of the bed, whose stages are given up, to what the bed exchanged over dt. In
 * an explicit step adds that, which is friction alone. */
void tally_bed(struct gas *g, double dt) {
    const struct bed_set *bed = g->dense->bed.home;
    for (int i = 0; i < g->dense->borders && g->books.tally; i++) {
        const struct dense_border *b = &g->dense->border[i];
        const double area = g->blocks.area ? g->blocks.area[b->through] : 1;
        if (b->edge < 0) continue;
        for (int v = 0; v < g->nvar; v++) {
            double *flow = &g->books.tally->flow[v][b->edge];
            *flow = (g->step.hybrid ? 0 : *flow) + g->patches.side[b->edge].out * (dt * area * bed->kept[v][b->face]);
        }
    }
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

struct showing { /* context of show_edge */
    const struct gas *g;
    gas_face_visitor *visit;
    void *context;
};

/* Fills a face's numbers, rates of the last step, and shows it. */
static void show_edge(void *showing, int i, double scale, struct gas_face *out) {
    const struct showing *s = showing;
    const struct gas *g = s->g;
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
    s->visit(s->context, out);
}

double gas_tally_step(const struct gas *g) {
    return g->books.tally ? g->books.tally->dt : 0;
}

void gas_tally_faces(const struct gas *g, int block, gas_face_visitor *visit, void *context) {
    if (g->books.tally) g->engine->state.edges(g, block, show_edge, &(struct showing){g, visit, context});
}
