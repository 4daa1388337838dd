/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coefficients of diffusion on the faces of a lattice, and the rates that bound its steps. */
#include "libcore/lattice/tiles_diffuser.h"

#include <stdlib.h>

static status sheets_make(const struct forest *f, double ***out) {
    TRY(allocate(out, f->ntiles, sizeof(double *), "tiles"));
    for (int t = 0; t < f->ntiles && f->dim > 1; t++)
        TRY(allocate(&(*out)[t], 4 * f->dim * SHEET_LINES(f->dim) * f->sheet + SLACK, sizeof(double),
                     "sides of tiles"));
    return OK;
}

status tiles_diffuser_make(struct gas *g) {
    struct diffuser *d;
    TRY(allocate(&d, 1, sizeof *d, "diffusion"));
    g->tiles->diffuser = d;
    double ***blocks[] = {&d->sum[0], &d->sum[1], &d->start};
    for (int i = 0; i < 3; i++) TRY(blocks_make(g->forest, g->components, blocks[i]));
    TRY(sheets_make(g->forest, &d->sheet));
    TRY(blocks_make(g->forest, FACE_LINES * g->dim, &d->face));
    TRY(blocks_make(g->forest, g->dim, &d->keep));
    for (int t = 0; t < g->forest->ntiles && g->diffusion.terms.diagonal; t++)
        memset(d->keep[t], 0, (size_t)(g->dim * g->forest->size) * sizeof(double));
    TRY(blocks_make(g->forest, 1, &d->light));
    for (int i = 0; i < 2; i++) g->diffusion.sum[i] = d->sum[i];
    g->diffusion.wide = g->size;
    TRY(blocks_make(g->forest, WALL_LINES, &d->wall));
    for (int i = 0; g->dim > 2 && i < 2; i++)
        TRY(allocate(&d->plane[i], g->forest->stride[2] / g->forest->stride[1], sizeof *d->plane[i], "diffusion"));
    TRY(tiles_turn_make(g));
    return g->diffusion.terms.cross ? blocks_make(g->forest, g->dim + 1, &d->cross) : OK;
}

void tiles_diffuser_free(struct gas *g) {
    struct diffuser *d = g->tiles->diffuser;
    if (!d) return;
    double **blocks[] = {d->sum[0], d->sum[1], d->start, d->sheet, d->face,
                         d->light,  d->wall,   d->keep,  d->cross, d->turn};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) blocks_free(g->forest, blocks[i]);
    for (int i = 0; i < 2; i++) free(d->plane[i]);
    free(d);
}

struct coefficients { /* what coefficient_visit needs */
    const struct gas *g;
    const double *U;
    double *warm, *cross, *dilation; /* lines of cells; NULL: there is no such term */
    const double *shear_rate;        /* NULL: the law does not ask for it */
};

/* T of n cells at `offset` of a block U; their velocity and eps go to the workspace. */
static void temperature_of_row(const struct gas *g, const double *U, long offset, int n, double T[BATCH]) {
    velocities_of_row(g, U, offset, n);
    for (int i = 0; i < n; i++) T[i] = temperature_of(&g->models.material, g->tiles->work.eps[offset + i]);
}

/* The coefficients bulk, shear and heat of a run of cells go to the scratch lines p, c and gruneisen, others to lines
 * of their own. */
static void coefficient_visit(void *context, long offset, int n) {
    const struct coefficients *v = context;
    const struct gas *g = v->g;
    const struct work *w = &g->tiles->work;
    double T[BATCH], *warm = v->warm + offset;
    temperature_of_row(g, v->U, offset, n, T);
    for (int i = 0; i < n; i++) T[i] = larger(T[i], COLDEST);
    for (int i = 0; i < n && g->diffusion.ahead; i++) T[i] *= warm[i];
    for (int i = 0; i < n && !g->diffusion.ahead; i++) warm[i] = T[i];
    const struct gas_models *m = &g->models;
    const struct closure_line cells = {.eos = m->eos,
                                       .material = &m->material,
                                       .n = n,
                                       .rho = v->U + offset,
                                       .T = T,
                                       .shear_rate = v->shear_rate ? v->shear_rate + offset : NULL};
    transport_row(g, &cells, w->p + offset, w->c + offset, w->gruneisen + offset);
    if (v->cross) m->transport->cross(&m->transport_params, &cells, v->cross + offset);
    if (v->dilation) m->transport->dilation(&m->transport_params, &cells, v->dilation + offset);
}

