/* Viscous stress and heat conduction on a forest of tiles, second order: fluxes on the faces from the jumps across
 * them, tangential derivatives of velocity as means of the two cells' central differences. These need the neighbours'
 * own neighbours, so the gradients get ghosts by a fill of their own, and at a wall by the wall's rule for velocity. */
#include "libcore/gas/patch.h"
#include "libcore/lattice/tiles.h"
#include "libcore/lattice/tiles_faces.h"

#include <stdlib.h>

#define MOST_RISE 4.                        /* of T ahead; a front that passes tells nothing of what follows */
enum { EDGE = 8, LINE = EDGE + BATCH + 8 }; /* of a row in scratch: its first cell, and doubles */

/* Rows in whole vectors, without a rest cell by cell: beyond the row there are ghosts, which are filled again before
 * they are read, and padding, where 1/rho is 0. */
static int padded(int n) {
    return (n + 7) / 8 * 8;
}

status diffuser_make(struct gas *g) {
    struct diffuser *d = &g->tiles->diffuser;
    double ***blocks[] = {&d->sum[0], &d->sum[1], &d->start};
    for (int i = 0; i < 3; i++) TRY(blocks_make(g->forest, g->dim, blocks[i]));
    TRY(blocks_make(g->forest, g->dim * g->dim, &d->gradient));
    TRY(blocks_make(g->forest, FACE_LINES * g->dim, &d->face));
    TRY(blocks_make(g->forest, g->dim, &d->keep));
    TRY(blocks_make(g->forest, 1, &d->light));
    TRY(blocks_make(g->forest, 1, &d->mark));
    TRY(blocks_make(g->forest, 1, &g->friction));
    TRY(blocks_make(g->forest, 1, &g->cooled));
    return blocks_make(g->forest, 1, &d->warm);
}

void diffuser_free(struct gas *g) {
    struct diffuser *d = &g->tiles->diffuser;
    double **blocks[] = {d->sum[0], d->sum[1], d->start, d->gradient, d->face,  d->light,
                         d->mark,   d->warm,   d->keep,  g->friction, g->cooled};
    for (int i = 0; i < 11; i++) blocks_free(g->forest, blocks[i]);
}

static int lines_of(const struct gas *g, enum diffusing what) {
    return what == VISCOUS ? g->dim : 1;
}

struct coefficients { /* what its row visitor needs */
    const struct gas *g;
    const double *U;
    double *warm;
};

/* T of a row of U; velocity and eps go to the workspace. */
static void temperature_of_row(const struct gas *g, const double *U, long offset, int n, double T[BATCH]) {
    velocities_of_row(g, U, offset, n);
    for (int i = 0; i < n; i++) T[i] = (g->models.material.gamma - 1) * g->tiles->work.eps[offset + i];
}

/* Of the cells of a row, into the scratch lines p, c and gruneisen: bulk, shear, heat. */
static void coefficient_visit(void *context, long offset, int n) {
    const struct coefficients *v = context;
    const struct gas *g = v->g;
    const struct work *w = &g->tiles->work;
    double T[BATCH], *warm = v->warm + offset;
    temperature_of_row(g, v->U, offset, n, T);
    for (int i = 0; i < n && g->ahead; i++) T[i] *= warm[i];
    for (int i = 0; i < n && !g->ahead; i++) warm[i] = T[i];
    g->models.transport->coefficients(&g->models.numbers, g->models.eos, &g->models.material, n, v->U + offset, T,
                                      w->p + offset, w->c + offset, w->gruneisen + offset);
}

ALWAYS_INLINE double harmonic(double a, double b) {
    return 2 * a * b / (a + b + 1e-300); /* 0 of zeros */
}

/* Faces below n cells; `trace`: 2/d */
KERNEL static void face_coefficients(int n, long step, long size, double trace, double width,
                                     const double *restrict bulk, const double *restrict shear,
                                     const double *restrict heat, double *restrict face) {
    const double square = 1 / (width * width);
    for (int i = 0; i < n; i++) {
        double mu = harmonic(shear[i - step], shear[i]), lambda = harmonic(bulk[i - step], bulk[i]) - trace * mu;
        face[NORMAL * size + i] = square * (lambda + 2 * mu);
        face[SHEAR * size + i] = square * mu;
        face[CONDUCTION * size + i] = square * harmonic(heat[i - step], heat[i]);
    }
}

