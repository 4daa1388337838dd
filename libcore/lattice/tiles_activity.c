/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Skipping of uniform regions (option skipUniform): which cells of a tile are neither computed nor stored. Where a cell
 * and its stencil hold the same bits, the fluxes on its two sides are the same bits and -div F is exactly zero, so
 * leaving such cells out changes no bit. A tile's background is first found as a corner cell that equals its inward
 * neighbours; from then on it is advanced as one cell, and only cells that were computed can differ from it. Each row
 * keeps one span of columns that holds all its cells that differ (drawing: docs/design.md). */
#include "libcore/lattice/tiles.h"

enum { BLOCK = 8 }; /* spans start and end on whole vectors */

static struct span widen(struct span s, int by) {
    return span_empty(s) ? s : (struct span){s.low - by, s.high + by};
}

static struct span overlap(struct span a, struct span b) {
    struct span s = {a.low > b.low ? a.low : b.low, a.high < b.high ? a.high : b.high};
    return span_empty(s) ? SPAN_EMPTY : s;
}

static long row_offset(const struct forest *f, int j, int k) {
    return f->first + j * f->stride[1] + k * f->stride[2];
}

static void vary_all(const struct gas *g, int tile, const struct state *s) {
    s->narrow[tile] = s->calm[tile] = false;
    for (int i = 0; i < g->tiles->activity.nspans; i++)
        s->varied[tile][i] = (struct span){0, g->forest->tile[tile].n[0]};
}

void activity_reset(const struct gas *g, const struct state *s) {
    for (int t = 0; t < g->forest->ntiles; t++) vary_all(g, t, s);
}

static bool has_background(const struct gas *g, const struct tile *t, struct span *varied) {
    for (int k = 0; k < t->n[2]; k++)
        for (int j = 0; j < t->n[1]; j++) {
            struct span s = *activity_row(&g->tiles->activity, varied, j, k);
            if (s.low > 0 || s.high < t->n[0]) return true;
        }
    return false;
}

bool activity_has_background(const struct gas *g, int tile, const struct state *s) {
    return has_background(g, &g->forest->tile[tile], s->varied[tile]);
}

/* The marks of a tile's cold cells, in which gravity acts in another way: cells that are equal but for these soon are
 * not. NULL: there are none. */
static const double *marks_of(const struct gas *g, int tile) {
    return g->falling.cells && g->falling.blocks[tile] ? g->falling.cells[tile] : NULL;
}

static bool same_cell(const struct gas *g, const double *U, const double *falls, long a, long b) {
    if (falls && falls[a] != falls[b]) return false;
    for (int v = 0; v < g->nvar; v++)
        if (bits_of(U[v * g->forest->size + a]) != bits_of(U[v * g->forest->size + b])) return false;
    return true;
}

/* A corner cell that equals its neighbour inwards along every axis, or -1. */
static long find_reference(const struct gas *g, const struct tile *t, const double *U, const double *falls) {
    const struct forest *f = g->forest;
    for (int corner = 0; corner < 1 << g->dim; corner++) {
        long at = f->first;
        bool same = true;
        for (int k = 0; k < g->dim; k++)
            if (corner >> k & 1) at += (t->n[k] - 1) * f->stride[k];
        for (int k = 0; k < g->dim && same; k++)
            same = t->n[k] > 1 && same_cell(g, U, falls, at, at + (corner >> k & 1 ? -1 : 1) * f->stride[k]);
        if (same) return at;
    }
    return -1;
}

/* Does gas move along the radius of a body of revolution, or around its axis? Then uniform gas does not stay so. */
static bool flows_outwards(const struct gas *g, const double *U, long at) {
    const long size = g->forest->size;
    if (g->forest->radial < 0) return false;
    return U[(g->forest->radial + 1) * size + at] != 0 ||
           (g->models.swirl && U[(g->models.swirl + 1) * size + at] != 0);
}

