/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Carried quantities on a lattice (libcore/gas/carried.h). Lines over faces have a line for each axis; a face stands
 * where the cell above it does. Slopes within cells are those of van Leer's monotonised central differences. In bodies
 * of revolution what crosses a face counts with the radius of the face, and a density with that of the cell. */
#include "libcore/gas/carried.h"
#include "libcore/lattice/tiles_diffuser.h"

/* Multiplies a line of the faces below n cells from `offset` on along an axis by their radii. */
static void weigh_faces(const struct gas *g, int tile, int axis, long offset, int n, double *q) {
    const struct forest *f = g->forest;
    const double shift = axis == f->radial ? 0 : 0.5;
    for (int i = 0; i < n && f->radial >= 0; i++)
        q[i] *= forest_radius(f, forest_place_along(f, tile, offset + i, f->radial) + shift);
}

/* Multiplies a line of n cells by their radii. */
static void weigh_cells(const struct gas *g, int tile, long offset, int n, double *rho) {
    double room[BATCH];
    const double *radius = row_radius(g, tile, offset, n, room);
    for (int i = 0; i < n && radius; i++) rho[i] *= radius[i];
}

/* ---- in the stages ---- */

void tiles_carry_begin(struct gas *g, int tile, const double *U) {
    const long size = g->forest->size;
    for (int a = 0; a < g->dim; a++) {
        double *to = g->carried->flux[tile] + a * size;
        for (long i = 0; i < size; i++) to[i] = U[(a + 1) * size];
        weigh_faces(g, tile, a, 0, (int)size, to);
    }
}

void tiles_carry(struct gas *g, int tile, int axis, long offset, int n, const double *low, const double *high) {
    const long step = g->forest->stride[axis];
    double *to = g->carried->flux[tile] + axis * g->forest->size + offset;
    memcpy(to, low, (size_t)n * sizeof *to);
    if (step == 1) {
        memcpy(to + 1, high, (size_t)n * sizeof *to);
        weigh_faces(g, tile, axis, offset, n + 1, to);
        return;
    }
    memcpy(to + step, high, (size_t)n * sizeof *to);
    weigh_faces(g, tile, axis, offset, n, to);
    weigh_faces(g, tile, axis, offset + step, n, to + step);
}

/* ---- P and K ---- */

/* Beyond patches the stress goes on with the slope inside, so that a cell there has that slope. */
static void stress_edge(struct gas *g, int tile, const struct edge *e, const void *context) {
    double *line = g->carried->stress[tile];
    const long inward = e->from - e->to;
    (void)context;
    for (int i = 0; i < e->n; i++) {
        const long at = e->from + i * e->step;
        line[at - inward] = 2 * line[at] - line[at + inward];
    }
}

void tiles_carried_rise(struct gas *g) {
    const struct forest *f = g->forest;
    for (int t = 0; t < f->ntiles; t++) {
        edges_visit(g, t, stress_edge, NULL);
        const double *stress = g->carried->stress[t];
        double *rise = g->carried->rise[t];
        memset(rise, 0, (size_t)f->size * sizeof(double));
        for (int a = 0; a < g->dim; a++) {
            const double per = g->carried->up[a] / (2 * f->width[a]);
            for (long i = f->stride[a]; i < f->size - f->stride[a]; i++)
                rise[i] += per * (stress[i + f->stride[a]] - stress[i - f->stride[a]]);
        }
    }
}

/* The mean of two densities is the harmonic one: near vacuum little mass is exchanged. */
static double mean_density(double a, double b) {
    return a + b > 0 ? 2 * a * b / (a + b) : 0;
}

static void terms_of_axis(struct gas *g, int tile, int axis, double dt) {
    const struct forest *f = g->forest;
    const struct carried *c = g->carried;
    const long step = f->stride[axis];
    const double *rho = c->rho[tile], *D = c->D[tile], *speed = c->f[tile];
    double *P = c->exchange[tile] + axis * f->size, *K = c->spread[tile] + axis * f->size;
    for (long i = step; i < f->size; i++) {
        const double mean = 0.5 * dt * mean_density(rho[i - step], rho[i]);
        P[i] = mean * (speed[i - step] + speed[i]) * c->up[axis];
        K[i] = mean * (D[i - step] + D[i]) / f->width[axis];
    }
    weigh_faces(g, tile, axis, step, (int)(f->size - step), P + step);
    weigh_faces(g, tile, axis, step, (int)(f->size - step), K + step);
}

