/* Viscous stress and heat conduction on a forest of tiles, second order: fluxes on the faces from the jumps across
 * them, tangential derivatives of velocity as means of the two cells' central differences. These need the neighbours'
 * own neighbours, so the gradients get ghosts by a fill of their own, and at a wall by the wall's rule for velocity. */
#include "libcore/state.h"

#include <stdlib.h>

status diffuser_make(struct gas *g) {
    struct diffuser *d = &g->diffuser;
    double ***blocks[] = {&d->sum[0], &d->sum[1], &d->start};
    for (int i = 0; i < 3; i++) TRY(blocks_make(g->forest, g->dim, blocks[i]));
    TRY(blocks_make(g->forest, g->dim * g->dim, &d->gradient));
    TRY(blocks_make(g->forest, 3 * g->dim, &d->face));
    TRY(blocks_make(g->forest, 1, &d->light));
    TRY(blocks_make(g->forest, 1, &d->mark));
    return allocate(&d->part, g->forest->ntiles, sizeof(double *), "tiles");
}

void diffuser_free(struct gas *g) {
    struct diffuser *d = &g->diffuser;
    double **blocks[] = {d->sum[0], d->sum[1], d->start, d->gradient, d->face, d->light, d->mark};
    for (int i = 0; i < 7; i++) blocks_free(g->forest, blocks[i]);
    free(d->part);
}

static int lines_of(const struct gas *g, enum diffusing what) {
    return what == VISCOUS ? g->dim : 1;
}

struct coefficients { /* what its row visitor needs */
    const struct gas *g;
    const double *U;
};

/* Of the cells of a row, into the scratch lines p, c and gruneisen: bulk, shear, heat. */
static void coefficient_visit(void *context, long offset, int n) {
    const struct coefficients *v = context;
    const struct gas *g = v->g;
    const struct work *w = &g->work;
    double T[BATCH];
    velocities_of_row(g, v->U, offset, n);
    for (int i = 0; i < n; i++) T[i] = (g->models.material.gamma - 1) * w->eps[offset + i];
    g->models.transport->coefficients(&g->models.numbers, g->models.eos, &g->models.material, n, v->U + offset, T,
                                      w->p + offset, w->c + offset, w->gruneisen + offset);
}

ALWAYS_INLINE double harmonic(double a, double b) {
    return 2 * a * b / (a + b + 1e-300); /* 0 of zeros */
}

/* Faces above n cells; `trace`: 2/d; `per`: 1/h^2 */
KERNEL static void face_coefficients(int n, long step, double trace, double per, const double *restrict bulk,
                                     const double *restrict shear, const double *restrict heat, double *restrict lambda,
                                     double *restrict mu, double *restrict kappa) {
    for (int i = 0; i < n; i++) {
        double s = per * harmonic(shear[i], shear[i + step]);
        lambda[i] = per * harmonic(bulk[i], bulk[i + step]) - trace * s;
        mu[i] = s;
        kappa[i] = per * harmonic(heat[i], heat[i + step]);
    }
}

static long row_at(const struct forest *f, int j, int k) {
    return f->first + j * f->stride[1] + k * f->stride[2];
}

static void tile_faces(struct gas *g, int tile) {
    const struct forest *f = g->forest;
    const int *n = f->tile[tile].n;
    const struct work *w = &g->work;
    const double trace = g->models.material.disks ? 1 : 2. / 3;
    for (int axis = 0; axis < g->dim; axis++) {
        double *face = g->diffuser.face[tile] + 3 * axis * f->size, h = f->width[axis];
        for (int k = axis == 2 ? -1 : 0; k < n[2]; k++)
            for (int j = axis == 1 ? -1 : 0; j < n[1]; j++) {
                long at = row_at(f, j, k) - (axis == 0);
                face_coefficients(n[0] + (axis == 0), f->stride[axis], trace, 1 / (h * h), w->p + at, w->c + at,
                                  w->gruneisen + at, face + at, face + f->size + at, face + 2 * f->size + at);
            }
    }
}

