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
        const bool edge =
            (i <= 0 && t->side[2 * radial].patch >= 0) || (i == t->n[radial] && t->side[2 * radial + 1].patch >= 0);
        for (int j = 0; j < (f->dim > 1 ? t->n[other] : 1); j++) {
            const long at = f->first + i * f->stride[radial] + j * f->stride[other];
            turn[LEAN * f->size + at] = 0.5 * h / forest_radius(f, t->low[radial] + i + 0.5);
            turn[RING * f->size + at] = face == 0 ? 0 : 0.5 * h / face;
            turn[ON_AXIS * f->size + at] = face == 0;
            turn[NEARER * f->size + at] =
                edge ? 1 : forest_radius(f, t->low[radial] + i - 0.5) / forest_radius(f, t->low[radial] + i + 0.5);
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

/* The stress along the radius and around the axis, and in the end the work of the former. */
ALWAYS_INLINE void turn_radial(int dim, bool ends, bool plain, long size, const double *restrict turn,
                               const struct stress_row *restrict r, double *restrict work) {
    const double *restrict a = r->face + NORMAL * size, *restrict b = r->face + SHEAR * size, *restrict keep = r->keep;
    const double *restrict u = r->S + r->axis * size, *restrict ring = turn + RING * size,
                           *restrict axis = turn + ON_AXIS * size;
    const double *restrict low = r->low + (1 - r->axis) * 3 * LINE, *restrict high = r->high + (1 - r->axis) * 3 * LINE;
    double *restrict stress = r->out[r->axis], *restrict hoop = r->out[HOOP];
    const long step = r->step;
    const double h = r->h;
    EACH_ALONE
    for (int i = 0; i < r->n; i++) {
        const double jump = u[i] - u[i - step], sum = u[i - step] + u[i];
        const double side = dim > 1 ? (plain ? h * keep[i] : h) * (low[i] + high[i]) : 0;
        const double around = ring[i] * sum + axis[i] * jump, all = jump + (side + around);
        hoop[i] = (a[i] - 2 * b[i]) * all + 2 * b[i] * around;
        stress[i] = a[i] * all - 2 * b[i] * (side + around);
        if (ends) work[i] = stress[i] * (0.5 * sum);
    }
}

/* The stress of component t of the velocity, and in the end its work. slopes: t has derivatives along the side. */
ALWAYS_INLINE void turn_shear(bool slopes, bool ends, bool plain, int t, long size, const struct stress_row *restrict r,
                              double *restrict work) {
    const double *restrict b = r->face + SHEAR * size, *restrict v = r->S + t * size, *restrict keep = r->keep;
    const double *restrict low = r->low + (t * 2 + r->axis) * LINE, *restrict high = r->high + (t * 2 + r->axis) * LINE;
    double *restrict out = r->out[t];
    const long step = r->step;
    const double h = r->h;
    EACH_ALONE
    for (int i = 0; i < r->n; i++) {
        const double along = slopes ? (plain ? h * keep[i] : h) * (low[i] + high[i]) : 0;
        out[i] = b[i] * ((v[i] - v[i - step]) + along);
        if (ends) work[i] += out[i] * (0.5 * (v[i - step] + v[i]));
    }
}

/* That of the swirl, which is component t. */
ALWAYS_INLINE void turn_swirl(bool ends, int t, long size, const double *restrict lean,
                              const struct stress_row *restrict r, double *restrict work) {
    const double *restrict b = r->face + SHEAR * size, *restrict v = r->S + t * size;
    double *restrict out = r->out[t];
    const long step = r->step;
    EACH_ALONE
    for (int i = 0; i < r->n; i++) {
        const double above = (1 - lean[i]) * v[i], below = (1 + lean[i - step]) * v[i - step];
        out[i] = b[i] * (above - below);
        if (ends) work[i] += out[i] * (0.5 * (below + above));
    }
}

ALWAYS_INLINE void turn_all(int dim, bool ends, bool plain, const struct gas *g, const double *turn,
                            const struct stress_row *r) {
    double *work = ends ? r->out[g->components] : NULL;
    turn_radial(dim, ends, plain, g->size, turn, r, work);
    if (dim > 1) turn_shear(true, ends, plain, 1 - r->axis, g->size, r, work);
    for (int t = dim; t < g->components; t++)
        if (t == g->models.swirl)
            turn_swirl(ends, t, g->size, turn + LEAN * g->size, r, work);
        else
            turn_shear(false, ends, plain, t, g->size, r, work);
}

#define TURN(dim)                                                                                                      \
    KERNEL static void turn_faces_##dim##d(const struct gas *g, bool ends, const double *turn,                         \
                                           const struct stress_row *r) {                                               \
        if (r->keep)                                                                                                   \
            ends ? turn_all(dim, true, true, g, turn, r) : turn_all(dim, false, true, g, turn, r);                     \
        else                                                                                                           \
            ends ? turn_all(dim, true, false, g, turn, r) : turn_all(dim, false, false, g, turn, r);                   \
    }
