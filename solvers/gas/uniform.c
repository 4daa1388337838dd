/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the axes along which a run is uniform (uniform.h). */
#include "solvers/gas/uniform.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_ARRAYS = MAX_VAR + CARRIED_MOST };

/* Lists the arrays from which the gas takes its state; returns their number. */
static int list_state(const struct initial *s, const double *out[MOST_ARRAYS]) {
    int n = 0;
    for (int i = 0; i < s->carried.n; i++) out[n++] = s->carried.phi[i];
    for (int v = 0; v < MAX_VAR && s->conserved[v]; v++) out[n++] = s->conserved[v];
    if (s->conserved[0]) return n;
    out[n++] = s->rho;
    out[n++] = s->T;
    for (int k = 0; k < 3 && s->u[k]; k++) out[n++] = s->u[k];
    return n;
}

/* Do the same values hold on two faces of a patch? */
static bool same_faces(const struct initial *s, int p, long a, long b) {
    for (int i = 0; i < 3; i++) {
        const double *values = s->values[3 * p + i];
        const struct varying *v = initial_varying(s, p, i);
        if (v && !varying_alike(v, a, b)) return false;
        const long n = i == 1 ? s->components : 1;
        if (values && memcmp(values + a * n, values + b * n, (size_t)n * sizeof *values)) return false;
    }
    for (int i = 0; i < s->carried.n; i++) {
        const struct patch_field *q = &s->carried.field[i]->patch[p];
        if (q->varying && !varying_alike(q->varying, a, b)) return false;
        if (q->values && q->values[a] != q->values[b]) return false;
    }
    return true;
}

/* Have the cells at two places the same cells or patches, with the same values, beyond their sides across other axes?
 */
static bool same_sides(const struct polymesh *m, const struct initial *s, const struct lattice *l, int axis,
                       const int at[3], const int before[3]) {
    for (int side = 0; side < 2 * l->dim; side++) {
        long a, b;
        if (side / 2 == axis || (at[side / 2] != (side % 2 ? l->n[side / 2] - 1 : 0))) continue;
        const int p = lattice_patch(l, m, at, side, &a), q = lattice_patch(l, m, before, side, &b);
        if (p != q || (p >= 0 && !same_faces(s, p, a, b))) return false;
    }
    return true;
}

/* Pairs of neighbours along an axis, of which the one before stands in the slice of another rank. */
struct pairs {
    int n, room;
    int *cell, *before;
};

struct search { /* along one axis; what the functions below share */
    const struct polymesh *mesh;
    const struct initial *start;
    const struct lattice *lattice;
    int axis;
    bool same;   /* as far as the search has come */
    int *before; /* [cells of this rank's slice] the cells before them, where no rank has a table of cells; else NULL */
    struct pairs apart;
};

static status add_pair(struct pairs *p, long cell, long before) {
    if (p->n == p->room) {
        p->room = 2 * p->room + 1024;
        int *cells = realloc(p->cell, (size_t)p->room * sizeof *cells);
        if (cells) p->cell = cells;
        int *others = cells ? realloc(p->before, (size_t)p->room * sizeof *others) : NULL;
        if (!others) return fail(ERR_SYSTEM, "out of memory: %d cells of other ranks", p->room);
        p->before = others;
    }
    p->cell[p->n] = (int)cell;
    p->before[p->n++] = (int)before;
    return OK;
}

/* Compares a cell of this rank's slice with the one before it. */
static status compare(struct search *x, long cell, const int at[3]) {
    const struct initial *s = x->start;
    const long first = s->sliced ? s->share.first : 0;
    int before[3] = {at[0], at[1], at[2]};
    const double *state[MOST_ARRAYS];
    const int nstate = list_state(s, state);
    if (before[x->axis]-- == 0) return OK;
    const long other = x->before ? x->before[cell - first] : lattice_cell(x->lattice, before);
    x->same = same_sides(x->mesh, s, x->lattice, x->axis, at, before);
    if (other < first || other >= first + s->ncells) return add_pair(&x->apart, cell, other);
    for (int v = 0; v < nstate; v++)
        x->same = x->same && !memcmp(&state[v][cell - first], &state[v][other - first], sizeof(double));
    return OK;
}

/* Goes through the cells of this rank's slice until two differ. Without a table of cells numbers tell their places. */
static status compare_all(struct search *x) {
    const struct initial *s = x->start;
    const struct lattice *l = x->lattice;
    const long first = s->sliced ? s->share.first : 0, end = first + s->ncells;
    int at[3];
    const bool listed = l->boxes || !lattice_is_local(l);
    for (long cell = first; listed && cell < end && x->same; cell++) {
        lattice_at(l, cell, at);
        TRY(compare(x, cell, at));
    }
    if (listed) return OK;
    for (at[2] = 0; at[2] < l->n[2]; at[2]++)
        for (at[1] = 0; at[1] < l->n[1]; at[1]++)
            for (at[0] = 0; at[0] < l->n[0] && x->same; at[0]++) {
                const long cell = lattice_cell(l, at);
                if (cell >= first && cell < end) TRY(compare(x, cell, at));
            }
    return OK;
}

/* Compares the cells whose neighbours stand in other slices. */
static status compare_apart(struct search *x) {
    const struct share *share = &x->start->share;
    const struct pairs *p = &x->apart;
    const double *state[MOST_ARRAYS];
    const int nstate = list_state(x->start, state);
    double *there = NULL;
    TRY(comm_agree(share->comm, allocate(&there, p->n, sizeof *there, "cells of other ranks")));
    status e = OK;
    for (int v = 0; v < nstate && !e; v++) {
        e = share_fetch(share, 1, state[v], p->n, p->before, there);
        for (int i = 0; i < p->n && !e && x->same; i++)
            x->same = !memcmp(&state[v][p->cell[i] - share->first], &there[i], sizeof *there);
    }
    free(there);
    return e;
}

/* Is it the same on all ranks? */
static bool all_same(const struct initial *s, bool same) {
    double least = same;
    if (s->sliced) comm_min(s->share.comm, &least, 1);
    return least > 0;
}

/* Lists the cells before those of the slice, where that takes other ranks. */
static status list_before(struct search *x) {
    const struct share *share = &x->start->share;
    if (lattice_is_local(x->lattice)) return OK;
    TRY(comm_agree(share->comm, allocate(&x->before, share->end - share->first, sizeof *x->before, "cells")));
    return lattice_before(x->lattice, x->axis, x->before);
}

static status is_uniform(struct search *x) {
    const struct initial *s = x->start;
    status e = list_before(x);
    if (!e) e = compare_all(x);
    if (s->sliced) e = comm_agree(s->share.comm, e);
    x->same = !e && all_same(s, x->same);
    if (x->same && s->sliced) e = compare_apart(x);
    x->same = !e && all_same(s, x->same);
    free(x->before);
    free(x->apart.cell);
    free(x->apart.before);
    return e;
}

status uniform_find(const struct polymesh *m, const struct initial *s, struct lattice *l) {
    for (int k = 0; k < l->dim; k++) {
        struct search x = {.mesh = m, .start = s, .lattice = l, .axis = k, .same = true};
        if (!lattice_may_be_uniform(l, m, k)) continue;
        TRY(is_uniform(&x));
        l->uniform[k] = x.same;
    }
    return OK;
}
