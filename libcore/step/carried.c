/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Carried quantities on any mesh (libcore/gas/carried.h), and as a part of a step: the mass that its stages bring
 * through the faces is summed up. When the step stands, gas_step moves the quantities by it. */
#include "libcore/gas/carried.h"

#include "libcore/step/step_parts.h"

#include <stdlib.h>

enum { MOST_PARTS = 10000 };          /* a step may be cut into */
static const double FULL = 1 - 1e-12; /* of a cell's mass may leave it in a part of a step: round-off stays behind */

static status make_quantities(struct gas *g) {
    struct carried *c = g->carried;
    TRY(allocate(&c->quantity, c->n, sizeof *c->quantity, "carried quantities"));
    for (int i = 0; i < c->n; i++) {
        struct carried_quantity *q = &c->quantity[i];
        q->choice = g->models.carried[i];
        q->terms = q->choice.kind->terms(&q->choice.params);
        c->terms |= q->terms;
        TRY(allocate(&q->rule, g->patches.n, sizeof *q->rule, "carried quantities"));
        for (int p = 0; p < g->patches.n; p++) q->rule[p] = &g->patches.rules[p].carried[i];
        TRY(line_make(g, &q->phi));
    }
    return OK;
}

static status make_faces(const struct gas *g, double ***out) {
    TRY(allocate(out, g->blocks.n, sizeof **out, "carried quantities"));
    for (int b = 0; b < g->blocks.n; b++)
        TRY(allocate(&(*out)[b], g->blocks.faces + SLACK, sizeof(double), "carried quantities"));
    return OK;
}

static status make(struct gas *g) {
    struct carried *c = g->carried;
    double ***faces[] = {&c->flux, &c->mass, &c->exchange, &c->spread};
    const double *gravity = g->models.source.gravity;
    double square = 0;
    for (int k = 0; k < g->dim; k++) square += gravity[k] * gravity[k];
    for (int k = 0; k < g->dim && square > 0; k++) c->up[k] = -gravity[k] / sqrt(square);
    TRY(make_quantities(g));
    c->clear = true;
    if (c->terms) {
        TRY(line_make(g, &c->rho));
        TRY(line_make(g, &c->D));
        TRY(line_make(g, &c->f));
    }
    if (c->terms & CARRIED_STRESS) {
        TRY(line_make(g, &c->stress));
        TRY(line_make(g, &c->rise));
    }
    for (int i = 0; i < 4; i++) TRY(make_faces(g, faces[i]));
    return OK;
}

status carried_make(struct gas *g) {
    if (g->models.ncarried == 0) return OK;
    TRY(allocate(&g->carried, 1, sizeof *g->carried, "carried quantities"));
    g->carried->n = g->models.ncarried;
    return make(g);
}

void carried_free(struct gas *g) {
    struct carried *c = g->carried;
    if (!c) return;
    for (int i = 0; i < c->n && c->quantity; i++) {
        line_free(g, c->quantity[i].phi);
        free(c->quantity[i].rule);
    }
    double **lines[] = {c->rho, c->D, c->f, c->stress, c->rise, c->flux, c->mass, c->exchange, c->spread};
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) line_free(g, lines[i]);
    free(c->quantity);
    free(c);
}

void carried_begin(struct gas *g) {
    for (int b = 0; b < g->blocks.n; b++) memset(g->carried->mass[b], 0, (size_t)g->blocks.faces * sizeof(double));
}

void carried_keep(struct gas *g, double weight) {
    struct carried *c = g->carried;
    for (int b = 0; b < g->blocks.n; b++)
        for (long i = 0; i < g->blocks.faces; i++) c->mass[b][i] += weight * c->flux[b][i];
}

/* Sets the mass through the k-th faces of a row of cells of the bed, but kept ones, to what it exchanged over dt; cell:
 * the first of these. */
static void take_sides(struct gas *g, const struct row *row, const struct sides *s, int k, int cell, double dt) {
    const struct bed_set *bed = g->dense->bed.home;
    for (int i = 0; i < row->n; i++) {
        if (s->face[i] == NO_SIDE) continue;
        const int place = s->face[i] < 0 ? ~s->face[i] : s->face[i];
        const int entry = bed->face_of_cell[bed->face_start[cell + i] + k], face = entry < 0 ? ~entry : entry;
        const double area = g->blocks.area ? g->blocks.area[place] : 1;
        if (bed->kind[face] == BED_KEPT) continue;
        g->carried->mass[row->block][place] = dt * area * bed->kept[0][face] * face_radius(g, row->block, place);
    }
}

static void take_bed(struct gas *g, double dt) {
    const struct dense *d = g->dense;
    struct sides s;
    for (int r = 0, cell = 0; r < d->rows; cell += d->row[r++].n)
        for (int k = 0; g->engine->state.sides(g, &d->row[r], k, &s); k++) take_sides(g, &d->row[r], &s, k, cell, dt);
}

/* ---- ghosts ---- */

/* Fills the ghosts of a line of cells, beyond patches with the values of the cells. */
static void fill(struct gas *g, double **line) {
    g->engine->state.fill(g, 1, 1, line);
    for (int i = 0; i < g->patches.sides; i++) {
        const struct patch_side *s = &g->patches.side[i];
        line[s->block][s->beyond] = line[s->block][s->inside];
    }
}