/* A row's share of the rates from its faces along one axis. */
KERNEL static void add_rates(int n, long step, long size, const double *restrict face, double (*restrict sum)[BATCH]) {
    const double *restrict lambda = face, *restrict mu = face + size, *restrict kappa = face + 2 * size;
    for (int i = 0; i < n; i++) {
        double low = lambda[i - step] + 2 * mu[i - step], high = lambda[i] + 2 * mu[i];
        sum[0][i] += low + high;
        sum[1][i] += kappa[i - step] + kappa[i];
    }
}

static void tile_rates(const struct gas *g, int tile, const double *rho, double most[2]) {
    const struct forest *f = g->forest;
    const int *n = f->tile[tile].n;
    const double factor[2] = {1, g->models.material.gamma - 1};
    double *light = g->diffuser.light[tile];
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++) {
            double sum[2][BATCH] = {{0}};
            const long at = row_at(f, j, k);
            for (int axis = 0; axis < g->dim; axis++)
                add_rates(n[0], f->stride[axis], f->size, g->diffuser.face[tile] + 3 * axis * f->size + at, sum);
            for (int i = 0; i < n[0]; i++) light[at + i] = 1 / rho[at + i];
            for (int what = 0; what < 2; what++)
                for (int i = 0; i < n[0]; i++)
                    most[what] = larger(factor[what] * sum[what][i] * light[at + i], most[what]);
        }
}

void tiles_diffusion_rates(struct gas *g, const struct state *Y0, double most[2]) {
    const struct forest *f = g->forest;
    most[0] = most[1] = 0;
    forest_fill(g->forest, g->nvar, Y0->block);
    for (int t = 0; t < f->ntiles; t++) {
        struct coefficients v = {.g = g, .U = Y0->block[t]};
        ghosts_of_patches(g, t, Y0->block[t]);
        rows_visit(f, &f->tile[t], 1, coefficient_visit, &v);
        tile_faces(g, t);
        tile_rates(g, t, Y0->block[t], most);
    }
}

/* ---- S and its ghosts ----------------------------------------------------------------------------------------------
 */

struct beginning { /* what its row visitor needs */
    const struct gas *g;
    enum diffusing what;
    const double *U;
    double *start, *sum, factor;
};

/* q_0 of a row: velocity, or T; and S_1 */
static void begin_visit(void *context, long offset, int n) {
    const struct beginning *b = context;
    const struct gas *g = b->g;
    const long size = g->forest->size;
    velocities_of_row(g, b->U, offset, n);
    for (int v = 0; v < lines_of(g, b->what); v++) {
        double *q = b->start + v * size + offset, *S = b->sum + v * size + offset;
        if (b->what == VISCOUS)
            memcpy(q, g->work.velocity[v] + offset, (size_t)n * sizeof(double));
        else
            for (int i = 0; i < n; i++) q[i] = (g->models.material.gamma - 1) * g->work.eps[offset + i];
        for (int i = 0; i < n; i++) S[i] = b->factor * q[i];
    }
}

void tiles_diffusion_begin(struct gas *g, enum diffusing what, const struct state *Y0, double factor) {
    const struct forest *f = g->forest;
    for (int t = 0; t < f->ntiles; t++) {
        struct beginning b = {g,     what, Y0->block[t], g->diffuser.start[t], g->diffuser.sum[g->diffuser.last][t],
                              factor};
        ghosts_of_patches(g, t, Y0->block[t]);
        rows_visit(f, &f->tile[t], 1, begin_visit, &b);
    }
}

struct edge { /* n cells along a side: offsets of the first one and of its ghost, from cell to cell `step` */
    const struct patch_rules *rules;
    const int *face; /* [n] within the patch */
    int normal, n;
    long from, to, step;
};

/* The lines of q at the cells of an edge, or at its ghosts. */
static void take_edge(long size, long at, const struct edge *e, int components, const double *q, double (*out)[BATCH]) {
    for (int c = 0; c < components; c++)
        for (int i = 0; i < e->n; i++) out[c][i] = q[c * size + at + i * e->step];
}

static void put_edge(long size, const struct edge *e, int components, double (*in)[BATCH], double *q) {
    for (int c = 0; c < components; c++)
        for (int i = 0; i < e->n; i++) q[c * size + e->to + i * e->step] = in[c][i];
}

typedef void edge_visitor(struct gas *g, int tile, const struct edge *e, const void *context);

