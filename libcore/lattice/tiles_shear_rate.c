/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shear rate of the cells of a lattice, for laws that ask for it: central differences. */
#include "libcore/lattice/tiles_diffuser.h"

struct velocities { /* context of velocity_visit */
    const struct gas *g;
    const double *U;
};

static void velocity_visit(void *context, long offset, int n) {
    const struct velocities *v = context;
    velocities_of_row(v->g, v->U, offset, n);
}

/* Beyond a wall that holds the gas u is 2 w - u. The drag of a wall that gas slips along follows from the coefficients,
 * which the shear rate is for: u along it goes on with the slope inside. Other walls are mirrors. */
static void velocity_edge(struct gas *g, int tile, const struct edge *e, const void *context) {
    const bool holds = wall_holds(e->rules);
    const long out = e->to - e->from;
    double w[MAX_DIM];
    (void)tile, (void)context;
    if (!g->models.transport || !wall_drags(e->rules)) return;
    for (int i = 0; i < e->n; i++) {
        const long at = e->from + i * e->step;
        wall_velocity(e->rules, g->components, e->face[i], w);
        for (int k = 0; k < g->components; k++) {
            double *u = g->tiles->work.velocity[k] + at;
            if (holds)
                u[out] = 2 * w[k] - u[0];
            else if (k != e->normal)
                u[out] = 2 * u[0] - u[-out];
        }
    }
}

/* Sets u_r/r of n cells, and takes u_s/r from the slope of the swirl along the radius. Returns NULL if the mesh is none
 * of a body of revolution. */
static const double *turn_slopes(const struct gas *g, int tile, long at, int n, double (*slope)[BATCH],
                                 double *around) {
    const int radial = g->forest->radial, swirl = g->models.swirl;
    double room[BATCH];
    const double *r = row_radius(g, tile, at, n, room), *u = g->tiles->work.velocity[swirl] + at;
    for (int i = 0; i < n && r; i++) around[i] = g->tiles->work.velocity[radial][at + i] / r[i];
    for (int i = 0; i < n && r && swirl; i++) slope[radial * g->components + swirl][i] -= u[i] / r[i];
    return r ? around : NULL;
}

static void tile_shear_rate(struct gas *g, int tile, double *out) {
    const struct forest *f = g->forest;
    const int *n = f->tile[tile].n, m = g->components;
    double slope[MAX_DIM * MAX_DIM][BATCH], around[BATCH];
    const double *gradient[MAX_DIM * MAX_DIM];
    for (int i = 0; i < MAX_DIM * MAX_DIM; i++) gradient[i] = slope[i];
    for (int row = 0; row < n[1] * n[2]; row++) {
        const long at = f->first + row % n[1] * f->stride[1] + row / n[1] * f->stride[2];
        for (int line = 0; line < g->dim * m; line++) {
            const double *u = g->tiles->work.velocity[line % m] + at, quarter = 0.25 / f->width[line / m];
            for (int i = 0; i < n[0]; i++) slope[line][i] = 2 * half_derivative(u + i, f->stride[line / m], quarter);
        }
        shear_rate_row(g, n[0], gradient, turn_slopes(g, tile, at, n[0], slope, around), out + at);
    }
}

static void rate_edge(struct gas *g, int tile, const struct edge *e, const void *context) {
    double *rate = g->diffusion.shear_rate.now[tile];
    (void)context;
    for (int i = 0; i < e->n; i++) rate[e->to + i * e->step] = rate[e->from + i * e->step];
}

void tiles_shear_rate(struct gas *g, const struct state *s) {
    const struct forest *f = g->forest;
    forest_fill_layers(g->forest, 1, g->nvar, s->block);
    for (int t = 0; t < f->ntiles; t++) {
        ghosts_of_patches(g, t, s->block[t], 1, NULL);
        runs_visit(f, &f->tile[t], 1, velocity_visit, &(struct velocities){g, s->block[t]});
        edges_visit(g, t, velocity_edge, NULL);
        tile_shear_rate(g, t, g->diffusion.shear_rate.now[t]);
    }
    forest_fill_layers(g->forest, 1, 1, g->diffusion.shear_rate.now);
    for (int t = 0; t < f->ntiles; t++) edges_visit(g, t, rate_edge, NULL);
}
