/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscous stress and heat conduction on a lattice, second order: fluxes on the faces from the jumps across them, with
 * the tangential derivatives of velocity as means of the two cells' central differences. Tangential derivatives need
 * the neighbours' own neighbours, so they have ghosts of their own (tiles_sums.c). */
#include "libcore/lattice/tiles_diffuser.h"

/* The cells of a row in whole vectors of 8. What is computed beyond the row does no harm: it goes to ghosts, which are
 * filled again before they are read, and to padding, where 1/rho is 0. */
static int padded(int n) {
    return (n + 7) / 8 * 8;
}

struct sweep { /* one stage of a tile, or its end */
    struct gas *g;
    enum diffusing what;
    int tile;
    const double *S, *c; /* c: of the next stage, next_sum; NULL: this was the last one */
    double *next;
    const double *Y0; /* of the end */
    const double *E;  /* that the work is added to: of Y0, and the heat of friction on walls */
    double *to, dt;
    long bad;
};

static void end_row(struct sweep *s, long at, int n, double (*M)[BATCH]) {
    s->bad += move_row(s->g, &(struct moved){s->what, {s->tile, at, n}, s->Y0, s->E, s->to, s->dt, M});
}

/* The heat that conduction brings to a cell, at which the lines stand. Terms that a swap of axes or a mirror exchanges
 * are added without fma. */
ALWAYS_INLINE double heat_gain(int dim, const long *stride, long size, const double *face, const double *S) {
    double sum = 0;
    for (int axis = 0; axis < dim; axis++) {
        const double *heat = face + (FACE_LINES * axis + CONDUCTION) * size;
        const long step = stride[axis];
        const double here = heat[step] * (S[step] - S[0]) - heat[0] * (S[0] - S[-step]);
        sum = axis ? sum + here : here;
    }
    return sum;
}

ALWAYS_INLINE void heat_next(int n, int dim, const long *stride, long size, const double *restrict face,
                             const double *restrict friction, const struct stage_row *restrict r) {
    const double *c = r->c, *light = r->light, *start = r->start, *last = r->last;
    double *next = r->next;
    for (int i = 0; i < n; i++)
        next[i] = next_sum(c, last[i], next[i], heat_gain(dim, stride, size, face + i, last + i), light[i], start[i]) +
                  c[4] * friction[i];
}

ALWAYS_INLINE void heat_gains(int n, int dim, const long *stride, long size, const double *restrict face,
                              const double *restrict S, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = heat_gain(dim, stride, size, face + i, S + i);
}

ALWAYS_INLINE void heat_sweep(struct sweep *s, int dim, bool round) {
    const struct forest *f = s->g->forest;
    const struct diffuser *d = s->g->tiles->diffuser;
    const double *turn = round ? turn_line(s->g, s->tile, 0) : NULL;
    const int *n = f->tile[s->tile].n, vectors = padded(n[0]);
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++) {
            const long at = f->first + j * f->stride[1] + k * f->stride[2];
            const double *face = d->face[s->tile] + at;
            double M[1][BATCH];
            const double *friction = s->g->diffusion.friction[s->tile] + at;
            const struct stage_row row = {s->c, d->light[s->tile] + at, d->start[s->tile] + at, s->S + at,
                                          s->next + at};
            if (turn)
                turn_heat(s->g, vectors, turn + at, face, friction, &row, s->c ? NULL : M[0]);
            else if (s->c)
                heat_next(vectors, dim, f->stride, f->size, face, friction, &row);
            else
                heat_gains(vectors, dim, f->stride, f->size, face, s->S + at, M[0]);
            if (!s->c) end_row(s, at, n[0], M);
        }
}

ALWAYS_INLINE void divergence_row(int n, long step, double quarter, const double *restrict q,
                                  const double *restrict lean, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = half_divergence(q + i, step, quarter, lean[i]);
}

enum { EVERY_AXIS = -1 };

/* Does the stress on faces across an axis take line k dim + c, the derivative of component c along axis k? */
ALWAYS_INLINE bool takes(int axis, int dim, int line) {
    const int along = line / dim, c = line % dim;
    return axis == EVERY_AXIS || (along != axis && (c == along || c == axis));
}

