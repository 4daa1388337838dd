/* What a stage need not compute. Where a cell and its stencil hold the same bits, the fluxes on its two sides are the
 * same bits and -div F is exactly zero: such cells are left out, and the result has the same bits as without leaving
 * out. A tile is compared with one reference cell, a corner that equals its inward neighbours; each row keeps one span.
 */
#include "libcore/state.h"

enum { BLOCK = 8 }; /* spans start and end on whole vectors */

static struct span widen(struct span s, int by) {
    return span_empty(s) ? s : (struct span){s.low - by, s.high + by};
}

struct span *activity_row(const struct activity *a, struct span *spans, int j, int k) {
    return &spans[(j + GHOSTS) + a->rows * (k + GHOSTS)];
}

static bool same_cell(const struct gas *g, const double *U, long a, long b) {
    for (int v = 0; v < g->nvar; v++)
        if (bits_of(U[v * g->forest->size + a]) != bits_of(U[v * g->forest->size + b])) return false;
    return true;
}

/* A corner cell that equals its neighbour inwards along every axis, or -1. */
static long find_reference(const struct gas *g, const struct tile *t, const double *U) {
    const struct forest *f = g->forest;
    for (int corner = 0; corner < 1 << g->dim; corner++) {
        long at = f->first;
        bool calm = true;
        for (int k = 0; k < g->dim; k++)
            if (corner >> k & 1) at += (t->n[k] - 1) * f->stride[k];
        for (int k = 0; k < g->dim && calm; k++)
            calm = t->n[k] > 1 && same_cell(g, U, at, at + (corner >> k & 1 ? -1 : 1) * f->stride[k]);
        if (calm) return at;
    }
    return -1;
}

/* Does any of 8 cells from `offset` on differ from the reference? */
KERNEL static bool block_differs(int nvar, long size, const double *restrict U, const double *restrict reference) {
    uint64_t any = 0;
    for (int v = 0; v < nvar; v++) {
        uint64_t bits = bits_of(reference[v]);
        for (int i = 0; i < BLOCK; i++) any |= bits_of(U[v * size + i]) ^ bits;
    }
    return any != 0;
}

/* The span of columns low <= i < high of a row that differs; in whole blocks inside, cell by cell in the margin. */
static struct span differing(const struct gas *g, const double *U, long row, long reference, int n, int margin) {
    double values[MAX_VAR];
    struct span s = SPAN_EMPTY;
    for (int v = 0; v < g->nvar; v++) values[v] = U[v * g->forest->size + reference];
    for (int i = -margin; i < n + margin && span_empty(s); i++) {
        bool block = i >= 0 && i + BLOCK <= n;
        if (block ? block_differs(g->nvar, g->forest->size, U + row + i, values) : !same_cell(g, U, row + i, reference))
            s = (struct span){i, i + 1};
        else if (block)
            i += BLOCK - 1;
    }
    if (span_empty(s)) return s;
    for (int i = n + margin - 1; i >= s.high; i--) {
        bool block = i < n && (i + 1) % BLOCK == 0;
        if (block ? block_differs(g->nvar, g->forest->size, U + row + i + 1 - BLOCK, values)
                  : !same_cell(g, U, row + i, reference)) {
            s.high = i + 1;
            break;
        }
        if (block) i -= BLOCK - 1;
    }
    if (s.low >= 0 && s.low + BLOCK <= n && s.high < s.low + BLOCK) s.high = s.low + BLOCK; /* the block found first */
    return s;
}

void activity_find(struct gas *g, int tile, const double *U, int margin) {
    const struct forest *f = g->forest;
    const struct tile *t = &f->tile[tile];
    struct activity *a = &g->activity;
    int reach[MAX_DIM] = {0};
    for (int k = 0; k < g->dim; k++) reach[k] = margin;
    a->reference = g->models.skip_uniform && !g->flagged[tile] ? find_reference(g, t, U) : -1;
    for (int k = -reach[2]; k < t->n[2] + reach[2]; k++)
        for (int j = -reach[1]; j < t->n[1] + reach[1]; j++) {
            bool out_j = j < 0 || j >= t->n[1], out_k = k < 0 || k >= t->n[2];
            int side = out_j || out_k ? 0 : reach[0];
            long row = f->first + j * f->stride[1] + k * f->stride[2];
            struct span *s = activity_row(a, a->differ, j, k);
            if (out_j && out_k)
                *s = SPAN_EMPTY;
            else if (a->reference < 0)
                *s = (struct span){-side, t->n[0] + side};
            else
                *s = differing(g, U, row, a->reference, t->n[0], side);
        }
}

static bool within(int i, int n, int margin) {
    return i >= -margin && i < n + margin;
}

/* The spans within GHOSTS rows of row (j, k) along the axes above 0, joined; rows up to `margin` outside the tile
 * count. */
static struct span gather(const struct gas *g, const struct tile *t, struct span *from, int j, int k, int margin) {
    const struct activity *a = &g->activity;
    struct span s = SPAN_EMPTY;
    for (int m = -GHOSTS; m <= GHOSTS; m++) {
        if (g->dim > 1 && within(j + m, t->n[1], margin) && within(k, t->n[2], 0))
            s = span_join(s, *activity_row(a, from, j + m, k));
        if (g->dim > 2 && within(k + m, t->n[2], margin) && within(j, t->n[1], 0))
            s = span_join(s, *activity_row(a, from, j, k + m));
    }
    return s;
}

bool activity_spread(struct gas *g, int tile) {
    const struct tile *t = &g->forest->tile[tile];
    struct activity *a = &g->activity;
    bool any = false;
    for (int k = 0; k < t->n[2]; k++)
        for (int j = 0; j < t->n[1]; j++) {
            struct span s =
                span_join(widen(*activity_row(a, a->differ, j, k), GHOSTS), gather(g, t, a->differ, j, k, GHOSTS));
            s.low = s.low < 0 ? 0 : s.low / BLOCK * BLOCK;
            s.high = (s.high + BLOCK - 1) / BLOCK * BLOCK;
            if (s.high > t->n[0]) s.high = t->n[0];
            if (span_empty(s)) s = SPAN_EMPTY;
            any |= !span_empty(s);
            *activity_row(a, a->active, j, k) = s;
        }
    int reach1 = g->dim > 1 ? GHOSTS : 0, reach2 = g->dim > 2 ? GHOSTS : 0;
    for (int k = -reach2; any && k < t->n[2] + reach2; k++)
        for (int j = -reach1; j < t->n[1] + reach1; j++) {
            struct span s = gather(g, t, a->active, j, k, 0);
            if (within(j, t->n[1], 0) && within(k, t->n[2], 0))
                s = span_join(s, widen(*activity_row(a, a->active, j, k), GHOSTS));
            *activity_row(a, a->needed, j, k) = s;
        }
    return any;
}

void spans_visit(const struct gas *g, int tile, struct span *spans, int margin, row_visitor *visit, void *context) {
    const struct forest *f = g->forest;
    const struct tile *t = &f->tile[tile];
    int reach1 = g->dim > 1 ? margin : 0, reach2 = g->dim > 2 ? margin : 0;
    for (int k = -reach2; k < t->n[2] + reach2; k++)
        for (int j = -reach1; j < t->n[1] + reach1; j++) {
            struct span s = *activity_row(&g->activity, spans, j, k);
            long row = f->first + j * f->stride[1] + k * f->stride[2];
            for (int i = s.low; i < s.high; i += BATCH)
                visit(context, row + i, s.high - i < BATCH ? s.high - i : BATCH);
        }
}
