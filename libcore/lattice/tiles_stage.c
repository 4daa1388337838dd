/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One Runge-Kutta stage of one tile, while it is in L2: primitives, fluxes of all axes, update, admissibility. In 2D
 * row by row. */
#include "libcore/lattice/tiles.h"

void runs_visit(const struct forest *f, const struct tile *tile, int margin, run_visitor *visit, void *context) {
    int reach[MAX_DIM] = {0};
    for (int k = 0; k < f->dim; k++) reach[k] = margin;
    for (int k = -reach[2]; k < tile->n[2] + reach[2]; k++)
        for (int j = -reach[1]; j < tile->n[1] + reach[1]; j++) {
            bool out_j = j < 0 || j >= tile->n[1], out_k = k < 0 || k >= tile->n[2];
            if (out_j && out_k) continue;
            int low = out_j || out_k ? 0 : -reach[0], high = tile->n[0] + (out_j || out_k ? 0 : reach[0]);
            long row = f->first + j * f->stride[1] + k * f->stride[2];
            for (int i = low; i < high; i += BATCH) visit(context, row + i, high - i < BATCH ? high - i : BATCH);
        }
}

void velocities_of_row(const struct gas *g, const double *U, long offset, int n) {
    double *velocity[MAX_DIM];
    for (int k = 0; k < g->components; k++) velocity[k] = g->tiles->work.velocity[k] + offset;
    velocity_row(n, g->components, g->forest->size, U + offset, velocity, g->tiles->work.eps + offset);
}

void primitives_of_row(const struct gas *g, const double *U, long offset, int n) {
    const struct work *w = &g->tiles->work;
    velocities_of_row(g, U, offset, n);
    g->models.eos->state(&g->models.material, n, U + offset, w->eps + offset, w->p + offset, w->c + offset,
                         w->gruneisen + offset);
    root_row(n, w->c + offset);
}

struct pass { /* what the visitors of this file need */
    struct gas *g;
    const double *U;
    int axis;
    const int *n;       /* cells of the tile along the axes */
    struct walls walls; /* under gravity */
};

static void primitive_visit(void *context, long offset, int n) {
    const struct pass *p = context;
    primitives_of_row(p->g, p->U, offset, n);
}

/* F = u_k U + p (0, e_k, u_k) */
KERNEL static void nodal_row(int n, int dim, int axis, long size, const double *restrict U, const double *restrict u,
                             const double *restrict p, double *const *flux) {
    for (int v = 0; v < dim + 2; v++) {
        const double *restrict q = U + v * size;
        double *restrict F = flux[v];
        if (v == 0)
            for (int i = 0; i < n; i++) F[i] = U[(axis + 1) * size + i];
        else if (v == dim + 1)
            for (int i = 0; i < n; i++) F[i] = (q[i] + p[i]) * u[i];
        else if (v == axis + 1)
            for (int i = 0; i < n; i++) F[i] = q[i] * u[i] + p[i];
        else
            for (int i = 0; i < n; i++) F[i] = q[i] * u[i];
    }
}

static void nodal_visit(void *context, long offset, int n) {
    const struct pass *pass = context;
    const struct gas *g = pass->g;
    double *flux[MAX_VAR];
    for (int v = 0; v < g->nvar; v++) flux[v] = g->tiles->work.flux[v] + offset;
    nodal_row(n, g->components, pass->axis, g->forest->size, pass->U + offset,
              g->tiles->work.velocity[pass->axis] + offset, g->tiles->work.p + offset, flux);
}

/* Faces along `axis` whose left cells start at `offset`; out[v] are the lines of variable v in program order, filled
 * from `column` on. */