/* The gradients of n cells, as far as faces across an axis take them. */
ALWAYS_INLINE void cell_gradients(int n, int dim, int axis, const struct forest *f, const double *S, double *out) {
    for (int c = 0; c < dim; c++) {
        const double *restrict q = S + c * f->size;
        double *restrict to = out + c * LINE;
        const double quarter[] = {0.25 / f->width[0], 0.25 / f->width[1], 0.25 / f->width[2]};
        const long second = f->stride[1], third = f->stride[2];
        EACH_ALONE
        for (int i = 0; i < n; i++) {
            if (takes(axis, dim, c)) to[i] = half_derivative(q + i, 1, quarter[0]);
            if (dim > 1 && takes(axis, dim, dim + c)) to[dim * LINE + i] = half_derivative(q + i, second, quarter[1]);
            if (dim > 2 && takes(axis, dim, 2 * dim + c))
                to[2 * dim * LINE + i] = half_derivative(q + i, third, quarter[2]);
        }
    }
}

/* The gradients of a row of cells, or in a row of ghosts the derivatives along the side, as far as faces across an axis
 * take them. That of the velocity along the radius is its divergence in the body of revolution, as the stress along the
 * axis wants. */
ALWAYS_INLINE void row_gradients(const struct sweep *s, int dim, int axis, int j, int k, const double *turn,
                                 double *out) {
    const struct forest *f = s->g->forest;
    const int *n = f->tile[s->tile].n, vectors = padded(n[0]), lines = SHEET_LINES(dim);
    const double *S = s->S, *sheet = s->g->tiles->diffuser->sheet[s->tile];
    const long at = f->first + j * f->stride[1] + k * f->stride[2];
    const int side = j < 0 ? 2 : j >= n[1] ? 3 : k < 0 ? 4 : k >= n[2] ? 5 : 0;
    double *row = out + EDGE;
    if (side) {
        const double *beyond = sheet + forest_sheet(f, 2 * dim + side, lines, 0) + (side < 4 ? k : j) * n[0];
        for (int line = 0; line < dim * dim; line++)
            if (takes(side / 2, dim, line))
                memcpy(row + line * LINE, beyond + sheet_line(side / 2, line / dim, line % dim) * f->sheet,
                       (size_t)vectors * sizeof *row);
        return;
    }
    cell_gradients(vectors, dim, axis, f, S + at, row);
    if (axis != EVERY_AXIS) return;
    if (turn) {
        const int radial = f->radial, line = radial * (dim + 1);
        divergence_row(vectors, f->stride[radial], 0.25 / f->width[radial], S + radial * f->size + at, turn + at,
                       row + line * LINE);
    }
    for (int line = 0; line < dim * dim; line++) {
        const double *beyond = sheet + sheet_line(0, line / dim, line % dim) * f->sheet + k * n[1] + j;
        if (!takes(0, dim, line)) continue;
        row[line * LINE - 1] = beyond[forest_sheet(f, 2 * dim, lines, 0)];
        row[line * LINE + n[0]] = beyond[forest_sheet(f, 2 * dim + 1, lines, 0)];
    }
}

ALWAYS_INLINE struct stress_row stress_row(const struct sweep *s, int axis, bool plain, long at, const double *low,
                                           const double *high, double (*out)[LINE]) {
    const struct forest *f = s->g->forest;
    const struct diffuser *d = s->g->tiles->diffuser;
    return (struct stress_row){.n = padded(f->tile[s->tile].n[0] + (axis == 0)),
                               .axis = axis,
                               .h = f->width[axis],
                               .step = axis ? f->stride[axis] : 1,
                               .face = d->face[s->tile] + FACE_LINES * axis * f->size + at,
                               .keep = plain ? d->keep[s->tile] + axis * f->size + at : NULL,
                               .low = low,
                               .high = high,
                               .S = s->S + at,
                               .out = out};
}

/* Through the faces of a row: stress of S (the flux of momentum inwards), and in the end its work on S. With a =
 * (lambda + 2 mu)/h^2, b = mu/h^2, the difference d of u, and the tangential derivative s/h of v the normal stress is a
 * d + (a - 2 b) s. Of the m components of u those from dim on lie along axes without derivatives: their stress is b d
 * alone. */
