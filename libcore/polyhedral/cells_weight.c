/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The weight of the gas beside walls of polyhedra (docs/physics.md 7.4).
 *
 * Polynomials take a mirror for a cell. A plain image has the p of the cell, so that at rest, where dp/dn = rho g.n,
 * polynomials lack half of that slope, and p on the wall an error of first order. So in the stages the mirror has what
 * gas at rest has at its place: d from the cell to the mirror,
 *     rho_m = rho + d.(gradient of rho by least squares over the cells across the faces of the cell),
 *     p_m   = p + x (rho + rho_m)/2,    x = share g.d,    eps_m = eps p_m/p(rho_m, eps),
 * and moves as the plain image does. These are limited where gas is not at rest:
 * - share goes from 1 to 0 as the speed across the wall goes from c/2 to c, as on lattices
 *   (libcore/lattice/tiles_balance.c);
 * - |x| is at most p/(2 rho), since cold gas carries no weight;
 * - rho changes by no more than twice the part by which p does, so that without weight the image is plain; and by half
 *   of what is left until packing. */
#include "libcore/polyhedral/cells.h"
#include "libcore/schemes/polynomial_fit.h"

#include <stdlib.h>

/* Of walls that gravity crosses by less than this part nothing is known but round-off. */
static const double ALONG = 1e-10;
/* A mirror that has more than this weight in the gradient of its cell leaves too little for the others. */
static const double OWN = 0.9;

struct cells_weight {    /* mirrors beyond walls that gravity crosses */
    int n, ninner;       /* the first are those of inner cells, whose stencils need no other rank */
    int *mirror;         /* [n] */
    int *start, *beside; /* [n + 1] into beside: cells across the faces of the cell */
    double *share;       /* of beside: d.(gradient of rho) is the sum of share times rho less rho of the cell */
};

/* Returns the vector d from a mirror's cell to the mirror, and g.d. */
static double fall_to(const struct polyhedra *m, const double g[MAX_DIM], int mirror, double d[MAX_DIM]) {
    double fall = 0;
    for (int k = 0; k < m->dim; k++) {
        d[k] = m->centre[k][m->ncells + mirror] - m->centre[k][m->mirror.cell[mirror]];
        fall += g[k] * d[k];
    }
    return fall;
}

static bool carries(const struct gas *g, int mirror) {
    const struct polyhedra *m = g->cells->polyhedra;
    const double *gravity = g->models.source.gravity;
    double d[MAX_DIM], squares[2] = {0}, fall = fall_to(m, gravity, mirror, d);
    for (int k = 0; k < m->dim; k++) {
        squares[0] += gravity[k] * gravity[k];
        squares[1] += d[k] * d[k];
    }
    return patch_is_wall(&g->patches.rules[m->mirror.patch[mirror]]) &&
           fabs(fall) > ALONG * sqrt(squares[0] * squares[1]);
}

/* Lists the cells beside a mirror's cell with their shares. The gradient of the cell is that without the mirror if the
 * mirror lies on it: its own share then moves to the others. */
static void list_beside(const struct polyhedra *m, const struct entries *slope, int mirror, struct cells_weight *w) {
    const int cell = m->mirror.cell[mirror], lane = cell % LANES;
    double d[MAX_DIM], none[MAX_DIM] = {0}, own = 0;
    int from = w->start[w->n], n = 0;
    (void)fall_to(m, none, mirror, d);
    for (int j = slope->start[cell / LANES]; j < slope->start[cell / LANES + 1]; j++) {
        const int other = slope->cell[(long)j * LANES + lane];
        double share = 0;
        for (int k = 0; k < m->dim; k++) share += slope->data[((long)j * m->dim + k) * LANES + lane] * d[k];
        if (other == m->ncells + mirror) own += share;
        if (other >= m->ncells || other == cell) continue;
        w->beside[from + n] = other;
        w->share[from + n++] = share;
    }
    for (int i = 0; i < n; i++) w->share[from + i] = own < OWN ? w->share[from + i] / (1 - own) : 0;
    w->mirror[w->n++] = mirror;
    w->start[w->n] = from + n;
}