static struct faces faces_at(const struct gas *g, const double *U, int axis, long offset, int n, double (*out)[BATCH],
                             int column) {
    const struct work *w = &g->tiles->work;
    struct faces f = {.n = whole_vectors(n),
                      .dim = g->components,
                      .stride = g->forest->stride[axis],
                      .p = w->p + offset,
                      .eps = w->eps + offset,
                      .c = w->c + offset,
                      .gruneisen = w->gruneisen + offset,
                      .fastest = g->fastest[axis],
                      .pace = w->pace[axis],
                      .params = &g->models.flux_params};
    for (int v = 0; v < g->nvar; v++) {
        int from = v; /* normal component first, the others in their order */
        if (v >= 1 && v <= g->components) from = v == 1 ? axis + 1 : v - 1 <= axis ? v - 1 : v;
        f.state[v] = U + from * g->forest->size + offset;
        f.flux[v] = w->flux[from] + offset;
        f.out[v] = out[from] + column;
        if (v >= 1 && v <= g->components) f.velocity[v - 1] = w->velocity[from - 1] + offset;
    }
    return f;
}

/* A limited face between two tiles is counted by the tile that holds its left cell. */
static bool is_counted(const struct gas *g, const struct strip *s, int i) {
    return s->from + (s->axis == 0 ? i : 0) >= 0 || g->forest->tile[s->tile].side[2 * s->axis].patch >= 0;
}

/* Limits the fluxes `out` through faces of flagged cells. */
static void limit_flagged(struct gas *g, const double *U, const struct strip *s, double (*out)[BATCH], int column) {
    double limited[MAX_VAR][BATCH], theta[BATCH];
    struct faces f = faces_at(g, U, s->axis, s->offset, s->n, limited, 0);
    const double *flag = g->tiles->flag[s->tile] + s->offset;
    bool any = false;
    for (int i = 0; i < s->n; i++) any |= flag[i] + flag[i + f.stride] > 0;
    if (!any) return;
    f.n = s->n;
    for (int v = 0; v < g->nvar; v++) memcpy(limited[v], out[v] + column, (size_t)s->n * sizeof(double));
    limit_faces(&f, g->least, g->limit, theta);
    for (int i = 0; i < s->n; i++) {
        if (flag[i] + flag[i + f.stride] == 0) continue;
        for (int v = 0; v < g->nvar; v++) out[v][column + i] = limited[v][i];
        g->faces += theta[i] < 1 && is_counted(g, s, i);
    }
}

/* Computes the fluxes through the faces f of a strip. */
static void through(const struct gas *g, const struct strip *s, const struct faces *f, const struct reconstruct *r) {
    if (balance_acts(g, s->axis) && g->tiles->work.taken[s->row])
        balance_through(g, s, f, r);
    else
        g->models.flux->through(f, g->models.eos, &g->models.material, r);
}

/* Takes the flux of first order at the faces of packed cells, in a gas whose slow impacts are elastic. There T may be a
 * millionth of u^2, so that an undershoot of E by as little would leave the cell without pressure, and its neighbours
 * would press it to packing: the collapse that the threshold keeps away. */
static void flatten_packed(const struct gas *g, const double *U, const struct strip *s, double (*out)[BATCH],
                           int column) {
    double lower[MAX_VAR][BATCH];
    struct faces f = faces_at(g, U, s->axis, s->offset, s->n, lower, 0);
    const double *rho = f.state[0];
    bool packed[BATCH], any = false;
    for (int i = 0; i < s->n; i++) any |= packed[i] = larger(rho[i], rho[i + f.stride]) > PACKED * g->limit;
    if (!any) return;
    g->models.flux->through(&f, g->models.eos, &g->models.material, g->first_order);
    for (int v = 0; v < g->nvar; v++)
        for (int i = 0; i < s->n; i++)
            if (packed[i]) out[v][column + i] = lower[v][i];
}

