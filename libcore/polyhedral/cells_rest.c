/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The balance of pressure and weight on polyhedra, so that gas at rest stays so to round-off (docs/physics.md 7.4).
 *
 * On cells of any shape no formula says which averages are at rest. So the state U* that a case lays at rest says it.
 * Its own polynomials have two values at a point of a face; their mean is U*(x), one for both sides. Other states U are
 * reconstructed by their deviation,
 *     U(x) = w U*(x) + U_i - w U*_i + polynomial of (U - w U*),
 * with w = 1 where a cell i is near U* and 0 where it is far (Berberich, Chandrashekar & Klingenberg, Comput. Fluids
 * 219, 2021), and a cell gets the force w r, by which U* misses the balance:
 *     r = (sum over its faces of p(U*(x)) A n)/V - rho* g.
 * Both U*(x) and r differ from what they stand for by errors of the scheme, so that it is consistent with any w. At U*
 * both sides of a point are the same bits, no face moves mass, and the force is exactly 0. Limiters and weights see
 * deviations only; from the whole column they make the scheme unstable at U*. */
#include "libcore/polyhedral/cells.h"

#include <stdlib.h>

/* Relative distances of rho or p from U*, up to which w is 1, and from which on it is 0. */
static const double NEAR = 0.1, FAR = 0.2;

enum { KNOWN, VALUES, FORCES }; /* is U* known, or are its values at points, or then its forces, being found? */

struct cells_rest {
    double *U[2];              /* [size] rho* and E* */
    double *p;                 /* [nnear] p* */
    bool *rests;               /* [nnear] is the cell at rest in U*? */
    double *near;              /* [nnear] w of the state in hand */
    double *at[2];             /* [points] rho*(x) and E*(x) */
    double *force[MAX_DIM];    /* [nown] r, N/m^dim */
    double *missed;            /* [boundary faces] Pa, at walls: p of U* there above p* + rho* g.(x_f - x), else 0 */
    double *of_walls[MAX_DIM]; /* [nown] N/m^dim: the part of r that makes up for this */
    double *taken;             /* [nown] how much of r the last stage added; with fluxes through patches only */
    double *on_face;           /* [faces] mean of p(U*(x)) */
    int finds;                 /* KNOWN, or what is being found */
};

static status make(const struct gas *g, struct cells_rest **out) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct cells_rest *r;
    TRY(allocate(&r, 1, sizeof *r, "gas at rest"));
    *out = r;
    for (int i = 0; i < 2; i++) {
        TRY(allocate(&r->U[i], m->size, sizeof(double), "gas at rest"));
        TRY(allocate(&r->at[i], m->point.n, sizeof(double), "gas at rest"));
    }
    TRY(allocate(&r->p, m->nnear, sizeof(double), "gas at rest"));
    TRY(allocate(&r->on_face, m->face.n, sizeof(double), "gas at rest"));
    TRY(allocate(&r->near, m->nnear, sizeof(double), "gas at rest"));
    for (int k = 0; k < g->dim; k++) {
        TRY(allocate(&r->force[k], m->nown, sizeof(double), "gas at rest"));
        TRY(allocate(&r->of_walls[k], m->nown, sizeof(double), "gas at rest"));
    }
    TRY(allocate(&r->missed, m->face.n - m->face.ninternal, sizeof(double), "gas at rest"));
    TRY(allocate(&r->taken, m->nown, sizeof(double), "gas at rest"));
    return allocate(&r->rests, m->nnear, sizeof *r->rests, "gas at rest");
}

void cells_rest_free(struct cells_rest *r) {
    if (!r) return;
    for (int i = 0; i < 2; i++) {
        free(r->U[i]);
        free(r->at[i]);
    }
    for (int k = 0; k < MAX_DIM; k++) {
        free(r->force[k]);
        free(r->of_walls[k]);
    }
    free(r->p);
    free(r->on_face);
    free(r->missed);
    free(r->taken);
    free(r->near);
    free(r->rests);
    free(r);
}