static status list(const struct gas *g, const struct entries *slope, struct cells_weight *w) {
    const struct polyhedra *m = g->cells->polyhedra;
    int n = 0, most = 0;
    for (int i = 0; i < m->mirror.n; i++) {
        const int batch = m->mirror.cell[i] / LANES;
        if (!carries(g, i)) continue;
        n++;
        most += slope->start[batch + 1] - slope->start[batch];
    }
    TRY(allocate(&w->mirror, n, sizeof *w->mirror, "the weight on walls"));
    TRY(allocate(&w->start, n + 1, sizeof *w->start, "the weight on walls"));
    TRY(allocate(&w->beside, most, sizeof *w->beside, "the weight on walls"));
    TRY(allocate(&w->share, most, sizeof *w->share, "the weight on walls"));
    for (int inner = 1; inner >= 0; inner--) {
        for (int i = 0; i < m->mirror.n; i++)
            if ((m->mirror.cell[i] < m->ninner) == inner && carries(g, i)) list_beside(m, slope, i, w);
        if (inner) w->ninner = w->n;
    }
    return OK;
}

status cells_weight_make(struct gas *g) {
    struct entries slope = {0};
    if (!source_falls(&g->models.source, g->dim)) return OK;
    TRY(allocate(&g->cells->weight, 1, sizeof *g->cells->weight, "the weight on walls"));
    status s = fit_gradients(g->cells->fit, &slope);
    if (!s) s = list(g, &slope, g->cells->weight);
    entries_free(&slope);
    return s;
}

void cells_weight_free(struct cells_weight *w) {
    if (!w) return;
    free(w->mirror);
    free(w->start);
    free(w->beside);
    free(w->share);
    free(w);
}

struct images { /* of n cells */
    double inner[MAX_VAR][BATCH], velocity[MAX_DIM][BATCH], eps[BATCH], p[BATCH], c2[BATCH], gruneisen[BATCH];
    double rho[BATCH]; /* of the mirrors; p becomes theirs, too */
};

/* Finds rho and p of the mirrors from <= i < from + n of the list. */
static void find_rest(const struct gas *g, int from, int n, const double *rho, struct images *q) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct cells_weight *w = g->cells->weight;
    for (int i = 0; i < n; i++) {
        const int mirror = w->mirror[from + i];
        const double here = q->inner[0][i], most = 0.5 * q->p[i] / here;
        double d[MAX_DIM], across = 0, more = 0, x = fall_to(m, g->falling.gravity, mirror, d);
        for (int k = 0; k < m->dim; k++) across += q->velocity[k][i] * m->mirror.normal[k][mirror];
        for (int j = w->start[from + i]; j < w->start[from + i + 1]; j++)
            more += w->share[j] * (rho[w->beside[j]] - here);
        x *= smaller(larger(2 - 2 * fabs(across) / sqrt(q->c2[i]), 0), 1);
        x = smaller(larger(x, -most), most);
        const double room = here * smaller(fabs(x) / most, 0.5);
        q->rho[i] = here + smaller(smaller(larger(more, -room), room), 0.5 * (g->limits.most - here));
        q->p[i] += 0.5 * x * (here + q->rho[i]);
    }
}

static void weigh(const struct gas *g, int from, int n, double *const U[MAX_VAR]) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct gas_models *models = &g->models;
    const int *mirror = g->cells->weight->mirror + from, last = energy_at(g);
    struct images q;
    double plain[BATCH], *u[MAX_DIM] = {q.velocity[0], q.velocity[1], q.velocity[2]};
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < n; i++) q.inner[v][i] = U[v][m->mirror.cell[mirror[i]]];
    velocity_row(n, g->components, BATCH, q.inner[0], u, q.eps);
    models->eos->state(&models->material, n, q.inner[0], q.eps, q.p, q.c2, q.gruneisen);
    find_rest(g, from, n, U[0], &q);
    models->eos->state(&models->material, n, q.rho, q.eps, plain, q.c2, q.gruneisen);
    for (int i = 0; i < n; i++) {
        const int at = m->ncells + mirror[i];
        const double here = q.inner[0][i], more = q.rho[i] - here, eps = eps_at_pressure(q.p[i], plain[i], q.eps[i]);
        double square = 0;
        for (int k = 1; k < last; k++) {
            const double moved = U[k][at] / here;
            square += moved * moved;
            U[k][at] += more * moved;
        }
        U[0][at] = q.rho[i];
        U[last][at] += (q.rho[i] * eps - here * q.eps[i]) + 0.5 * more * square;
    }
}

void cells_weigh(const struct gas *g, bool inner, double *const U[MAX_VAR]) {
    const struct cells_weight *w = g->cells->weight;
    if (!w) return;
    const int to = inner ? w->ninner : w->n;
    for (int n, from = inner ? 0 : w->ninner; from < to; from += n) {
        n = to - from < BATCH ? to - from : BATCH;
        weigh(g, from, n, U);
    }
}