/* The first layer of ghosts of all sides of a tile that are patches. */
static void edges_visit(struct gas *g, int tile, edge_visitor *visit, const void *context) {
    const struct forest *f = g->forest;
    const struct tile *t = &f->tile[tile];
    for (int side = 0; side < 2 * g->dim; side++) {
        const int axis = side / 2, across = axis == 0 ? 1 : 0, deep = axis == 2 ? 1 : 2;
        if (t->side[side].patch < 0) continue;
        struct edge e = {.rules = &g->rules[t->side[side].patch], .normal = axis, .step = f->stride[across]};
        for (int k = 0; k < t->n[deep]; k++)
            for (int start = 0; start < t->n[across]; start += BATCH) {
                e.from = f->first + (side % 2 ? (t->n[axis] - 1) * f->stride[axis] : 0) + k * f->stride[deep] +
                         start * f->stride[across];
                e.face = t->side[side].face + (long)k * t->n[across] + start;
                e.to = e.from + (side % 2 ? f->stride[axis] : -f->stride[axis]);
                e.n = t->n[across] - start < BATCH ? t->n[across] - start : BATCH;
                visit(g, tile, &e, context);
            }
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
    double *S = g->diffuser.sum[g->diffuser.last][tile], inner[MAX_DIM][BATCH], start[MAX_DIM][BATCH],
           ghost[MAX_DIM][BATCH];
    struct sum_line line = {e->n,  lines, fill->what == VISCOUS ? e->normal : -1, e->face, fill->weight, inner,
                            start, ghost};
    take_edge(size, e->from, e, lines, S, inner);
    take_edge(size, e->to, e, lines, g->diffuser.start[tile], start);
    sums_beyond(e->rules, fill->what, &line);
    put_edge(size, e, lines, ghost, S);
}

/* Derivatives along a wall follow the wall's rule for velocity. */
static void gradient_edge(struct gas *g, int tile, const struct edge *e, const void *context) {
    const long size = g->forest->size;
    double inner[MAX_DIM][BATCH], ghost[MAX_DIM][BATCH];
    struct sum_line line = {
        .n = e->n, .components = g->dim, .normal = e->normal, .face = e->face, .inner = inner, .ghost = ghost};
    (void)context;
    for (int along = 0; along < g->dim; along++) {
        double *derivatives = g->diffuser.gradient[tile] + along * g->dim * size;
        if (along == e->normal) continue;
        take_edge(size, e->from, e, g->dim, derivatives, inner);
        reflect_sums(e->rules, &line);
        put_edge(size, e, g->dim, ghost, derivatives);
    }
}

struct gradients { /* what its row visitor needs */
    const struct gas *g;
    const double *S;
    double *out;
};

KERNEL static void central_row(int n, long step, double half_inverse, const double *restrict q, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = (q[i + step] - q[i - step]) * half_inverse;
}

static void gradient_visit(void *context, long offset, int n) {
    const struct gradients *v = context;
    const struct forest *f = v->g->forest;
    const int dim = v->g->dim;
    for (int k = 0; k < dim; k++)
        for (int c = 0; c < dim; c++)
            central_row(n, f->stride[k], 0.5 / f->width[k], v->S + c * f->size + offset,
                        v->out + (k * dim + c) * f->size + offset);
}

static void find_gradients(struct gas *g) {
    const struct forest *f = g->forest;
    struct diffuser *d = &g->diffuser;
    const int all = g->dim * g->dim, each = all <= FILL_VARIABLES ? all : g->dim;
    for (int t = 0; t < f->ntiles; t++) {
        struct gradients v = {g, d->sum[d->last][t], d->gradient[t]};
        rows_visit(f, &f->tile[t], 0, gradient_visit, &v);
    }
    for (int from = 0; from < all; from += each) {
        for (int t = 0; t < f->ntiles; t++) d->part[t] = d->gradient[t] + from * f->size;
        forest_fill_layers(g->forest, 1, each, d->part);
    }
    for (int t = 0; t < f->ntiles; t++) edges_visit(g, t, gradient_edge, NULL);
}

static void fill_sums(struct gas *g, enum diffusing what, double weight) {
    const struct forest *f = g->forest;
    const struct fill fill = {what, weight};
    forest_fill_layers(g->forest, 1, lines_of(g, what), g->diffuser.sum[g->diffuser.last]);
    for (int t = 0; t < f->ntiles; t++) edges_visit(g, t, sum_edge, &fill);
    if (what == VISCOUS && g->dim > 1) find_gradients(g);
}

/* ---- fluxes and what they move -------------------------------------------------------------------------------------
 */

/* `half`: half the width of a cell */
ALWAYS_INLINE void mean_across(int n, long step, double half, const double *restrict q, const double *restrict keep,
                               double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = half * (q[i] + q[i + step]);
    for (int i = 0; keep && i < n; i++) out[i] *= keep[i];
}

/* Through the faces above n cells along `axis`, over the width of a cell there: stress of S (the flux of momentum
 * inwards), and its work on S. Lines stand at the first cell; `step` leads across the face. keep: 0 where tangential
 * derivatives do not count, else 1; NULL: they all do. */
KERNEL static void viscous_faces(int n, int dim, int axis, long step, long size, double width, bool ends,
                                 const double *restrict S, const double *restrict gradient, const double *restrict face,
                                 const double *restrict keep, double (*restrict out)[BATCH]) {
    const double *restrict lambda = face, *restrict mu = face + size, *restrict u = S + axis * size;
    double spread[BATCH], side[BATCH], *restrict work = out[dim];
    for (int i = 0; i < n; i++) spread[i] = u[i + step] - u[i];
    for (int t = 0; t < dim; t++) {
        if (t == axis) continue;
        mean_across(n, step, 0.5 * width, gradient + (t * dim + t) * size, keep, side);
        for (int i = 0; i < n; i++) spread[i] += side[i];
    }
    for (int i = 0; i < n; i++) out[axis][i] = lambda[i] * spread[i] + 2 * mu[i] * (u[i + step] - u[i]);
    for (int t = 0; t < dim; t++) {
        const double *restrict v = S + t * size;
        if (t == axis) continue;
        mean_across(n, step, 0.5 * width, gradient + (t * dim + axis) * size, keep, side);
        for (int i = 0; i < n; i++) out[t][i] = mu[i] * ((v[i + step] - v[i]) + side[i]);
    }
    for (int i = 0; ends && i < n; i++) work[i] = out[axis][i] * (0.5 * (u[i] + u[i + step]));
    for (int t = 0; ends && t < dim; t++) {
        const double *restrict v = S + t * size;
        if (t == axis) continue;
        for (int i = 0; i < n; i++) work[i] += out[t][i] * (0.5 * (v[i] + v[i + step]));
    }
}

struct sweep { /* of a tile */
    enum diffusing what;
    const double *Y0, *c; /* c: of the next stage; NULL: this was the last one */
    double *to, dt;
    int tile, n;
    long bad;
};

static void viscous_above(const struct gas *g, const struct sweep *s, int axis, long at, int n, double (*out)[BATCH]) {
    const struct forest *f = g->forest;
    const struct diffuser *d = &g->diffuser;
    const double *S = d->sum[d->last][s->tile] + at, *face = d->face[s->tile] + 3 * axis * f->size + at;
    const double *flag = g->flag[s->tile] + at;
    const long step = f->stride[axis];
    double keep[BATCH];
    for (int i = 0; i < n && g->flagged[s->tile]; i++) keep[i] = flag[i] + flag[i + step] > 0 ? 0 : 1;
    viscous_faces(n, g->dim, axis, step, f->size, f->width[axis], !s->c, S, d->gradient[s->tile] + at, face,
                  g->flagged[s->tile] ? keep : NULL, out);
}

struct around { /* a row: lines of its faces along axis 0, and pairs of lines below and above it along the others */
    const double *x, *y[2], *z[2];
};

/* What n cells gain by their faces. */
KERNEL static void gain_row(int n, int dim, const struct around *f, double *restrict out) {
    const double *restrict x = f->x, *restrict y0 = f->y[0], *restrict y1 = f->y[1], *restrict z0 = f->z[0],
                           *restrict z1 = f->z[1];
    if (dim == 1)
        for (int i = 0; i < n; i++) out[i] = x[i + 1] - x[i];
    else if (dim == 2)
        for (int i = 0; i < n; i++) out[i] = (x[i + 1] - x[i]) + (y1[i] - y0[i]);
    else
        for (int i = 0; i < n; i++) out[i] = (x[i + 1] - x[i]) + (y1[i] - y0[i]) + (z1[i] - z0[i]);
}

/* The same by conduction; lines stand at the cell. Sums of terms that a swap of axes or a mirror exchanges. */
ALWAYS_INLINE double heat_gain(int dim, const long *stride, long size, const double *face, const double *S) {
    double sum = 0;
    for (int axis = 0; axis < dim; axis++) {
        const double *kappa = face + (3 * axis + 2) * size;
        const long step = stride[axis];
        const double here = kappa[0] * (S[step] - S[0]) - kappa[-step] * (S[0] - S[-step]);
        sum = axis ? sum + here : here;
    }
    return sum;
}

/* S of the next stage in place of the one before the last, which may hold anything where it does not count;
 * c: of S, of that, of the gain over rho, of q_0. */
ALWAYS_INLINE double next_sum(const double *c, double last, double before, double gain, double light, double start) {
    return (c[0] * last + (c[1] == 0 ? 0 : c[1] * before)) + (c[2] * (gain * light) + c[3] * start);
}

KERNEL static void next_row(int n, const double *restrict c, const double *restrict gain, const double *restrict light,
                            const double *restrict start, const double *restrict last, double *restrict next) {
    for (int i = 0; i < n; i++) next[i] = next_sum(c, last[i], next[i], gain[i], light[i], start[i]);
}

ALWAYS_INLINE void heat_row(int n, int dim, const long *stride, long size, const double *restrict c,
                            const double *restrict face, const double *restrict light, const double *restrict start,
                            const double *restrict last, double *restrict next) {
    for (int i = 0; i < n; i++)
        next[i] = next_sum(c, last[i], next[i], heat_gain(dim, stride, size, face + i, last + i), light[i], start[i]);
}

KERNEL static void heat_stage(const struct forest *f, const int *n, const double *restrict c,
                              const double *restrict face, const double *restrict light, const double *restrict start,
                              const double *restrict last, double *restrict next) {
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++) {
            const long at = f->first + j * f->stride[1] + k * f->stride[2];
            if (f->dim == 1)
                heat_row(n[0], 1, f->stride, f->size, c, face + at, light + at, start + at, last + at, next + at);
            else if (f->dim == 2)
                heat_row(n[0], 2, f->stride, f->size, c, face + at, light + at, start + at, last + at, next + at);
            else
                heat_row(n[0], 3, f->stride, f->size, c, face + at, light + at, start + at, last + at, next + at);
        }
}

