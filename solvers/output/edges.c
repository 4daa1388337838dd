/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gathers the state beside the faces of patches (edges.h). */
#include "solvers/output/edges.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

struct own { /* a face whose cell this rank has */
    int block, cell;
    long face; /* among all that are listed */
};

struct edges {
    const struct setup *setup;
    long n;
    struct edge_face *face; /* [n] patch by patch */
    long *first;            /* [npatches] the patch's first face; -1: it is not listed */
    long nown;
    struct own *own; /* [nown] block by block */
    double *state;   /* [n][EDGE_STATE] room to gather them */
};

static bool has_faces(const struct patch *p) {
    return strcmp(p->type, "empty") != 0 && strncmp(p->type, "cyclic", 6) != 0;
}

struct wanted { /* the cell beside a face */
    int cell;
    long face;
};
static int by_cell(const void *a, const void *b) {
    const struct wanted *p = a, *q = b;
    return p->cell != q->cell ? (p->cell > q->cell ? 1 : -1) : (p->face > q->face) - (p->face < q->face);
}

static status list_faces(struct edges *e, const bool *takes, struct wanted **wanted) {
    const struct polymesh *m = e->setup->mesh;
    TRY(allocate(&e->first, m->npatches, sizeof *e->first, "patches"));
    for (int p = 0; p < m->npatches; p++) {
        const bool taken = has_faces(&m->patch[p]) && (!takes || takes[p]);
        e->first[p] = taken ? e->n : -1;
        e->n += taken ? m->patch[p].nfaces : 0;
    }
    TRY(allocate(wanted, e->n + 1, sizeof **wanted, "faces of patches"));
    TRY(allocate(&e->face, e->n + 1, sizeof *e->face, "faces of patches"));
    TRY(allocate(&e->own, e->n + 1, sizeof *e->own, "faces of patches"));
    TRY(allocate(&e->state, EDGE_STATE * (e->n + 1), sizeof *e->state, "faces of patches"));
    for (int p = 0; p < m->npatches; p++)
        for (int i = 0; e->first[p] >= 0 && i < m->patch[p].nfaces; i++) {
            const long at = e->first[p] + i;
            double centre[3], area[3];
            polymesh_patch_face(m, p, i, centre, area);
            const double size = sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
            e->face[at].face = i;
            for (int k = 0; k < 3; k++) e->face[at].normal[k] = area[k] / size;
            for (int k = 0; k < 3; k++) e->face[at].gap += 2 * centre[k] * e->face[at].normal[k]; /* less the cell's */
            (*wanted)[at] = (struct wanted){polymesh_patch_cell(m, p, i), at};
        }
    qsort(*wanted, (size_t)e->n, sizeof **wanted, by_cell);
    return OK;
}

/* What is looked for: entries in the order of their cells, and which of a few places a cell among them may have, by
 * which most cells of the mesh are ruled out at once. */
struct lookup_table {
    const struct wanted *entry;
    long n;
    size_t mask; /* places less 1, a power of two less 1 */
    bool *may;
};
static size_t place_of(const struct lookup_table *l, int cell) {
    return (size_t)((uint32_t)cell * 2654435761U >> 3) & l->mask;
}

static status make_table(const struct wanted *entry, long n, struct lookup_table *l) {
    *l = (struct lookup_table){.entry = entry, .n = n, .mask = 255};
    while ((long)l->mask < 8 * n) l->mask = 2 * l->mask + 1;
    TRY(allocate(&l->may, (long)l->mask + 1, sizeof *l->may, "faces of patches"));
    for (long i = 0; i < n; i++) l->may[place_of(l, entry[i].cell)] = true;
    return OK;
}

/* Returns the first entry that has the cell; n: none has. */
static long first_of(const struct lookup_table *l, int cell) {
    long low = 0, high = l->n;
    if (!l->may[place_of(l, cell)]) return l->n;
    while (low < high) {
        const long middle = low + (high - low) / 2;
        if (l->entry[middle].cell < cell)
            low = middle + 1;
        else
            high = middle;
    }
    return low < l->n && l->entry[low].cell == cell ? low : l->n;
}

/* Finds the cells of this rank, and with their centres the gaps, which all ranks get. */
static void find_own(struct edges *e, const struct lookup_table *l) {
    const struct grid *g = e->setup->grid;
    double *gap = e->state;
    for (long i = 0; i < e->n; i++) gap[i] = -HUGE_VAL;
    for (int b = 0; b < g->nblocks; b++)
        for (int i = 0; i < g->block[b].ncells; i++)
            for (long w = first_of(l, g->block[b].cell[i]); w < l->n; w++) {
                if (l->entry[w].cell != g->block[b].cell[i]) break;
                const long at = l->entry[w].face;
                double x[3];
                grid_centre(g, b, i, x);
                gap[at] = e->face[at].gap;
                for (int k = 0; k < e->setup->dim; k++) {
                    const int axis = e->setup->axis[k];
                    gap[at] -= 2 * x[axis] * e->face[at].normal[axis];
                }
                e->own[e->nown++] = (struct own){b, i, at};
            }
    comm_max(e->setup->comm, gap, (int)e->n);
    for (long i = 0; i < e->n; i++) e->face[i].gap = gap[i];
}

