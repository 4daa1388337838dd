/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One Runge-Kutta stage of one tile: primitives, fluxes of all axes, update, admissibility. In 2D row by row while rows
 * are in L1, in 3D so within a plane, and plane by plane while planes are in L2. */
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
    struct walls walls; /* under gravity */
};

static void primitive_visit(void *context, long offset, int n) {
    const struct pass *p = context;
    primitives_of_row(p->g, p->U, offset, n);
}

/* F = u_k U + p (0, e_k, u_k), but for the mass, whose flux is the momentum. */
KERNEL static void nodal_row(int n, int dim, int axis, long size, const double *restrict U, const double *restrict u,
                             const double *restrict p, double *const *flux) {
    for (int v = 1; v < dim + 2; v++) {
        const double *restrict q = U + v * size;
        double *restrict F = flux[v];
        if (v == dim + 1)
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
    const struct axis_lines *lines = &g->tiles->work.along[pass->axis];
    double *flux[MAX_VAR];
    for (int v = 1; v < g->nvar; v++) flux[v] = lines->flux[v] + offset - lines->origin;
    nodal_row(n, g->components, pass->axis, g->forest->size, pass->U + offset,
              g->tiles->work.velocity[pass->axis] + offset, g->tiles->work.p + offset, flux);
}

/* Makes f the faces of a strip; out[v] are the lines of variable v in program
 * order, filled from `column` on. Filled in place: a copy of a struct that was just written would wait for the writes.
 */
static void make_faces(const struct gas *g, const double *U, const struct strip *s, double (*out)[BATCH], int column,
                       struct faces *f) {
    const struct work *w = &g->tiles->work;
    const int axis = s->axis;
    const long offset = s->offset;
    const struct axis_lines *lines = &w->along[axis];
    memset(f, 0, sizeof *f);
    f->n = whole_vectors(s->n);
    f->padding = f->n - s->n;
    f->dim = g->components;
    f->beyond = g->components - g->dim;
    f->stride = g->forest->stride[axis];
    f->p = w->p + offset;
    f->floor = fronts_floor(g, s);
    f->eps = w->eps + offset;
    f->c = w->c + offset;
    f->gruneisen = w->gruneisen + offset;
    f->falls = g->falling.cells != NULL;
    f->fastest = g->step.fastest[axis];
    f->pace = w->pace[axis];
    f->params = &g->models.flux_params;
    for (int v = 0; v < g->nvar; v++) {
        int from = v; /* normal component first, the others in their order */
        if (v >= 1 && v <= g->components) from = v == 1 ? axis + 1 : v - 1 <= axis ? v - 1 : v;
        f->state[v] = U + from * g->forest->size + offset;
        f->flux[v] = v == 0 ? U + (axis + 1) * g->forest->size + offset : lines->flux[from] + offset - lines->origin;
        f->out[v] = out[from] + column;
        if (v >= 1 && v <= g->components) f->velocity[v - 1] = w->velocity[from - 1] + offset;
    }
}

/* A limited face between two tiles is counted by the tile that holds its left cell. */
static bool is_counted(const struct gas *g, const struct strip *s, int i) {
    return s->from + (s->axis == 0 ? i : 0) >= 0 || g->forest->tile[s->tile].side[2 * s->axis].patch >= 0;
}

/* Limits the fluxes `out` through faces of flagged cells. */
static void limit_flagged(struct gas *g, const double *U, const struct strip *s, double (*out)[BATCH], int column) {
    double limited[MAX_VAR][BATCH], theta[BATCH];
    struct faces f;
    make_faces(g, U, s, limited, 0, &f);
    const double *flag = g->limits.flags.cells[s->tile] + s->offset;
    bool any = false;
    for (int i = 0; i < s->n; i++) any |= flag[i] + flag[i + f.stride] > 0;
    if (!any) return;
    f.n = s->n;
    for (int v = 0; v < g->nvar; v++) memcpy(limited[v], out[v] + column, (size_t)s->n * sizeof(double));
    limit_faces(&f, g->limits.least, g->limits.most, theta);
    for (int i = 0; i < s->n; i++) {
        if (flag[i] + flag[i + f.stride] == 0) continue;
        for (int v = 0; v < g->nvar; v++) out[v][column + i] = limited[v][i];
        g->limits.faces += theta[i] < 1 && is_counted(g, s, i);
    }
}

/* Computes the fluxes through the faces f of a strip. */
static void through(const struct gas *g, const struct strip *s, const struct faces *f, const struct reconstruct *r) {
    if (balance_acts(g, s->axis) && g->tiles->work.along[s->axis].taken[s->row])
        balance_through(g, s, f, r);
    else
        g->models.flux->through(f, g->models.eos, &g->models.material, r);
}

/* Chooses the faces of packed cells; returns bits that are all 0 if there are none. */
KERNEL static uint64_t find_packed(int n, long stride, double most, const double *restrict rho,
                                   double *restrict packed) {
    uint64_t any = 0;
    for (int i = 0; i < n; i++) {
        packed[i] = larger(rho[i], rho[i + stride]) > most ? 1 : 0;
        any |= bits_of(packed[i]);
    }
    return any;
}

/* The faces of a strip from the first chosen one to the last; there is one. */
static struct strip strip_of_chosen(const struct strip *s, const double *chosen) {
    struct strip of = *s;
    int low = 0, high = s->n;
    while (!(chosen[low] > 0)) low++;
    while (!(chosen[high - 1] > 0)) high--;
    of.n = high - low;
    of.offset += low;
    of.column += low;
    if (s->axis == 0) of.from += low;
    return of;
}

/* Takes the flux of first order at the faces of packed cells, in a gas whose slow impacts are elastic. There T may be a
 * millionth of u^2, so that an undershoot of E by as little would leave the cell without pressure, and its neighbours
 * would press it to packing: the collapse that the threshold keeps away. flat: faces that have it already, or NULL. */
static void flatten_packed(const struct gas *g, const double *U, const struct strip *s, const double *flat,
                           double (*out)[BATCH], int column) {
    double packed[BATCH], lower[MAX_VAR][BATCH];
    struct faces f;
    if (!find_packed(s->n, g->forest->stride[s->axis], PACKED * g->limits.most, U + s->offset, packed)) return;
    const struct strip part = strip_of_chosen(s, packed);
    const int skipped = part.column - s->column;
    make_faces(g, U, &part, lower, 0, &f);
    g->models.flux->through(&f, g->models.eos, &g->models.material, g->limits.first_order);
    for (int i = skipped; i < skipped + part.n; i++)
        for (int v = 0; v < g->nvar && packed[i] > 0 && !(flat && flat[i] > 0); v++)
            out[v][column + i] = lower[v][i - skipped];
}

/* The faces of thin cells beside dense ones are flat: a polynomial through densities a hundredfold apart carries energy
 * into a cell without mass, which then gets a T and a speed beyond those of the gas. */
static void face_fluxes(struct gas *g, const double *U, const struct strip *s, double (*out)[BATCH], int column) {
    struct faces f;
    double flat[BATCH];
    make_faces(g, U, s, out, column, &f);
    if (voids_find(g, U, s, flat)) f.flat = flat;
    through(g, s, &f, g->models.reconstruct);
    if (g->models.material.threshold > 0) flatten_packed(g, U, s, f.flat, out, column);
    if (g->limits.flags.blocks[s->tile]) limit_flagged(g, U, s, out, column);
    if (g->patches.fed) tiles_feed(g, U, s, out, column);
    if (tiles_hold_bed(g, s->tile)) tiles_note_fluxes(g, s, out, column);
    if (g->books.tally) tiles_tally(g, s, out, column);
}

static struct faces_of_row faces_of_row(const struct gas *g, int axis, const double *low, const double *high) {
    return (struct faces_of_row){(const double(*)[BATCH])low, (const double(*)[BATCH])high, 1 / g->forest->width[axis]};
}

/* Computes residual = -div F of a row, summed from the first axis on. */
ALWAYS_INLINE void residual_dim(const int dim, int n, int nvar, const struct faces_of_row f[MAX_DIM],
                                double (*restrict residual)[BATCH]) {
    const double ix = f[0].inverse, iy = dim > 1 ? f[1].inverse : 0, iz = dim > 2 ? f[2].inverse : 0;
    for (int v = 0; v < nvar; v++) {
        const double *restrict xl = f[0].low[v], *restrict xh = f[0].high[v];
        const double *restrict yl = dim > 1 ? f[1].low[v] : xl, *restrict yh = dim > 1 ? f[1].high[v] : xl;
        const double *restrict zl = dim > 2 ? f[2].low[v] : xl, *restrict zh = dim > 2 ? f[2].high[v] : xl;
        for (int i = 0; i < n; i++) {
            double sum = (xl[i] - xh[i]) * ix;
            if (dim > 1) sum += (yl[i] - yh[i]) * iy;
            if (dim > 2) sum += (zl[i] - zh[i]) * iz;
            residual[v][i] = sum;
        }
    }
}
KERNEL static void residual_row(int dim, int n, int nvar, const struct faces_of_row f[MAX_DIM],
                                double (*restrict residual)[BATCH]) {
    if (dim == 1) residual_dim(1, n, nvar, f, residual);
    if (dim == 2) residual_dim(2, n, nvar, f, residual);
    if (dim == 3) residual_dim(3, n, nvar, f, residual);
}

/* Marks the cells that `residual` changes neither in density nor in energy; returns whether there are any. */
KERNEL static bool find_still(int n, double dt, const double *restrict rho, const double *restrict E,
                              const double *restrict mass, const double *restrict power, uint64_t *restrict still) {
    uint64_t any = 0;
    for (int i = 0; i < n; i++) {
        still[i] = -(uint64_t)((rho[i] + dt * mass[i] == rho[i]) & (E[i] + dt * power[i] == E[i]));
        any |= still[i];
    }
    return any != 0;
}

/* Clears the residuals of those cells whose momentum they change by at most 2^-53 rho c. */
KERNEL static void still_cells(int n, int nvar, double dt, const double *restrict rho, const double *restrict c,
                               uint64_t *restrict still, double (*restrict residual)[BATCH]) {
    for (int v = 1; v < nvar - 1; v++)
        for (int i = 0; i < n; i++) still[i] &= -(uint64_t)(dt * fabs(residual[v][i]) <= 0x1p-53 * (rho[i] * c[i]));
    for (int v = 0; v < nvar; v++)
        for (int i = 0; i < n; i++) residual[v][i] = double_of(bits_of(residual[v][i]) & ~still[i]);
}

/* Takes a change of the state below round-off for none. Momentum across a stream that a wave meets falls from cell to
 * cell without ever being 0; the stream would carry that ahead of the wave by three cells a stage, and soon no gas
 * would be uniform (tiles_activity.c). Where neither density nor energy change by a bit, momentum that is less than the
 * round-off of the fluxes, some 2^-53 p dt/dx, says nothing. Mass and energy stay as they were. */
static void still_row(const struct gas *g, int n, double dt, const double *U, long offset, double (*residual)[BATCH]) {
    ALIGNED uint64_t still[BATCH];
    const long energy = energy_at(g) * g->forest->size;
    if (find_still(n, dt, U, U + energy, residual[0], residual[energy_at(g)], still))
        still_cells(n, g->nvar, dt, U, g->tiles->work.c + offset, still, residual);
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

/* Advances n cells of a row from `offset` on by their residual. */
static void update_row(struct update *u, long offset, int n, double (*residual)[BATCH]) {
    const struct gas *g = u->g;
    const double *falls = u->falls ? u->falls + offset : NULL, *flag = u->dropped ? u->flag + offset : NULL;
    const double *part = tiles_hold_bed(g, u->tile) ? g->dense->part[u->tile] + offset : NULL;
    double radius[BATCH];
    const struct advance s = {.weight = u->dropped ? row_radius(g, u->tile, offset, n, radius) : NULL,
                              .U0 = u->U0 + offset,
                              .from = u->from + offset,
                              .residual = residual[0],
                              .each = BATCH,
                              .to = u->to + offset,
                              .a = u->a,
                              .dt = u->dt};
    still_row(g, n, u->dt, s.from, offset, residual);
    advance_row(g, n, &s, falls, flag);
    if (g->falling.cells && u->dropped) drop_row(g, n, &s, falls, flag, part, u->dropped);
    if (part) freeze_row(g, n, &s, part);
    u->bad += row_limited(g, n, u->from + offset, u->to + offset, u->flag + offset);
    u->g->counts.computed += n;
}

/* Advances the background, a cell whose residual is that of gravity alone, with the bits of update_row. */
static void settle_background(const struct update *u) {
    const double none[MAX_VAR] = {0};
    const struct advance s = {
        .U0 = u->U0, .from = u->from, .residual = none, .each = 1, .to = u->to, .a = u->a, .dt = u->dt};
    advance_row(u->g, 1, &s, u->falls, NULL);
}

/* A tile in hand. Rows are (j, k), counted along axes 1 and 2; the faces of axis a that belong to a row are those above
 * its cells. */
struct stage_sweep {
    struct pass pass;
    struct update *update;
    const int *n; /* cells of the tile along the axes */
    int tile;
    struct seam seam[6];
    face_lines *own; /* [2] faces along axis 1 below and above a row, in turn */
};

static struct span *active_row(const struct gas *g, int j, int k) {
    const struct activity *a = &g->tiles->activity;
    return activity_row(a, a->active, j, k);
}

/* The columns of row (j, k) above which the fluxes along the pass's axis read the balance of faces. */
static struct span balanced_span(const struct stage_sweep *x, int j, int k) {
    const struct gas *g = x->pass.g;
    const struct activity *a = &g->tiles->activity;
    const int reach = g->models.reconstruct->reach;
    if (x->pass.axis > 0) return *activity_row(a, a->crossed, j, k);
    const struct span s = *active_row(g, j, k);
    return span_empty(s) ? s : (struct span){s.low - 1 - reach, s.high + reach};
}

/* Computes the balance of row (j, k) along the pass's axis, wherever fluxes need it. */
static void balance(const struct stage_sweep *x, int j, int k) {
    const struct gas *g = x->pass.g;
    const int axis = x->pass.axis;
    const struct span s = balanced_span(x, j, k);
    const long offset = g->forest->first + s.low + j * g->forest->stride[1] + k * g->forest->stride[2];
    const int place = axis == 0 ? s.low : axis == 1 ? j : k;
    if (span_empty(s)) return;
    g->tiles->work.along[axis].taken[active_row(g, j, k) - g->tiles->activity.active] =
        balance_row(g, &x->pass.walls, x->pass.U, axis, place, offset, s.high - s.low);
}

/* Makes the primitives of row (j, k). */
static void make_row(struct stage_sweep *x, int j, int k) {
    const struct gas *g = x->pass.g;
    span_visit(g, g->tiles->activity.needed, j, k, primitive_visit, &x->pass);
    voids_row(g, x->pass.U, j, k);
}

/* Makes what the fluxes along an axis read of row (j, k), whose primitives are there: its nodal fluxes, and the balance
 * of the faces below it (axis 0: of its own). */
static void ready_row(struct stage_sweep *x, int axis, int j, int k) {
    const struct gas *g = x->pass.g;
    const struct activity *a = &g->tiles->activity;
    x->pass.axis = axis;
    span_visit(g, axis > 0 ? a->crossed : a->needed, j, k, nodal_visit, &x->pass);
    if (!balance_acts(g, axis)) return;
    if (axis == 0) balance(x, j, k);
    if (axis == 1 && j > -GHOSTS) balance(x, j - 1, k);
    if (axis == 2 && k > -GHOSTS) balance(x, j, k - 1);
}

/* Computes the faces of row (j, k) along an axis: along axis 0 those of the row's active cells, the one below the first
 * among them, but not those that are known; along others those that the active cells of this row and of the next one
 * have in common, each in its column. Rows -1 have faces, but no cells. */
static void row_faces(const struct stage_sweep *x, int axis, int j, int k, double (*out)[BATCH]) {
    struct gas *g = x->pass.g;
    const struct forest *f = g->forest;
    const int at[MAX_DIM] = {0, j, k};
    const struct span *row = active_row(g, j, k);
    struct span s = at[axis] < 0 ? SPAN_EMPTY : *row;
    if (axis > 0 && at[axis] + 1 < x->n[axis]) s = span_join(s, *active_row(g, j + (axis == 1), k + (axis == 2)));
    if (span_empty(s)) return;
    const int below = axis == 0 && !x->seam[0].known, last = axis == 0 && x->seam[1].known;
    const struct strip strip = {.tile = x->tile,
                                .axis = axis,
                                .n = s.high - s.low + below - last,
                                .offset = f->first + s.low - below + j * f->stride[1] + k * f->stride[2],
                                .from = axis == 0 ? s.low - below : at[axis],
                                .row = (int)(row - g->tiles->activity.active),
                                .column = s.low - below};
    face_fluxes(g, x->pass.U, &strip, out, axis == 0 ? 1 - below : s.low);
}

/* Takes the fluxes at the ends of row (j, k) from the seams there, or keeps them. */
static void join_ends(const struct stage_sweep *x, int j, int k, double (*faces)[BATCH]) {
    for (int high = 0; high < 2; high++) {
        const struct seam *s = &x->seam[high];
        for (int v = 0; v < x->pass.g->nvar && s->row; v++) {
            double *face = &faces[v][high ? x->n[0] : 0], *kept = &s->row[k][v][j];
            if (s->known)
                *face = *kept;
            else
                *kept = *face;
        }
    }
}

/* Returns where the faces above row (j, k) along axis 1 or 2 are: at the sides of the tile in its seams, if it has any
 * there. */
static face_lines *lines_above(struct stage_sweep *x, int axis, int j, int k) {
    const int place = axis == 1 ? j : k, row = axis == 1 ? k : j;
    const struct seam *low = &x->seam[2 * axis], *high = low + 1;
    if (place < 0 && low->row) return low->row + row;
    if (place == x->n[axis] - 1 && high->row) return high->row + row;
    return axis == 1 ? x->own + (place & 1) : &x->pass.g->tiles->work.planes[place & 1][row];
}

/* Computes these faces, unless they are known. */
static void faces_above(struct stage_sweep *x, int axis, int j, int k) {
    const int place = axis == 1 ? j : k;
    const bool low = place < 0 && x->seam[2 * axis].known;
    const bool high = place == x->n[axis] - 1 && x->seam[2 * axis + 1].known;
    if (!low && !high) row_faces(x, axis, j, k, *lines_above(x, axis, j, k));
}

/* Computes the faces along axis 0 of row (j, k), and advances its cells by all their faces. */
static void advance_cells(struct stage_sweep *x, int j, int k) {
    struct gas *g = x->pass.g;
    const struct span s = *active_row(g, j, k);
    const long row = g->forest->first + j * g->forest->stride[1] + k * g->forest->stride[2];
    ALIGNED double faces[MAX_VAR][BATCH], residual[MAX_VAR][BATCH];
    if (span_empty(s)) return;
    g->tiles->work.along[0].origin = row - g->forest->first;
    ready_row(x, 0, j, k);
    row_faces(x, 0, j, k, faces);
    join_ends(x, j, k, faces);
    struct faces_of_row f[MAX_DIM] = {faces_of_row(g, 0, faces[0], faces[0] + 1)};
    for (int a = 1; a < g->dim; a++) {
        const double *low = (*lines_above(x, a, j - (a == 1), k - (a == 2)))[0], *high = (*lines_above(x, a, j, k))[0];
        f[a] = faces_of_row(g, a, low + s.low, high + s.low);
    }
    for (int a = 0; a < g->dim && g->carried; a++)
        tiles_carry(g, x->tile, a, row + s.low, s.high - s.low, f[a].low[0], f[a].high[0]);
    if (g->forest->radial < 0)
        residual_row(g->dim, s.high - s.low, g->nvar, f, residual);
    else
        round_residual(g, x->tile, x->pass.U, row + s.low, s.high - s.low, f, residual);
    update_row(x->update, row + s.low, s.high - s.low, residual);
}

/* Advances plane k row by row, each as soon as the stencils of its faces are complete. */
static void sweep_plane(struct stage_sweep *x, int k) {
    struct gas *g = x->pass.g;
    const int reach = g->dim > 1 ? GHOSTS : 0;
    if (g->dim > 2) g->tiles->work.along[1].origin = k * g->forest->stride[2];
    for (int top = -reach; top < x->n[1] + reach; top++) {
        const int j = top - reach;
        if (g->dim < 3) make_row(x, top, k);
        if (g->dim > 1) ready_row(x, 1, top, k);
        if (g->dim > 1 && j >= -1) faces_above(x, 1, j, k);
        if (g->dim > 2 && j >= 0) faces_above(x, 2, j, k);
        if (j >= 0) advance_cells(x, j, k);
    }
}

/* Makes the primitives of plane k, ghosts included, and what fluxes along axis 2 read of it. */
static void ready_plane(struct stage_sweep *x, int k) {
    const int reach = k < 0 || k >= x->n[2] ? 0 : GHOSTS;
    for (int j = -reach; j < x->n[1] + reach; j++) {
        make_row(x, j, k);
        if (j >= 0 && j < x->n[1]) ready_row(x, 2, j, k);
    }
}

static void sweep_tile(struct stage_sweep *x) {
    if (x->pass.g->dim < 3) {
        sweep_plane(x, 0);
        return;
    }
    for (int top = -GHOSTS; top < x->n[2] + GHOSTS; top++) {
        const int k = top - GHOSTS;
        ready_plane(x, top);
        for (int j = 0; j < x->n[1] && k == -1; j++) faces_above(x, 2, j, k);
        if (k >= 0) sweep_plane(x, k);
    }
}

/* Sets dt/dx of the faces along each axis. */
static void set_paces(struct gas *g) {
    for (int k = 0; k < g->dim; k++)
        for (int i = 0; i < BATCH; i++) g->tiles->work.pace[k][i] = g->step.dt / g->forest->width[k];
}

int stage_of_tile(struct gas *g, int tile, const struct state *U0, const struct state *from, const struct state *to,
                  double a, double dt) {
    struct update update = {.g = g,
                            .U0 = U0->block[tile],
                            .from = from->block[tile],
                            .to = to->block[tile],
                            .flag = g->limits.flags.cells[tile],
                            .falls = g->falling.cells && g->falling.blocks[tile] ? g->falling.cells[tile] : NULL,
                            .dropped =
                                g->falling.dropped && g->limits.flags.blocks[tile] ? &g->falling.dropped[tile] : NULL,
                            .a = a,
                            .dt = dt,
                            .tile = tile};
    ALIGNED face_lines own[2];
    struct stage_sweep sweep = {.pass = {.g = g, .U = from->block[tile]},
                                .update = &update,
                                .n = g->forest->tile[tile].n,
                                .tile = tile,
                                .own = own};
    struct activity *active = &g->tiles->activity;
    if (g->models.flux->paced) set_paces(g);
    if (g->falling.cells) balance_walls(g, tile, &sweep.pass.walls);
    if (g->books.tally) tiles_tally_begin(g, tile, from->block[tile]);
    if (g->carried) tiles_carry_begin(g, tile, from->block[tile]);
    if (activity_spread(g, tile, U0, from)) {
        activity_store(g, tile, from, active->needed, GHOSTS);
        activity_store(g, tile, U0, active->active, 0);
        seams_of_tile(g, tile, sweep.seam);
        sweep_tile(&sweep);
        seams_end(g, tile);
    }
    settle_background(&update);
    to->narrow[tile] = false;
    memcpy(to->varied[tile], active->active, (size_t)active->nspans * sizeof(struct span));
    for (int i = 0; i < active->nspans && tiles_hold_bed(g, tile); i++)
        to->varied[tile][i] = (struct span){0, g->forest->tile[tile].n[0]};
    const int *n = g->forest->tile[tile].n;
    g->counts.all += (long)n[0] * n[1] * n[2];
    return update.bad;
}
