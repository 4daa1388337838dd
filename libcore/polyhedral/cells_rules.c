/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the faces of polyhedra that follow a rule of their own (libcore/schemes/flux_private.h; docs/physics.md 6.12).
 * The sensors see the averages of both cells of a face and of the cells across their faces. Faces of patches follow no
 * rule. */
#include "libcore/polyhedral/cells.h"
#include "libcore/schemes/flux_rules.h"
#include "libcore/schemes/polynomial_fit.h"

#include <stdlib.h>

/* Where g changes DENSER times in four cells in a row, two of them differ by the cube root of that. */
static const double DENSER_ROOT = 1.2599;

struct cells_rules {
    struct wanted_rules on;
    double *p, *c, *g;    /* [size] of the averages */
    int *start, *beside;  /* [nnear + 1] into beside: the first rings of the stencils, close together in memory */
    unsigned char *rough; /* [nnear] 1: p or g differ across a face of the cell, so that its faces are looked at */
    struct entries slope; /* weights of the gradient of p; contacts only */
};

static status list_beside(const struct polyhedra *m, struct cells_rules *r) {
    int n = 0;
    TRY(allocate(&r->start, m->nnear + 1, sizeof *r->start, "rules of faces"));
    for (int i = 0; i < m->nnear; i++) {
        for (int at = m->stencil_start[i]; at < m->stencil_start[i + 1] && m->ring[at] == 1; at++) n++;
        r->start[i + 1] = n;
    }
    TRY(allocate(&r->beside, n, sizeof *r->beside, "rules of faces"));
    for (int i = 0; i < m->nnear; i++)
        for (int k = r->start[i]; k < r->start[i + 1]; k++)
            r->beside[k] = m->stencil[m->stencil_start[i] + k - r->start[i]];
    return OK;
}

status cells_rules_make(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct wanted_rules on = rules_of(g->models.flux, &g->models.flux_params, false, g->falling.cells != NULL);
    if (!(on.shocks || on.expansions || on.contacts)) return OK;
    TRY(allocate(&g->cells->rules, 1, sizeof *g->cells->rules, "rules of faces"));
    struct cells_rules *r = g->cells->rules;
    r->on = on;
    double **line[] = {&r->p, &r->c, &r->g};
    for (int i = 0; i < 3; i++) TRY(allocate(line[i], m->size, sizeof(double), "rules of faces"));
    TRY(allocate(&r->rough, m->nnear, sizeof *r->rough, "rules of faces"));
    TRY(list_beside(m, r));
    return on.contacts ? fit_gradients(g->cells->fit, &r->slope) : OK;
}

void cells_rules_free(struct cells_rules *r) {
    if (!r) return;
    free(r->p);
    free(r->c);
    free(r->g);
    free(r->start);
    free(r->beside);
    free(r->rough);
    entries_free(&r->slope);
    free(r);
}

void cells_rules_note(const struct gas *g, int from, int to, const double *const *U) {
    const struct cells_rules *r = g->cells->rules;
    double velocity[MAX_DIM][BATCH], eps[BATCH];
    double *u[MAX_DIM] = {velocity[0], velocity[1], velocity[2]};
    for (int at = from, n; at < to; at += n) {
        n = to - at < BATCH ? to - at : BATCH;
        velocity_row(n, g->components, g->size, U[0] + at, u, eps);
        g->models.eos->state(&g->models.material, n, U[0] + at, eps, r->p + at, r->c + at, r->g + at);
        root_row(n, r->c + at);
    }
}

void cells_rules_look(const struct gas *g, int from, int to) {
    const struct cells_rules *r = g->cells->rules;
    const double *restrict p = r->p, *restrict gruneisen = r->g;
    for (int i = from; i < to; i++) {
        int rough = 0;
        for (int k = r->start[i]; k < r->start[i + 1]; k++) {
            const int j = r->beside[k];
            rough |= exceeds(STEEP, p[i], p[j]) | exceeds(DENSER_ROOT, gruneisen[i], gruneisen[j]);
        }
        r->rough[i] = (unsigned char)rough;
    }
}

struct window { /* of the cells around a face: extremes of p, with their cells, and of g */
    int low, high;
    double least, most;
};
static void widen(const struct cells_rules *r, int cell, struct window *w) {
    if (r->p[cell] < r->p[w->low]) w->low = cell;
    if (r->p[cell] > r->p[w->high]) w->high = cell;
    w->least = smaller(w->least, r->g[cell]);
    w->most = larger(w->most, r->g[cell]);
}
/* The window of two cells and of the members of their stencils in the first rings. */
static struct window window_of(const struct gas *g, int left, int right, int rings) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct cells_rules *r = g->cells->rules;
    struct window w = {left, left, r->g[left], r->g[left]};
    const int sides[2] = {left, right};
    for (int k = 0; k < 2; k++) {
        const int i = sides[k];
        widen(r, i, &w);
        for (int at = m->stencil_start[i]; at < m->stencil_start[i + 1] && m->ring[at] <= rings; at++)
            widen(r, m->stencil[at], &w);
    }
    return w;
}

