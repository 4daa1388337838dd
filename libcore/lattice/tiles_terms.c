/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the transport law asks for on a lattice besides stress and conduction: the heat flux -cross grad rho, and the
 * heat that goes with div u (libcore/models/transport.h). */
#include "libcore/lattice/tiles_diffuser.h"

struct term { /* context of the visitors of rows */
    const struct gas *g;
    const struct state *to;
    double dt;
};

KERNEL static void cross_row(int n, int dim, const long *stride, long size, double dt, const double *restrict face,
                             double *restrict E) {
    for (int i = 0; i < n; i++) {
        double sum = 0;
        for (int axis = 0; axis < dim; axis++) {
            const double here = face[axis * size + stride[axis] + i] - face[axis * size + i];
            sum = axis ? sum + here : here;
        }
        E[i] += dt * sum;
    }
}

static void cross_visit(void *term, const struct row *row) {
    const struct term *t = term;
    const struct forest *f = t->g->forest;
    const double *turn = turn_line(t->g, row->block, LEAN);
    double *E = t->to->block[row->block] + energy_at(t->g) * f->size + row->at, gain[BATCH];
    if (turn) {
        turn_cross(t->g, row->n, turn + row->at, t->g->tiles->diffuser->cross[row->block] + row->at, gain);
        for (int i = 0; i < row->n; i++) E[i] += t->dt * gain[i];
        return;
    }
    cross_row(row->n, f->dim, f->stride, f->size, t->dt, t->g->tiles->diffuser->cross[row->block] + row->at, E);
}

void tiles_diffusion_cross(struct gas *g, const struct state *to, double dt) {
    g->engine->state.rows(g, EVERY_CELL, to, cross_visit, &(struct term){g, to, dt});
    if (g->books.tally) tiles_tally_cross(g, dt);
}

/* Adds half of div u to `spread` in a row of cells, at whose first cell U stands. A central difference has the mean of
 * both cells on each face; along the radius of a body of revolution it is that of half_divergence. */
KERNEL static void add_half_spread(int n, const struct forest *f, const double *restrict U, const double *restrict lean,
                                   double *restrict spread) {
    double sum[BATCH] = {0};
    for (int axis = 0; axis < f->dim; axis++) {
        const double quarter = 0.25 / f->width[axis], *restrict m = U + (axis + 1) * f->size;
        const long step = f->stride[axis];
        for (int i = 0; i < n && axis != f->radial; i++)
            sum[i] += quarter * (m[i + step] / U[i + step] - m[i - step] / U[i - step]);
        for (int i = 0; i < n && axis == f->radial; i++)
            sum[i] += quarter * ((1 + 2 * lean[i]) * (m[i + step] / U[i + step]) -
                                 (1 - 2 * lean[i]) * (m[i - step] / U[i - step]));
    }
    for (int i = 0; i < n; i++) spread[i] += sum[i];
}

void tiles_diffusion_spread(const struct gas *g, const struct state *from, const struct state *to,
                            const struct row *row, double *spread) {
    const struct forest *f = g->forest;
    const struct state *both[] = {from, to};
    memset(spread, 0, (size_t)row->n * sizeof *spread);
    const double *turn = turn_line(g, row->block, LEAN);
    for (int i = 0; i < 2; i++)
        add_half_spread(row->n, f, both[i]->block[row->block] + row->at, turn ? turn + row->at : NULL, spread);
}

void tiles_near_ghosts(struct gas *g, const struct state *s) {
    forest_fill_layers(g->forest, 1, g->nvar, s->block);
    for (int t = 0; t < g->forest->ntiles; t++) ghosts_of_patches(g, t, s->block[t], GHOSTS, NULL);
}