/* Through patches nothing percolates; what diffuses has half the way. */
static void terms_edge(struct gas *g, int tile, const struct edge *e, const void *context) {
    const struct carried *c = g->carried;
    const long at = e->normal * g->forest->size + (e->to > e->from ? e->to : e->from);
    (void)context;
    for (int i = 0; i < e->n; i++) {
        c->exchange[tile][at + i * e->step] = 0;
        c->spread[tile][at + i * e->step] *= 2;
    }
}

void tiles_carried_terms(struct gas *g, double dt) {
    for (int t = 0; t < g->forest->ntiles; t++) {
        for (int a = 0; a < g->dim; a++) terms_of_axis(g, t, a, dt);
        edges_visit(g, t, terms_edge, NULL);
    }
}

/* ---- a part of a step ---- */

struct both_faces { /* of n cells of a row along an axis: M, P and K of the faces below and above; width of the cells */
    const double *mass[2], *exchange[2], *spread[2];
    double inverse; /* 1/width */
};
static struct both_faces both_faces_of(const struct gas *g, int tile, int axis, long offset) {
    const struct carried *c = g->carried;
    const long at = axis * g->forest->size + offset, step = g->forest->stride[axis];
    const double *M = c->mass[tile] + at, *P = c->exchange[tile] + at, *K = c->spread[tile] + at;
    return (struct both_faces){{M, M + step}, {P, P + step}, {K, K + step}, 1 / g->forest->width[axis]};
}

/* Adds what leaves a cell through its two faces: mass, both sides of an exchange, and what diffuses. */
KERNEL static void carried_out(int n, const struct both_faces *s, double *restrict out) {
    const double *low = s->mass[0], *high = s->mass[1];
    for (int i = 0; i < n; i++) {
        const double flow = larger(-low[i], 0) + larger(high[i], 0);
        const double exchanged = fabs(s->exchange[0][i]) + fabs(s->exchange[1][i]);
        out[i] += s->inverse * ((flow + exchanged) + (s->spread[0][i] + s->spread[1][i]));
    }
}

struct measure { /* context of out_visit */
    const struct gas *g;
    int tile;
    double most;
};

static void out_visit(void *measure, long offset, int n) {
    struct measure *m = measure;
    const struct gas *g = m->g;
    const double *before = g->V.block[m->tile] + offset, *now = g->U.block[m->tile] + offset;
    double out[BATCH] = {0}, room[BATCH];
    const double *radius = row_radius(g, m->tile, offset, n, room);
    for (int a = 0; a < g->dim; a++) {
        const struct both_faces s = both_faces_of(g, m->tile, a, offset);
        carried_out(n, &s, out);
    }
    for (int i = 0; i < n && radius; i++) out[i] /= radius[i];
    for (int i = 0; i < n; i++) m->most = larger(m->most, carried_share(out[i], before[i], now[i]));
}

double tiles_carried_most_out(const struct gas *g) {
    struct measure m = {.g = g};
    for (m.tile = 0; m.tile < g->forest->ntiles; m.tile++)
        runs_visit(g->forest, &g->forest->tile[m.tile], 0, out_visit, &m);
    return m.most;
}

struct row_slopes {                 /* of a row of n cells */
    double low[BATCH], high[BATCH]; /* the least and the largest phi in a cell and around it */
    double slope[MAX_DIM][BATCH];   /* times the width */
    double shift[BATCH];            /* less half of the way of the gas in the part of the step, times the slopes */
    double theta[BATCH], sum[BATCH], out[BATCH];
};

