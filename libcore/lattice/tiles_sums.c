/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sums S of diffusion on a lattice (libcore/gas/diffusion.h): their start, their ghosts, and their derivatives
 * along the sides of tiles. */
#include "libcore/lattice/tiles_diffuser.h"

/* Copies the lines of q at the cells of an edge, or at its ghosts, to a batch. */
static void take_edge(long size, long at, const struct edge *e, int components, const double *q, double (*out)[BATCH]) {
    for (int c = 0; c < components; c++)
        for (int i = 0; i < e->n; i++) out[c][i] = q[c * size + at + i * e->step];
}

static void put_edge(long size, const struct edge *e, int components, double (*in)[BATCH], double *q) {
    for (int c = 0; c < components; c++)
        for (int i = 0; i < e->n; i++) q[c * size + e->to + i * e->step] = in[c][i];
}

struct beginning { /* what begin_visit needs */
    const struct gas *g;
    enum diffusing what;
    const struct state *Y0;
    int tile;
    double pending;
};

static void begin_visit(void *context, long offset, int n) {
    const struct beginning *b = context;
    double *q[MAX_DIM] = {NULL};
    for (int v = 0; v < lines_of(b->g, b->what); v++)
        q[v] = b->g->tiles->diffuser->start[b->tile] + v * b->g->size + offset;
    start_row(b->g, b->what, b->Y0, &(struct row){b->tile, offset, n}, b->pending, q);
}

KERNEL static void first_sums(long n, double factor, const double *restrict start, double *restrict S,
                              double *restrict before) {
    for (long i = 0; i < n; i++) {
        S[i] = factor * start[i];
        before[i] = 0;
    }
}

/* Does a patch of the tile hold values, so that S beyond it follows from q_0 there? */
static bool beyond_counts(const struct gas *g, const struct tile *t) {
    bool counts = false;
    for (int side = 0; side < 2 * g->dim; side++)
        if (t->side[side].patch >= 0) counts |= patch_needs_values(&g->patches.rules[t->side[side].patch]);
    return counts;
}

void tiles_diffusion_begin(struct gas *g, enum diffusing what, const struct state *Y0, double factor, double pending) {
    const struct forest *f = g->forest;
    struct diffuser *d = g->tiles->diffuser;
    if (what == VISCOUS) tiles_plain_faces(g);
    for (int t = 0; t < f->ntiles; t++) {
        struct beginning b = {g, what, Y0, t, pending};
        const bool beyond = beyond_counts(g, &f->tile[t]);
        if (beyond) ghosts_of_patches(g, t, Y0->block[t], GHOSTS, NULL);
        runs_visit(f, &f->tile[t], beyond, begin_visit, &b);
        first_sums(lines_of(g, what) * f->size, factor, d->start[t], d->sum[g->diffusion.last][t],
                   d->sum[1 - g->diffusion.last][t]);
    }
}

struct fill {
    enum diffusing what;
    double weight;
};

static void sum_edge(struct gas *g, int tile, const struct edge *e, const void *context) {
    const struct fill *fill = context;
    const long size = g->forest->size;
    const int lines = lines_of(g, fill->what);
    double *S = g->diffusion.sum[g->diffusion.last][tile], inner[MAX_DIM][BATCH], start[MAX_DIM][BATCH],
           ghost[MAX_DIM][BATCH], share[1][BATCH];
    struct sum_line line = {
        e->n, lines, fill->what == VISCOUS ? e->normal : -1, e->face, fill->weight, share[0], inner, start, ghost};
    take_edge(size, e->to, e, 1, g->tiles->diffuser->wall[tile] + DRAG * size, share);
    take_edge(size, e->from, e, lines, S, inner);
    take_edge(size, e->to, e, lines, g->tiles->diffuser->start[tile], start);
    const double turn = fill->what == VISCOUS ? edge_turn(g, tile, e) : 1;
    for (int i = 0; i < e->n && turn != 1; i++) inner[g->models.swirl][i] *= turn;
    sums_beyond(e->rules, fill->what, &line);
    carry_sums(e->rules, fill->what, &line);
    for (int i = 0; i < e->n && turn != 1 && turn != 0; i++) ghost[g->models.swirl][i] /= edge_turn_back(g, tile, e);
    put_edge(size, e, lines, ghost, S);
}

void tiles_sums_beyond(struct gas *g, enum diffusing what, double weight, int tile, int side, long at) {
    const struct side *s = &g->forest->tile[tile].side[side];
    const long step = g->forest->stride[side / 2];
    const struct edge e = {.rules = &g->patches.rules[s->patch],
                           .normal = side / 2,
                           .n = 1,
                           .from = at,
                           .to = side % 2 ? at + step : at - step,
                           .step = 1,
                           .face = s->face + face_at_side(g->forest, tile, side, at)};
    sum_edge(g, tile, &e, &(struct fill){what, weight});
}

