/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Diffusion in bodies of revolution on a lattice (docs/physics.md 1.4, libcore/lattice/tiles_round.c).
 *
 * Faces across the radius have the weights r_f/r of the areas, for the swirl those of moments. What comes in besides is
 * the rate of strain around the axis, u_r/r, which lies on the same faces: e = (u_1 + u_2)/(2 r_f), on the axis the
 * slope of u_r. So the rate of work of the radial stress is a sum over faces of r_f h (lambda (d + e + x)^2 +
 * 2 mu (d^2 + e^2)), d and x the slopes along radius and axis, and never below 0; the force on a cell follows from it:
 *     ((r tau_rr)_2 - (r tau_rr)_1)/(r h) - (tau_ss,1 + tau_ss,2)/(2 r),     1, 2: its faces.
 * Uniform expansion, u_r = a r, has the same stress on all faces, and no force. The stress of the swirl is
 * mu r_f (u_s/r)'; rigid rotation has none. */
#include "libcore/lattice/tiles_diffuser.h"

/* Sets the lines of the faces and cells of a tile, and of one layer of ghosts along the radius. */
static void set_turn(const struct forest *f, int tile, double *turn) {
    const struct tile *t = &f->tile[tile];
    const int radial = f->radial, other = 1 - radial;
    const double h = f->width[radial];
    for (int i = -1; i <= t->n[radial]; i++) {
        const double face = forest_radius(f, t->low[radial] + i);
        for (int j = 0; j < (f->dim > 1 ? t->n[other] : 1); j++) {
            const long at = f->first + i * f->stride[radial] + j * f->stride[other];
            turn[LEAN * f->size + at] = 0.5 * h / forest_radius(f, t->low[radial] + i + 0.5);
            turn[RING * f->size + at] = face == 0 ? 0 : 0.5 * h / face;
            turn[ON_AXIS * f->size + at] = face == 0;
        }
    }
}

status tiles_turn_make(struct gas *g) {
    if (g->forest->radial < 0) return OK;
    TRY(blocks_make(g->forest, TURN_LINES, &g->tiles->diffuser->turn));
    for (int t = 0; t < g->forest->ntiles; t++) set_turn(g->forest, t, g->tiles->diffuser->turn[t]);
    return OK;
}

double edge_widens(const struct gas *g, int tile, const struct edge *e) {
    const double *lean = turn_line(g, tile, LEAN);
    if (!lean || e->normal != g->forest->radial) return 1;
    return e->to > e->from ? 1 + lean[e->from] : 1 - lean[e->from];
}

double edge_turn(const struct gas *g, int tile, const struct edge *e) {
    return g->models.swirl && patch_is_wall(e->rules) ? edge_widens(g, tile, e) : 1;
}

double edge_turn_back(const struct gas *g, int tile, const struct edge *e) {
    const double *lean = turn_line(g, tile, LEAN);
    return e->to > e->from ? 1 - lean[e->to] : 1 + lean[e->to];
}

/* The stress along the radius and around the axis, and the work of the former. */
KERNEL static void turn_radial(int dim, long size, const double *restrict turn, const struct stress_row *restrict r,
                               double *restrict work) {
    const double *restrict a = r->face + NORMAL * size, *restrict b = r->face + SHEAR * size, *restrict keep = r->keep;
    const double *restrict u = r->S + r->axis * size, *restrict ring = turn + RING * size,
                           *restrict axis = turn + ON_AXIS * size;
    const double *restrict low = r->low + (1 - r->axis) * 3 * LINE, *restrict high = r->high + (1 - r->axis) * 3 * LINE;
    double *restrict stress = r->out[r->axis], *restrict hoop = r->out[HOOP], side[LINE] = {0};
    const long step = r->step;
    for (int i = 0; i < r->n && dim > 1; i++) side[i] = (keep ? r->h * keep[i] : r->h) * (low[i] + high[i]);
    for (int i = 0; i < r->n; i++) {
        const double jump = u[i] - u[i - step], sum = u[i - step] + u[i];
        const double around = ring[i] * sum + axis[i] * jump, all = jump + (side[i] + around);
        hoop[i] = (a[i] - 2 * b[i]) * all + 2 * b[i] * around;
        stress[i] = a[i] * all - 2 * b[i] * (side[i] + around);
        work[i] = stress[i] * (0.5 * sum);
    }
}

/* The stress of component t of the velocity, and its work; lean: of the swirl, else NULL. */
KERNEL static void turn_shear(int dim, int t, long size, const double *restrict lean,
                              const struct stress_row *restrict r, double *restrict work) {
    const double *restrict b = r->face + SHEAR * size, *restrict v = r->S + t * size, *restrict keep = r->keep;
    const double *restrict low = r->low + (t * dim + r->axis) * LINE, *restrict high =
                                                                          r->high + (t * dim + r->axis) * LINE;
    double *restrict out = r->out[t], along[LINE] = {0};
    const long step = r->step;
    for (int i = 0; i < r->n && t < dim; i++) along[i] = (keep ? r->h * keep[i] : r->h) * (low[i] + high[i]);
    for (int i = 0; i < r->n && !lean; i++) {
        out[i] = b[i] * ((v[i] - v[i - step]) + along[i]);
        work[i] += out[i] * (0.5 * (v[i - step] + v[i]));
    }
    for (int i = 0; i < r->n && lean; i++) {
        const double above = (1 - lean[i]) * v[i], below = (1 + lean[i - step]) * v[i - step];
        out[i] = b[i] * ((above - below) + along[i]);
        work[i] += out[i] * (0.5 * (below + above));
    }
}