static void face_fluxes(struct gas *g, const double *U, const struct strip *s, double (*out)[BATCH], int column) {
    struct faces f = faces_at(g, U, s->axis, s->offset, s->n, out, column);
    through(g, s, &f, g->models.reconstruct);
    if (g->models.material.threshold > 0) flatten_packed(g, U, s, out, column);
    if (g->tiles->flagged[s->tile]) limit_flagged(g, U, s, out, column);
    if (g->fed) tiles_feed(g, U, s, out, column);
    if (tiles_hold_bed(g, s->tile)) tiles_note_fluxes(g, s, out, column);
    if (g->tally) tiles_tally(g, s, out, column);
}

KERNEL static void difference_row(int n, double inverse, const double *restrict low, const double *restrict high,
                                  bool add, double *restrict residual) {
    if (add)
        for (int i = 0; i < n; i++) residual[i] += (low[i] - high[i]) * inverse;
    else
        for (int i = 0; i < n; i++) residual[i] = (low[i] - high[i]) * inverse;
}

struct update {
    struct gas *g;
    const double *U0, *from;
    double *to, *flag;
    const double *falls; /* NULL: no cell of the tile falls */
    double a, dt;
    int tile;
    double *dropped; /* NULL: no cell of the tile, nor beside it, is flagged */
    int bad;
};

static void update_visit(void *context, long offset, int n) {
    struct update *u = context;
    const struct gas *g = u->g;
    const double *falls = u->falls ? u->falls + offset : NULL, *flag = u->dropped ? u->flag + offset : NULL;
    const double *part = tiles_hold_bed(g, u->tile) ? g->dense->part[u->tile] + offset : NULL;
    const struct advance s = {.U0 = u->U0 + offset,
                              .from = u->from + offset,
                              .residual = g->tiles->work.residual[0] + offset,
                              .each = g->size,
                              .to = u->to + offset,
                              .a = u->a,
                              .dt = u->dt};
    advance_row(g, n, &s, falls, flag);
    if (g->falls && u->dropped) drop_row(g, n, &s, falls, flag, part, u->dropped);
    if (part) freeze_row(g, n, &s, part);
    u->bad += row_limited(g, n, u->from + offset, u->to + offset, u->flag + offset);
    u->g->computed += n;
}

/* Advances the background, a cell whose residual is that of gravity alone, with the bits of update_visit. */
static void settle_background(const struct update *u) {
    const double none[MAX_VAR] = {0};
    const struct advance s = {
        .U0 = u->U0, .from = u->from, .residual = none, .each = 1, .to = u->to, .a = u->a, .dt = u->dt};
    advance_row(u->g, 1, &s, u->falls, NULL);
}

/* residual = -(F_high - F_low)/width along axis 0, where a row holds its faces side by side. */
static void sweep_row(struct gas *g, int tile, const double *U, int j, int k) {
    const struct forest *f = g->forest;
    double faces[MAX_VAR][BATCH], inverse = 1 / f->width[0];
    const struct activity *a = &g->tiles->activity;
    const struct span *row = activity_row(a, a->active, j, k), s = *row;
    if (span_empty(s)) return;
    long offset = f->first + s.low + j * f->stride[1] + k * f->stride[2];
    const struct strip strip = {
        .tile = tile, .n = s.high - s.low + 1, .offset = offset - 1, .from = s.low - 1, .row = (int)(row - a->active)};
    face_fluxes(g, U, &strip, faces, 0);
    for (int v = 0; v < g->nvar; v++)
        difference_row(s.high - s.low, inverse, faces[v], faces[v] + 1, false, g->tiles->work.residual[v] + offset);
}

struct column { /* rows one above the other along `axis`, at place `outer` of the third axis */
    int axis, outer;
    double faces[2][MAX_VAR][BATCH]; /* below and above a row, in turn */
};

/* The row of activity_row at place j of a column. */
static int row_of(const struct gas *g, const struct column *c, int j) {
    const struct activity *a = &g->tiles->activity;
    return (int)(activity_row(a, a->active, c->axis == 1 ? j : c->outer, c->axis == 1 ? c->outer : j) - a->active);
}

