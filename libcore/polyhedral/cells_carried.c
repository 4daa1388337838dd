/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Carried quantities on polyhedra (libcore/gas/carried.h). Lines over faces have the order of the faces. Slopes within
 * cells are the gradients of cells_gradient.h. */
#include "libcore/gas/carried.h"
#include "libcore/polyhedral/cells_gradient.h"

#include <stdlib.h>

/* Lines of the slopes besides those of carried.h: the least and the largest phi in a cell and around it. */
enum { LOW = 1, HIGH, LINES };

/* From a line of the slopes to the next: gradients are written in whole batches of lanes. */
static long wide(const struct gas *g) {
    return g->size + LANES;
}
_Static_assert((int)LANES <= (int)SLACK, "gradients read lines in whole batches of lanes");

struct cells_carried {
    double *slope;           /* [LINES + dim] of wide(g): phi_f is phi + line 0 + slopes * way to the face */
    double *arm[2][MAX_DIM]; /* [left or right][dim][faces] m: from the centre of the cell to that of the face */
};

status cells_carried_make(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    struct cells_carried *x;
    TRY(allocate(&x, 1, sizeof *x, "carried quantities"));
    g->cells->carried = x;
    TRY(allocate(&x->slope, (LINES + g->dim) * wide(g), sizeof(double), "carried quantities"));
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < g->dim; k++) {
            TRY(allocate(&x->arm[side][k], m->face.n, sizeof(double), "carried quantities"));
            for (int f = 0; f < m->face.n; f++) x->arm[side][k][f] = cells_arm(m, f, side, k);
        }
    return OK;
}

void cells_carried_free(struct cells_carried *x) {
    if (!x) return;
    free(x->slope);
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < MAX_DIM; k++) free(x->arm[side][k]);
    free(x);
}

void cells_carry(struct gas *g) {
    memcpy(g->carried->flux[0], g->cells->flux[0], (size_t)g->cells->polyhedra->face.n * sizeof(double));
}

/* ---- ghosts ---- */

static void fill_ghosts(const struct gas *g, int n, double *block) {
    double *line[LINES + MAX_DIM];
    for (int i = 0; i < n; i++) line[i] = block + i * wide(g);
    polyhedra_fill_start(g->cells->polyhedra, n, line);
    polyhedra_fill_finish(g->cells->polyhedra);
}

/* ---- P and K ---- */

/* The gradient of a line of filled values, in the own cells: lines 1 .. dim of the slopes. */
static void gradient_of(struct gas *g, double *line, double *slope) {
    const struct polyhedra *m = g->cells->polyhedra;
    double *out[MAX_DIM];
    for (int k = 0; k < g->dim; k++) out[k] = slope + (1 + k) * wide(g);
    cells_gradients(g->dim, &g->cells->gradient, 1, 0, m->nown, &line, out);
}

void cells_carried_rise(struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    const double *slope = g->cells->carried->slope;
    double *rise = g->carried->rise[0];
    gradient_of(g, g->carried->stress[0], g->cells->carried->slope);
    for (int i = 0; i < m->nown; i++) {
        rise[i] = 0;
        for (int k = 0; k < g->dim; k++) rise[i] += g->carried->up[k] * slope[(1 + k) * wide(g) + i];
    }
}

static double mean_density(double a, double b) {
    return a + b > 0 ? 2 * a * b / (a + b) : 0;
}

/* The distance of both centres along the normal of a face; of a face on a patch from the cell to the patch. */
static double distance_of(const struct gas *g, int face) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct cells_carried *x = g->cells->carried;
    double sum = 0;
    for (int k = 0; k < g->dim; k++)
        sum += m->face.normal[k][face] * (x->arm[0][k][face] - (face < m->face.ninternal ? x->arm[1][k][face] : 0));
    return sum;
}

void cells_carried_terms(struct gas *g, double dt) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct carried *c = g->carried;
    for (int f = 0; f < m->face.n; f++) {
        const int l = m->face.left[f], r = m->face.right[f];
        const double mean = 0.5 * dt * m->face.area[f] * mean_density(c->rho[0][l], c->rho[0][r]);
        double up = 0;
        for (int k = 0; k < g->dim && f < m->face.ninternal; k++) up += c->up[k] * m->face.normal[k][f];
        c->exchange[0][f] = mean * (c->f[0][l] + c->f[0][r]) * up;
        c->spread[0][f] = mean * (c->D[0][l] + c->D[0][r]) / distance_of(g, f);
    }
}

/* ---- a part of a step ---- */

struct seen_face { /* a face as a cell sees it; mass: outwards */
    int face, side, other;
    double mass, exchange, spread;
};
static struct seen_face look(const struct gas *g, int entry) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct carried *c = g->carried;
    const int listed = m->face_of_cell[entry], side = listed < 0, face = side ? ~listed : listed;
    return (struct seen_face){face,
                              side,
                              side ? m->face.left[face] : m->face.right[face],
                              side ? -c->mass[0][face] : c->mass[0][face],
                              fabs(c->exchange[0][face]),
                              c->spread[0][face]};
}

/* What diffuses counts twice, as gradients within the cells bring up to as much. */
static double out_of(const struct seen_face *s) {
    return (larger(s->mass, 0) + s->exchange) + 2 * s->spread;
}

double cells_carried_most_out(const struct gas *g) {
    const struct polyhedra *m = g->cells->polyhedra;
    const double *before = g->V.block[0], *now = g->U.block[0];
    double most = 0;
    for (int i = 0; i < m->nown; i++) {
        double out = 0;
        for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
            const struct seen_face s = look(g, j);
            out += out_of(&s);
        }
        most = larger(most, carried_share(out / m->volume[i], before[i], now[i]));
    }
    return most;
}