/* Sets bit i if cell i of 8 from `offset` on differs from the background. */
KERNEL static unsigned block_differs(int nvar, long size, const double *restrict U, long offset) {
    uint64_t any[BLOCK] = {0};
    unsigned marks = 0;
    for (int v = 0; v < nvar; v++) {
        uint64_t bits = bits_of(U[v * size]);
        for (int i = 0; i < BLOCK; i++) any[i] |= bits_of(U[v * size + offset + i]) ^ bits;
    }
    for (int i = 0; i < BLOCK; i++) marks |= (unsigned)(any[i] != 0) << i;
    return marks;
}

/* The same for the n <= 8 cells from `offset` on. */
static unsigned cells_differ(const struct gas *g, const double *U, const double *falls, long offset, int n) {
    unsigned marks = 0;
    if (n == BLOCK && !falls) return block_differs(g->nvar, g->forest->size, U, offset);
    for (int i = 0; i < n; i++) marks |= (unsigned)!same_cell(g, U, falls, offset + i, 0) << i;
    return marks;
}

/* Takes from both ends of a row's span the cells that equal the background. */
static struct span differing(const struct gas *g, const double *U, const double *falls, long row, struct span s) {
    unsigned marks = 0;
    while (!span_empty(s)) {
        int n = s.high - s.low < BLOCK ? s.high - s.low : BLOCK;
        marks = cells_differ(g, U, falls, row + s.low, n);
        if (marks) break;
        s.low += n;
    }
    for (; marks && !(marks & 1); marks >>= 1) s.low++;
    for (marks = 0; !span_empty(s);) {
        int n = s.high - s.low < BLOCK ? s.high - s.low : BLOCK;
        marks = cells_differ(g, U, falls, row + s.high - n, n) << (BLOCK - n);
        if (marks) break;
        s.high -= n;
    }
    for (; marks && !(marks & 1u << (BLOCK - 1)); marks <<= 1) s.high--;
    return span_empty(s) ? SPAN_EMPTY : s;
}

bool activity_find(const struct gas *g, int tile, const struct state *s) {
    const struct tile *t = &g->forest->tile[tile];
    double *U = s->block[tile];
    const double *falls = marks_of(g, tile);
    if (!g->models.skip_uniform || g->step.hybrid) return false;
    if (s->narrow[tile]) return true;
    if (!has_background(g, t, s->varied[tile])) {
        long reference = find_reference(g, t, U, falls);
        if (reference < 0 || flows_outwards(g, U, reference)) return false;
        for (int v = 0; v < g->nvar; v++) U[v * g->forest->size] = U[v * g->forest->size + reference];
        if (falls) g->falling.cells[tile][0] = falls[reference];
    }
    bool calm = true;
    for (int k = 0; k < t->n[2]; k++)
        for (int j = 0; j < t->n[1]; j++) {
            struct span *row = activity_row(&g->tiles->activity, s->varied[tile], j, k);
            *row = differing(g, U, falls, row_offset(g->forest, j, k), *row);
            calm &= span_empty(*row);
        }
    s->calm[tile] = calm;
    return s->narrow[tile] = calm || has_background(g, t, s->varied[tile]);
}

void activity_empty(const struct gas *g, int tile, const struct state *s) {
    for (int i = 0; i < g->tiles->activity.nspans && !s->calm[tile]; i++) s->varied[tile][i] = SPAN_EMPTY;
    s->narrow[tile] = s->calm[tile] = true;
}

bool same_background(const struct gas *g, const double *a, const double *b) {
    for (int v = 0; v < g->nvar; v++)
        if (bits_of(a[v * g->forest->size]) != bits_of(b[v * g->forest->size])) return false;
    return true;
}

/* Writes the background to columns low <= i < high of a row. */
static void write_row(const struct gas *g, double *U, long row, int low, int high) {
    for (int v = 0; v < g->nvar && low < high; v++) {
        double *q = U + v * g->forest->size;
        const double background = q[0];
        for (int i = low; i < high; i++) q[row + i] = background;
    }
}