static struct span active_span(const struct gas *g, int tile, const struct column *c, int j) {
    if (j < 0 || j >= g->forest->tile[tile].n[c->axis]) return SPAN_EMPTY;
    return g->tiles->activity.active[row_of(g, c, j)];
}

/* Adds to the residual of row j of a column, j from -1 on, what its faces along the column's axis give. The faces
 * between rows j and j + 1 cover the active spans of both; those below row j were kept from the call before. */
static void sweep_column(struct gas *g, int tile, const double *U, struct column *c, int j) {
    const struct forest *f = g->forest;
    double inverse = 1 / f->width[c->axis];
    struct span mine = active_span(g, tile, c, j), s = span_join(mine, active_span(g, tile, c, j + 1));
    double(*low)[BATCH] = c->faces[(j + 1) % 2], (*high)[BATCH] = c->faces[(j + 2) % 2];
    long row = f->first + j * f->stride[c->axis] + c->outer * f->stride[c->axis == 1 ? 2 : 1];
    const struct strip strip = {
        .tile = tile, .axis = c->axis, .n = s.high - s.low, .offset = row + s.low, .from = j, .row = row_of(g, c, j)};
    if (!span_empty(s)) face_fluxes(g, U, &strip, high, s.low);
    for (int v = 0; v < g->nvar && !span_empty(mine); v++)
        difference_row(mine.high - mine.low, inverse, low[v] + mine.low, high[v] + mine.low, true,
                       g->tiles->work.residual[v] + row + mine.low);
}

/* The columns of row (j, k) above which the fluxes along the pass's axis read the balance of faces. `needed` has
 * besides whole vectors of active cells what fluxes along axis 0 read. */
static struct span balanced_span(const struct pass *pass, int j, int k) {
    const struct activity *a = &pass->g->tiles->activity;
    const int n = pass->n[0], reach = pass->g->models.reconstruct->reach;
    struct span s = *activity_row(a, pass->axis == 0 ? a->active : a->needed, j, k);
    if (span_empty(s)) return s;
    if (pass->axis == 0) return (struct span){s.low - 1 - reach, s.high + reach};
    return (struct span){s.low < 0 ? 0 : whole_vectors(s.low), s.high < n ? s.high / 8 * 8 : n};
}

/* Computes the balance of row (j, k) along the pass's axis, wherever fluxes need it. */
static void balance(const struct pass *pass, int j, int k) {
    const struct gas *g = pass->g;
    const struct activity *a = &g->tiles->activity;
    const struct span s = balanced_span(pass, j, k);
    const long offset = g->forest->first + s.low + j * g->forest->stride[1] + k * g->forest->stride[2];
    const int place = pass->axis == 0 ? s.low : pass->axis == 1 ? j : k;
    if (span_empty(s)) return;
    g->tiles->work.taken[activity_row(a, a->active, j, k) - a->active] =
        balance_row(g, &pass->walls, pass->U, pass->axis, place, offset, s.high - s.low);
}

/* The same of all rows of a tile. */
static void balance_rows(const struct pass *pass) {
    const int *n = pass->n, below = 1 + pass->g->models.reconstruct->reach, above = below - 1;
    const bool y = pass->axis == 1, z = pass->axis == 2;
    for (int k = z ? -below : 0; k < n[2] + (z ? above : 0); k++)
        for (int j = y ? -below : 0; j < n[1] + (y ? above : 0); j++) balance(pass, j, k);
}

static void sweep_columns(struct gas *g, int tile, const double *U, int axis) {
    const int *n = g->forest->tile[tile].n, outer = 3 - axis;
    struct column column = {.axis = axis};
    for (column.outer = 0; column.outer < n[outer]; column.outer++)
        for (int j = -1; j < n[axis]; j++) sweep_column(g, tile, U, &column, j);
}

