/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pressure of bodies of revolution on polyhedra (struct polyhedra_round; docs/physics.md 1.4). Areas and volumes
 * have the weight r, so that the fluxes through the faces of a cell leave the force of the pressure on its sides along
 * the radius: p A_2/V, A_2 the area of the cell in the plane, p its mean there. A_2 is taken as the sum over the faces
 * of area times normal, which is the same: uniform p is in balance to round-off. The mean is that of a linear p, whose
 * slope comes from the states of the cell's own polynomial on its faces, as the average of a cell stands at another
 * centre. With a swirl u_s the sides push with p + rho u_s^2.
 *
 * rho u_s changes by torques: the flux through a face is the torque over the lever of the face, int r^2 over int r, and
 * a cell has the arm int r^3 over int r^2, with which rho u_s V arm is its angular momentum, exact in rigid rotation:
 *     d(rho u_s)/dt = -sum over the faces of (lever A F)/(V arm)
 * Angular momentum is conserved to round-off. Cells whose faces are limited have the weights of mass and energy, and
 * what their own p and u_s do on their sides, as in libcore/lattice/tiles_round.c. */
#include "libcore/polyhedral/cells.h"

#include <stdlib.h>

struct cells_round {
    double *side; /* [nown] A_2/V, 1/m */
    double *flat; /* [nown] m^dim: volumes in the plane */
    double (
        *lag)[BATCH];  /* as faces of chunks, m^dim: length of the face in the plane times lag along its normal out */
    double *inside[2]; /* [faces + 1] Pa: p + rho u_s^2 on a face by the polynomial of its left and right cell */
    double *lever;     /* [faces] m; with a swirl, as all below */
    double *weight;    /* [points] of the means over faces for the torque, sum to 1 over a face */
    double *inertia;   /* [nown] 1/(V arm), 1/m^(dim+1) */
    double (*torque)[BATCH]; /* as faces of chunks, m: lever, into the cell */
};

void cells_round_free(struct cells_round *r) {
    if (!r) return;
    free(r->side);
    free(r->flat);
    free(r->lag);
    free(r->lever);
    free(r->weight);
    free(r->inertia);
    free(r->torque);
    for (int side = 0; side < 2; side++) free(r->inside[side]);
    free(r);
}

/* Sets the lever of a face and the weights of its points. */
static void set_lever(const struct polyhedra *m, struct cells_round *r, int face) {
    const int radial = m->round.radial;
    const double from = m->centre[radial][m->face.left[face]] - m->round.at;
    double sum = 0;
    for (int p = m->face.point_start[face]; p < m->face.point_start[face + 1]; p++) {
        r->weight[p] = m->point.weight[p] * (from + m->point.arm[0][radial][p]);
        sum += r->weight[p];
    }
    const bool on_axis = m->round.reach[face] < NO_RADIUS;
    r->lever[face] = on_axis ? 0 : sum;
    for (int p = m->face.point_start[face]; p < m->face.point_start[face + 1]; p++)
        r->weight[p] = on_axis ? m->point.weight[p] : r->weight[p] / sum;
}

/* Sets a weight of each entry of face_of_cell of cell i. */
typedef void weigh_entries(const struct gas *g, int i, double *weight);
static status make_weights(const struct gas *g, weigh_entries *weigh, double (**out)[BATCH]) {
    const struct polyhedra *m = g->cells->polyhedra;
    double *weight;
    TRY(allocate(&weight, m->face_start[m->nown], sizeof *weight, "the faces"));
    for (int i = 0; i < m->nown; i++) weigh(g, i, weight);
    const status s = cells_sides_weights(g->cells, weight, out);
    free(weight);
    return s;
}

static void weigh_lag(const struct gas *g, int i, double *weight) {
    const struct polyhedra *m = g->cells->polyhedra;
    for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
        const int entry = m->face_of_cell[j], face = entry < 0 ? ~entry : entry;
        double along = 0;
        for (int k = 0; k < m->dim; k++) along += m->round.lag[k][i] * m->face.normal[k][face];
        const double part = m->face.area[face] / m->round.reach[face] * along;
        weight[j] = entry < 0 ? -part : part;
    }
}