/* Writes the background to the wanted columns of a row whose own cells lie in `varied`. */
static void write_outside(const struct gas *g, double *U, long row, struct span wanted, struct span varied) {
    if (span_empty(varied)) varied = (struct span){wanted.high, wanted.high};
    write_row(g, U, row, wanted.low, wanted.high < varied.low ? wanted.high : varied.low);
    write_row(g, U, row, wanted.low > varied.high ? wanted.low : varied.high, wanted.high);
}

/* A box of cells of a tile: all of them, or the layers inside one side. */
struct layers {
    int low[3], high[3];
};
static struct layers layers_inside(const struct gas *g, const struct tile *t, int side) {
    struct layers l = {.high = {t->n[0], t->n[1], t->n[2]}};
    int k = side / 2, reach = g->tiles->activity.reach, thick = t->n[k] < reach ? t->n[k] : reach;
    if (side % 2)
        l.low[k] = t->n[k] - thick;
    else
        l.high[k] = thick;
    return l;
}

static bool layers_calm(const struct gas *g, const struct state *s, int tile, struct layers l) {
    struct span *varied = s->varied[tile];
    if (s->calm[tile]) return true;
    for (int k = l.low[2]; k < l.high[2]; k++)
        for (int j = l.low[1]; j < l.high[1]; j++) {
            struct span row = *activity_row(&g->tiles->activity, varied, j, k);
            if (!span_empty(overlap(row, (struct span){l.low[0], l.high[0]}))) return false;
        }
    return true;
}

static void store_layers(const struct gas *g, int tile, const struct state *s, struct layers l) {
    for (int k = l.low[2]; k < l.high[2]; k++)
        for (int j = l.low[1]; j < l.high[1]; j++)
            write_outside(g, s->block[tile], row_offset(g->forest, j, k), (struct span){l.low[0], l.high[0]},
                          *activity_row(&g->tiles->activity, s->varied[tile], j, k));
}

void activity_store_all(const struct gas *g, int tile, const struct state *s) {
    const int *n = g->forest->tile[tile].n;
    store_layers(g, tile, s, (struct layers){.high = {n[0], n[1], n[2]}});
}

void activity_unfold(const struct gas *g, int tile, const struct state *s) {
    activity_store_all(g, tile, s);
    vary_all(g, tile, s);
}

/* Beyond a patch that asks for no values and is no wall the ghosts are copies of the cells beside it. */
static bool is_quiet(const struct gas *g, const struct state *s, int tile, int side) {
    const struct tile *t = &g->forest->tile[tile];
    const int other = t->side[side].neighbour, patch = t->side[side].patch;
    if (patch >= 0 && (patch_needs_values(&g->patches.rules[patch]) || patch_is_wall(&g->patches.rules[patch])))
        return false;
    if (patch >= 0) return layers_calm(g, s, tile, layers_inside(g, t, side));
    if (other < 0) return false;
    if (!same_background(g, s->block[tile], s->block[other])) return false;
    return layers_calm(g, s, other, layers_inside(g, &g->forest->tile[other], side ^ 1));
}

void activity_prepare(struct gas *g, const struct state *s) {
    const struct forest *f = g->forest;
    bool *quiet = g->tiles->activity.quiet;
    for (int t = 0; t < f->ntiles; t++) (void)activity_find(g, t, s);
    for (int t = 0; t < f->ntiles; t++)
        for (int side = 0; side < 2 * f->dim; side++) quiet[6 * t + side] = is_quiet(g, s, t, side);
    for (int t = 0; t < f->ntiles; t++)
        for (int side = 0; side < 2 * f->dim; side++) {
            const int other = f->tile[t].side[side].neighbour;
            const bool skipped = quiet[other < 0 ? 6 * t + side : 6 * other + (side ^ 1)];
            if (!skipped) store_layers(g, t, s, layers_inside(g, &f->tile[t], side));
        }
}

/* The side of a tile beyond which a row of ghosts lies. */
static int side_of_row(const struct tile *t, int j, int k) {
    return k < 0 ? 4 : k >= t->n[2] ? 5 : j < 0 ? 2 : 3;
}

/* The columns of a row, of the tile or of its ghosts, that differ from the background, or whose fluxes do: beside a
 * patch that gives the mass that flows in they may differ from those of the same states in the last bit. */