/* All rows of a tile, axis by axis. */
static void sweep_axes(struct gas *g, int tile, struct pass *pass, struct update *update) {
    const int *n = g->forest->tile[tile].n;
    spans_visit(g, tile, g->tiles->activity.needed, GHOSTS, primitive_visit, pass);
    for (pass->axis = 0; pass->axis < g->dim; pass->axis++) {
        spans_visit(g, tile, g->tiles->activity.needed, GHOSTS, nodal_visit, pass);
        if (balance_acts(g, pass->axis)) balance_rows(pass);
        for (int k = 0; k < n[2] && pass->axis == 0; k++)
            for (int j = 0; j < n[1]; j++) sweep_row(g, tile, pass->U, j, k);
        if (pass->axis > 0) sweep_columns(g, tile, pass->U, pass->axis);
    }
    spans_visit(g, tile, g->tiles->activity.active, 0, update_visit, update);
}

/* The same in 2D, row by row while a row is in L1: primitives and nodal fluxes of the row for both axes, its faces
 * along axis 0, then the faces along axis 1 whose stencil the row completes, and the update of the row below these. */
static void sweep_rows(struct gas *g, int tile, struct pass *pass, struct update *update) {
    struct activity *a = &g->tiles->activity;
    struct column column = {.axis = 1};
    int n = g->forest->tile[tile].n[1];
    for (int top = -GHOSTS; top < n + GHOSTS; top++) {
        int j = top - GHOSTS;
        span_visit(g, a->needed, top, 0, primitive_visit, pass);
        if (top >= 0 && top < n) {
            pass->axis = 0;
            span_visit(g, a->needed, top, 0, nodal_visit, pass);
            if (balance_acts(g, 0)) balance(pass, top, 0);
            sweep_row(g, tile, pass->U, top, 0);
        }
        pass->axis = 1;
        span_visit(g, a->needed, top, 0, nodal_visit, pass);
        if (balance_acts(g, 1) && top > -GHOSTS) balance(pass, top - 1, 0);
        if (j >= -1) sweep_column(g, tile, pass->U, &column, j);
        if (j >= 0) span_visit(g, a->active, j, 0, update_visit, update);
    }
}

/* Sets dt/dx of the faces along each axis. */
static void set_paces(struct gas *g) {
    for (int k = 0; k < g->dim; k++)
        for (int i = 0; i < BATCH; i++) g->tiles->work.pace[k][i] = g->dt / g->forest->width[k];
}

int stage_of_tile(struct gas *g, int tile, const struct state *U0, const struct state *from, const struct state *to,
                  double a, double dt) {
    struct pass pass = {.g = g, .U = from->block[tile], .n = g->forest->tile[tile].n};
    struct update update = {.g = g,
                            .U0 = U0->block[tile],
                            .from = from->block[tile],
                            .to = to->block[tile],
                            .flag = g->tiles->flag[tile],
                            .falls = g->falls && g->falling[tile] ? g->falls[tile] : NULL,
                            .dropped = g->dropped && g->tiles->flagged[tile] ? &g->dropped[tile] : NULL,
                            .a = a,
                            .dt = dt,
                            .tile = tile};
    struct activity *active = &g->tiles->activity;
    if (g->models.flux->paced) set_paces(g);
    if (g->falls) balance_walls(g, tile, &pass.walls);
    if (g->tally) tiles_tally_begin(g, tile, from->block[tile]);
    if (activity_spread(g, tile, U0, from)) {
        activity_store(g, tile, from, active->needed, GHOSTS);
        activity_store(g, tile, U0, active->active, 0);
        (g->dim == 2 ? sweep_rows : sweep_axes)(g, tile, &pass, &update);
    }
    settle_background(&update);
    memcpy(to->varied[tile], active->active, (size_t)active->nspans * sizeof(struct span));
    for (int i = 0; i < active->nspans && tiles_hold_bed(g, tile); i++)
        to->varied[tile][i] = (struct span){0, g->forest->tile[tile].n[0]};
    const int *n = g->forest->tile[tile].n;
    g->all += (long)n[0] * n[1] * n[2];
    return update.bad;
}