/* Along an axis; per: half of the part of the step over the width; middle: densities in its middle. */
KERNEL static void carried_slopes(int n, long step, const double *restrict phi, double per,
                                  const struct both_faces *restrict s, const double *restrict middle,
                                  double *restrict slope, struct row_slopes *restrict r) {
    for (int i = 0; i < n; i++) {
        const double below = phi[i - step], here = phi[i], above = phi[i + step];
        const double a = here - below, b = above - here, centre = 0.5 * (a + b);
        const double steep = 2 * smaller(fabs(a), fabs(b)), size = smaller(steep, fabs(centre));
        slope[i] = select_double(a * b > 0, select_double(a > 0, size, -size), 0);
        r->low[i] = smaller(r->low[i], smaller(below, above));
        r->high[i] = larger(r->high[i], larger(below, above));
        r->shift[i] -= 0.5 * (per * (s->mass[0][i] + s->mass[1][i]) / middle[i]) * slope[i];
    }
}

/* The greatest factor <= theta by which a difference d from phi stays within its bounds. */
static inline double bounded(double theta, double d, double down, double up) {
    const double room = d > 0 ? up : down;
    return fabs(d) * theta > fabs(room) ? room / d : theta;
}

/* Looks at what leaves through the two faces of a cell: bounds its phi, and sums how much it differs. */
KERNEL static void carried_bounds(int n, const struct both_faces *restrict s, const double *restrict phi,
                                  const double *restrict slope, struct row_slopes *restrict r) {
    for (int i = 0; i < n; i++) {
        const double down = r->low[i] - phi[i], up = r->high[i] - phi[i];
        const double below = r->shift[i] - 0.5 * slope[i], above = r->shift[i] + 0.5 * slope[i];
        const double leaves[2] = {larger(-s->mass[0][i], 0) + fabs(s->exchange[0][i]),
                                  larger(s->mass[1][i], 0) + fabs(s->exchange[1][i])};
        r->theta[i] = leaves[0] > 0 ? bounded(r->theta[i], below, down, up) : r->theta[i];
        r->theta[i] = leaves[1] > 0 ? bounded(r->theta[i], above, down, up) : r->theta[i];
        r->sum[i] += s->inverse * (leaves[0] * below + leaves[1] * above);
    }
}

/* Bounds what stays behind; rho: before the part of the step. */
KERNEL static void carried_stays(int n, double share, const double *restrict rho, const double *restrict phi,
                                 struct row_slopes *restrict r) {
    for (int i = 0; i < n; i++) {
        const double stays = larger(rho[i] - share * r->out[i], 0), lost = share * r->sum[i];
        r->theta[i] = bounded(r->theta[i], -lost, stays * (r->low[i] - phi[i]), stays * (r->high[i] - phi[i]));
    }
}

struct carry { /* context of the visitors below */
    struct gas *g;
    const struct carried_quantity *q;
    struct carried_part part;
    int tile;
};

/* The density at a time within the step; in bodies of revolution times the radius. */
static void density_at(const struct carry *m, double when, long offset, int n, double *rho) {
    const double *before = m->g->V.block[m->tile] + offset, *now = m->g->U.block[m->tile] + offset;
    for (int i = 0; i < n; i++) rho[i] = when == 1 ? now[i] : before[i] + when * (now[i] - before[i]);
    weigh_cells(m->g, m->tile, offset, n, rho);
}

static void slopes_visit(void *moving, long offset, int n) {
    const struct carry *m = moving;
    const struct gas *g = m->g;
    const long size = g->forest->size;
    const double *phi = m->q->phi[m->tile] + offset, share = m->part.share;
    double *to = g->tiles->slope[m->tile] + offset, rho[BATCH] = {0}, middle[BATCH] = {0};
    struct row_slopes r = {.shift = {0}};
    memcpy(r.low, phi, (size_t)n * sizeof *phi);
    memcpy(r.high, phi, (size_t)n * sizeof *phi);
    density_at(m, m->part.from, offset, n, rho);
    density_at(m, m->part.from + 0.5 * share, offset, n, middle);
    for (int i = 0; i < n; i++) r.theta[i] = 1;
    for (int a = 0; a < g->dim; a++) {
        const struct both_faces s = both_faces_of(g, m->tile, a, offset);
        carried_slopes(n, g->forest->stride[a], phi, 0.5 * share * s.inverse, &s, middle, r.slope[a], &r);
        carried_out(n, &s, r.out);
    }
    for (int a = 0; a < g->dim; a++) {
        const struct both_faces s = both_faces_of(g, m->tile, a, offset);
        carried_bounds(n, &s, phi, r.slope[a], &r);
    }
    carried_stays(n, share, rho, phi, &r);
    for (int i = 0; i < n; i++) to[i] = r.theta[i] * r.shift[i];
    for (int a = 0; a < g->dim; a++)
        for (int i = 0; i < n; i++) to[(a + 1) * size + i] = r.theta[i] * r.slope[a][i];
}