TURN(1)
TURN(2)

void turn_faces(const struct gas *g, bool ends, const double *turn, const struct stress_row *r) {
    g->dim > 1 ? turn_faces_2d(g, ends, turn, r) : turn_faces_1d(g, ends, turn, r);
}

enum weighting { BY_AREA, BY_MOMENT, WITH_HOOP };

/* What comes through the faces to n cells: goes to r->out, or to the next sum of its stage. */
ALWAYS_INLINE void turn_weigh(enum weighting how, int dim, bool ends, const struct turn_row *restrict r) {
    const double *restrict lean = r->turn, *restrict low = r->low, *restrict high = r->high;
    const double *restrict first = r->along[0], *restrict last = r->along[1];
    const double *restrict hoop_low = r->hoop_low, *restrict hoop_high = r->hoop_high;
    const double *restrict light = r->to.light, *restrict start = r->to.start, *restrict S = r->to.last, *c = r->to.c;
    double *restrict out = r->out, *restrict next = r->to.next;
    EACH_ALONE
    for (int i = 0; i < r->n; i++) {
        const double q = lean[i], below = 1 - q, above = 1 + q;
        double sum = how == BY_MOMENT ? ((above * above) * high[i] - (below * below) * low[i]) / (1 + q * q)
                                      : above * high[i] - below * low[i];
        if (how == WITH_HOOP) sum -= q * (hoop_low[i] + hoop_high[i]);
        if (dim > 1) sum += last[i] - first[i];
        if (ends)
            out[i] = sum;
        else
            next[i] = next_sum(c, S[i], next[i], sum, light[i], start[i]);
    }
}

ALWAYS_INLINE void turn_sums(int dim, bool ends, enum weighting how, const struct turn_row *restrict r) {
    if (how == BY_MOMENT)
        turn_weigh(BY_MOMENT, dim, ends, r);
    else if (how == WITH_HOOP)
        turn_weigh(WITH_HOOP, dim, ends, r);
    else
        turn_weigh(BY_AREA, dim, ends, r);
}

KERNEL static void turn_sum(int dim, enum weighting how, const struct turn_row *restrict r) {
    if (r->out)
        dim > 1 ? turn_sums(2, true, how, r) : turn_sums(1, true, how, r);
    else
        dim > 1 ? turn_sums(2, false, how, r) : turn_sums(1, false, how, r);
}

void turn_gain(const struct gas *g, const struct turn_row *r) {
    const bool around = g->models.swirl && r->line == g->models.swirl;
    turn_sum(g->dim, r->line == g->forest->radial ? WITH_HOOP : around ? BY_MOMENT : BY_AREA, r);
}

struct heat_lines { /* of the faces below n cells across the radius and along the axis; steps lead across them */
    int n;
    long step[2];
    const double *heat[2], *turn, *S, *friction;
    double *out;
    struct stage_row to;
};

/* What conduction brings to n cells: goes to l->out, or to the next sum of its stage. */
ALWAYS_INLINE void heat_weigh(int dim, bool ends, const struct heat_lines *restrict l) {
    const double *restrict lean = l->turn, *restrict S = l->S, *restrict radial = l->heat[0],
                           *restrict axial = l->heat[1];
    const double *restrict light = l->to.light, *restrict start = l->to.start,
                           *c = l->to.c, *restrict friction = l->friction;
    double *restrict out = l->out, *restrict next = l->to.next;
    const long r = l->step[0], a = l->step[1];
    EACH_ALONE
    for (int i = 0; i < l->n; i++) {
        double sum =
            (1 + lean[i]) * (radial[i + r] * (S[i + r] - S[i])) - (1 - lean[i]) * (radial[i] * (S[i] - S[i - r]));
        if (dim > 1) sum += axial[i + a] * (S[i + a] - S[i]) - axial[i] * (S[i] - S[i - a]);
        if (ends)
            out[i] = sum;
        else
            next[i] = next_sum(c, S[i], next[i], sum, light[i], start[i]) + c[4] * friction[i];
    }
}