static struct span differ_with_ghosts(const struct gas *g, int tile, const struct state *s, int j, int k) {
    const struct tile *t = &g->forest->tile[tile];
    const double *U = s->block[tile];
    const bool *quiet = g->tiles->activity.quiet + 6 * tile;
    bool out_j = j < 0 || j >= t->n[1], out_k = k < 0 || k >= t->n[2];
    long row = row_offset(g->forest, j, k);
    if (out_j && out_k) return SPAN_EMPTY;
    const struct span whole = {0, t->n[0]};
    if (out_j || out_k) {
        const int side = side_of_row(t, j, k);
        return quiet[side] ? SPAN_EMPTY : tiles_fed(g, tile, side) ? whole : differing(g, U, NULL, row, whole);
    }
    struct span differ = *activity_row(&g->tiles->activity, s->varied[tile], j, k);
    for (int m = 0; m < g->tiles->activity.reach; m++)
        for (int high = 0; high < 2; high++) {
            int i = high ? t->n[0] + m : -1 - m;
            if (!quiet[high] && (tiles_fed(g, tile, high) || !same_cell(g, U, NULL, row + i, 0)))
                differ = span_join(differ, (struct span){i, i + 1});
        }
    return differ;
}

static void find_differ(struct gas *g, int tile, const struct state *s) {
    const struct tile *t = &g->forest->tile[tile];
    const int reach = g->tiles->activity.reach, reach1 = g->dim > 1 ? reach : 0, reach2 = g->dim > 2 ? reach : 0;
    for (int k = -reach2; k < t->n[2] + reach2; k++)
        for (int j = -reach1; j < t->n[1] + reach1; j++)
            *activity_row(&g->tiles->activity, g->tiles->activity.differ, j, k) = differ_with_ghosts(g, tile, s, j, k);
}

static int least(int a, int b) {
    return a < b ? a : b;
}
static int most(int a, int b) {
    return a > b ? a : b;
}
static bool within(int i, int n, int margin) {
    return i >= -margin && i < n + margin;
}

/* The joined spans of all rows within the reach of row (j, k) along axes 1 and 2; rows up to `margin` outside the tile
 * count. */
static struct span gather(const struct gas *g, const struct tile *t, struct span *from, int j, int k, int margin) {
    const struct activity *a = &g->tiles->activity;
    const int end1 = least(j + a->reach + 1, t->n[1] + margin), end2 = least(k + a->reach + 1, t->n[2] + margin);
    struct span s = SPAN_EMPTY;
    for (int i = most(j - a->reach, -margin); g->dim > 1 && within(k, t->n[2], 0) && i < end1; i++)
        s = span_join(s, *activity_row(a, from, i, k));
    for (int i = most(k - a->reach, -margin); g->dim > 2 && within(j, t->n[1], 0) && i < end2; i++)
        s = span_join(s, *activity_row(a, from, j, i));
    return s;
}

/* Widens a span of a row of n cells to one that begins with a vector and has one cell less than fills vectors, where n
 * allows it: as many faces as fill them. */
static struct span fill_vectors(struct span s, int n) {
    if (span_empty(s)) return s;
    s = (struct span){s.low / BLOCK * BLOCK, (s.high + BLOCK) / BLOCK * BLOCK - 1};
    return overlap(s, (struct span){0, n});
}

/* The active span of a row: cells with a differing cell in their stencil, or which the step's start stores. */
static struct span spread_row(const struct gas *g, const struct tile *t, struct span *start, int j, int k) {
    const struct activity *a = &g->tiles->activity;
    struct span s =
        span_join(widen(*activity_row(a, a->differ, j, k), a->reach), gather(g, t, a->differ, j, k, GHOSTS));
    s = overlap(span_join(s, *activity_row(a, start, j, k)), (struct span){0, t->n[0]});
    return fill_vectors(s, t->n[0]);
}

