/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The gas on polyhedra: the memory of its cells, state in and out, rows of cells, fields, wave speeds, totals; and the
 * table of the engine's hooks. */
#include "libcore/gas/patch.h"
#include "libcore/polyhedral/cells_gradient.h"

#include <stdlib.h>

_Static_assert((int)MAX_VAR <= (int)POLYHEDRA_VARIABLES, "a ghost fill of polyhedra has no room for the state");

void cells_lines(const struct gas *g, const struct state *s, double *line[MAX_VAR]) {
    for (int v = 0; v < g->nvar; v++) line[v] = s->block[0] + (long)v * g->cells->polyhedra->size;
}

static status make_lines(struct gas *g) {
    struct cells *c = g->cells;
    const struct polyhedra *m = c->polyhedra;
    struct state *states[] = {&g->U, &g->U0, &g->V, &g->W};
    for (int i = 0; i < 4; i++) {
        TRY(allocate(&states[i]->block, 1, sizeof(double *), "the state"));
        TRY(allocate(&states[i]->block[0], (long)g->nvar * m->size + SLACK, sizeof(double), "the state"));
    }
    TRY(allocate(&c->flux[0], g->nvar * g->blocks.faces, sizeof(double), "fluxes"));
    for (int v = 1; v < g->nvar; v++) c->flux[v] = c->flux[0] + v * g->blocks.faces;
    for (int k = 0; k < g->dim; k++) TRY(allocate(&c->girth[k], m->nown, sizeof(double), "cells"));
    double **single[] = {&c->inverse_volume, &c->total_girth, &c->line};
    for (int i = 0; i < 3; i++) TRY(allocate(single[i], m->nown, sizeof(double), "cells"));
    return OK;
}

static void measure_cells(struct cells *c) {
    const struct polyhedra *m = c->polyhedra;
    for (int i = 0; i < m->nown; i++) {
        c->inverse_volume[i] = 1 / m->volume[i];
        double half = 0.5 * c->inverse_volume[i];
        for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
            int face = m->face_of_cell[j] < 0 ? ~m->face_of_cell[j] : m->face_of_cell[j];
            c->total_girth[i] += half * m->face.area[face];
            for (int k = 0; k < m->dim; k++)
                c->girth[k][i] += half * m->face.area[face] * fabs(m->face.normal[k][face]);
        }
    }
}

/* At walls that drag the gas or hold its T a mirror image is a first-order error: p has no slope there, so rho has that
 * of 1/T; and a moving wall carries gas along. The stencils of quadratics are large enough without the mirrors of such
 * walls, so these are left out of the fit. */
static status make_fit(struct gas *g) {
    struct cells *c = g->cells;
    const struct polyhedra *m = c->polyhedra;
    bool *unknown;
    if (!g->models.transport || g->models.polynomial->degree < 2)
        return fit_make(m, g->models.polynomial, g->components, NULL, &c->fit);
    TRY(allocate(&unknown, m->mirror.n, sizeof *unknown, "mirrors"));
    for (int i = 0; i < m->mirror.n; i++) {
        const struct patch_rules *r = &g->patches.rules[m->mirror.patch[i]];
        unknown[i] = wall_drags(r) || wall_conducts(r);
    }
    const status s = fit_make(m, g->models.polynomial, g->components, unknown, &c->fit);
    free(unknown);
    return s;
}

static status cells_make(struct gas *g) {
    struct cells *c;
    TRY(allocate(&c, 1, sizeof *c, "the gas"));
    g->cells = c;
    c->polyhedra = g->blocks.grid->polyhedra;
    for (int f = 0; f < c->polyhedra->face.n; f++)
        if (c->polyhedra->face.point_start[f + 1] - c->polyhedra->face.point_start[f] > BATCH)
            return fail(ERR_INPUT, "a face has too many corners for %d quadrature points", BATCH);
    TRY(make_lines(g));
    measure_cells(c);
    TRY(make_fit(g));
    fit_keep(c->fit, g->limits.least, g->limits.most);
    TRY(cells_sweep_make(c->polyhedra, g->models.stepper->local ? NULL : c->fit, &c->sweep));
    TRY(cells_sides_make(c->polyhedra, &c->sides));
    TRY(cells_rules_make(g));
    TRY(cells_weight_make(g));
    TRY(cells_round_make(g));
    TRY(cells_fronts_make(g));
    TRY(cells_local_make(g));
    TRY(cells_still_make(g));
    if (g->models.transport || needs_shear_rate(&g->models) || g->models.ncarried)
        TRY(cells_gradient_weights(g, &c->gradient));
    if (needs_shear_rate(&g->models)) TRY(cells_shear_rate_make(g));
    if (g->models.ncarried) TRY(cells_carried_make(g));
    if (g->dense) TRY(comm_agree(g->comm, cells_bed_make(g)));
    return g->models.transport ? cells_diffuser_make(g) : OK;
}

