/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shear rate of the cells of polyhedra, for laws that ask for it, by the gradients of diffusion
 * (libcore/polyhedral/cells_gradient.c). */
#include "libcore/gas/patch.h"
#include "libcore/polyhedral/cells_gradient.h"

#include <stdlib.h>

struct cells_shear_rate { /* lines of [size], a batch longer */
    double *velocity[MAX_DIM];
    double *gradient[MAX_DIM * MAX_DIM]; /* du_c/dx_k at k components + c */
};

status cells_shear_rate_make(struct gas *g) {
    const long size = g->cells->polyhedra->size + LANES;
    struct cells_shear_rate *x;
    TRY(allocate(&x, 1, sizeof *x, "the shear rate"));
    g->cells->shear_rate = x;
    for (int c = 0; c < g->components; c++) TRY(allocate(&x->velocity[c], size, sizeof(double), "the shear rate"));
    for (int i = 0; i < g->dim * g->components; i++)
        TRY(allocate(&x->gradient[i], size, sizeof(double), "the shear rate"));
    return OK;
}

void cells_shear_rate_free(struct cells_shear_rate *x) {
    if (!x) return;
    for (int c = 0; c < MAX_DIM; c++) free(x->velocity[c]);
    for (int i = 0; i < MAX_DIM * MAX_DIM; i++) free(x->gradient[i]);
    free(x);
}

static void find_velocities(struct gas *g, const struct state *s) {
    struct polyhedra *m = g->cells->polyhedra;
    double *const *line = g->cells->shear_rate->velocity, *U[MAX_VAR], eps[BATCH];
    cells_lines(g, s, U);
    polyhedra_fill_start(m, g->nvar, U);
    polyhedra_fill_finish(m);
    cells_mirrors(g, 0, m->mirror.n, U);
    for (int at = 0; at < m->size; at += BATCH) {
        double *u[MAX_DIM] = {NULL};
        for (int c = 0; c < g->components; c++) u[c] = line[c] + at;
        velocity_row(m->size - at < BATCH ? m->size - at : BATCH, g->components, m->size, U[0] + at, u, eps);
    }
}

/* Finds the weight of a mirror in the gradient of its cell. */
static void weight_of(const struct gas *g, int mirror, double out[MAX_DIM]) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct entries *r = &g->cells->gradient;
    const int cell = m->mirror.cell[mirror], lane = cell % LANES;
    for (int k = 0; k < g->dim; k++) out[k] = 0;
    for (long j = r->start[cell / LANES]; j < r->start[cell / LANES + 1]; j++)
        for (int k = 0; k < g->dim && r->cell[j * LANES + lane] == m->ncells + mirror; k++)
            out[k] += r->data[(j * r->width + k) * LANES + lane];
}

/* The drag of a wall that gas slips along follows from the coefficients, which the shear rate is for: u along it goes
 * on with the slope inside. A mirror image has u itself. With s more of u there the gradient G of the cell is G + W s,
 * W being the weight of the mirror at the distance o, and s = o.(G + W s). */
static void slide_along(struct gas *g, int mirror) {
    const struct polyhedra *m = g->cells->polyhedra;
    double *const *gradient = g->cells->shear_rate->gradient, W[MAX_DIM], s[MAX_DIM], own = 1, across = 0;
    const int cell = m->mirror.cell[mirror], lines = g->components;
    double arm[MAX_DIM];
    weight_of(g, mirror, W);
    for (int k = 0; k < g->dim; k++) {
        arm[k] = m->centre[k][m->ncells + mirror] - m->centre[k][cell];
        own -= arm[k] * W[k];
    }
    for (int c = 0; c < lines; c++) {
        s[c] = 0;
        for (int k = 0; k < g->dim; k++) s[c] += arm[k] * gradient[k * lines + c][cell];
        s[c] /= larger(own, 0.1); /* 1/2 on boxes, 1/4 on tetrahedra */
    }
    for (int k = 0; k < g->dim; k++) across += s[k] * m->mirror.normal[k][mirror];
    for (int k = 0; k < g->dim; k++) s[k] -= across * m->mirror.normal[k][mirror];
    for (int k = 0; k < g->dim; k++)
        for (int c = 0; c < lines; c++) gradient[k * lines + c][cell] += W[k] * s[c];
}

/* Sets u_r/r of n cells from `at` on, and takes u_s/r from the slope of the swirl along the radius. Returns NULL if the
 * mesh is none of a body of revolution. */
static const double *turn_of(const struct gas *g, int at, int n, double *around) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct cells_shear_rate *x = g->cells->shear_rate;
    const int radial = m->round.radial, swirl = g->models.swirl;
    for (int i = at; i < at + n && radial >= 0; i++) {
        const double r = m->centre[radial][i] - m->round.at;
        around[i - at] = x->velocity[radial][i] / r;
        if (swirl) x->gradient[radial * g->components + swirl][i] -= x->velocity[swirl][i] / r;
    }
    return radial >= 0 ? around : NULL;
}

void cells_shear_rate(struct gas *g, const struct state *s) {
    struct polyhedra *m = g->cells->polyhedra;
    struct cells_shear_rate *x = g->cells->shear_rate;
    double *rate = g->diffusion.shear_rate.now[0];
    find_velocities(g, s);
    cells_gradients(g->dim, &g->cells->gradient, g->components, 0, m->nown, x->velocity, x->gradient);
    for (int i = 0; i < m->face.n - m->face.ninternal && g->models.transport; i++)
        if (wall_slides(&g->patches.rules[m->mirror.patch[i]])) slide_along(g, i);
    for (int at = 0; at < m->nown; at += BATCH) {
        const double *gradient[MAX_DIM * MAX_DIM] = {NULL};
        const int n = m->nown - at < BATCH ? m->nown - at : BATCH;
        double around[BATCH];
        for (int i = 0; i < g->dim * g->components; i++) gradient[i] = x->gradient[i] + at;
        shear_rate_row(g, n, gradient, turn_of(g, at, n, around), rate + at);
    }
    polyhedra_fill_start(m, 1, &rate);
    polyhedra_fill_finish(m);
    for (int i = 0; i < m->mirror.n; i++) rate[m->ncells + i] = rate[m->mirror.cell[i]];
}