ALWAYS_INLINE void viscous_faces(int dim, int m, bool ends, long size, struct stress_row r) {
    const double *face = r.face, *keep = r.keep, *low = r.low, *high = r.high;
    const double *S = r.S, *u = S + r.axis * size, h = r.h;
    double(*out)[LINE] = r.out;
    const int axis = r.axis, n = r.n;
    const long step = r.step;
    EACH_ALONE
    for (int i = 0; i < n; i++) {
        double side = 0;
        UNROLL
        for (int t = 0; t < dim; t++)
            if (t != axis) side += low[(t * dim + t) * LINE + i] + high[(t * dim + t) * LINE + i];
        side *= keep ? h * keep[i] : h;
        const double a = face[NORMAL * size + i], b = face[SHEAR * size + i];
        double stress = dim > 1 ? a * ((u[i] - u[i - step]) + side) - b * (side + side) : a * (u[i] - u[i - step]);
        double work = stress * (0.5 * (u[i - step] + u[i]));
        out[axis][i] = stress;
        UNROLL
        for (int t = 0; t < dim; t++) {
            const double *v = S + t * size + i;
            if (t == axis) continue;
            side = low[(t * dim + axis) * LINE + i] + high[(t * dim + axis) * LINE + i];
            side *= keep ? h * keep[i] : h;
            double shear = b * ((v[0] - v[-step]) + side);
            work += shear * (0.5 * (v[-step] + v[0]));
            out[t][i] = shear;
        }
        UNROLL
        for (int t = dim; t < m; t++) {
            const double *v = S + t * size + i, shear = b * (v[0] - v[-step]);
            work += shear * (0.5 * (v[-step] + v[0]));
            out[t][i] = shear;
        }
        if (ends) out[m][i] = work;
    }
}

struct faces_around { /* a row of cells: the faces along axis 0; those below and above along the other axes */
    const double *restrict x, *restrict y[2], *restrict z[2];
};

/* The gain of a cell by its faces. */
ALWAYS_INLINE double gain(int dim, int i, const struct faces_around *restrict f) {
    double sum = f->x[i + 1] - f->x[i];
    if (dim > 1) sum += f->y[1][i] - f->y[0][i];
    if (dim > 2) sum += f->z[1][i] - f->z[0][i];
    return sum;
}

ALWAYS_INLINE void gain_row(int n, int dim, const struct faces_around *restrict f, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = gain(dim, i, f);
}

ALWAYS_INLINE void next_row(int n, int dim, const struct faces_around *restrict f, const struct stage_row *restrict r) {
    const double *c = r->c, *light = r->light, *start = r->start, *last = r->last;
    double *next = r->next;
    for (int i = 0; i < n; i++) next[i] = next_sum(c, last[i], next[i], gain(dim, i, f), light[i], start[i]);
}

ALWAYS_INLINE void faces_of(int dim, int m, bool ends, const struct sweep *s, const double *turn, long size,
                            struct stress_row r) {
    if (turn && r.axis == s->g->forest->radial) {
        const struct stress_row across = r;
        turn_faces(s->g, ends, turn + (r.S - s->S), &across);
    } else {
        viscous_faces(dim, m, ends, size, r);
    }
}

struct row_lines { /* lines of the faces around a row of cells, as struct faces_around has them */
    double (*x)[LINE], (*y[2])[LINE], (*z[2])[LINE];
};

/* What a row of cells gains in line v in a body of revolution. */
static void turn_gain_of(const struct sweep *s, int v, const double *turn, const struct row_lines *l,
                         const struct stage_row *to, double *out) {
    const bool across = s->g->forest->radial == 0; /* is it axis 0 that leads along the radius? */
    const double *x[2] = {l->x[v], l->x[v] + 1}, *y[2] = {l->y[0][v], l->y[1][v]};
    const double **radial = across ? x : y, **axial = across ? y : x;
    turn_gain(s->g, &(struct turn_row){.n = padded(s->g->forest->tile[s->tile].n[0]),
                                       .line = v,
                                       .low = radial[0],
                                       .high = radial[1],
                                       .hoop_low = across ? l->x[HOOP] : l->y[0][HOOP],
                                       .hoop_high = across ? l->x[HOOP] + 1 : l->y[1][HOOP],
                                       .along = {axial[0], axial[1]},
                                       .turn = turn,
                                       .out = out,
                                       .to = *to});
}

/* Takes what the faces bring to a row of cells: to S of the next stage, or in the end to M. */
ALWAYS_INLINE void take_gains(struct sweep *s, int dim, int lines, const double *turn, long at,
                              const struct row_lines *l, double (*M)[BATCH]) {
    const struct diffuser *d = s->g->tiles->diffuser;
    const int vectors = padded(s->g->forest->tile[s->tile].n[0]);
    const long size = s->g->forest->size;
    for (int v = 0; v < lines; v++) {
        const struct faces_around around = {l->x[v], {l->y[0][v], l->y[1][v]}, {l->z[0][v], l->z[1][v]}};
        const long to = v * size + at;
        const struct stage_row row = {s->c, d->light[s->tile] + at, d->start[s->tile] + to, s->S + to, s->next + to};
        if (turn)
            turn_gain_of(s, v, turn + at, l, &row, M ? M[v] : NULL);
        else if (M)
            gain_row(vectors, dim, &around, M[v]);
        else
            next_row(vectors, dim, &around, &row);
    }
}