static void cells_free(struct gas *g) {
    struct cells *c = g->cells;
    struct state *states[] = {&g->U, &g->U0, &g->V, &g->W};
    for (int i = 0; i < 4; i++) {
        if (states[i]->block) free(states[i]->block[0]);
        free(states[i]->block);
    }
    if (!c) return;
    fit_free(c->fit);
    cells_sweep_free(&c->sweep);
    cells_sides_free(&c->sides);
    cells_diffuser_free(c->diffuser);
    cells_shear_rate_free(c->shear_rate);
    cells_carried_free(c->carried);
    entries_free(&c->gradient);
    cells_weight_free(c->weight);
    cells_round_free(c->round);
    cells_rest_free(c->rest);
    cells_rules_free(c->rules);
    cells_fronts_free(c->fronts);
    cells_local_free(c->local);
    cells_still_free(c->still);
    free(c->flux[0]);
    for (int k = 0; k < MAX_DIM; k++) free(c->girth[k]);
    free(c->inverse_volume);
    free(c->total_girth);
    free(c->line);
    free(c);
}

static void cells_of_block(const struct gas *g, int block, const struct state *s, struct block_cells *out) {
    const struct polyhedra *m = g->cells->polyhedra;
    const int start = m->block_start[block];
    (void)s;
    *out = (struct block_cells){
        .n = {m->block_start[block + 1] - start, 1, 1}, .step = {1, 1, 1}, .at = m->block_cell + start};
}

static void cells_rows(const struct gas *g, enum extent extent, const struct state *s, row_visitor *visit,
                       void *context) {
    const int end = extent == NEAR_CELLS ? g->cells->polyhedra->size : g->cells->polyhedra->nown;
    (void)s; /* every cell has a state of its own */
    for (int at = 0; at < end; at += BATCH) visit(context, &(struct row){0, at, end - at < BATCH ? end - at : BATCH});
}

static void cells_fill(const struct gas *g, int layers, int n, double *const *block) {
    double *line[MAX_VAR];
    (void)layers;
    for (int v = 0; v < n; v++) line[v] = block[0] + v * g->size;
    polyhedra_fill_start(g->cells->polyhedra, n, line);
    polyhedra_fill_finish(g->cells->polyhedra);
}

static void cells_place(const struct gas *g, int block, long at, double place[3]) {
    (void)block;
    memcpy(place, g->cells->polyhedra->middle[at], 3 * sizeof *place);
}

void cells_primitives(const struct gas *g, int n, const double *U, struct cells_primitives *q) {
    double *velocity[MAX_DIM] = {q->velocity[0], q->velocity[1], q->velocity[2]};
    velocity_row(n, g->components, g->size, U, velocity, q->eps);
    g->models.eos->state(&g->models.material, n, U, q->eps, q->p, q->c, q->gruneisen);
    root_row(n, q->c);
}

/* rate = sum_k |u_k| girth_k + c total_girth, which is no less than the sum over the faces of (|u_n| + c) A / (2 V),
 * and on boxes the rate of the lattice; fast = |u| + c, with all components of u, as a mesh with these axes has it */
KERNEL static void rate_line(int n, int dim, int components, const struct cells_primitives *q,
                             double *const girth[MAX_DIM], const double *restrict total, double *restrict rate,
                             double *restrict fast) {
    for (int i = 0; i < n; i++) {
        rate[i] = q->c[i] * total[i];
        fast[i] = 0;
    }
    for (int k = 0; k < dim; k++) {
        const double *restrict u = q->velocity[k], *restrict w = girth[k];
        for (int i = 0; i < n; i++) {
            rate[i] = fma(fabs(u[i]), w[i], rate[i]);
            fast[i] = fma(u[i], u[i], fast[i]);
        }
    }
    for (int k = dim; k < components; k++)
        for (int i = 0; i < n; i++) fast[i] = fma(q->velocity[k][i], q->velocity[k][i], fast[i]);
    for (int i = 0; i < n; i++) fast[i] = sqrt(fast[i]) + q->c[i];
}

static void rate_batch(const struct gas *g, const struct state *s, int from, int n, struct cells_primitives *q,
                       double *rate, double *fast) {
    const struct cells *c = g->cells;
    double *girth[MAX_DIM];
    for (int k = 0; k < g->dim; k++) girth[k] = c->girth[k] + from;
    cells_primitives(g, n, s->block[0] + from, q);
    rate_line(n, g->dim, g->components, q, girth, c->total_girth + from, rate, fast);
}