static long row_at(const struct forest *f, int j, int k) {
    return f->first + j * f->stride[1] + k * f->stride[2];
}

static void tile_faces(struct gas *g, int tile) {
    const struct forest *f = g->forest;
    const int *n = f->tile[tile].n;
    const struct work *w = &g->tiles->work;
    const double trace = g->models.material.disks ? 1 : 2. / 3;
    for (int axis = 0; axis < g->dim; axis++) {
        double *face = g->tiles->diffuser.face[tile] + FACE_LINES * axis * f->size;
        for (int k = 0; k < n[2] + (axis == 2); k++)
            for (int j = 0; j < n[1] + (axis == 1); j++) {
                long at = row_at(f, j, k);
                face_coefficients(n[0] + (axis == 0), f->stride[axis], f->size, trace, f->width[axis], w->p + at,
                                  w->c + at, w->gruneisen + at, face + at);
            }
    }
}

/* A row's share of the rates from its faces along one axis. */
KERNEL static void add_rates(int n, long step, long size, const double *restrict face, double (*restrict sum)[BATCH]) {
    const double *restrict normal = face + NORMAL * size, *restrict heat = face + CONDUCTION * size;
    for (int i = 0; i < n; i++) {
        sum[0][i] += normal[i] + normal[i + step];
        sum[1][i] += heat[i] + heat[i + step];
    }
}