status edges_make(const struct setup *s, const bool *takes, struct edges **out) {
    struct wanted *wanted = NULL;
    struct lookup_table table = {.may = NULL};
    *out = NULL;
    if (!s->medium->type->edge) return OK;
    status e = allocate(out, 1, sizeof **out, "faces of patches");
    if (!e) {
        (*out)->setup = s;
        e = list_faces(*out, takes, &wanted);
    }
    if (!e) e = make_table(wanted, (*out)->n, &table);
    e = comm_agree(s->comm, e);
    if (!e) find_own(*out, &table);
    free(table.may);
    free(wanted);
    return e;
}

void edges_free(struct edges *e) {
    if (!e) return;
    free(e->first);
    free(e->face);
    free(e->own);
    free(e->state);
    free(e);
}

/* Takes a quantity in the cells of this rank; its components begin at `at` of the state. */
static void take(struct edges *e, int quantity, int at, double *const line[3]) {
    const struct medium *m = e->setup->medium;
    const int components = m->fields.quantity[quantity].components;
    for (long i = 0, held = -1; i < e->nown; i++) {
        const struct own *o = &e->own[i];
        double *to = e->state + EDGE_STATE * o->face + at;
        if (o->block != held) m->type->block(m, o->block, quantity, line);
        held = o->block;
        for (int k = 0; k < components; k++) to[k] = components == 1 ? line[0][o->cell] : 0;
        for (int k = 0; components == 3 && k < setup_lines(e->setup, quantity); k++)
            to[e->setup->axis[k]] = line[k][o->cell];
    }
}

status edges_find(struct edges *e) {
    if (!e) return OK;
    const struct medium_type *type = e->setup->medium->type;
    const struct grid *g = e->setup->grid;
    double *line[3] = {NULL, NULL, NULL};
    long most = 1;
    for (int b = 0; b < g->nblocks; b++)
        if (g->block[b].ncells > most) most = g->block[b].ncells;
    TRY(comm_agree(e->setup->comm, allocate(&line[0], 3 * most, sizeof(double), "faces of patches")));
    line[1] = line[0] + most;
    line[2] = line[1] + most;
    for (long i = 0; i < EDGE_STATE * e->n; i++) e->state[i] = -HUGE_VAL;
    for (int i = 0, at = 0; type->edge_state[i] >= 0; i++) {
        take(e, type->edge_state[i], at, line);
        at += e->setup->medium->fields.quantity[type->edge_state[i]].components;
    }
    free(line[0]);
    comm_max(e->setup->comm, e->state, (int)(EDGE_STATE * e->n)); /* one rank has each value, the others -infinity */
    for (long i = 0; i < e->n; i++) memcpy(e->face[i].state, e->state + EDGE_STATE * i, sizeof e->face[i].state);
    return OK;
}

void edges_values(const struct edges *e, int quantity, int patch, int n, const int *face, double *values) {
    if (!e || e->first[patch] < 0) return;
    const struct medium *m = e->setup->medium;
    const struct edge_face *first = e->face + e->first[patch];
    const int components = m->fields.quantity[quantity].components;
    if (!face) m->type->edge(m, quantity, patch, n, first, values);
    for (int i = 0; face && i < n; i++)
        m->type->edge(m, quantity, patch, 1, first + face[i], values + (long)i * components);
}

/* Adds the value on face i of a patch to its points. */
static void add_face(const struct polymesh *m, int p, int i, double value, double *at_point, int *count) {
    const int face = m->patch[p].start + i;
    for (int k = m->face_start[face]; k < m->face_start[face + 1]; k++) {
        const int point = m->face_points[k];
        at_point[point] = count[point]++ ? at_point[point] + value : value;
    }
}

void edges_points(const struct edges *e, int quantity, int component, double *at_point, int *count) {
    const struct medium *medium = e->setup->medium;
    const struct polymesh *m = e->setup->mesh;
    for (int i = 0; i < m->npoints; i++) {
        at_point[i] = NAN;
        count[i] = 0;
    }
    for (int p = 0; p < m->npatches; p++) {
        if (e->first[p] < 0 || !medium->type->gives(medium, quantity, p)) continue;
        for (int i = 0; i < m->patch[p].nfaces; i++) {
            double value[3] = {NAN, NAN, NAN};
            edges_values(e, quantity, p, 1, &i, value);
            add_face(m, p, i, value[component], at_point, count);
        }
    }
    for (int i = 0; i < m->npoints; i++)
        if (count[i]) at_point[i] /= count[i];
}
