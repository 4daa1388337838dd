/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the fronts of shocks on polyhedra, once a step (docs/physics.md 6.12): the speed S of a cell is the largest
 * front_speed of its faces, and no less than S of the cells across them, as no face of triangles lies along a front. A
 * face gets the larger S of its two cells as the floor of struct faces. Faces of patches are no fronts. S is doubled:
 * with once front_speed, strong shocks keep three times the noise on triangles, with four times no less. */
#include "libcore/polyhedral/cells.h"
#include "libcore/schemes/flux_rules.h"

#include <stdlib.h>

struct cells_fronts {
    double *p, *c;         /* [size] of the averages */
    double *speed, *wider; /* [size] m/s: S of the cell's own faces, and with its neighbours'; 0 in mirrors */
    bool any;              /* is any S above 0? */
};

status cells_fronts_make(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    const bool wanted = rules_of(g->models.flux, &g->models.flux_params, false, false).fronts;
    struct cells_fronts *x;
    if (!wanted || g->dim < 2) return OK;
    TRY(allocate(&x, 1, sizeof *x, "fronts"));
    g->cells->fronts = x;
    double **line[] = {&x->p, &x->c, &x->speed, &x->wider};
    for (int i = 0; i < 4; i++) TRY(allocate(line[i], m->size, sizeof(double), "fronts"));
    return OK;
}

void cells_fronts_free(struct cells_fronts *x) {
    if (!x) return;
    free(x->p);
    free(x->c);
    free(x->speed);
    free(x->wider);
    free(x);
}

static void note(const struct gas *g, int from, int to, const double *U) {
    const struct cells_fronts *x = g->cells->fronts;
    struct cells_primitives q;
    for (int at = from, n; at < to; at += n) {
        n = to - at < BATCH ? to - at : BATCH;
        cells_primitives(g, n, U + at, &q);
        memcpy(x->p + at, q.p, (size_t)n * sizeof(double));
        memcpy(x->c + at, q.c, (size_t)n * sizeof(double));
    }
}

/* Gives both cells of each face the speed of that face. */
static void find(const struct gas *g, const double *const *U) {
    const struct cells_fronts *x = g->cells->fronts;
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    for (int face = 0; face < f->ninternal; face++) {
        const int l = f->left[face], r = f->right[face];
        if (!exceeds(FRONT, x->p[l], x->p[r])) continue;
        const double impedance[2] = {U[0][l] * x->c[l], U[0][r] * x->c[r]};
        const double S = 2 * front_speed(-cells_parting(g, face, U), x->c[l], x->c[r], impedance, x->p[l], x->p[r]);
        x->speed[l] = larger(x->speed[l], S);
        x->speed[r] = larger(x->speed[r], S);
    }
}

static void widen(const struct gas *g) {
    const struct cells_fronts *x = g->cells->fronts;
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    memcpy(x->wider, x->speed, (size_t)g->cells->polyhedra->size * sizeof(double));
    for (int face = 0; face < f->ninternal; face++) {
        const int l = f->left[face], r = f->right[face];
        x->wider[l] = larger(x->wider[l], x->speed[r]);
        x->wider[r] = larger(x->wider[r], x->speed[l]);
    }
}

static void fill(struct polyhedra *m, int nvar, double *const *line) {
    polyhedra_fill_start(m, nvar, line);
    polyhedra_fill_finish(m);
}

void cells_fronts(struct gas *g, const struct gas_speed *speed) {
    struct cells_fronts *x = g->cells->fronts;
    struct polyhedra *m = g->cells->polyhedra;
    double *line[MAX_VAR];
    if (!x) return;
    x->any = false;
    if (!exceeds(FRONT, speed->low, speed->high)) return;
    cells_lines(g, &g->U, line);
    fill(m, g->nvar, line);
    note(g, 0, m->ncells, line[0]);
    memset(x->speed, 0, (size_t)m->size * sizeof(double));
    find(g, (const double *const *)line);
    fill(m, 1, &x->speed);
    widen(g);
    fill(m, 1, &x->wider);
    for (int i = 0; i < m->ncells; i++) x->any |= x->wider[i] > 0;
}

bool cells_fronts_floor(const struct gas *g, int n, const int *face, double *floor) {
    const struct cells_fronts *x = g->cells->fronts;
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    bool any = false;
    if (!x || !x->any) return false;
    for (int i = 0; i < n; i++) {
        floor[i] = larger(x->wider[f->left[face[i]]], x->wider[f->right[face[i]]]);
        any |= floor[i] > 0;
    }
    return any;
}