static void tile_rates(const struct gas *g, int tile, const double *rho, double most[2]) {
    const struct forest *f = g->forest;
    const int *n = f->tile[tile].n;
    const double factor[2] = {1, g->models.material.gamma - 1};
    double *light = g->tiles->diffuser.light[tile];
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++) {
            double sum[2][BATCH] = {{0}};
            const long at = row_at(f, j, k);
            for (int axis = 0; axis < g->dim; axis++)
                add_rates(n[0], f->stride[axis], f->size,
                          g->tiles->diffuser.face[tile] + FACE_LINES * axis * f->size + at, sum);
            for (int i = 0; i < n[0]; i++) light[at + i] = 1 / rho[at + i];
            for (int what = 0; what < 2; what++)
                for (int i = 0; i < n[0]; i++)
                    most[what] = larger(factor[what] * sum[what][i] * light[at + i], most[what]);
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

/* Walls that take heat: their share of the conduction. eps is still in the workspace. */
static void conduction_edge(struct gas *g, int tile, const struct edge *e, const void *context) {
    const struct forest *f = g->forest;
    const double width = f->width[e->normal], *U = context;
    double *faces = g->tiles->diffuser.face[tile] + (FACE_LINES * e->normal + CONDUCTION) * f->size;
    double rho[BATCH], T[BATCH], push[BATCH], d[BATCH], heat[BATCH], share[BATCH];
    const long face = e->to > e->from ? e->to : e->from;
    if (!wall_conducts(e->rules)) return;
    for (int i = 0; i < e->n; i++) {
        const long at = e->from + i * e->step;
        rho[i] = U[at];
        T[i] = (g->models.material.gamma - 1) * g->tiles->work.eps[at] *
               (g->ahead ? g->tiles->diffuser.warm[tile][at] : 1);
        push[i] = e->to > e->from ? g->pull[e->normal] : -g->pull[e->normal];
        d[i] = width;
        heat[i] = width * width * faces[face + i * e->step];
    }
    wall_shares(g, e->rules, e->n, rho, T, push, d, heat, share);
    for (int i = 0; i < e->n; i++) faces[face + i * e->step] *= share[i];
}

void tiles_diffusion_rates(struct gas *g, const struct state *Y0, double most[2]) {
    const struct forest *f = g->forest;
    most[0] = most[1] = 0;
    g->tiles->diffuser.plain = false;
    forest_fill_layers(g->forest, 1, g->nvar, Y0->block);
    for (int t = 0; t < f->ntiles; t++) {
        struct coefficients v = {g, Y0->block[t], g->tiles->diffuser.warm[t]};
        ghosts_of_patches(g, t, Y0->block[t]);
        runs_visit(f, &f->tile[t], 1, coefficient_visit, &v);
        tile_faces(g, t);
        edges_visit(g, t, conduction_edge, Y0->block[t]);
        tile_rates(g, t, Y0->block[t], most);
    }
}

static void ahead_visit(void *context, long offset, int n) {
    const struct coefficients *v = context;
    double T[BATCH], *warm = v->warm + offset;
    temperature_of_row(v->g, v->U, offset, n, T);
    for (int i = 0; i < n; i++) warm[i] = smaller(larger(T[i] / warm[i], 1 / MOST_RISE), MOST_RISE);
}

void tiles_diffusion_ahead(struct gas *g, const struct state *to) {
    const struct forest *f = g->forest;
    forest_fill_layers(g->forest, 1, g->nvar, to->block);
    for (int t = 0; t < f->ntiles; t++) {
        struct coefficients v = {g, to->block[t], g->tiles->diffuser.warm[t]};
        ghosts_of_patches(g, t, to->block[t]);
        runs_visit(f, &f->tile[t], 1, ahead_visit, &v);
    }
}

/* ---- S and its ghosts ----------------------------------------------------------------------------------------------
 */

struct beginning { /* what its row visitor needs */
    const struct gas *g;
    enum diffusing what;
    const double *U;
    double *start, rest;
    const double *friction, *cooled; /* 0 in ghosts */
};

/* q_0 of a row: velocity, or T less what friction is yet to make */
static void begin_visit(void *context, long offset, int n) {
    const struct beginning *b = context;
    const struct gas *g = b->g;
    const long size = g->forest->size;
    velocities_of_row(g, b->U, offset, n);
    for (int v = 0; b->what == VISCOUS && v < g->dim; v++)
        memcpy(b->start + v * size + offset, g->tiles->work.velocity[v] + offset, (size_t)n * sizeof(double));
    for (int i = 0; b->what == HEAT && i < n; i++)
        b->start[offset + i] = (g->models.material.gamma - 1) * g->tiles->work.eps[offset + i] -
                               b->rest * b->friction[offset + i] - (g->late ? b->cooled[offset + i] : 0);
}

KERNEL static void first_sums(long n, double factor, const double *restrict start, double *restrict S,
                              double *restrict before) {
    for (long i = 0; i < n; i++) {
        S[i] = factor * start[i];
        before[i] = 0;
    }
}

/* Does S beyond a side of the tile follow from q_0 there? */
static bool beyond_counts(const struct gas *g, const struct tile *t) {
    bool counts = false;
    for (int side = 0; side < 2 * g->dim; side++)
        if (t->side[side].patch >= 0) counts |= patch_needs_values(&g->rules[t->side[side].patch]);
    return counts;
}

void tiles_diffusion_begin(struct gas *g, enum diffusing what, const struct state *Y0, double factor, double rest) {
    const struct forest *f = g->forest;
    struct diffuser *d = &g->tiles->diffuser;
    for (int t = 0; t < f->ntiles; t++) {
        struct beginning b = {g, what, Y0->block[t], d->start[t], rest, g->friction[t], g->cooled[t]};
        const bool beyond = beyond_counts(g, &f->tile[t]);
        if (beyond) ghosts_of_patches(g, t, Y0->block[t]);
        runs_visit(f, &f->tile[t], beyond, begin_visit, &b);
        first_sums(lines_of(g, what) * f->size, factor, d->start[t], d->sum[d->last][t], d->sum[1 - d->last][t]);
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
    double *S = g->tiles->diffuser.sum[g->tiles->diffuser.last][tile], inner[MAX_DIM][BATCH], start[MAX_DIM][BATCH],
           ghost[MAX_DIM][BATCH];
    struct sum_line line = {e->n,  lines, fill->what == VISCOUS ? e->normal : -1, e->face, fill->weight, inner,
                            start, ghost};
    take_edge(size, e->from, e, lines, S, inner);
    take_edge(size, e->to, e, lines, g->tiles->diffuser.start[tile], start);
    sums_beyond(e->rules, fill->what, &line);
    carry_sums(e->rules, fill->what, &line);
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
        double *derivatives = g->tiles->diffuser.gradient[tile] + along * g->dim * size;
        if (along == e->normal) continue;
        take_edge(size, e->from, e, g->dim, derivatives, inner);
        reflect_sums(e->rules, &line);
        put_edge(size, e, g->dim, ghost, derivatives);
    }
}

/* Half of a central difference; quarter: 1/(4 h) */
ALWAYS_INLINE double half_derivative(const double *q, long step, double quarter) {
    return (q[step] - q[-step]) * quarter;
}

/* Of the cells along the sides, for the ghosts beyond these: the derivatives along a side. */
static void side_gradients(const struct forest *f, const struct tile *t, const double *S, double *out) {
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
                for (int i = 0; i < t->n[across]; i++)
                    to[i * step] = half_derivative(q + i * step, f->stride[along], quarter);
            }
        }
    }
}

