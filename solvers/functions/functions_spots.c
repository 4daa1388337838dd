/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the cells that hold points, for function objects that sample there, and gathers fields at the points: values of
 * the cells, or linear in the simplices of cells, of second order beside walls, too (vicinity.h). */
#include "solvers/functions/functions_private.h"

#include "mesh/grid/vicinity.h"
#include "solvers/output/edges.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const spot_schemes[] = {"cell", "cellPoint", NULL};

static void bounding_box(const struct polymesh *m, double low[3], double high[3]) {
    polymesh_bounds(m, low, high);
    for (int a = 0; a < 3; a++) {
        const double slack = 1e-9 * (high[a] - low[a]);
        low[a] -= slack;
        high[a] += slack;
    }
}

status spots_add(struct spots *s, const struct function *f, struct dict *d, const char *key, int n,
                 const double *points, bool allow_outside) {
    if (n > MOST_SPOTS - s->n)
        return dict_fail(d, key, "more than %d points in one function object; give several", (int)MOST_SPOTS);
    struct spot *more = realloc(s->at, (size_t)(s->n + n + 1) * sizeof *more);
    if (!more) return fail(ERR_SYSTEM, "out of memory");
    s->at = more;
    double low[3], high[3]; /* needed as grid_locate looks at the solved axes only */
    bounding_box(f->setup->mesh, low, high);
    for (int i = 0; i < n; i++) {
        struct spot *p = &s->at[s->n++];
        memcpy(p->x, points + 3 * (long)i, sizeof p->x);
        TRY(grid_locate(f->setup->grid, p->x, &p->block, &p->cell));
        double found = p->block >= 0;
        for (int a = 0; a < 3; a++)
            if (p->x[a] < low[a] || p->x[a] > high[a]) found = 0;
        if (found == 0) p->block = -1;
        comm_max(f->setup->comm, &found, 1);
        p->inside = found > 0;
        if (!p->inside && !allow_outside)
            return dict_fail(d, key, "the point (%g %g %g) lies outside the mesh; move it, or say  allowOutside yes;",
                             p->x[0], p->x[1], p->x[2]);
    }
    return OK;
}

/* ---- values of cells, on every rank ---- */

status picks_make(const struct function *f, int slots, const int *slot_of, struct picks *out) {
    const struct grid *g = f->setup->grid;
    out->slots = slots;
    for (int list = 0; list < 2; list++) {
        if (list) TRY(pool_take(f->pool, &out->pick, out->n, sizeof *out->pick, "samples"));
        out->n = 0;
        for (int b = 0; b < g->nblocks; b++)
            for (int i = 0; i < g->block[b].ncells; i++) {
                const int slot = slot_of[g->block[b].cell[i]];
                if (slot < 0) continue;
                if (list) out->pick[out->n] = (struct pick){b, i, slot};
                out->n++;
            }
    }
    return OK;
}

/* One rank has each value, the others -infinity. */
void picks_gather(const struct picks *p, const struct function *f, int quantity, double *out) {
    const struct setup *s = f->setup;
    const int m = quantity_of(f, quantity)->components;
    double *lines[3];
    for (long i = 0; i < (long)p->slots * m; i++) out[i] = -HUGE_VAL;
    for (int i = 0, held = -1; i < p->n; i++) {
        const struct pick *one = &p->pick[i];
        double *to = out + (long)one->slot * m;
        if (one->block != held) function_block(f, held = one->block, quantity, lines);
        for (int k = 0; k < m; k++) to[k] = m == 1 ? lines[0][one->cell] : 0;
        for (int k = 0; m == 3 && k < setup_lines(s, quantity); k++) to[s->axis[k]] = lines[k][one->cell];
    }
    comm_max(s->comm, out, p->slots * m);
}

/* ---- values that are linear in the simplices of cells ----
 *
 * The root finds the simplices, and the cells whose values they need; every rank sends its cells' values. */

struct corner { /* of the simplex that holds a spot: spots[4], on the root */
    long node;
    double weight;
};
struct spots_linear {
    struct picks picks;
    int *cell;                 /* [picks.slots] of the mesh, ascending */
    double *slots;             /* [3 picks.slots] their values */
    struct vicinity *vicinity; /* on the root, as what follows */
    struct corner *corner;     /* [spots][4] */
    double *value;             /* [ncells] of one component; only wanted cells have theirs */
    struct edges *edges;       /* of the patches that the simplices touch; NULL: they touch none */
    double *at_point;          /* [npoints] values that these give to points; NULL, as `count`: they touch none */
    int *count;
};