ALWAYS_INLINE double harmonic(double a, double b) {
    return 2 * a * b / (a + b + 1e-300); /* two zeros give 0 */
}

/* Coefficients of the faces below n cells from `at` on; `trace`: 2/d; w: as coefficient_visit leaves it. */
KERNEL static void face_coefficients(int n, long step, long size, double trace, double width, const struct work *w,
                                     long at, double *restrict face) {
    const double *restrict bulk = w->p + at, *restrict shear = w->c + at, *restrict heat = w->gruneisen + at;
    const double square = 1 / (width * width);
    for (int i = 0; i < n; i++) {
        double mu = harmonic(shear[i - step], shear[i]), lambda = harmonic(bulk[i - step], bulk[i]) - trace * mu;
        face[NORMAL * size + i] = square * (lambda + 2 * mu);
        face[SHEAR * size + i] = square * mu;
        face[CONDUCTION * size + i] = square * harmonic(heat[i - step], heat[i]);
    }
}

/* cross has either sign (it is below 0 near packing at e = 0.5): where the signs differ it passes through 0. */
KERNEL static void cross_faces(int n, long step, double width, double thin, const double *restrict rho,
                               const double *restrict cross, double *restrict face) {
    const double square = 1 / (width * width);
    for (int i = 0; i < n; i++) {
        const double a = cross[i - step], b = cross[i];
        const double r = rho[i - step], s = rho[i], most = 2 * harmonic(fabs(a) * r, fabs(b) * s);
        face[i] =
            cross_jump(thin, square * select_double(a * b > 0, harmonic(a, b), 0), s - r, smaller(r, s), square * most);
    }
}

static long row_at(const struct forest *f, int j, int k) {
    return f->first + j * f->stride[1] + k * f->stride[2];
}

static void tile_faces(struct gas *g, int tile, const double *rho) {
    const struct forest *f = g->forest;
    const int *n = f->tile[tile].n;
    const struct work *w = &g->tiles->work;
    const double trace = trace_share(&g->models.material);
    const double thin = g->diffusion.terms.thin / packing_per_density(&g->models.material);
    for (int axis = 0; axis < g->dim; axis++) {
        double *face = g->tiles->diffuser->face[tile] + FACE_LINES * axis * f->size;
        double *cross = g->diffusion.terms.cross ? g->tiles->diffuser->cross[tile] : NULL;
        for (int k = 0; k < n[2] + (axis == 2); k++)
            for (int j = 0; j < n[1] + (axis == 1); j++) {
                long at = row_at(f, j, k);
                face_coefficients(n[0] + (axis == 0), f->stride[axis], f->size, trace, f->width[axis], w, at,
                                  face + at);
                if (cross)
                    cross_faces(n[0] + (axis == 0), f->stride[axis], f->width[axis], thin, rho + at,
                                cross + g->dim * f->size + at, cross + axis * f->size + at);
            }
    }
}

/* Adds what the faces along one axis bring to the rates of a row. */
KERNEL static void add_rates(int n, long step, long size, const double *restrict face, double (*restrict sum)[BATCH]) {
    const double *restrict normal = face + NORMAL * size, *restrict heat = face + CONDUCTION * size;
    for (int i = 0; i < n; i++) {
        sum[0][i] += normal[i] + normal[i + step];
        sum[1][i] += heat[i] + heat[i + step];
    }
}