void turn_faces(const struct gas *g, bool ends, const double *turn, const struct stress_row *r) {
    double room[LINE], *work = ends ? r->out[g->components] : room;
    turn_radial(g->dim, g->size, turn, r, work);
    for (int t = 0; t < g->components; t++)
        if (t != r->axis)
            turn_shear(g->dim, t, g->size, t == g->models.swirl && t > 0 ? turn + LEAN * g->size : NULL, r, work);
}

enum weighting { BY_AREA, BY_MOMENT, WITH_HOOP };

ALWAYS_INLINE void turn_weigh(enum weighting how, const struct turn_row *restrict r) {
    const double *restrict lean = r->turn, *restrict low = r->low, *restrict high = r->high;
    const double *restrict first = r->along[0], *restrict last = r->along[1];
    const double *restrict hoop_low = r->hoop_low, *restrict hoop_high = r->hoop_high;
    double *restrict out = r->out;
    for (int i = 0; i < r->n; i++) {
        const double q = lean[i], below = 1 - q, above = 1 + q;
        out[i] = how == BY_MOMENT ? ((above * above) * high[i] - (below * below) * low[i]) / (1 + q * q)
                                  : above * high[i] - below * low[i];
        if (how == WITH_HOOP) out[i] -= q * (hoop_low[i] + hoop_high[i]);
    }
    for (int i = 0; i < r->n && first; i++) out[i] += last[i] - first[i];
}

KERNEL static void turn_sum(enum weighting how, const struct turn_row *restrict r) {
    if (how == BY_MOMENT)
        turn_weigh(BY_MOMENT, r);
    else if (how == WITH_HOOP)
        turn_weigh(WITH_HOOP, r);
    else
        turn_weigh(BY_AREA, r);
}

void turn_gain(const struct gas *g, const struct turn_row *r) {
    const bool around = g->models.swirl && r->line == g->models.swirl;
    turn_sum(r->line == g->forest->radial ? WITH_HOOP : around ? BY_MOMENT : BY_AREA, r);
}

/* Sums what goes through the faces of n cells along all axes: lines of flux[axis] at the faces below them. */
static void turn_through(const struct gas *g, int n, const double *turn, const double *const flux[2],
                         const long step[2], double *out) {
    const int radial = g->forest->radial, axial = 1 - radial;
    turn_sum(BY_AREA, &(struct turn_row){
                          .n = n,
                          .low = flux[radial],
                          .high = flux[radial] + step[radial],
                          .along = {g->dim > 1 ? flux[axial] : NULL, g->dim > 1 ? flux[axial] + step[axial] : NULL},
                          .turn = turn,
                          .out = out});
}

/* The heat that flows down through the faces below and above n cells along an axis. */
KERNEL static void turn_flow(int n, long step, const double *restrict heat, const double *restrict S,
                             double *restrict below, double *restrict above) {
    for (int i = 0; i < n; i++) {
        below[i] = heat[i] * (S[i] - S[i - step]);
        above[i] = heat[i + step] * (S[i + step] - S[i]);
    }
}

void turn_heat(const struct gas *g, int n, const double *turn, const double *face, const double *S, double *out) {
    double flow[2][2][BATCH];
    const double *flux[2] = {flow[0][0], flow[1][0]};
    const long step[2] = {BATCH, BATCH};
    for (int axis = 0; axis < g->dim; axis++)
        turn_flow(n, g->forest->stride[axis], face + (FACE_LINES * axis + CONDUCTION) * g->size, S, flow[axis][0],
                  flow[axis][1]);
    turn_through(g, n, turn, flux, step, out);
}

void turn_cross(const struct gas *g, int n, const double *turn, const double *cross, double *out) {
    turn_through(g, n, turn, (const double *const[]){cross, cross + g->size}, g->forest->stride, out);
}

/* Adds the weights of the faces across the radius. Those of the radial stress are the diagonal of its operator, which
 * is tridiagonal, so that no eigenvalue exceeds twice the largest one. */
KERNEL static void turn_rates(int n, long step, long size, const double *restrict turn, const double *restrict face,
                              double (*restrict rate)[BATCH]) {
    const double *restrict normal = face + NORMAL * size, *restrict shear = face + SHEAR * size;
    const double *restrict heat = face + CONDUCTION * size, *restrict ring = turn + RING * size;
    for (int i = 0; i < n; i++) {
        const double q = turn[i], a = normal[i], b = shear[i], c = normal[i + step], d = shear[i + step];
        const double below = a * ((1 - q) + q * ring[i]) + 2 * q * (a - 2 * b);
        const double above = c * ((1 + q) + q * ring[i + step]) - 2 * q * (c - 2 * d);
        const double middle = 4 * (a - b); /* of the face on the axis, where q is 1 */
        rate[0][i] += select_double(turn[ON_AXIS * size + i] > 0, middle, below) + above;
        rate[1][i] += (1 - q) * heat[i] + (1 + q) * heat[i + step];
    }
}

void tiles_turn_rates(const struct gas *g, int n, const double *turn, const double *face, double (*rate)[BATCH]) {
    turn_rates(n, g->forest->stride[g->forest->radial], g->size, turn, face, rate);
}
