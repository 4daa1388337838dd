/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Deals the layers of a lattice to the ranks, and moves values between slices and slabs (segregation_places.h). */
#include "solvers/segregation/segregation_places.h"

#include <stdlib.h>
#include <string.h>

/* Lists the cells of all places, row by row. Collective. */
static status list_cells(struct segregation_places *p) {
    const struct lattice *l = p->lattice;
    const int last = l->dim - 1, rows = l->dim == 3 ? l->n[1] : 1;
    int *cell = p->cell;
    for (int i = -p->below; i < p->layers + p->above; i++)
        for (int j = 0; j < rows; j++, cell += l->n[0]) {
            int at[3] = {0, j, 0};
            at[last] = (p->layer + i + l->n[last]) % l->n[last];
            lattice_row(l, at, l->n[0], cell);
        }
    TRY(lattice_name(l, p->n, p->cell));
    for (long i = 0; i < p->nown; i++) p->ncells += p->cell[p->own_first + i] >= 0;
    return OK;
}

status segregation_places_make(const struct setup *s, struct segregation_places *out) {
    const struct lattice *l = s->lattice;
    const int last = l->dim - 1, ranks = comm_size(s->comm), rank = comm_rank(s->comm);
    const bool ring = l->periodic[last] && ranks > 1;
    *out = (struct segregation_places){.lattice = l, .share = share_make(s->comm, s->mesh->ncells)};
    memcpy(out->first, s->first, sizeof out->first);
    if (ranks > l->n[last])
        return fail(ERR_INPUT,
                    "%s: %d ranks for %d layers of cells along %c: each rank takes one or more; give  -np %d  at most",
                    s->mesh_path, ranks, l->n[last], "xyz"[l->axis[last]], l -> n[last]);
    const struct share layers = share_make(s->comm, l->n[last]);
    out->layer = (int)layers.first;
    out->layers = (int)(layers.end - layers.first);
    out->below = ring || rank > 0;
    out->above = ring || rank < ranks - 1;
    out->across = (long)l->n[0] * (l->dim == 3 ? l->n[1] : 1);
    out->own_first = out->below * out->across;
    out->nown = out->layers * out->across;
    out->n = out->nown + (out->below + out->above) * out->across;
    TRY(comm_agree(s->comm, allocate(&out->cell, out->n, sizeof *out->cell, "the places of a lattice")));
    return list_cells(out);
}

void segregation_places_free(struct segregation_places *p) {
    free(p->cell);
}

void segregation_places_at(const struct segregation_places *p, long place, int at[3]) {
    const struct lattice *l = p->lattice;
    const int last = l->dim - 1, layer = (int)(place / p->across) - p->below + p->layer;
    at[0] = (int)(place % l->n[0]);
    at[1] = (int)(place % p->across / l->n[0]);
    at[2] = 0;
    at[last] = (layer + l->n[last]) % l->n[last];
}

void segregation_places_centre(const struct segregation_places *p, long place, double x[3]) {
    const struct lattice *l = p->lattice;
    int at[3];
    segregation_places_at(p, place, at);
    memcpy(x, p->first, sizeof p->first);
    for (int k = 0; k < l->dim; k++) x[l->axis[k]] = l->origin[k] + l->width[k] * (at[k] + 0.5);
}

/* Lists the numbers of the cells in n places, without holes, and where they stand; *many gets how many they are. */
static status list_present(const int *cell, long n, long *many, int **numbers, long **where) {
    *many = 0;
    *where = NULL;
    status e = allocate(numbers, n, sizeof **numbers, "the cells of a slab");
    if (!e) e = allocate(where, n, sizeof **where, "the cells of a slab");
    for (long i = 0; i < n && !e; i++)
        if (cell[i] >= 0) {
            (*numbers)[*many] = cell[i];
            (*where)[(*many)++] = i;
        }
    return e;
}

status segregation_places_fetch(const struct segregation_places *p, int components, const double *slice, double **out) {
    const size_t bytes = (size_t)components * sizeof **out;
    int *number = NULL;
    long many, *where = NULL;
    double *found = NULL;
    *out = NULL;
    status e = list_present(p->cell, p->n, &many, &number, &where);
    if (!e) e = allocate(&found, many * components, sizeof *found, "values of a slab");
    if (!e) e = allocate(out, p->n * components, sizeof **out, "values of a slab");
    e = comm_agree(p->share.comm, e);
    if (!e) e = share_fetch(&p->share, components, slice, many, number, found);
    for (long i = 0; i < many && !e; i++) memcpy(*out + where[i] * components, found + i * components, bytes);
    free(number);
    free(where);
    free(found);
    return e;
}

status segregation_places_take(const struct segregation_places *p, int components, const double *whole, double **out) {
    TRY(allocate(out, p->n * components, sizeof **out, "values of a slab"));
    for (long i = 0; i < p->n; i++)
        if (p->cell[i] >= 0)
            memcpy(*out + i * components, whole + (long)p->cell[i] * components, (size_t)components * sizeof **out);
    return OK;
}

status segregation_places_store(const struct segregation_places *p, int components, const double *own, double *slice) {
    int *number = NULL;
    long many, *where = NULL;
    double *values = NULL;
    status e = list_present(p->cell + p->own_first, p->nown, &many, &number, &where);
    if (!e) e = allocate(&values, many * components, sizeof *values, "values of a slab");
    e = comm_agree(p->share.comm, e);
    for (long i = 0; i < many && !e; i++)
        memcpy(values + i * components, own + where[i] * components, (size_t)components * sizeof *values);
    if (!e) e = share_store(&p->share, components, many, number, values, slice);
    free(number);
    free(where);
    free(values);
    return e;
}