void cells_rest_find(const struct gas *g, int from, int to, const double *const *U, const bool *due) {
    struct cells_rest *r = g->cells->rest;
    double velocity[MAX_DIM][BATCH], eps[BATCH], p[BATCH], c[BATCH], gruneisen[BATCH];
    double *u[MAX_DIM] = {velocity[0], velocity[1], velocity[2]};
    for (int at = from, n; at < to; at += n) {
        n = to - at < BATCH ? to - at : BATCH;
        velocity_row(n, g->components, g->size, U[0] + at, u, eps);
        g->models.eos->state(&g->models.material, n, U[0] + at, eps, p, c, gruneisen);
        if (r->finds == VALUES) memcpy(r->p + at, p, (size_t)n * sizeof *p);
        for (int i = 0; i < n; i++) {
            if (due && !due[at + i]) continue;
            const double rho = r->U[0][at + i], off = fabs(U[0][at + i] - rho) / rho;
            const double away = larger(off, fabs(p[i] - r->p[at + i]) / r->p[at + i]);
            const bool none = r->finds == VALUES || !r->rests[at + i];
            r->near[at + i] = none ? 0 : smaller(larger((FAR - away) / (FAR - NEAR), 0), 1);
        }
    }
}

void cells_rest_add(const struct gas *g, const int *point, int n, const int *cell, double (*at)[BATCH]) {
    const struct cells_rest *r = g->cells->rest;
    for (int v = 0; v < 2; v++) {
        double *q = at[v * energy_at(g)];
        for (int i = 0; i < n; i++) {
            const double w = r->near[cell[i]];
            q[i] = (q[i] - w * r->U[v][cell[i]]) + w * r->at[v][point[i]];
        }
    }
}

void cells_rest_note(const struct gas *g, int side, int from, int n, const int *face, double (*at)[BATCH]) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    struct cells_rest *r = g->cells->rest;
    for (int i = 0; i < n && r->finds == VALUES; i++) {
        const bool left = r->rests[f->left[face[i]]], right = side && r->rests[f->right[face[i]]];
        for (int v = 0; v < 2; v++) {
            const double here = at[v * energy_at(g)][i];
            double *q = &r->at[v][from + i];
            *q = side && left && right ? 0.5 * (*q + here) : side && left ? *q : here;
        }
    }
}

void cells_rest_pressures(const struct gas *g, int from, int n, double *out) {
    const struct cells_rest *r = g->cells->rest;
    double eps[BATCH], c[BATCH], gruneisen[BATCH];
    for (int i = 0; i < n; i++) eps[i] = r->at[1][from + i] / r->at[0][from + i];
    g->models.eos->state(&g->models.material, n, r->at[0] + from, eps, out, c, gruneisen);
}

double cells_rest_near(const struct gas *g, int cell, double *p) {
    *p = g->cells->rest->p[cell];
    return g->cells->rest->near[cell];
}

/* Is a cell one of the bed, whose stages are given up? */
static bool is_beds(const struct gas *g, int cell) {
    return g->step.hybrid && g->dense->part[0][cell] > 0;
}

void cells_rest_weigh(const struct gas *g, int at, int n, const double *falls, const double *flag,
                      double *const residual[MAX_VAR]) {
    const struct cells_rest *r = g->cells->rest;
    for (int k = 0; k < g->dim; k++)
        for (int i = 0; i < n; i++) {
            const bool out = (falls && falls[i] > 0) || (flag && flag[i] > 0);
            if (r->finds == FORCES) r->force[k][at + i] = -residual[k + 1][i];
            residual[k + 1][i] += out ? 0 : r->near[at + i] * r->force[k][at + i];
            if (g->books.tally) r->taken[at + i] = out || is_beds(g, at + i) ? 0 : r->near[at + i];
        }
}

void cells_rest_push(const struct gas *g, int at, int n, const double *share, double per,
                     double *const momentum[MAX_DIM]) {
    const struct cells_rest *r = g->cells->rest;
    for (int k = 0; k < g->dim; k++)
        for (int i = 0; i < n; i++) momentum[k][i] += share[i] * (r->near[at + i] * r->force[k][at + i]);
    for (int i = 0; i < n; i++) r->taken[at + i] += per * share[i] * r->near[at + i];
}

void cells_rest_forget(const struct gas *g) {
    memset(g->cells->rest->taken, 0, (size_t)g->cells->polyhedra->nown * sizeof(double));
}

double cells_rest_miss(const struct gas *g, int face, int cell, double fall) {
    const struct cells_rest *r = g->cells->rest;
    return r->near[cell] * (r->on_face[face] - (r->p[cell] + r->U[0][cell] * fall));
}