/* Tells every rank the cell of the mesh that holds each spot; -1: it is outside. */
static status find_cells(const struct spots *s, const struct setup *setup, double **out) {
    TRY(allocate(out, s->n + 1L, sizeof **out, "points"));
    for (int i = 0; i < s->n; i++) {
        const struct spot *p = &s->at[i];
        (*out)[i] = p->block < 0 ? -1 : setup->grid->block[p->block].cell[p->cell];
    }
    comm_max(setup->comm, *out, s->n);
    return OK;
}

/* Finds the simplices of the spots and marks the cells that their corners need. */
static status find_simplices(struct pool *pool, struct spots_linear *l, const struct spots *s,
                             const struct setup *setup, const double *cell, bool *wanted) {
    TRY(setup_complete(setup));
    TRY(vicinity_make(setup->mesh, setup->centre, setup->dim, setup->axis, &l->vicinity));
    TRY(pool_take(pool, &l->corner, 4L * s->n + 1, sizeof *l->corner, "points"));
    TRY(pool_take(pool, &l->value, setup->mesh->ncells, sizeof *l->value, "samples"));
    for (int i = 0; i < s->n; i++) {
        long node[4];
        double weight[4];
        if (!s->at[i].inside) continue;
        const int n = vicinity_locate(l->vicinity, (int)cell[i], s->at[i].x, node, weight);
        for (int k = 0; k < n; k++) {
            l->corner[4L * i + k] = (struct corner){node[k], weight[k]};
            if (weight[k] != 0) vicinity_mark_node(l->vicinity, node[k], wanted);
        }
    }
    return OK;
}

/* Marks the points that a corner of a simplex needs. */
static void mark_points(const struct polymesh *m, long node, bool *points) {
    if (node < m->npoints) points[node] = true;
    const long face = node - m->npoints - m->ncells;
    for (int k = face < 0 ? 0 : m->face_start[face]; face >= 0 && k < m->face_start[face + 1]; k++)
        points[m->face_points[k]] = true;
}

/* Finds the patches that the simplices touch, on the root. */
static status find_patches(struct pool *pool, struct spots_linear *l, int nspots, const struct polymesh *m,
                           bool *takes) {
    bool *points, any = false;
    TRY(allocate(&points, m->npoints, sizeof *points, "points"));
    for (long i = 0; i < 4L * nspots; i++)
        if (l->corner[i].weight != 0) mark_points(m, l->corner[i].node, points);
    for (int p = 0; p < m->npatches; p++)
        for (int f = m->patch[p].start; f < m->patch[p].start + m->patch[p].nfaces; f++)
            for (int k = m->face_start[f]; k < m->face_start[f + 1]; k++) takes[p] |= points[m->face_points[k]];
    free(points);
    for (int p = 0; p < m->npatches; p++) any |= takes[p] && strcmp(m->patch[p].type, "empty") != 0;
    if (!any) return OK;
    TRY(pool_take(pool, &l->at_point, m->npoints, sizeof *l->at_point, "points"));
    return pool_take(pool, &l->count, m->npoints, sizeof *l->count, "points");
}

static status find_edges(struct pool *pool, struct spots_linear *l, int nspots, const struct setup *s) {
    bool *takes;
    TRY(comm_agree(s->comm, allocate(&takes, s->mesh->npatches + 1L, sizeof *takes, "patches")));
    status e = comm_agree(s->comm, comm_root(s->comm) ? find_patches(pool, l, nspots, s->mesh, takes) : OK);
    takes[s->mesh->npatches] = l->at_point != NULL;
    comm_broadcast(s->comm, takes, (s->mesh->npatches + 1L) * (long)sizeof *takes);
    if (!e && takes[s->mesh->npatches]) e = edges_make(s, takes, &l->edges);
    free(takes);
    return e;
}