/* Notes the stress on the sides of a tile that row (j, k) touches; lines as in viscous_sweep. */
static void note_sides(const struct sweep *s, int j, int k, const double *x, const double *low, const double *high,
                       const double *z0, const double *z1) {
    struct gas *g = s->g;
    const struct forest *f = g->forest;
    const int *n = f->tile[s->tile].n;
    const long at = f->first + j * f->stride[1] + k * f->stride[2];
    const double per = 1 / s->dt;
    tiles_tally_stress(g, s->tile, 0, at, 1, per, x, LINE);
    tiles_tally_stress(g, s->tile, 1, at + n[0] - 1, 1, per, x + n[0], LINE);
    if (g->dim > 1 && j == 0) tiles_tally_stress(g, s->tile, 2, at, n[0], per, low, LINE);
    if (g->dim > 1 && j == n[1] - 1) tiles_tally_stress(g, s->tile, 3, at, n[0], per, high, LINE);
    if (g->dim > 2 && k == 0) tiles_tally_stress(g, s->tile, 4, at, n[0], per, z0, LINE);
    if (g->dim > 2 && k == n[2] - 1) tiles_tally_stress(g, s->tile, 5, at, n[0], per, z1, LINE);
}

/* The faces above a row of cells along axis 2, or below the tile with k = -1. here: gradients of the row, if it is one
 * of cells. */
ALWAYS_INLINE void faces_above(const struct sweep *s, int m, bool ends, bool plain, int j, int k, const double *here,
                               double (*out)[LINE]) {
    const struct forest *f = s->g->forest;
    const long top = f->first + j * f->stride[1] + (k + 1) * f->stride[2];
    _Alignas(64) double low[MAX_DIM * MAX_DIM * LINE], high[MAX_DIM * MAX_DIM * LINE];
    if (k < 0) row_gradients(s, 3, 2, j, k, NULL, low);
    row_gradients(s, 3, 2, j, k + 1, NULL, high);
    viscous_faces(3, m, ends, f->size, stress_row(s, 2, plain, top, (k < 0 ? low : here) + EDGE, high + EDGE, out));
}

ALWAYS_INLINE void ask_for(int n, const double *row) {
    for (int i = 0; i < n; i += 8) __builtin_prefetch(row + i);
}

/* Asks memory for the lines that the next row reads first. A sweep in 3D reads more lines side by side than the
 * processor can ask for in time. */
ALWAYS_INLINE void ask_for_next(const struct sweep *s, int dim, int m, long at) {
    const struct forest *f = s->g->forest;
    const struct diffuser *d = s->g->tiles->diffuser;
    const int n = f->tile[s->tile].n[0];
    if (dim < 3) return;
    at += f->stride[1];
    for (int axis = 0; axis < dim; axis++) {
        const double *face = d->face[s->tile] + FACE_LINES * axis * f->size + at + (axis ? f->stride[axis] : 0);
        ask_for(n, face + NORMAL * f->size);
        ask_for(n, face + SHEAR * f->size);
    }
    for (int v = 0; v < m; v++) {
        ask_for(n, s->S + v * f->size + at + f->stride[1] + f->stride[2]);
        ask_for(n, s->next + v * f->size + at);
        ask_for(n, d->start[s->tile] + v * f->size + at);
    }
    ask_for(n, d->light[s->tile] + at);
}

/* The gradients of a row, and the faces below it along axis 1, serve two rows each, so two buffers take odd and even
 * rows in turn; faces along axis 2 serve two planes, and two buffers take odd and even planes. */