void cells_rates(const struct gas *g, const struct state *s, int from, int n, double *rate, double *fast) {
    struct cells_primitives q;
    rate_batch(g, s, from, n, &q, rate, fast);
}

static void cells_speed(struct gas *g, struct gas_speed *speed) {
    const struct polyhedra *m = g->cells->polyhedra;
    double most[4] = {0, 0, 0, 0}, least = HUGE_VAL, rate[BATCH], fast[BATCH]; /* rate, loose, speed, pressure */
    struct cells_primitives q;
    for (int from = 0; from < m->nown; from += BATCH) {
        int n = m->nown - from < BATCH ? m->nown - from : BATCH;
        const double *rho = g->U.block[0] + from;
        rate_batch(g, &g->U, from, n, &q, rate, fast);
        for (int i = 0; i < n; i++) {
            most[0] = larger(most[0], rate[i]);
            most[1] = larger(most[1], rho[i] < PACKED * g->limits.most ? rate[i] : 0);
            most[2] = larger(most[2], fast[i]);
            most[3] = larger(most[3], q.p[i]);
            least = smaller(least, q.p[i]);
        }
    }
    *speed = (struct gas_speed){
        .rate = most[0], .loose = most[1], .axis = {most[2], most[2], most[2]}, .low = least, .high = most[3]};
    if (g->cells->local) cells_local_longest(g, speed);
}

/* flow = sum_k |u_k| girth_k, thin = flow + c total_girth */
static void cells_speeds(struct gas *g, const struct state *s, const struct row *row, struct row_speeds *out) {
    const struct cells *c = g->cells;
    double fast[BATCH];
    struct cells_primitives q;
    rate_batch(g, s, (int)row->at, row->n, &q, out->rate, fast);
    for (int i = 0; i < row->n; i++) {
        const long at = row->at + i;
        out->eps[i] = q.eps[i];
        out->p[i] = q.p[i];
        out->flow[i] = 0;
        for (int k = 0; k < g->dim; k++) out->flow[i] += fabs(q.velocity[k][i]) * c->girth[k][at];
        out->thin[i] = out->flow[i] + q.c[i] * c->total_girth[at];
    }
}

static bool cells_sides(const struct gas *g, const struct row *row, int k, struct sides *out) {
    const struct polyhedra *m = g->cells->polyhedra;
    bool any = false;
    out->line = false;
    for (int i = 0; i < row->n; i++) {
        const int cell = (int)row->at + i, entry = m->face_start[cell] + k;
        const bool has = entry < m->face_start[cell + 1];
        const int face = has ? m->face_of_cell[entry] : NO_SIDE;
        const int edge = face < m->face.ninternal ? -1 : face - m->face.ninternal; /* there cells are on the left */
        out->across[i] = has ? cells_across(m, entry) : cell;
        out->face[i] = face;
        out->edge[i] = edge;
        if (edge >= 0) out->patch[i] = (struct patch_face){m->face.patch[edge], m->face.place[edge]};
        any |= has;
    }
    return any;
}

const struct engine engine_polyhedral = {
    .state = {.make = cells_make,
              .free = cells_free,
              .cells = cells_of_block,
              .rest = cells_rest,
              .rows = cells_rows,
              .fill = cells_fill,
              .place = cells_place,
              .sides = cells_sides,
              .edges = cells_edges,
              .ghosts = cells_near_ghosts,
              .speed = cells_speed,
              .speeds = cells_speeds,
              .shear_rate = cells_shear_rate},
    .stage = {.fronts = cells_fronts, .stage = cells_stage, .local = cells_local, .redo = cells_redo},
    .diffusion = {.most_stages = {0, CELLS_STAGES, CELLS_STAGES, CELLS_STAGES_3D},
                  .cooled_first = true,
                  .rates = cells_diffusion_rates,
                  .begin = cells_diffusion_begin,
                  .stage = cells_diffusion_stage,
                  .end = cells_diffusion_end,
                  .cross = cells_diffusion_cross,
                  .spread = cells_diffusion_spread,
                  .weight = cells_implicit_weight},
    .bed = {.blocks = cells_bed_blocks, .balance = cells_bed_balance},
    .tally = {.rest = cells_tally_rest},
    .carried = {.rise = cells_carried_rise,
                .terms = cells_carried_terms,
                .most_out = cells_carried_most_out,
                .move = cells_carried_move}};