/* The derivatives beyond a patch follow its rule for velocity: per axis a component along the side and that across it.
 */
static void sheet_edge(struct gas *g, int tile, const struct edge *e, const void *context) {
    const struct forest *f = g->forest;
    const int side = 2 * e->normal + (e->to > e->from), lines = SHEET_LINES(g->dim);
    const long at = e->face - f->tile[tile].side[side].face;
    double *sheet = g->tiles->diffuser->sheet[tile] + at, inner[MAX_DIM][BATCH], ghost[MAX_DIM][BATCH], share[1][BATCH];
    const struct sum_line line = {
        .n = e->n, .components = 2, .normal = 1, .face = e->face, .share = share[0], .inner = inner, .ghost = ghost};
    const size_t bytes = (size_t)e->n * sizeof(double);
    (void)context;
    take_edge(g->size, e->to, e, 1, g->tiles->diffuser->wall[tile] + DRAG * g->size, share);
    for (int v = 0; v < lines; v += 2) {
        for (int i = 0; i < 2; i++) memcpy(inner[i], sheet + forest_sheet(f, side, lines, v + i), bytes);
        reflect_sums(e->rules, &line);
        for (int i = 0; i < 2; i++) memcpy(sheet + forest_sheet(f, 2 * g->dim + side, lines, v + i), ghost[i], bytes);
    }
}

struct layer { /* the cells along a side of a tile: n[0] rows of n[1]; steps from row to row, from cell to cell */
    int n[2];
    long step[2];
};

KERNEL static void layer_derivatives(const struct layer *l, long across, double quarter, const double *restrict q,
                                     double *restrict out) {
    const int n = l->n[1];
    for (int k = 0; k < l->n[0]; k++, q += l->step[0], out += n)
        if (l->step[1] == 1)
            for (int i = 0; i < n; i++) out[i] = half_derivative(q + i, across, quarter);
        else
            for (int i = 0; i < n; i++) out[i] = half_derivative(q + i * l->step[1], across, quarter);
}

/* That along the radius of a body of revolution. */
static void layer_divergence(const struct layer *l, long across, double quarter, const double *q, const double *lean,
                             double *out) {
    for (int i = 0; i < l->n[1]; i++)
        out[i] = half_divergence(q + i * l->step[1], across, quarter, lean[i * l->step[1]]);
}

/* Derivatives along each side in the cells beside it, from which those beyond the side are made. */
static void side_derivatives(const struct forest *f, const struct tile *t, const double *S, const double *turn,
                             double *sheet) {
    for (int side = 0; side < 2 * f->dim; side++) {
        const int axis = side / 2, across = axis == 0 ? 1 : 0, deep = axis == 2 ? 1 : 2;
        const struct layer l = {{t->n[deep], t->n[across]}, {f->stride[deep], f->stride[across]}};
        const long first = f->first + (side % 2 ? (t->n[axis] - 1) * f->stride[axis] : 0);
        for (int line = 0; line < SHEET_LINES(f->dim); line++) {
            const int other = line / 2, k = other + (other >= axis), c = line % 2 ? axis : k;
            const double quarter = 0.25 / f->width[k], *q = S + c * f->size + first;
            double *to = sheet + forest_sheet(f, side, SHEET_LINES(f->dim), line);
            if (turn && k == f->radial && c == k)
                layer_divergence(&l, f->stride[k], quarter, q, turn + first, to);
            else
                layer_derivatives(&l, f->stride[k], quarter, q, to);
        }
    }
}

static void fill_sheets(struct gas *g) {
    const struct forest *f = g->forest;
    struct diffuser *d = g->tiles->diffuser;
    for (int t = 0; t < f->ntiles; t++)
        side_derivatives(f, &f->tile[t], d->sum[g->diffusion.last][t], turn_line(g, t, 0), d->sheet[t]);
    forest_fill_sheets(g->forest, SHEET_LINES(f->dim), d->sheet);
    for (int t = 0; t < f->ntiles; t++) edges_visit(g, t, sheet_edge, NULL);
}

void tiles_fill_sums(struct gas *g, enum diffusing what, double weight) {
    const struct forest *f = g->forest;
    const struct fill fill = {what, weight};
    forest_fill_layers(g->forest, 1, lines_of(g, what), g->diffusion.sum[g->diffusion.last]);
    for (int t = 0; t < f->ntiles; t++) edges_visit(g, t, sum_edge, &fill);
    if (what == VISCOUS && g->dim > 1) fill_sheets(g);
}