ALWAYS_INLINE void viscous_sweep(struct sweep *s, int dim, int m, bool ends, bool plain, bool round) {
    const struct forest *f = s->g->forest;
    const int *n = f->tile[s->tile].n;
    const long size = f->size, *stride = f->stride;
    _Alignas(64) double x[STRESS_LINES][LINE] = {{0}}, y[2][STRESS_LINES][LINE], M[4][BATCH];
    _Alignas(64) double gradient[2][MAX_DIM * MAX_DIM * LINE];
    const double *turn = round ? turn_line(s->g, s->tile, 0) : NULL;
    double(*z[2])[STRESS_LINES][LINE] = {s->g->tiles->diffuser->plane[0], s->g->tiles->diffuser->plane[1]};
    for (int j = 0; dim > 2 && j < n[1]; j++) faces_above(s, m, ends, plain, j, -1, NULL, z[0][j]);
    for (int k = 0; k < n[2]; k++)
        for (int j = dim > 1 ? -1 : 0; j < n[1]; j++) {
            const long at = f->first + j * stride[1] + k * stride[2], above = at + stride[1];
            ask_for_next(s, dim, m, at);
            double *here = gradient[j & 1], *next = gradient[(j + 1) & 1], (*low)[LINE] = y[j & 1],
                   (*high)[LINE] = y[(j + 1) & 1];
            if (j >= 0)
                faces_of(dim, m, ends, s, turn, size, stress_row(s, 0, plain, at, here + EDGE - 1, here + EDGE, x));
            else
                row_gradients(s, dim, EVERY_AXIS, j, k, turn, here);
            if (dim > 1) {
                row_gradients(s, dim, EVERY_AXIS, j + 1, k, turn, next);
                faces_of(dim, m, ends, s, turn, size, stress_row(s, 1, plain, above, here + EDGE, next + EDGE, high));
            }
            if (j < 0) continue;
            double(*bottom)[LINE] = dim > 2 ? z[k & 1][j] : NULL, (*top)[LINE] = dim > 2 ? z[(k + 1) & 1][j] : NULL;
            if (dim > 2) faces_above(s, m, ends, plain, j, k, here, top);
            if (ends && s->g->books.tally) note_sides(s, j, k, x[0], low[0], high[0], bottom[0], top[0]);
            take_gains(s, dim, m + ends, turn, at, &(struct row_lines){x, {low, high}, {bottom, top}}, ends ? M : NULL);
            if (ends) end_row(s, at, n[0], M);
        }
}

#define SWEEP(name, dim, m, round)                                                                                     \
    KERNEL static void name##_##dim##d_##m(struct sweep *s, bool plain) {                                              \
        if (s->what == HEAT)                                                                                           \
            heat_sweep(s, dim, round);                                                                                 \
        else if (plain)                                                                                                \
            s->c ? viscous_sweep(s, dim, m, false, true, round) : viscous_sweep(s, dim, m, true, true, round);         \
        else                                                                                                           \
            s->c ? viscous_sweep(s, dim, m, false, false, round) : viscous_sweep(s, dim, m, true, false, round);       \
    }
SWEEP(sweep, 1, 1, false)
SWEEP(sweep, 1, 2, false)
SWEEP(sweep, 1, 3, false)
SWEEP(sweep, 2, 2, false)
SWEEP(sweep, 2, 3, false)
SWEEP(sweep, 3, 3, false)
SWEEP(round_sweep, 1, 1, true)
SWEEP(round_sweep, 1, 2, true)
SWEEP(round_sweep, 1, 3, true)
SWEEP(round_sweep, 2, 2, true)
SWEEP(round_sweep, 2, 3, true)

typedef void sweep_function(struct sweep *s, bool plain);
/* In the plane, and of bodies of revolution, by the dimension and the components of u beyond it. */
static sweep_function *const sweeps[2][3][3] = {
    {{sweep_1d_1, sweep_1d_2, sweep_1d_3}, {sweep_2d_2, sweep_2d_3, NULL}, {sweep_3d_3, NULL, NULL}},
    {{round_sweep_1d_1, round_sweep_1d_2, round_sweep_1d_3}, {round_sweep_2d_2, round_sweep_2d_3, NULL}}};

static void sweep_tile(struct sweep *s) {
    const struct diffuser *d = s->g->tiles->diffuser;
    s->S = d->sum[s->g->diffusion.last][s->tile];
    s->next = d->sum[1 - s->g->diffusion.last][s->tile];
    sweeps[d->turn != NULL][s->g->dim - 1][s->g->components - s->g->dim](s, d->plain);
}

void tiles_diffusion_stage(struct gas *g, enum diffusing what, const struct state *Y0, const double c[5],
                           double weight) {
    const double factor[5] = {c[0], c[1], what == HEAT ? temperature_of(&g->models.material, c[2]) : c[2], c[2] + c[3],
                              c[4]};
    (void)Y0;
    tiles_fill_sums(g, what, weight);
    for (int t = 0; t < g->forest->ntiles; t++)
        sweep_tile(&(struct sweep){.g = g, .what = what, .tile = t, .c = factor});
    g->diffusion.last = 1 - g->diffusion.last;
}