/* Computes the rates of n cells of a tile from `at` on, with the 1/rho that is kept. */
static void rates_row(const struct gas *g, int tile, long at, int n, double (*rate)[BATCH]) {
    const struct forest *f = g->forest;
    const struct diffuser *d = g->tiles->diffuser;
    const double factor[2] = {1, temperature_of(&g->models.material, 1)}, *light = d->light[tile] + at;
    const double *face = d->face[tile] + at;
    if (d->turn) {
        tiles_turn_rates(g, n, turn_line(g, tile, 0) + at, face, rate);
    } else {
        memset(rate, 0, 2 * sizeof *rate);
        for (int axis = 0; axis < g->dim; axis++)
            add_rates(n, f->stride[axis], f->size, face + FACE_LINES * axis * f->size, rate);
    }
    for (int what = 0; what < 2; what++)
        for (int i = 0; i < n; i++) rate[what][i] = factor[what] * rate[what][i] * light[i];
}

/* each: two lines of the tile, or NULL */
static void tile_rates(const struct gas *g, int tile, const double *rho, double most[2], double *each) {
    const int *n = g->forest->tile[tile].n;
    double *light = g->tiles->diffuser->light[tile], rate[2][BATCH];
    for (int k = 0; k < n[2]; k++)
        for (int j = 0; j < n[1]; j++) {
            const long at = row_at(g->forest, j, k);
            for (int i = 0; i < n[0]; i++) light[at + i] = 1 / rho[at + i];
            rates_row(g, tile, at, n[0], rate);
            for (int what = 0; what < 2 && each; what++)
                memcpy(each + what * g->size + at, rate[what], (size_t)n[0] * sizeof *each);
            for (int what = 0; what < 2; what++)
                for (int i = 0; i < n[0]; i++) most[what] = larger(rate[what][i], most[what]);
        }
}