KERNEL static void turn_conduct(int dim, const struct heat_lines *restrict l) {
    if (l->out)
        dim > 1 ? heat_weigh(2, true, l) : heat_weigh(1, true, l);
    else
        dim > 1 ? heat_weigh(2, false, l) : heat_weigh(1, false, l);
}

void turn_heat(const struct gas *g, int n, const double *turn, const double *face, const double *friction,
               const struct stage_row *to, double *out) {
    const int radial = g->forest->radial, axial = g->dim > 1 ? 1 - radial : radial;
    const double *heat = face + CONDUCTION * g->size;
    turn_conduct(g->dim, &(struct heat_lines){
                             .n = n,
                             .step = {g->forest->stride[radial], g->forest->stride[axial]},
                             .heat = {heat + FACE_LINES * radial * g->size, heat + FACE_LINES * axial * g->size},
                             .turn = turn,
                             .S = to->last,
                             .friction = friction,
                             .out = out,
                             .to = *to});
}

void turn_cross(const struct gas *g, int n, const double *turn, const double *cross, double *out) {
    const int radial = g->forest->radial, axial = g->dim > 1 ? 1 - radial : radial;
    const double *across = cross + radial * g->size, *along = cross + axial * g->size;
    turn_sum(g->dim, BY_AREA,
             &(struct turn_row){.n = n,
                                .low = across,
                                .high = across + g->forest->stride[radial],
                                .along = {along, along + g->forest->stride[axial]},
                                .turn = turn,
                                .out = out});
}

/* The rates of a row. Twice the largest one bounds the eigenvalues: that of plane flow, with the weights of the areas;
 * and that of the radial stress, as u_r/r stiffens the cells beside the axis. The operator of the latter is
 * tridiagonal, so that half the sums of its rows, each column times 1/r, are a bound (Gershgorin). u_r differs along
 * the axis by the shear alone. step, face: across the radius and along the axis. */
KERNEL static void turn_rates(int dim, int n, const long step[2], long size, const double *restrict turn,
                              const double *const face[2], double (*restrict rate)[BATCH]) {
    const double *restrict normal = face[0] + NORMAL * size, *restrict shear = face[0] + SHEAR * size,
                           *restrict heat = face[0] + CONDUCTION * size;
    const double *restrict ring = turn + RING * size, *restrict axis = turn + ON_AXIS * size,
                           *restrict nearer = turn + NEARER * size;
    const double *restrict along = face[1];
    const long up = step[0], on = step[1];
    for (int i = 0; i < n; i++) {
        const double q = turn[i], a = normal[i], c = normal[i + up], e = ring[i], f = ring[i + up];
        const double below = a * (1 + e + 3 * axis[i]) - 4 * q * shear[i], above = c * (1 - f) + 4 * q * shear[i + up];
        const double beside = (1 - axis[i]) * a * fabs(1 - e) / nearer[i] + c * (1 + f) * nearer[i + up];
        const double stretch = dim > 1 ? along[NORMAL * size + i] + along[NORMAL * size + i + on] : 0;
        const double slide = dim > 1 ? along[SHEAR * size + i] + along[SHEAR * size + i + on] : 0;
        const double flow = dim > 1 ? along[CONDUCTION * size + i] + along[CONDUCTION * size + i + on] : 0;
        rate[0][i] = larger((1 - q) * a + (1 + q) * c + stretch, 0.5 * (below + above + beside) + slide);
        rate[1][i] = (1 - q) * heat[i] + (1 + q) * heat[i + up] + flow;
    }
}

void tiles_turn_rates(const struct gas *g, int n, const double *turn, const double *face, double (*rate)[BATCH]) {
    const int radial = g->forest->radial, axial = g->dim > 1 ? 1 - radial : radial;
    turn_rates(g->dim, n, (const long[]){g->forest->stride[radial], g->forest->stride[axial]}, g->size, turn,
               (const double *const[]){face + FACE_LINES * radial * g->size, face + FACE_LINES * axial * g->size},
               rate);
}
