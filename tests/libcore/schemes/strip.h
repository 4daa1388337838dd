/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cells in a row, as the fluxes see them: for tests of fluxes. */
#ifndef TESTS_LIBCORE_SCHEMES_STRIP_H
#define TESTS_LIBCORE_SCHEMES_STRIP_H

#include "libcore/schemes/flux.h"
#include "tests/defaults.h"

enum { CELLS = 12 };

static const struct material granular = {
    .diameter = 0.1, .mass = 1, .restitution = 0.97, .gamma = 5. / 3, .alpha_max = 0.65};

struct strip { /* cells in a row, as the fluxes see them */
    int dim;
    double U[MAX_VAR][CELLS], F[MAX_VAR][CELLS], u[MAX_DIM][CELLS], eps[CELLS], p[CELLS], c[CELLS], g[CELLS];
    double out[MAX_VAR][CELLS];
    double fastest;
    double gravity;            /* times the cells' width; 0: no pressure of gas at rest is taken */
    bool falls;                /* does the gas feel gravity? */
    const double *floor;       /* [n] of the faces whose flux is computed, or NULL */
    const unsigned char *rule; /* likewise */
};

static inline void close_strip(struct strip *s) { /* from rho, u, eps */
    eos_find("GoldshteinShapiro")->state(&granular, CELLS, s->U[0], s->eps, s->p, s->c, s->g);
    s->fastest = 0;
    for (int i = 0; i < CELLS; i++) {
        double kinetic = 0, rho = s->U[0][i], un = s->u[0][i];
        s->c[i] = sqrt(s->c[i]);
        for (int k = 0; k < s->dim; k++) {
            kinetic += 0.5 * s->u[k][i] * s->u[k][i];
            s->U[k + 1][i] = rho * s->u[k][i];
        }
        s->U[s->dim + 1][i] = rho * (s->eps[i] + kinetic);
        for (int v = 0; v < s->dim + 2; v++) s->F[v][i] = s->U[v][i] * un;
        s->F[1][i] += s->p[i];
        s->F[s->dim + 1][i] += s->p[i] * un;
        s->fastest = larger(s->fastest, fabs(un) + s->c[i]);
    }
}

struct lifts { /* what a lattice takes at the faces behind the cells (libcore/lattice/tiles_balance.c) */
    double base[2][CELLS], rise[CELLS], on[CELLS], P[CELLS];
};

static inline void lift(const struct strip *s, int first, struct lifts *l, struct faces *f) {
    for (int i = 0; i + 1 < CELLS; i++) {
        const double low = 0.5 * s->gravity * s->U[0][i], high = 0.5 * s->gravity * s->U[0][i + 1];
        l->P[i] = 0.5 * ((s->p[i] + low) + (s->p[i + 1] - high));
        l->base[0][i] = l->P[i] - low;
        l->base[1][i] = l->P[i] + high;
        l->rise[i] = low + high;
        l->on[i] = 1;
    }
    for (int side = 0; side < 2; side++) f->base[side] = l->base[side] + first;
    f->rise = l->rise + first;
    f->on = l->on + first;
    f->rest = l->P + first;
}

static inline void flux_of_grains(struct strip *s, const struct material *m, const struct flux *flux,
                                  const struct reconstruct *r, int first, int n, const struct own_params *params) {
    double pace[CELLS];
    for (int i = 0; i < CELLS; i++) pace[i] = 0.7 / s->fastest; /* a Courant number of 0.7 */
    struct faces f = {.n = n,
                      .dim = s->dim,
                      .stride = 1,
                      .p = s->p + first,
                      .eps = s->eps + first,
                      .c = s->c + first,
                      .gruneisen = s->g + first,
                      .fastest = s->fastest,
                      .pace = pace,
                      .falls = s->falls,
                      .floor = s->floor,
                      .rule = s->rule,
                      .params = params};
    for (int v = 0; v < s->dim + 2; v++) {
        f.state[v] = s->U[v] + first;
        f.flux[v] = s->F[v] + first;
        f.out[v] = s->out[v];
    }
    for (int k = 0; k < s->dim; k++) f.velocity[k] = s->u[k] + first;
    struct lifts l;
    if (s->gravity != 0) lift(s, first, &l, &f);
    if (s->gravity != 0)
        flux_undamped(flux, &f, eos_find("GoldshteinShapiro"), m, r);
    else
        flux->through(&f, eos_find("GoldshteinShapiro"), m, r);
    for (int i = 0; i < n && s->gravity != 0; i++) s->out[1][i] += l.P[first + i];
}

static inline void flux_with(struct strip *s, const struct flux *flux, const struct reconstruct *r, int first, int n,
                             const struct own_params *params) {
    flux_of_grains(s, &granular, flux, r, first, n, params);
}

static inline void flux_of(struct strip *s, const struct flux *flux, const struct reconstruct *r, int first, int n) {
    const struct own_params params = own_defaults(&flux->model);
    flux_with(s, flux, r, first, n, &params);
}

/* Gives all gas the speed w along the faces, on the second axis. */
static inline void move_along(struct strip *s, double w) {
    for (int i = 0; i < CELLS; i++) s->u[1][i] += w;
    close_strip(s);
}

/* Returns by how much n fluxes of `moved`, which is s with the speed w along the faces, differ from those of s as seen
 * by who moves along, over the largest flux of the energy of that motion. */
static inline double off_by_motion(const struct strip *s, const struct strip *moved, double w, int n) {
    const int E = s->dim + 1;
    double most = 0, size = 0;
    for (int i = 0; i < n; i++) {
        const double F0 = s->out[0][i], F2 = s->out[2][i];
        for (int v = 0; v <= E; v++) {
            const double gained = v == 2 ? w * F0 : v == E ? w * F2 + 0.5 * w * w * F0 : 0;
            const double unit = v == 0 ? w * w : v < E ? w : 1;
            most = larger(most, fabs(moved->out[v][i] - (s->out[v][i] + gained)) * unit);
        }
        size = larger(size, fabs(0.5 * w * w * F0));
    }
    return most / size;
}

#endif