void edges_visit(struct gas *g, int tile, edge_visitor *visit, const void *context) {
    const struct forest *f = g->forest;
    const struct tile *t = &f->tile[tile];
    for (int side = 0; side < 2 * g->dim; side++) {
        const int axis = side / 2, across = axis == 0 ? 1 : 0, deep = axis == 2 ? 1 : 2;
        if (t->side[side].patch < 0) continue;
        struct edge e = {.rules = &g->patches.rules[t->side[side].patch], .normal = axis, .step = f->stride[across]};
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

/* Square of the velocity of the gas along a wall, less the wall's own. Velocities are still in the workspace. */
static double slip_at(const struct gas *g, const struct edge *e, double turn, int i) {
    double w[MAX_DIM], square = 0;
    wall_velocity(e->rules, g->components, e->face[i], w);
    for (int k = 0; k < g->components; k++) {
        const double u = g->tiles->work.velocity[k][e->from + i * e->step];
        const double s = (k == g->models.swirl ? turn * u : u) - w[k];
        if (k != e->normal) square += s * s;
    }
    return square;
}

struct wall_batch { /* the lines of a struct wall_line */
    double rho[BATCH], T[BATCH], push[BATCH], d[BATCH], shear[BATCH], heat[BATCH], slip[BATCH], cross[BATCH];
};

/* Gathers the cells at a wall. Velocities and eps are still in the workspace. */
static void take_wall(const struct gas *g, int tile, const struct edge *e, const double *rho, struct wall_batch *b) {
    const long size = g->forest->size, face = e->to > e->from ? e->to : e->from;
    const struct diffuser *d = g->tiles->diffuser;
    const double width = g->forest->width[e->normal], *faces = d->face[tile] + FACE_LINES * e->normal * size;
    const bool slides = wall_slides(e->rules);
    const double turn = edge_turn(g, tile, e);
    for (int i = 0; i < e->n; i++) {
        const long at = e->from + i * e->step, over = face + i * e->step;
        b->rho[i] = rho[at];
        b->T[i] = larger(temperature_of(&g->models.material, g->tiles->work.eps[at]), COLDEST) *
                  (g->diffusion.ahead ? g->diffusion.warm[tile][at] : 1);
        b->push[i] = e->to > e->from ? g->diffusion.pull[e->normal] : -g->diffusion.pull[e->normal];
        b->d[i] = width;
        b->shear[i] = width * width * faces[SHEAR * size + over];
        b->heat[i] = width * width * faces[CONDUCTION * size + over];
        b->slip[i] = slides ? slip_at(g, e, turn, i) : 0;
        b->cross[i] = d->cross ? d->cross[tile][g->dim * size + at] : 0;
    }
}

/* Sets the shares at an open patch. Velocities are still in the workspace. */
static void note_inflow(const struct gas *g, const struct edge *e, double *share) {
    const double *u = g->tiles->work.velocity[e->normal], out = e->to > e->from ? 1 : -1;
    for (int i = 0; i < e->n; i++) share[e->to + i * e->step] = inflow_share(out * u[e->from + i * e->step]);
}

/* Finds the shares of drag and heat at a wall; the share of heat goes into the coefficients of the wall's faces. */
static void wall_edge(struct gas *g, int tile, const struct edge *e, const void *context) {
    const struct forest *f = g->forest;
    const struct diffuser *d = g->tiles->diffuser;
    const long face = e->to > e->from ? e->to : e->from;
    double *heat = d->face[tile] + (FACE_LINES * e->normal + CONDUCTION) * f->size + face, *wall = d->wall[tile],
           share[2][BATCH];
    struct wall_batch b;
    struct wall_line line = {.n = e->n,
                             .face = e->face,
                             .eos = g->models.eos,
                             .material = &g->models.material,
                             .rho = b.rho,
                             .T = b.T,
                             .push = b.push,
                             .d = b.d,
                             .shear = b.shear,
                             .heat = b.heat,
                             .slip = b.slip,
                             .cross = d->cross ? b.cross : NULL};
    if (!patch_is_wall(e->rules)) {
        note_inflow(g, e, wall + DRAG * f->size);
        return;
    }
    take_wall(g, tile, e, context, &b);
    wall_shares(e->rules, &line, share[0], share[1]);
    for (int i = 0; i < e->n; i++) {
        const long beyond = e->to + i * e->step;
        wall[DRAG * f->size + beyond] = share[0][i];
        wall[STAYS * f->size + beyond] = line.stays[i];
        if (wall_conducts(e->rules)) heat[i * e->step] *= share[1][i];
    }
    if (!d->cross || !wall_conducts(e->rules)) return;
    double *cross = d->cross[tile] + e->normal * f->size + face;
    const double sign = e->to > e->from ? 1 : -1;
    for (int i = 0; i < e->n; i++) {
        heat[i * e->step] *= line.through[i] / b.heat[i];
        cross[i * e->step] = sign * line.fed[i] / f->width[e->normal];
    }
}

void tiles_diffusion_rates(struct gas *g, const struct state *Y0, double most[2], const struct state *each) {
    const struct forest *f = g->forest;
    most[0] = most[1] = 0;
    g->tiles->diffuser->plain = g->diffusion.terms.diagonal;
    forest_fill_layers(g->forest, 1, g->nvar, Y0->block);
    for (int t = 0; t < f->ntiles; t++) {
        const struct diffuser *d = g->tiles->diffuser;
        struct coefficients v = {g,
                                 Y0->block[t],
                                 g->diffusion.warm[t],
                                 d->cross ? d->cross[t] + g->dim * f->size : NULL,
                                 g->diffusion.dilation ? g->diffusion.dilation[t] : NULL,
                                 shear_rate_at(g, g->models.transport->needs, t, 0)};
        ghosts_of_patches(g, t, Y0->block[t], GHOSTS, NULL);
        runs_visit(f, &f->tile[t], 1, coefficient_visit, &v);
        tile_faces(g, t, Y0->block[t]);
        edges_visit(g, t, wall_edge, Y0->block[t]);
        tile_rates(g, t, Y0->block[t], most, each ? each->block[t] : NULL);
    }
}