double cells_parting(const struct gas *g, int face, const double *const *U) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const int l = f->left[face], r = f->right[face];
    double speed = 0;
    for (int k = 0; k < g->dim; k++) speed += f->normal[k][face] * (U[k + 1][r] / U[0][r] - U[k + 1][l] / U[0][l]);
    return speed;
}

/* Two rings, where the stencils have them, hold a shock that lies within a few cells, wherever the face stands in it.
 */
static bool is_shock(const struct gas *g, int left, int right, const double *const *U) {
    const struct cells_rules *r = g->cells->rules;
    const struct window w = window_of(g, left, right, 2);
    double square = 0;
    for (int k = 0; k < g->components; k++) {
        const double du = U[k + 1][w.high] / U[0][w.high] - U[k + 1][w.low] / U[0][w.low];
        square += du * du;
    }
    return near_hugoniot(square, U[0][w.high], U[0][w.low], r->p[w.high], r->p[w.low]);
}

static bool is_contact(const struct gas *g, int left, int right) {
    const struct window w = window_of(g, left, right, 1);
    return !exceeds(STEEP, g->cells->rules->p[w.high], g->cells->rules->p[w.low]) && w.most > DENSER * w.least;
}

static bool is_expansion(const struct gas *g, int face, double speed, const double *rho) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const struct cells_rules *r = g->cells->rules;
    const int left = f->left[face], right = f->right[face];
    const double impedance[2] = {rho[left] * r->c[left], rho[right] * r->c[right]};
    return expands(speed, r->c[left], r->c[right], impedance, r->p[left], r->p[right]);
}

static enum face_rule rule_of(const struct gas *g, int face, const double *const *U) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const struct wanted_rules *on = &g->cells->rules->on;
    const int left = f->left[face], right = f->right[face];
    const double speed = cells_parting(g, face, U);
    if (on->shocks && speed < 0 && is_shock(g, left, right, U)) return SHOCK_RULE;
    if (on->expansions && is_expansion(g, face, speed, U[0])) return EXPANSION_RULE;
    return on->contacts && is_contact(g, left, right) ? CONTACT_RULE : NO_RULE;
}

bool cells_rules_find(const struct gas *g, int n, const int *face, const double *const *U, unsigned char *rule) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const unsigned char *rough = g->cells->rules->rough;
    int any = 0;
    for (int i = 0; i < n; i++) any |= rough[f->left[face[i]]] | rough[f->right[face[i]]];
    if (!any) return false;
    for (int i = any = 0; i < n; i++) {
        const bool look = rough[f->left[face[i]]] || rough[f->right[face[i]]], same = i > 0 && face[i] == face[i - 1];
        rule[i] = same ? rule[i - 1] : (unsigned char)(look ? rule_of(g, face[i], U) : NO_RULE);
        any |= rule[i] != NO_RULE;
    }
    return any;
}

/* Returns the value of p that the averages around a cell give at a point, no further away than they are. */
static double pressure_at(const struct gas *g, int cell, const double arm[MAX_DIM], double share) {
    const struct cells_rules *r = g->cells->rules;
    const struct entries *slope = &r->slope;
    const int batch = cell / LANES, lane = cell % LANES, dim = g->dim;
    double change = 0, low = 0, high = 0;
    for (int j = slope->start[batch]; j < slope->start[batch + 1]; j++) {
        const double d = r->p[slope->cell[(long)j * LANES + lane]] - r->p[cell];
        low = smaller(low, d);
        high = larger(high, d);
        for (int k = 0; k < dim; k++) change += slope->data[((long)j * dim + k) * LANES + lane] * arm[k] * d;
    }
    return r->p[cell] + share * larger(smaller(change, high), low);
}

void cells_rules_pressures(const struct gas *g, int side, int from, int n, const int *face, double *p) {
    const struct polyhedra *m = g->cells->polyhedra;
    double rest[BATCH], near = 0, here = 0;
    if (!g->cells->rules->on.contacts) return;
    if (g->cells->rest) cells_rest_pressures(g, from, n, rest);
    for (int i = 0; i < n; i++) {
        const int cell = side ? m->face.right[face[i]] : m->face.left[face[i]];
        double arm[MAX_DIM];
        for (int k = 0; k < g->dim; k++) arm[k] = m->point.arm[side][k][from + i];
        if (g->cells->rest) near = cells_rest_near(g, cell, &here);
        p[i] = pressure_at(g, cell, arm, 1 - near);
        if (near > 0) p[i] += near * (rest[i] - here);
    }
}
