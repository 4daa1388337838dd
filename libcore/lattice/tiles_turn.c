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

struct axis_turn { /* the axes of the mesh and the component around the axis */
    int dim, components, radial, swirl;
    long size;
};

static struct axis_turn axes_of(const struct gas *g) {
    return (struct axis_turn){g->dim, g->components, g->forest->radial, g->models.swirl, g->size};
}

/* The stress along the radius and around the axis, and what both do in the end; `side`: the slope along the axis. */
ALWAYS_INLINE double radial_stress(const struct stress_row *r, const double *restrict turn, long size, int i,
                                   double side) {
    const double *u = r->S + r->axis * size + i, a = r->face[NORMAL * size + i], b = r->face[SHEAR * size + i];
    const double jump = u[0] - u[-r->step], sum = u[-r->step] + u[0];
    const double ring = turn[RING * size + i] * sum + turn[ON_AXIS * size + i] * jump, all = jump + (side + ring);
    r->out[HOOP][i] = (a - 2 * b) * all + 2 * b * ring;
    return a * all - 2 * b * (side + ring);
}

KERNEL static void turn_stress(const struct axis_turn *x, bool ends, const double *restrict turn,
                               const struct stress_row *restrict r) {
    const int axial = 1 - r->axis, dim = x->dim;
    const long size = x->size, step = r->step;
    const double *restrict lean = turn + LEAN * size;
    for (int i = 0; i < r->n; i++) {
        const double wide = r->keep ? r->h * r->keep[i] : r->h, b = r->face[SHEAR * size + i];
        const double *low = r->low + i, *high = r->high + i, *u = r->S + r->axis * size + i;
        const double side = dim > 1 ? wide * (low[axial * 3 * LINE] + high[axial * 3 * LINE]) : 0;
        const double stress = radial_stress(r, turn, size, i, side);
        double work = stress * (0.5 * (u[-step] + u[0]));
        r->out[r->axis][i] = stress;
        for (int t = 0; t < x->components; t++) {
            const double *v = r->S + t * size + i;
            if (t == r->axis) continue;
            const bool around = x->swirl && t == x->swirl;
            const double above = around ? (1 - lean[i]) * v[0] : v[0],
                         below = around ? (1 + lean[i - step]) * v[-step] : v[-step];
            const double along =
                t < dim ? wide * (low[(t * dim + r->axis) * LINE] + high[(t * dim + r->axis) * LINE]) : 0;
            const double shear = b * ((above - below) + along);
            work += shear * (0.5 * (below + above));
            r->out[t][i] = shear;
        }
        if (ends) r->out[x->components][i] = work;
    }
}

void turn_faces(const struct gas *g, bool ends, const double *turn, const struct stress_row *r) {
    const struct axis_turn x = axes_of(g);
    turn_stress(&x, ends, turn, r);
}

enum weighting { BY_AREA, BY_MOMENT, WITH_HOOP };

KERNEL static void turn_sum(enum weighting how, const struct turn_row *restrict r) {
    const double *restrict lean = r->turn, *restrict low = r->low, *restrict high = r->high;
    for (int i = 0; i < r->n; i++) {
        const double q = lean[i], below = 1 - q, above = 1 + q;
        double sum;
        if (how == BY_MOMENT)
            sum = ((above * above) * high[i] - (below * below) * low[i]) / (1 + q * q);
        else
            sum = above * high[i] - below * low[i];
        if (how == WITH_HOOP) sum -= q * (r->hoop_low[i] + r->hoop_high[i]);
        r->out[i] = r->along[0] ? sum + (r->along[1][i] - r->along[0][i]) : sum;
    }
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