/* Fills the ghosts of phi, beyond patches with its value on the patch. */
static void fill_phi(struct gas *g, const struct carried_quantity *q) {
    g->engine->state.fill(g, 1, 1, q->phi);
    for (int i = 0; i < g->patches.sides; i++) {
        const struct patch_side *s = &g->patches.side[i];
        const struct rule *rule = q->rule[s->patch.patch];
        double *phi = q->phi[s->block], outflow = s->out * g->carried->mass[s->block][s->face];
        const struct ghost_line l = {.n = 1,
                                     .components = 1,
                                     .face = &s->patch.face,
                                     .inner = {&phi[s->inside]},
                                     .outflow = &outflow,
                                     .normal = -1,
                                     .ghost = {&phi[s->beyond]}};
        rule->type->ghost(rule, &l);
    }
}

/* ---- P and K ---- */

static void density_row(void *gas, const struct row *row) {
    const struct gas *g = gas;
    const double *before = g->V.block[row->block] + row->at, *now = g->U.block[row->block] + row->at;
    double *rho = g->carried->rho[row->block] + row->at, *stress = NULL, T[BATCH];
    for (int i = 0; i < row->n; i++) rho[i] = smaller(before[i], now[i]);
    if (!g->carried->stress) return;
    stress = g->carried->stress[row->block] + row->at;
    temperature_row(g, row->n, now, T);
    for (int i = 0; i < row->n; i++) stress[i] = now[i] * T[i];
}

struct finding { /* D and f of a quantity */
    const struct gas *g;
    const struct carried_quantity *q;
};

static void coefficient_row(void *finding, const struct row *row) {
    const struct finding *x = finding;
    const struct carried *c = x->g->carried;
    const long at = row->at;
    const bool sees = x->q->terms & CARRIED_STRESS;
    double T[BATCH];
    temperature_row(x->g, row->n, x->g->U.block[row->block] + at, T);
    const struct carried_line line = {row->n, &x->g->models.material, c->rho[row->block] + at, T,
                                      sees ? c->rise[row->block] + at : NULL};
    x->q->choice.kind->coefficients(&x->q->choice.params, &line, c->D[row->block] + at, c->f[row->block] + at);
}

static void clear_terms(struct gas *g) {
    struct carried *c = g->carried;
    for (int b = 0; b < g->blocks.n && !c->clear; b++) {
        memset(c->exchange[b], 0, (size_t)g->blocks.faces * sizeof(double));
        memset(c->spread[b], 0, (size_t)g->blocks.faces * sizeof(double));
    }
    c->clear = true;
}

/* Finds P and K of a quantity. */
static void find_terms(struct gas *g, const struct carried_quantity *q, double dt) {
    struct carried *c = g->carried;
    clear_terms(g);
    if (!q->terms) return;
    c->clear = false;
    g->engine->state.rows(g, EVERY_CELL, NULL, coefficient_row, &(struct finding){g, q});
    fill(g, c->D);
    fill(g, c->f);
    g->engine->carried.terms(g, dt);
}

/* ---- a step ---- */

/* Returns into how many parts the step is cut for what P and K are now. */
static double parts_of(struct gas *g) {
    double most = g->engine->carried.most_out(g);
    comm_max(g->comm, &most, 1);
    return larger(ceil(most / FULL), 1);
}

static void move_quantity(struct gas *g, const struct carried_quantity *q, int parts) {
    for (int i = 0; i < parts; i++) {
        const struct carried_part part = {(double)i / parts, (double)(i + 1) / parts, 1. / parts};
        fill_phi(g, q);
        g->engine->carried.move(g, q, part);
    }
}

static status too_many(const struct carried_quantity *q, double t, double parts) {
    return fail(ERR_STATE,
                "t = %.8g: %s would take %.3g parts of this step, at most %d are taken; lower its diffusivity or its "
                "percolation, or take wider cells",
                t, q->choice.name, parts, MOST_PARTS);
}

status carried_move(struct gas *g, double t, double dt) {
    struct carried *c = g->carried;
    if (!c) return OK;
    renew_patches(g, t + 0.5 * dt);
    spans_write_out(g, &g->V);
    spans_write_out(g, &g->U);
    if (c->terms) g->engine->state.rows(g, EVERY_CELL, NULL, density_row, g);
    if (c->terms) fill(g, c->rho);
    if (c->stress) {
        fill(g, c->stress);
        g->engine->carried.rise(g);
    }
    for (int i = 0; i < c->n; i++) {
        const struct carried_quantity *q = &c->quantity[i];
        find_terms(g, q, dt);
        const double parts = parts_of(g);
        if (!(parts <= MOST_PARTS)) return too_many(q, t, parts);
        move_quantity(g, q, (int)parts);
    }
    return OK;
}

/* ---- the part of a step ---- */

static bool are_carried(const struct gas *g, const struct attempt *a) {
    (void)a;
    return g->carried != NULL;
}

static bool carried_first(struct gas *g, struct attempt *a) {
    (void)a;
    carried_begin(g);
    return true;
}

static bool carried_stage(struct gas *g, struct attempt *a, const struct stage_now *s) {
    (void)a;
    carried_keep(g, s->part * s->dt);
    return true;
}

/* The bed has been advanced. */
static bool carried_last(struct gas *g, struct attempt *a) {
    if (g->step.hybrid) take_bed(g, a->dt);
    return true;
}

const struct part carried_part = {"carried quantities", are_carried,  carried_first, carried_stage,
                                  carried_last,         BOOKS_ITSELF, true};