/* Numbers the wanted cells, and finds those of this rank. */
static status find_picks(const struct function *f, struct spots_linear *l, const bool *wanted) {
    const int ncells = f->setup->mesh->ncells;
    int *slot, n = 0;
    TRY(allocate(&slot, ncells, sizeof *slot, "samples"));
    for (int c = 0; c < ncells; c++) slot[c] = wanted[c] ? n++ : -1;
    status e = pool_take(f->pool, &l->cell, n + 1L, sizeof *l->cell, "samples");
    if (!e) e = pool_take(f->pool, &l->slots, 3L * n + 1, sizeof *l->slots, "samples");
    for (int c = 0; !e && c < ncells; c++)
        if (wanted[c]) l->cell[slot[c]] = c;
    if (!e) e = picks_make(f, n, slot, &l->picks);
    free(slot);
    return e;
}

static status linear_make(const struct spots *s, const struct function *f, struct spots_linear **out) {
    const struct setup *setup = f->setup;
    bool *wanted = NULL;
    double *cell = NULL;
    struct spots_linear *l;
    status e = pool_take(f->pool, out, 1, sizeof **out, "points");
    if (!e) e = allocate(&wanted, setup->mesh->ncells, sizeof *wanted, "points");
    e = comm_agree(setup->comm, e);
    l = *out;
    if (!e) e = comm_agree(setup->comm, find_cells(s, setup, &cell));
    if (!e)
        e = comm_agree(setup->comm, comm_root(setup->comm) ? find_simplices(f->pool, l, s, setup, cell, wanted) : OK);
    if (!e) {
        comm_broadcast(setup->comm, wanted, (long)sizeof *wanted * setup->mesh->ncells);
        e = comm_agree(setup->comm, find_picks(f, l, wanted));
    }
    if (!e) e = find_edges(f->pool, l, s->n, setup);
    free(wanted);
    free(cell);
    return e;
}

static status linear_sample(const struct spots *s, const struct function *f, int field, double *out) {
    const struct spots_linear *l = s->fit;
    const int components = quantity_of(f, field)->components;
    picks_gather(&l->picks, f, field, l->slots);
    TRY(edges_find(l->edges));
    for (int k = 0; k < components && comm_root(f->setup->comm); k++) {
        const struct vicinity_field values = {l->vicinity, l->value, 1, NULL, l->edges ? l->at_point : NULL};
        if (l->edges) edges_points(l->edges, field, k, l->at_point, l->count);
        for (long i = 0; i < l->picks.slots; i++) l->value[l->cell[i]] = l->slots[i * components + k];
        for (int i = 0; i < s->n; i++) {
            double sum = 0;
            for (const struct corner *c = l->corner + 4L * i; c < l->corner + 4L * (i + 1); c++)
                if (c->weight != 0) sum += c->weight * vicinity_at_node(&values, c->node);
            out[(long)i * components + k] = sum;
        }
    }
    return OK;
}

/* ---- both ---- */

status spots_interpolate(struct spots *s, const struct function *f) {
    return linear_make(s, f, &s->fit);
}

static int by_block(const void *a, const void *b) {
    const struct pick *p = a, *q = b;
    if (p->block != q->block) return p->block < q->block ? -1 : 1;
    return (p->slot > q->slot) - (p->slot < q->slot);
}

static void sample_cells(const struct spots *s, const struct function *f, int field, struct pick *room, double *out) {
    struct picks here = {.slots = s->n, .pick = room};
    for (int i = 0; i < s->n; i++)
        if (s->at[i].block >= 0) room[here.n++] = (struct pick){s->at[i].block, s->at[i].cell, i};
    if (here.n) qsort(room, (size_t)here.n, sizeof *room, by_block);
    picks_gather(&here, f, field, out);
}

status spots_sample(const struct spots *s, const struct function *f, int field, double **out) {
    const int m = quantity_of(f, field)->components;
    struct pick *room = NULL;
    status e = allocate(out, (long)(s->n + 1) * m, sizeof(double), "samples");
    if (!e && !s->fit) e = allocate(&room, s->n, sizeof *room, "samples");
    TRY(comm_agree(f->setup->comm, e));
    if (s->fit)
        TRY(linear_sample(s, f, field, *out));
    else
        sample_cells(s, f, field, room, *out);
    free(room);
    for (int i = 0; i < s->n; i++)
        for (int c = 0; c < m && !s->at[i].inside; c++) (*out)[(long)i * m + c] = -1e300; /* as OpenFOAM does */
    return OK;
}

void spots_free(struct spots *s) {
    if (s->fit) {
        vicinity_free(s->fit->vicinity);
        edges_free(s->fit->edges);
    }
    free(s->at);
}