bool activity_calm(const struct gas *g, int tile, const struct state *U0, const struct state *from) {
    const int *n = g->forest->tile[tile].n;
    const struct layers all = {.high = {n[0], n[1], n[2]}};
    if (tiles_hold_bed(g, tile) || g->limits.flags.blocks[tile]) return false;
    for (int side = 0; side < 2 * g->dim; side++)
        if (!g->tiles->activity.quiet[6 * tile + side]) return false;
    return layers_calm(g, from, tile, all) && layers_calm(g, U0, tile, all);
}

bool activity_spread(struct gas *g, int tile, const struct state *U0, const struct state *from) {
    const struct tile *t = &g->forest->tile[tile];
    struct activity *a = &g->tiles->activity;
    const bool bed = tiles_hold_bed(g, tile);
    bool any = false, all = bed || g->limits.flags.blocks[tile] || !has_background(g, t, from->varied[tile]);
    a->whole = all && !bed && !g->limits.flags.blocks[tile];
    if (!all) find_differ(g, tile, from);
    for (int k = 0; k < t->n[2]; k++)
        for (int j = 0; j < t->n[1]; j++) {
            struct span s =
                bed   ? fill_vectors(tiles_moving_span(g, tile, row_offset(g->forest, j, k), t->n[0]), t->n[0])
                : all ? (struct span){0, t->n[0]}
                      : spread_row(g, t, U0->varied[tile], j, k);
            any |= !span_empty(s);
            *activity_row(a, a->active, j, k) = s;
        }
    int reach1 = g->dim > 1 ? GHOSTS : 0, reach2 = g->dim > 2 ? GHOSTS : 0;
    for (int k = -reach2; any && k < t->n[2] + reach2; k++)
        for (int j = -reach1; j < t->n[1] + reach1; j++) {
            struct span s = gather(g, t, a->active, j, k, 0);
            *activity_row(a, a->crossed, j, k) = s;
            if (within(j, t->n[1], 0) && within(k, t->n[2], 0))
                s = span_join(s, widen(*activity_row(a, a->active, j, k), a->reach));
            *activity_row(a, a->needed, j, k) = s;
        }
    return any;
}

void span_visit(const struct gas *g, struct span *spans, int j, int k, run_visitor *visit, void *context) {
    struct span s = *activity_row(&g->tiles->activity, spans, j, k);
    long row = row_offset(g->forest, j, k);
    for (int i = s.low; i < s.high; i += BATCH) visit(context, row + i, s.high - i < BATCH ? s.high - i : BATCH);
}

void spans_visit(const struct gas *g, int tile, struct span *spans, int margin, run_visitor *visit, void *context) {
    const struct tile *t = &g->forest->tile[tile];
    int reach1 = g->dim > 1 ? margin : 0, reach2 = g->dim > 2 ? margin : 0;
    for (int k = -reach2; k < t->n[2] + reach2; k++)
        for (int j = -reach1; j < t->n[1] + reach1; j++) span_visit(g, spans, j, k, visit, context);
}

void activity_store(const struct gas *g, int tile, const struct state *s, struct span *spans, int margin) {
    const struct tile *t = &g->forest->tile[tile];
    const bool *quiet = g->tiles->activity.quiet + 6 * tile;
    double *U = s->block[tile];
    int n = t->n[0], reach1 = g->dim > 1 ? margin : 0, reach2 = g->dim > 2 ? margin : 0;
    for (int k = -reach2; k < t->n[2] + reach2; k++)
        for (int j = -reach1; j < t->n[1] + reach1; j++) {
            struct span wanted = *activity_row(&g->tiles->activity, spans, j, k);
            long row = row_offset(g->forest, j, k);
            if (!within(j, t->n[1], 0) || !within(k, t->n[2], 0)) {
                if (quiet[side_of_row(t, j, k)]) write_row(g, U, row, wanted.low, wanted.high);
                continue;
            }
            write_outside(g, U, row, overlap(wanted, (struct span){0, n}),
                          *activity_row(&g->tiles->activity, s->varied[tile], j, k));
            if (quiet[0]) write_row(g, U, row, wanted.low, 0);
            if (quiet[1]) write_row(g, U, row, n, wanted.high);
        }
}