static void find_gradients(struct gas *g) {
    const struct forest *f = g->forest;
    struct diffuser *d = &g->tiles->diffuser;
    for (int t = 0; t < f->ntiles; t++) side_gradients(f, &f->tile[t], d->sum[d->last][t], d->gradient[t]);
    forest_fill_derivatives(g->forest, d->gradient);
    for (int t = 0; t < f->ntiles; t++) edges_visit(g, t, gradient_edge, NULL);
}

static void fill_sums(struct gas *g, enum diffusing what, double weight) {
    const struct forest *f = g->forest;
    const struct fill fill = {what, weight};
    forest_fill_layers(g->forest, 1, lines_of(g, what), g->tiles->diffuser.sum[g->tiles->diffuser.last]);
    for (int t = 0; t < f->ntiles; t++) edges_visit(g, t, sum_edge, &fill);
    if (what == VISCOUS && g->dim > 1) find_gradients(g);
}

/* ---- fluxes and what they move -------------------------------------------------------------------------------------
 */

struct sweep { /* of a tile */
    struct gas *g;
    enum diffusing what;
    int tile;
    const double *S, *c; /* c: of the next stage, next_sum; NULL: this was the last one */
    double *next;
    const double *Y0; /* of the end */
    double *to, dt;
    long bad;
};

KERNEL static void moved_row(int n, double factor, const double *restrict from, const double *restrict M,
                             double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = from[i] + factor * M[i];
}

/* to = Y_0 + div of the flux of S; the work of the stress of S on S/dt makes the energy. */
static void end_row(struct sweep *s, long at, int n, double (*M)[BATCH]) {
    struct gas *g = s->g;
    const long size = g->forest->size;
    const int lines = lines_of(g, s->what), energy = g->dim + 1;
    double moved[BATCH];
    for (int v = 0; v < g->nvar; v++) {
        const bool line = s->what == VISCOUS && v > 0 && v < energy, changes = line || v == energy;
        const double *from = s->Y0 + v * size + at;
        if (changes) {
            const double factor = v == energy && s->what == VISCOUS ? 1 / s->dt : 1;
            moved_row(n, factor, from, M[line ? v - 1 : s->what == VISCOUS ? lines : 0], moved);
        }
        if (changes || s->to != s->Y0)
            memcpy(s->to + v * size + at, changes ? moved : from, (size_t)n * sizeof(double));
    }
    s->bad += row_inadmissible(g, s->to, at, n, g->tiles->diffuser.mark[s->tile]);
}

/* S of the next stage, in place of the one before the last. c: of S, of that, of the gain over rho, of q_0. */
ALWAYS_INLINE double next_sum(const double *c, double last, double before, double gain, double light, double start) {
    return (c[0] * last + c[1] * before) + (c[2] * (gain * light) + c[3] * start);
}