KERNEL static void heat_gain_row(int n, int dim, const long *stride, long size, const double *restrict face,
                                 const double *restrict S, double *restrict out) {
    if (dim == 1)
        for (int i = 0; i < n; i++) out[i] = heat_gain(1, stride, size, face + i, S + i);
    else if (dim == 2)
        for (int i = 0; i < n; i++) out[i] = heat_gain(2, stride, size, face + i, S + i);
    else
        for (int i = 0; i < n; i++) out[i] = heat_gain(3, stride, size, face + i, S + i);
}

KERNEL static void moved_row(int n, double factor, const double *restrict from, const double *restrict M,
                             double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = from[i] + factor * M[i];
}

/* to = Y_0 + div of the flux of S; the work of the stress of S on S/dt makes the energy. */
static void end_row(struct gas *g, struct sweep *s, long at, double (*M)[BATCH]) {
    const long size = g->forest->size;
    const int lines = lines_of(g, s->what), energy = g->dim + 1;
    double moved[BATCH];
    for (int v = 0; v < g->nvar; v++) {
        const bool line = s->what == VISCOUS && v > 0 && v < energy, changes = line || v == energy;
        const double *from = s->Y0 + v * size + at;
        if (changes) {
            const double factor = v == energy && s->what == VISCOUS ? 1 / s->dt : 1;
            moved_row(s->n, factor, from, M[line ? v - 1 : s->what == VISCOUS ? lines : 0], moved);
        }
        if (changes || s->to != s->Y0)
            memcpy(s->to + v * size + at, changes ? moved : from, (size_t)s->n * sizeof(double));
    }
    s->bad += row_inadmissible(g, s->to, at, s->n, g->diffuser.mark[s->tile]);
}