static double density_at(const struct gas *g, int i, double when) {
    const double before = g->V.block[0][i], now = g->U.block[0][i];
    return when == 1 ? now : before + when * (now - before);
}

static double bounded(double theta, double d, double down, double up) {
    const double room = d > 0 ? up : down;
    return fabs(d) * theta > fabs(room) ? room / d : theta;
}

/* By how much phi at a face differs from that of the cell on a side. */
static double difference(const struct gas *g, int cell, int face, int side) {
    const double *slope = g->cells->carried->slope;
    double sum = slope[cell];
    for (int k = 0; k < g->dim; k++) sum += slope[(1 + k) * wide(g) + cell] * g->cells->carried->arm[side][k][face];
    return sum;
}

/* Bounds the slopes of a cell; line 0 of the slopes gets less half of the way of the gas, times the slopes. */
static void slopes_of_cell(struct gas *g, const double *phi, struct carried_part part, int i) {
    const struct polyhedra *m = g->cells->polyhedra;
    const int first = m->face_start[i], last = m->face_start[i + 1];
    double *slope = g->cells->carried->slope, low = phi[i], high = phi[i], out = 0, theta = 1, lost = 0;
    const double mass = m->volume[i] * density_at(g, i, part.from);
    const double middle = m->volume[i] * density_at(g, i, part.from + 0.5 * part.share);
    slope[i] = 0;
    for (int j = first; j < last; j++) {
        const struct seen_face s = look(g, j);
        low = smaller(low, phi[s.other]);
        high = larger(high, phi[s.other]);
        out += part.share * out_of(&s);
        for (int k = 0; k < g->dim; k++)
            slope[i] -= slope[(1 + k) * wide(g) + i] * g->cells->carried->arm[s.side][k][s.face] *
                        (0.5 * part.share * s.mass / middle);
    }
    for (int j = first; j < last; j++) {
        const struct seen_face s = look(g, j);
        const double leaves = larger(s.mass, 0) + s.exchange, d = difference(g, i, s.face, s.side);
        if (leaves > 0) theta = bounded(theta, d, low - phi[i], high - phi[i]);
        lost += part.share * leaves * d;
    }
    const double stays = larger(mass - out, 0);
    theta = bounded(theta, -lost, stays * (low - phi[i]), stays * (high - phi[i]));
    for (int k = 0; k <= g->dim; k++) slope[k * wide(g) + i] *= theta;
    slope[(g->dim + LOW) * wide(g) + i] = low;
    slope[(g->dim + HIGH) * wide(g) + i] = high;
}

static void find_slopes(struct gas *g, const struct carried_quantity *q, struct carried_part part) {
    gradient_of(g, q->phi[0], g->cells->carried->slope);
    for (int i = 0; i < g->cells->polyhedra->nown; i++) slopes_of_cell(g, q->phi[0], part, i);
    fill_ghosts(g, LINES + g->dim, g->cells->carried->slope);
}

/* How much phi may change in a cell if it rises, or falls, until it is that of a cell around it. */
static double room_of(const struct gas *g, const double *phi, int cell, bool rises) {
    const double *bound = g->cells->carried->slope + (g->dim + (rises ? HIGH : LOW)) * wide(g);
    return rises ? bound[cell] - phi[cell] : phi[cell] - bound[cell];
}

/* The jump across a face, less the part of it that is along the face where the line of centres is oblique. By that part
 * no cell may gain or lose more than it lacks of the cells around it, so that phi keeps its bounds. */
static double jump_across(const struct gas *g, const double *phi, int face) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct cells_carried *x = g->cells->carried;
    const double *slope = g->cells->carried->slope, distance = distance_of(g, face);
    const int l = m->face.left[face], r = m->face.right[face];
    const double jump = phi[r] - phi[l];
    double along = 0;
    if (face >= m->face.ninternal) return jump;
    for (int k = 0; k < g->dim; k++) {
        const double way = x->arm[0][k][face] - x->arm[1][k][face] - distance * m->face.normal[k][face];
        along += 0.5 * (slope[(1 + k) * wide(g) + l] + slope[(1 + k) * wide(g) + r]) * way;
    }
    const bool rises = along > 0; /* of the right cell: it gains */
    const double room = smaller(room_of(g, phi, r, rises), room_of(g, phi, l, !rises));
    return jump - larger(smaller(along, room), -room);
}

static void carry_through(struct gas *g, const double *phi, double share, int face) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct carried *c = g->carried;
    const int l = m->face.left[face], r = m->face.right[face];
    const double M = share * c->mass[0][face], P = share * c->exchange[0][face], K = share * c->spread[0][face];
    const double left = phi[l] + difference(g, l, face, 0);
    const double right = face < m->face.ninternal ? phi[r] + difference(g, r, face, 1) : phi[r];
    const double fallen = P > 0 ? P * (left * (1 - right)) : P * (right * (1 - left));
    c->flux[0][face] = (M > 0 ? M * left : M * right) + fallen - (K > 0 ? K * jump_across(g, phi, face) : 0);
}

void cells_carried_move(struct gas *g, const struct carried_quantity *q, struct carried_part part) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct carried_kind *kind = q->choice.kind;
    double *phi = q->phi[0];
    find_slopes(g, q, part);
    for (int f = 0; f < m->face.n; f++) carry_through(g, phi, part.share, f);
    for (int i = 0; i < m->nown; i++) {
        double change = 0;
        for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
            const struct seen_face s = look(g, j);
            const double carried = g->carried->flux[0][s.face];
            change += (s.side ? -carried : carried) - phi[i] * (part.share * s.mass);
        }
        const double next = phi[i] - change / (m->volume[i] * density_at(g, i, part.to));
        phi[i] = larger(smaller(next, kind->high), kind->low);
    }
}