/* What conduction brings to a cell; lines stand there. Sums of terms that a swap of axes or a mirror exchanges. */
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

ALWAYS_INLINE void heat_next(int n, int dim, const long *stride, long size, const double *restrict c,
                             const double *restrict face, const double *restrict light, const double *restrict start,
                             const double *restrict friction, const double *restrict last, double *restrict next) {
    for (int i = 0; i < n; i++)
        next[i] = next_sum(c, last[i], next[i], heat_gain(dim, stride, size, face + i, last + i), light[i], start[i]) +
                  c[4] * friction[i];
}

ALWAYS_INLINE void heat_gains(int n, int dim, const long *stride, long size, const double *restrict face,
                              const double *restrict S, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = heat_gain(dim, stride, size, face + i, S + i);
}

ALWAYS_INLINE void heat_sweep(struct sweep *s, int dim) {
    const struct forest *f = s->g->forest;
    const struct diffuser *d = &s->g->tiles->diffuser;
    const int *n = f->tile[s->tile].n, vectors = padded(n[0]);
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++) {
            const long at = f->first + j * f->stride[1] + k * f->stride[2];
            const double *face = d->face[s->tile] + at;
            double M[1][BATCH];
            if (s->c) {
                heat_next(vectors, dim, f->stride, f->size, s->c, face, d->light[s->tile] + at, d->start[s->tile] + at,
                          s->g->friction[s->tile] + at, s->S + at, s->next + at);
            } else {
                heat_gains(vectors, dim, f->stride, f->size, face, s->S + at, M[0]);
                end_row(s, at, n[0], M);
            }
        }
}

ALWAYS_INLINE void gradient_row(int n, long step, double quarter, const double *restrict q, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = half_derivative(q + i, step, quarter);
}

/* The gradients of a row of cells; of a row of ghosts, the derivatives along it. */
ALWAYS_INLINE void row_gradients(const struct forest *f, const int *n, int dim, int j, int k, const double *S,
                                 const double *ghosts, double *out) {
    const long at = f->first + j * f->stride[1] + k * f->stride[2];
    const int beyond = j < 0 || j >= n[1] ? 1 : k < 0 || k >= n[2] ? 2 : 0, vectors = padded(n[0]);
    for (int line = 0; line < dim * dim; line++) {
        const int along = line / dim;
        const double *ghost = ghosts + line * f->size + at;
        double *row = out + line * LINE + EDGE;
        if (beyond) {
            memcpy(row, ghost, (size_t)vectors * sizeof *row);
        } else {
            gradient_row(vectors, f->stride[along], 0.25 / f->width[along], S + line % dim * f->size + at, row);
            row[-1] = ghost[-1];
            row[n[0]] = ghost[n[0]];
        }
    }
}

/* Through the faces below n cells along `axis`, over the width h of a cell there: stress of S (the flux of momentum
 * inwards), and in the end its work on S. Lines stand at the first cell; `step` leads across the face; low, high: the
 * gradients on both sides. With a = (lambda + 2 mu)/h^2, b = mu/h^2, the difference d of u, and the tangential
 * derivative s/h of v the normal stress is a d + (a - 2 b) s. */
ALWAYS_INLINE void viscous_faces(int n, int dim, int axis, bool ends, double h, long step, long size,
                                 const double *restrict face, const double *restrict keep, const double *restrict low,
                                 const double *restrict high, const double *restrict S, double (*restrict out)[LINE]) {
    const double *u = S + axis * size;
    for (int i = 0; i < n; i++) {
        double side = 0;
        for (int t = 0; t < dim; t++)
            if (t != axis) side += low[(t * dim + t) * LINE + i] + high[(t * dim + t) * LINE + i];
        side *= keep ? h * keep[i] : h;
        const double a = face[NORMAL * size + i], b = face[SHEAR * size + i];
        double stress = dim > 1 ? a * ((u[i] - u[i - step]) + side) - b * (side + side) : a * (u[i] - u[i - step]);
        double work = stress * (0.5 * (u[i - step] + u[i]));
        out[axis][i] = stress;
        for (int t = 0; t < dim; t++) {
            const double *v = S + t * size + i;
            if (t == axis) continue;
            side = low[(t * dim + axis) * LINE + i] + high[(t * dim + axis) * LINE + i];
            side *= keep ? h * keep[i] : h;
            double shear = b * ((v[0] - v[-step]) + side);
            work += shear * (0.5 * (v[-step] + v[0]));
            out[t][i] = shear;
        }
        if (ends) out[dim][i] = work;
    }
}