static void weigh_torque(const struct gas *g, int i, double *weight) {
    const struct polyhedra *m = g->cells->polyhedra;
    for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
        const int entry = m->face_of_cell[j];
        weight[j] = entry < 0 ? g->cells->round->lever[~entry] : -g->cells->round->lever[entry];
    }
}

/* What a swirl needs besides. */
static status make_swirl(const struct gas *g, struct cells_round *r) {
    const struct polyhedra *m = g->cells->polyhedra;
    TRY(allocate(&r->lever, m->face.n + SLACK, sizeof(double), "the faces"));
    TRY(allocate(&r->weight, m->point.n, sizeof(double), "the faces"));
    TRY(allocate(&r->inertia, m->nown, sizeof(double), "the cells"));
    for (int face = 0; face < m->face.n; face++) set_lever(m, r, face);
    for (int i = 0; i < m->nown; i++) r->inertia[i] = 1 / (m->volume[i] * polyhedra_arm(m, i));
    return make_weights(g, weigh_torque, &r->torque);
}

status cells_round_make(struct gas *g) {
    struct cells *c = g->cells;
    const struct polyhedra *m = c->polyhedra;
    if (m->round.radial < 0) return OK;
    TRY(allocate(&c->round, 1, sizeof *c->round, "the cells"));
    TRY(allocate(&c->round->side, m->nown, sizeof(double), "the cells"));
    TRY(allocate(&c->round->flat, m->nown, sizeof(double), "the cells"));
    for (int side = 0; side < 2; side++)
        TRY(allocate(&c->round->inside[side], m->face.n + 1, sizeof(double), "the faces"));
    for (int i = 0; i < m->nown; i++) {
        double sum = 0;
        for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
            const int entry = m->face_of_cell[j], face = entry < 0 ? ~entry : entry;
            const double part = m->face.area[face] * m->face.normal[m->round.radial][face];
            sum += entry < 0 ? -part : part;
        }
        c->round->side[i] = sum * c->inverse_volume[i];
        c->round->flat[i] = m->volume[i] / m->round.radius[i];
    }
    TRY(make_weights(g, weigh_lag, &c->round->lag));
    return g->models.swirl ? make_swirl(g, c->round) : OK;
}

void cells_round_note(const struct gas *g, int first, int last, const double *left, const double *right) {
    const int *start = g->cells->polyhedra->face.point_start;
    const double *const p[2] = {left, right};
    const bool single = start[last] - start[first] == last - first;
    for (int side = 0; side < 2; side++) {
        double *inside = g->cells->round->inside[side];
        if (single) memcpy(inside + first, p[side], (size_t)(last - first) * sizeof *inside);
        for (int face = first; face < last && !single; face++) {
            double sum = 0;
            for (int i = start[face]; i < start[face + 1]; i++) sum += p[side][i - start[first]];
            inside[face] = sum / (start[face + 1] - start[face]);
        }
    }
}

/* What the sides of n cells push with: with the mean in the plane, which differs from the value of the average by
 * lag[i]/flat[i]; limited cells, if they have swirl, by their own states alone. */
static void push_sides(const struct gas *g, int at, int n, const double *U, const double *flag,
                       const struct cells_primitives *q, double *residual) {
    const struct cells_round *r = g->cells->round;
    const int swirl = g->models.swirl;
    double lag[BATCH];
    cells_sides_sum(g->cells, at, (const double(*)[BATCH])r->lag, r->inside[0], r->inside[1], lag);
    for (int i = 0; i < n && !swirl; i++) residual[i] += r->side[at + i] * (q->p[i] + lag[i] / r->flat[at + i]);
    for (int i = 0; i < n && swirl; i++) {
        const double around = U[(swirl + 1) * g->size + i] * q->velocity[swirl][i];
        const bool alone = flag && flag[i] > 0;
        residual[i] += r->side[at + i] * ((q->p[i] + around) + (alone ? 0 : lag[i] / r->flat[at + i]));
    }
}

