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

/* Ghosts of the derivatives along a patch: they follow its rule for velocity. */
static void gradient_edge(struct gas *g, int tile, const struct edge *e, const void *context) {
    const long size = g->forest->size;
    double inner[MAX_DIM][BATCH], ghost[MAX_DIM][BATCH], share[1][BATCH];
    struct sum_line line = {.n = e->n,
                            .components = g->dim,
                            .normal = e->normal,
                            .face = e->face,
                            .share = share[0],
                            .inner = inner,
                            .ghost = ghost};
    (void)context;
    take_edge(size, e->to, e, 1, g->tiles->diffuser->wall[tile] + DRAG * size, share);
    for (int along = 0; along < g->dim; along++) {
        double *derivatives = g->tiles->diffuser->gradient[tile] + along * g->dim * size;
        if (along == e->normal) continue;
        take_edge(size, e->from, e, g->dim, derivatives, inner);
        reflect_sums(e->rules, &line);
        put_edge(size, e, g->dim, ghost, derivatives);
    }
}

/* Derivatives along each side in the cells beside it, from which the ghosts beyond the side are made. */
static void side_gradients(const struct forest *f, const struct tile *t, const double *S, const double *turn,
                           double *out) {
    for (int side = 0; side < 2 * f->dim; side++) {
        const int axis = side / 2, across = axis == 0 ? 1 : 0, deep = axis == 2 ? 1 : 2;
        const long first = f->first + (side % 2 ? (t->n[axis] - 1) * f->stride[axis] : 0), step = f->stride[across];
        for (int line = 0; line < f->dim * f->dim; line++) {
            const int along = line / f->dim;
            const double quarter = 0.25 / f->width[along];
            for (int k = 0; along != axis && k < t->n[deep]; k++) {
                const long at = first + k * f->stride[deep];
                const double *q = S + line % f->dim * f->size + at;
                double *to = out + line * f->size + at;
                const bool spreads = turn && line == f->radial * (f->dim + 1);
                for (int i = 0; i < t->n[across]; i++)
                    to[i * step] = spreads
                                       ? half_divergence(q + i * step, f->stride[along], quarter, turn[at + i * step])
                                       : half_derivative(q + i * step, f->stride[along], quarter);
            }
        }
    }
}

static void find_gradients(struct gas *g) {
    const struct forest *f = g->forest;
    struct diffuser *d = g->tiles->diffuser;
    for (int t = 0; t < f->ntiles; t++)
        side_gradients(f, &f->tile[t], d->sum[g->diffusion.last][t], turn_line(g, t, 0), d->gradient[t]);
    forest_fill_derivatives(g->forest, d->gradient);
    for (int t = 0; t < f->ntiles; t++) edges_visit(g, t, gradient_edge, NULL);
}

void tiles_fill_sums(struct gas *g, enum diffusing what, double weight) {
    const struct forest *f = g->forest;
    const struct fill fill = {what, weight};
    forest_fill_layers(g->forest, 1, lines_of(g, what), g->diffusion.sum[g->diffusion.last]);
    for (int t = 0; t < f->ntiles; t++) edges_visit(g, t, sum_edge, &fill);
    if (what == VISCOUS && g->dim > 1) find_gradients(g);
}