/* What a cell gains by its faces: of lines along axis 0, and of those below and above it along the others. */
ALWAYS_INLINE double gain(int dim, int i, const double *x, const double *y0, const double *y1, const double *z0,
                          const double *z1) {
    double sum = x[i + 1] - x[i];
    if (dim > 1) sum += y1[i] - y0[i];
    if (dim > 2) sum += z1[i] - z0[i];
    return sum;
}

ALWAYS_INLINE void gain_row(int n, int dim, const double *restrict x, const double *restrict y0,
                            const double *restrict y1, const double *restrict z0, const double *restrict z1,
                            double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = gain(dim, i, x, y0, y1, z0, z1);
}

ALWAYS_INLINE void next_row(int n, int dim, const double *restrict c, const double *restrict x,
                            const double *restrict y0, const double *restrict y1, const double *restrict z0,
                            const double *restrict z1, const double *restrict light, const double *restrict start,
                            const double *restrict last, double *restrict next) {
    for (int i = 0; i < n; i++)
        next[i] = next_sum(c, last[i], next[i], gain(dim, i, x, y0, y1, z0, z1), light[i], start[i]);
}

/* Gradients of a row, and faces below it along axis 1, serve two rows: those of odd and even rows in turn. */
ALWAYS_INLINE void viscous_sweep(struct sweep *s, int dim, bool ends, bool plain) {
    const struct forest *f = s->g->forest;
    const struct diffuser *d = &s->g->tiles->diffuser;
    const int *n = f->tile[s->tile].n, vectors = padded(n[0]), lines = dim + ends;
    const long size = f->size, *stride = f->stride;
    _Alignas(64) double x[4][LINE] = {{0}}, y[2][4][LINE], z[2][4][LINE], M[4][BATCH];
    _Alignas(64) double gradient[2][MAX_DIM * MAX_DIM * LINE], outer[2][MAX_DIM * MAX_DIM * LINE];
    const double *face = d->face[s->tile], *keep = d->keep[s->tile], *ghosts = d->gradient[s->tile], *h = f->width;
    for (int k = 0; k < n[2]; k++)
        for (int j = dim > 1 ? -1 : 0; j < n[1]; j++) {
            const long at = f->first + j * stride[1] + k * stride[2], above = at + stride[1];
            double *here = gradient[j & 1], *next = gradient[(j + 1) & 1], (*low)[LINE] = y[j & 1],
                   (*high)[LINE] = y[(j + 1) & 1];
            if (j >= 0)
                viscous_faces(padded(n[0] + 1), dim, 0, ends, h[0], 1, size, face + at, plain ? keep + at : NULL,
                              here + EDGE - 1, here + EDGE, s->S + at, x);
            else
                row_gradients(f, n, dim, j, k, s->S, ghosts, here);
            if (dim > 1) {
                row_gradients(f, n, dim, j + 1, k, s->S, ghosts, next);
                viscous_faces(vectors, dim, 1, ends, h[1], stride[1], size, face + FACE_LINES * size + above,
                              plain ? keep + size + above : NULL, here + EDGE, next + EDGE, s->S + above, high);
            }
            if (j < 0) continue;
            for (int i = 0; dim > 2 && i < 2; i++) {
                const long top = at + i * stride[2];
                row_gradients(f, n, dim, j, k + 2 * i - 1, s->S, ghosts, outer[i]);
                viscous_faces(vectors, dim, 2, ends, h[2], stride[2], size, face + 2 * FACE_LINES * size + top,
                              plain ? keep + 2 * size + top : NULL, (i ? here : outer[0]) + EDGE,
                              (i ? outer[1] : here) + EDGE, s->S + top, z[i]);
            }
            for (int v = 0; v < lines; v++)
                if (ends)
                    gain_row(vectors, dim, x[v], low[v], high[v], z[0][v], z[1][v], M[v]);
                else
                    next_row(vectors, dim, s->c, x[v], low[v], high[v], z[0][v], z[1][v], d->light[s->tile] + at,
                             d->start[s->tile] + v * size + at, s->S + v * size + at, s->next + v * size + at);
            if (ends) end_row(s, at, n[0], M);
        }
}