struct ending_sums { /* what slide_edge needs */
    double weight, dt;
};

/* Gas that slips along a wall leaves there the work tau (u - w) of the stress on it less what the wall gets of that:
 * with the jump w - S of the share a it is the coefficient times a (1 - a/2) (w - S)^2, of which a part stays. */
static void slide_edge(struct gas *g, int tile, const struct edge *e, const void *context) {
    const struct ending_sums *ending = context;
    const long size = g->forest->size, face = e->to > e->from ? e->to : e->from;
    const double *S = g->diffusion.sum[g->diffusion.last][tile], *wall = g->tiles->diffuser->wall[tile];
    const double *shear = g->tiles->diffuser->face[tile] + (FACE_LINES * e->normal + SHEAR) * size;
    const double turn = edge_turn(g, tile, e), wide = edge_widens(g, tile, e);
    if (!wall_slides(e->rules)) return;
    for (int i = 0; i < e->n; i++) {
        const long at = e->from + i * e->step, beyond = e->to + i * e->step;
        const double a = wall[DRAG * size + beyond];
        double w[MAX_DIM], square = 0;
        wall_velocity(e->rules, g->components, e->face[i], w);
        for (int k = 0; k < g->components; k++) {
            const double u = S[k * size + at], jump = ending->weight * w[k] - (k == g->models.swirl ? turn * u : u);
            if (k != e->normal) square += jump * jump;
        }
        const double gain =
            wall[STAYS * size + beyond] * shear[face + i * e->step] * a * (1 - 0.5 * a) * square / ending->dt;
        g->tiles->work.p[at] += wide * gain;
        if (g->books.tally) tiles_tally_friction(g, tile, e, i, gain);
    }
}

static bool slides_anywhere(const struct gas *g, const struct tile *t) {
    bool slides = false;
    for (int side = 0; side < 2 * g->dim; side++)
        if (t->side[side].patch >= 0) slides |= wall_slides(&g->patches.rules[t->side[side].patch]);
    return slides;
}

/* The energy that the work of the stress is added to; where walls add to it a line of the workspace. */
static const double *energy_of(struct gas *g, enum diffusing what, int tile, const double *Y0,
                               const struct ending_sums *ending) {
    const long size = g->forest->size;
    const double *E = Y0 + energy_at(g) * size;
    if (what != VISCOUS || !slides_anywhere(g, &g->forest->tile[tile])) return E;
    memcpy(g->tiles->work.p, E, (size_t)size * sizeof *E);
    edges_visit(g, tile, slide_edge, ending);
    return g->tiles->work.p;
}

long tiles_diffusion_end(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to, double dt,
                         double weight) {
    const struct ending_sums ending = {weight, dt};
    long bad = 0;
    tiles_fill_sums(g, what, weight);
    if (g->books.tally && what == HEAT) tiles_tally_heat(g);
    for (int t = 0; t < g->forest->ntiles; t++) {
        struct sweep s = {.g = g, .what = what, .tile = t, .Y0 = Y0->block[t], .to = to->block[t], .dt = dt};
        s.E = energy_of(g, what, t, Y0->block[t], &ending);
        sweep_tile(&s);
        bad += s.bad;
    }
    return bad;
}

/* Leaves the tangential derivatives out of the stress on the faces of flagged cells, and the gradient of rho out of
 * their heat flux. */
static void plain_faces(struct gas *g, int tile) {
    const struct forest *f = g->forest;
    const double *flag = g->limits.flags.cells[tile];
    for (int axis = 0; axis < g->dim; axis++) {
        double *keep = g->tiles->diffuser->keep[tile] + axis * f->size;
        double *cross = g->diffusion.terms.cross ? g->tiles->diffuser->cross[tile] + axis * f->size : NULL;
        for (long i = f->stride[axis]; i < f->size; i++) {
            const bool flagged = flag[i - f->stride[axis]] + flag[i] > 0;
            keep[i] = flagged || g->diffusion.terms.diagonal ? 0 : 1;
            if (cross && flagged) cross[i] = 0;
        }
    }
}

void tiles_plain_faces(struct gas *g) {
    if (!g->diffusion.plain) return;
    for (int t = 0; t < g->forest->ntiles; t++) plain_faces(g, t);
    g->tiles->diffuser->plain = true;
}