/* Makes of the residual of rho u_s that of torques, or of limited cells that of the flow through their sides. */
static void push_around(const struct gas *g, int at, int n, const double *U, const double *flag,
                        const struct cells_primitives *q, double *residual) {
    const struct cells_round *r = g->cells->round;
    const int radial = g->cells->polyhedra->round.radial, swirl = g->models.swirl;
    double torque[BATCH];
    cells_round_torque(g, at, n, g->cells->flux[swirl + 1], torque);
    for (int i = 0; i < n; i++)
        if (flag && flag[i] > 0)
            residual[i] -= r->side[at + i] * (U[(swirl + 1) * g->size + i] * q->velocity[radial][i]);
        else
            residual[i] = torque[i];
}

void cells_round_push(const struct gas *g, int at, int n, const double *U, const double *flag,
                      double *const residual[MAX_VAR]) {
    struct cells_primitives q;
    cells_primitives(g, n, U, &q);
    push_sides(g, at, n, U, flag, &q, residual[g->cells->polyhedra->round.radial + 1]);
    if (g->models.swirl) push_around(g, at, n, U, flag, &q, residual[g->models.swirl + 1]);
}

/* The part by which p grows from a cell at radius r to R beyond a wall at `rim`, where its swirl u makes a slope of p.
 */
static double rise(double rho, double u, double p, double r, double R, double rim) {
    const double slope = rho * (u / r) * (u / r) * rim;
    return smaller(larger(slope * (R - r) / (p + 1e-300), -0.5), 0.5);
}

void cells_round_beyond(const struct gas *g, int from, int n, bool held, double *const U[MAX_VAR]) {
    const struct polyhedra *m = g->cells->polyhedra;
    const int swirl = g->models.swirl, last = energy_at(g);
    const double *at = m->centre[m->round.radial], *rim = m->round.rim + from;
    double inner[MAX_VAR][BATCH] = {{0}}, velocity[MAX_DIM][BATCH], eps[BATCH], p[BATCH], c2[BATCH], gruneisen[BATCH];
    double *u[MAX_DIM] = {velocity[0], velocity[1], velocity[2]};
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < n; i++) inner[v][i] = U[v][m->mirror.cell[from + i]];
    velocity_row(n, g->components, BATCH, inner[0], u, eps);
    g->models.eos->state(&g->models.material, n, inner[0], eps, p, c2, gruneisen);
    for (int i = 0; i < n; i++) {
        const int ghost = m->ncells + from + i;
        const double r = at[m->mirror.cell[from + i]] - m->round.at, R = at[ghost] - m->round.at;
        const double rho = U[0][ghost], spin = u[swirl][i], beyond = rim[i] < NO_RADIUS ? -spin : spin * (R / r);
        if (rim[i] > NO_RADIUS) U[last][ghost] += rho * eps[i] * rise(rho, spin, p[i], r, R, rim[i]);
        if (held) continue;
        U[swirl + 1][ghost] = rho * beyond;
        U[last][ghost] += 0.5 * rho * (beyond * beyond - spin * spin);
    }
}

void cells_round_torque(const struct gas *g, int at, int n, const double *flux, double *residual) {
    const struct cells_round *r = g->cells->round;
    double sum[BATCH];
    cells_sides_sum(g->cells, at, (const double(*)[BATCH])r->torque, flux, flux, sum);
    for (int i = 0; i < n; i++) residual[i] = sum[i] * r->inertia[at + i];
}

const double *cells_round_levers(const struct gas *g) {
    return g->cells->round->lever;
}

const double *cells_round_weights(const struct gas *g) {
    return g->cells->round->weight;
}

double cells_round_side(const struct gas *g, int i) {
    return g->cells->round->side[i];
}