#define SWEEP(dim)                                                                                                     \
    KERNEL static void sweep_##dim##d(struct sweep *s, bool plain) {                                                   \
        if (s->what == HEAT)                                                                                           \
            heat_sweep(s, dim);                                                                                        \
        else if (plain)                                                                                                \
            s->c ? viscous_sweep(s, dim, false, true) : viscous_sweep(s, dim, true, true);                             \
        else                                                                                                           \
            s->c ? viscous_sweep(s, dim, false, false) : viscous_sweep(s, dim, true, false);                           \
    }
SWEEP(1)
SWEEP(2)
SWEEP(3)

static void sweep_tile(struct sweep *s) {
    const struct diffuser *d = &s->g->tiles->diffuser;
    s->S = d->sum[d->last][s->tile];
    s->next = d->sum[1 - d->last][s->tile];
    (s->g->dim == 1 ? sweep_1d : s->g->dim == 2 ? sweep_2d : sweep_3d)(s, d->plain);
}

void tiles_diffusion_stage(struct gas *g, enum diffusing what, const struct state *Y0, const double c[5],
                           double weight) {
    const double factor[5] = {c[0], c[1], what == HEAT ? c[2] * (g->models.material.gamma - 1) : c[2], c[2] + c[3],
                              c[4]};
    (void)Y0;
    fill_sums(g, what, weight);
    for (int t = 0; t < g->forest->ntiles; t++)
        sweep_tile(&(struct sweep){.g = g, .what = what, .tile = t, .c = factor});
    g->tiles->diffuser.last = 1 - g->tiles->diffuser.last;
}

long tiles_diffusion_end(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to, double dt,
                         double weight) {
    long bad = 0;
    fill_sums(g, what, weight);
    for (int t = 0; t < g->forest->ntiles; t++) {
        struct sweep s = {.g = g, .what = what, .tile = t, .Y0 = Y0->block[t], .to = to->block[t], .dt = dt};
        sweep_tile(&s);
        bad += s.bad;
    }
    g->tiles->diffuser.marked |= bad > 0;
    return bad;
}

/* Leaves the tangential derivatives out of the stress on the faces of flagged cells. */
static void plain_faces(struct gas *g, int tile) {
    const struct forest *f = g->forest;
    const double *flag = g->tiles->flag[tile];
    for (int axis = 0; axis < g->dim; axis++) {
        double *keep = g->tiles->diffuser.keep[tile] + axis * f->size;
        for (long i = f->stride[axis]; i < f->size; i++) keep[i] = flag[i - f->stride[axis]] + flag[i] > 0 ? 0 : 1;
    }
}

/* Flags count from here on, the same on both sides of a face. */
long tiles_diffusion_flags(struct gas *g, bool keep) {
    const size_t bytes = (size_t)g->forest->size * sizeof(double);
    for (int t = 0; t < g->forest->ntiles && g->tiles->diffuser.marked; t++) {
        for (long i = 0; keep && i < g->forest->size; i++) g->tiles->flag[t][i] += g->tiles->diffuser.mark[t][i];
        memset(g->tiles->diffuser.mark[t], 0, bytes);
    }
    g->tiles->diffuser.marked = false;
    if (!keep) return 0;
    const long flagged = tiles_share_flags(g);
    for (int t = 0; t < g->forest->ntiles; t++) plain_faces(g, t);
    g->tiles->diffuser.plain = true;
    return flagged;
}