/* A row from its faces along all axes. */
static void move_row(struct gas *g, struct sweep *s, long at, double (*low)[BATCH], double (*high)[BATCH]) {
    const struct forest *f = g->forest;
    const struct diffuser *d = &g->diffuser;
    double x[MAX_VAR][BATCH], z[2][MAX_VAR][BATCH], M[MAX_VAR][BATCH];
    viscous_above(g, s, 0, at - 1, s->n + 1, x);
    for (int i = 0; i < 2 && g->dim > 2; i++) viscous_above(g, s, 2, at + (i - 1) * f->stride[2], s->n, z[i]);
    for (int v = 0; v < g->dim + !s->c; v++) {
        const struct around faces = {x[v], {low[v], high[v]}, {z[0][v], z[1][v]}};
        const long line = v * f->size + at;
        gain_row(s->n, g->dim, &faces, M[v]);
        if (s->c)
            next_row(s->n, s->c, M[v], d->light[s->tile] + at, d->start[s->tile] + line,
                     d->sum[d->last][s->tile] + line, d->sum[1 - d->last][s->tile] + line);
    }
    if (!s->c) end_row(g, s, at, M);
}

static void move_tile(struct gas *g, struct sweep *s) {
    const struct forest *f = g->forest;
    const int *n = f->tile[s->tile].n;
    double faces[2][MAX_VAR][BATCH];
    s->n = n[0];
    for (int k = 0; k < n[2]; k++)
        for (int row = g->dim > 1 ? -1 : 0; row < n[1]; row++) {
            const long at = row_at(f, row, k);
            double(*low)[BATCH] = faces[(row + 2) % 2], (*high)[BATCH] = faces[(row + 1) % 2];
            if (g->dim > 1) viscous_above(g, s, 1, at, n[0], high);
            if (row >= 0) move_row(g, s, at, low, high);
        }
}