static void find_slopes(struct gas *g, const struct carried_quantity *q, struct carried_part part) {
    for (int t = 0; t < g->forest->ntiles; t++)
        runs_visit(g->forest, &g->forest->tile[t], 0, slopes_visit, &(struct carry){g, q, part, t});
    forest_fill_layers(g->forest, 1, 1 + g->dim, g->tiles->slope);
}

/* What carries phi through n faces; the cells below are `step` before those above. shift, slope: of the latter; beyond
 * patches they are 0. */
KERNEL static void carried_flux(int n, long step, double share, const struct both_faces *restrict s,
                                const double *restrict phi, const double *restrict shift, const double *restrict slope,
                                double *restrict flux) {
    const double *restrict mass = s->mass[0], *restrict exchange = s->exchange[0], *restrict spread = s->spread[0];
    for (int i = 0; i < n; i++) {
        const double M = share * mass[i], P = share * exchange[i], K = share * spread[i];
        const double below = phi[i - step] + (shift[i - step] + 0.5 * slope[i - step]);
        const double above = phi[i] + (shift[i] - 0.5 * slope[i]);
        const double carried = M > 0 ? M * below : M * above;
        const double fallen = P > 0 ? P * (below * (1 - above)) : P * (above * (1 - below));
        flux[i] = (carried + fallen) - K * (phi[i] - phi[i - step]);
    }
}

static void fluxes_of_axis(const struct carry *m, int axis) {
    const struct forest *f = m->g->forest;
    const struct carried *c = m->g->carried;
    const int *n = f->tile[m->tile].n, faces = n[0] + (axis == 0);
    for (int k = 0; k < n[2] + (axis == 2); k++)
        for (int j = 0; j < n[1] + (axis == 1); j++) {
            const long at = f->first + j * f->stride[1] + k * f->stride[2];
            const double *slope = m->g->tiles->slope[m->tile] + at;
            const struct both_faces s = both_faces_of(m->g, m->tile, axis, at);
            carried_flux(faces, f->stride[axis], m->part.share, &s, m->q->phi[m->tile] + at, slope,
                         slope + (axis + 1) * f->size, c->flux[m->tile] + axis * f->size + at);
        }
}

KERNEL static void carried_change(int n, double share, double inverse, const double *restrict phi,
                                  const double *const mass[2], const double *restrict low, const double *restrict high,
                                  double *restrict change) {
    for (int i = 0; i < n; i++) {
        const double above = high[i] - phi[i] * (share * mass[1][i]), below = low[i] - phi[i] * (share * mass[0][i]);
        change[i] += inverse * (above - below);
    }
}

static void move_visit(void *moving, long offset, int n) {
    const struct carry *m = moving;
    const struct gas *g = m->g;
    const struct carried_kind *kind = m->q->choice.kind;
    double *phi = m->q->phi[m->tile] + offset, change[BATCH] = {0}, rho[BATCH];
    density_at(m, m->part.to, offset, n, rho);
    for (int a = 0; a < g->dim; a++) {
        const struct both_faces s = both_faces_of(g, m->tile, a, offset);
        const double *low = g->carried->flux[m->tile] + a * g->forest->size + offset;
        carried_change(n, m->part.share, s.inverse, phi, s.mass, low, low + g->forest->stride[a], change);
    }
    for (int i = 0; i < n; i++) phi[i] = larger(smaller(phi[i] - change[i] / rho[i], kind->high), kind->low);
}

void tiles_carried_move(struct gas *g, const struct carried_quantity *q, struct carried_part part) {
    find_slopes(g, q, part);
    for (int t = 0; t < g->forest->ntiles; t++) {
        struct carry m = {g, q, part, t};
        for (int a = 0; a < g->dim; a++) fluxes_of_axis(&m, a);
        runs_visit(g->forest, &g->forest->tile[t], 0, move_visit, &m);
    }
}