void cells_rest_added(const struct gas *g, int axis, double *out) {
    const struct cells_rest *r = g->cells->rest;
    for (int i = 0; i < g->cells->polyhedra->nown; i++)
        out[i] = r->taken[i] * (r->force[axis][i] - r->of_walls[axis][i]);
}

double cells_rest_of_wall(const struct gas *g, int face) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    const struct cells_rest *r = g->cells->rest;
    return r->taken[f->left[face]] * r->missed[face - f->ninternal];
}

/* The fluxes of U* are those of its pressure. */
static void note_faces(const struct gas *g) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    for (int i = 0; i < f->n; i++) {
        double sum = 0;
        for (int k = 0; k < g->dim; k++) sum += f->normal[k][i] * g->cells->flux[k + 1][i];
        g->cells->rest->on_face[i] = sum / f->area[i];
    }
}

/* On a wall p(U*) misses p* and the weight of half a cell by an error of the scheme; r makes up for it in the cell,
 * though it is the wall that carries it. */
static void note_walls(const struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct cells_rest *r = g->cells->rest;
    for (int i = m->face.ninternal; i < m->face.n; i++) {
        const int cell = m->face.left[i], at = i - m->face.ninternal;
        double fall = 0;
        if (!patch_is_wall(&g->patches.rules[m->face.patch[at]])) continue;
        for (int k = 0; k < g->dim; k++) fall += g->models.source.gravity[k] * cells_arm(m, i, 0, k);
        r->missed[at] = r->rests[cell] ? r->on_face[i] - (r->p[cell] + r->U[0][cell] * fall) : 0;
        for (int k = 0; k < g->dim; k++)
            r->of_walls[k][cell] += r->missed[at] * m->face.area[i] * m->face.normal[k][i] / m->volume[cell];
    }
}

/* Sets the force r to 0 in cells at open patches: the pressure there is not balanced, and that is no error of the
 * scheme. */
static void leave_open(const struct gas *g) {
    const struct polyhedra_faces *f = &g->cells->polyhedra->face;
    for (int i = f->ninternal; i < f->n; i++)
        for (int k = 0; k < g->dim && !patch_is_wall(&g->patches.rules[f->patch[i - f->ninternal]]); k++)
            g->cells->rest->force[k][f->left[i]] = 0;
}

/* Takes the velocity from the state, and keeps it, with all ghosts and mirrors. */
static void take_state(struct gas *g) {
    struct polyhedra *m = g->cells->polyhedra;
    double *U[MAX_VAR];
    cells_lines(g, &g->U, U);
    for (int i = 0; i < m->nown; i++)
        for (int k = 0; k < g->components; k++) {
            U[energy_at(g)][i] -= 0.5 * U[k + 1][i] * U[k + 1][i] / U[0][i];
            U[k + 1][i] = 0;
        }
    polyhedra_fill_start(m, g->nvar, U);
    polyhedra_fill_finish(m);
    cells_mirrors(g, 0, m->mirror.n, U);
    for (int inner = 1; inner >= 0; inner--) cells_weigh(g, inner, U);
    for (int v = 0; v < 2; v++) memcpy(g->cells->rest->U[v], U[v * energy_at(g)], (size_t)m->size * sizeof(double));
}

status cells_rest(struct gas *g, const bool *rests) {
    struct cells *c = g->cells;
    struct cells_rest *r = NULL;
    const long computed = g->counts.computed, all = g->counts.all;
    const status s = comm_agree(g->comm, make(g, &r));
    cells_rest_free(c->rest);
    c->rest = r;
    TRY(s);
    for (int i = 0; i < c->polyhedra->nnear; i++) r->rests[i] = rests[c->polyhedra->cell[i]];
    memcpy(g->falling.gravity, g->models.source.gravity, sizeof g->falling.gravity);
    g->falling.blocks[0] = false;
    take_state(g);
    fit_rest(c->fit, r->U[0], r->U[1], r->near);
    for (r->finds = VALUES; r->finds <= FORCES; r->finds++) (void)cells_stage(g, &g->U, &g->U, &g->W, 0, 0, NULL);
    r->finds = KNOWN;
    note_faces(g);
    note_walls(g);
    flags_clear(g);
    leave_open(g);
    g->counts.computed = computed;
    g->counts.all = all;
    g->step.speed_known = false;
    return OK;
}