static void heat_tile(struct gas *g, struct sweep *s) {
    const struct forest *f = g->forest;
    const struct diffuser *d = &g->diffuser;
    const int *n = f->tile[s->tile].n;
    const double *face = d->face[s->tile], *S = d->sum[d->last][s->tile];
    double M[1][BATCH];
    s->n = n[0];
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++) {
            const long at = row_at(f, j, k);
            heat_gain_row(n[0], g->dim, f->stride, f->size, face + at, S + at, M[0]);
            end_row(g, s, at, M);
        }
}

void tiles_diffusion_stage(struct gas *g, enum diffusing what, const struct state *Y0, const double c[4],
                           double weight) {
    struct diffuser *d = &g->diffuser;
    const double factor[4] = {c[0], c[1], what == HEAT ? c[2] * (g->models.material.gamma - 1) : c[2], c[2] + c[3]};
    fill_sums(g, what, weight);
    for (int t = 0; t < g->forest->ntiles; t++) {
        struct sweep s = {.what = what, .Y0 = Y0->block[t], .c = factor, .tile = t};
        if (what == HEAT)
            heat_stage(g->forest, g->forest->tile[t].n, factor, d->face[t], d->light[t], d->start[t],
                       d->sum[d->last][t], d->sum[1 - d->last][t]);
        else
            move_tile(g, &s);
    }
    d->last = 1 - d->last;
}

long tiles_diffusion_end(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to, double dt,
                         double weight) {
    long bad = 0;
    fill_sums(g, what, weight);
    for (int t = 0; t < g->forest->ntiles; t++) {
        struct sweep s = {.what = what, .Y0 = Y0->block[t], .to = to->block[t], .dt = dt, .tile = t};
        (what == HEAT ? heat_tile : move_tile)(g, &s);
        bad += s.bad;
    }
    g->diffuser.marked |= bad > 0;
    return bad;
}

/* Flags count from here on, the same on both sides of a face. */
long tiles_diffusion_flags(struct gas *g, bool keep) {
    const size_t bytes = (size_t)g->forest->size * sizeof(double);
    for (int t = 0; t < g->forest->ntiles && g->diffuser.marked; t++) {
        for (long i = 0; keep && i < g->forest->size; i++) g->flag[t][i] += g->diffuser.mark[t][i];
        memset(g->diffuser.mark[t], 0, bytes);
    }
    g->diffuser.marked = false;
    return keep ? tiles_share_flags(g) : 0;
}
