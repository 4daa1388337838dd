/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists the planes of the cells' faces, and the cells of buckets by place (cell_sides.h). */
#include "solvers/grains/cell_sides.h"

#include "mesh/base/pool.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct half_space { /* of a face: the cell is where normal . x <= offset */
    double normal[3], offset;
};
struct cell_sides {
    struct pool pool;
    int dim, n[3];
    double low[3], per[3]; /* m, 1/m: lower corner of the buckets, and one over their size */
    double slack;          /* m: so far beyond its faces points belong to a cell, too */
    int *plane_start;      /* [cells + 1] */
    struct half_space *plane;
    int *cell_start, *cell; /* [buckets + 1] */
    const double (*bounds)[6];
};

/* Adds the planes of face f to its cells: counts in next[], or writes where that points. */
static void add_planes(const struct polymesh *m, int dim, const int axis[3], int f, int *next,
                       struct half_space *list) {
    double centre[3], area[3], square = 0;
    struct half_space p = {{0}, 0};
    polymesh_one_face(m, f, centre, area);
    for (int k = 0; k < 3; k++) square += area[k] * area[k];
    for (int k = 0; k < dim; k++) {
        p.normal[k] = area[axis[k]] / sqrt(square);
        p.offset += p.normal[k] * centre[axis[k]];
    }
    double along = 0;
    for (int k = 0; k < dim; k++) along += p.normal[k] * p.normal[k];
    if (along < 0.5) return; /* an empty side of a plane mesh */
    for (int side = 0; side < (f < m->ninternal ? 2 : 1); side++) {
        int *at = &next[side ? m->neighbour[f] : m->owner[f]];
        if (list) {
            list[*at] = p;
            for (int k = 0; k < 3 && side; k++) list[*at].normal[k] = -p.normal[k];
            if (side) list[*at].offset = -p.offset;
        }
        ++*at;
    }
}

static status make_planes(struct cell_sides *s, const struct polymesh *m, const int axis[3]) {
    TRY(pool_take(&s->pool, &s->plane_start, m->ncells + 2L, sizeof(int), "planes of cells"));
    for (int f = 0; f < m->nfaces; f++) add_planes(m, s->dim, axis, f, s->plane_start + 2, NULL);
    for (int c = 1; c <= m->ncells; c++) s->plane_start[c + 1] += s->plane_start[c];
    TRY(pool_take(&s->pool, &s->plane, s->plane_start[m->ncells + 1], sizeof *s->plane, "planes of cells"));
    for (int f = 0; f < m->nfaces; f++) add_planes(m, s->dim, axis, f, s->plane_start + 1, s->plane);
    return OK;
}

/* Returns how far x is beyond the planes of a cell (m); <= 0: it is inside. */
static double beyond(const struct cell_sides *s, int c, const double x[3]) {
    double most = -HUGE_VAL;
    for (int i = s->plane_start[c]; i < s->plane_start[c + 1]; i++) {
        double h = -s->plane[i].offset;
        for (int k = 0; k < s->dim; k++) h += s->plane[i].normal[k] * x[k];
        most = fmax(most, h);
    }
    return most;
}

static double size_of(const struct cell_sides *s, int c) {
    double size = 0;
    for (int k = 0; k < s->dim; k++) size = fmax(size, s->bounds[c][3 + k] - s->bounds[c][k]);
    return size;
}

/* Do all corners of all cells lie within the planes? */
static bool all_convex(const struct cell_sides *s, const struct polymesh *m, const int axis[3]) {
    for (int f = 0; f < m->nfaces; f++)
        for (int i = m->face_start[f]; i < m->face_start[f + 1]; i++) {
            double x[3] = {0};
            for (int k = 0; k < s->dim; k++) x[k] = m->points[3L * m->face_points[i] + axis[k]];
            for (int side = 0; side < (f < m->ninternal ? 2 : 1); side++) {
                const int c = side ? m->neighbour[f] : m->owner[f];
                if (beyond(s, c, x) > 1e-9 * size_of(s, c)) return false;
            }
        }
    return true;
}

static int bucket_along(const struct cell_sides *s, int k, double x) {
    const double i = (x - s->low[k]) * s->per[k];
    return i > 0 ? (i < s->n[k] - 1 ? (int)i : s->n[k] - 1) : 0;
}

/* Can a cell have points in a bucket? The first and the last bucket go on beyond the mesh. */
static bool meets(const struct cell_sides *s, int c, const int at[3]) {
    for (int i = s->plane_start[c]; i < s->plane_start[c + 1]; i++) {
        const struct half_space *p = &s->plane[i];
        double least = -p->offset;
        for (int k = 0; k < s->dim; k++) least += p->normal[k] * (s->low[k] + (at[k] + (p->normal[k] < 0)) / s->per[k]);
        if (least > 10 * s->slack) return false;
    }
    return true;
}

/* Counts the cells of every bucket in next[] or, if `list`, writes the cells where next[] points. */
static void fill_buckets(const struct cell_sides *s, int cells, int *next, int *list) {
    for (int c = 0; c < cells; c++) {
        const double slack = 1e-9 * size_of(s, c);
        int from[3] = {0}, to[3] = {0};
        for (int k = 0; k < s->dim; k++) {
            from[k] = bucket_along(s, k, s->bounds[c][k] - slack);
            to[k] = bucket_along(s, k, s->bounds[c][3 + k] + slack);
        }
        for (int k = from[2]; k <= to[2]; k++)
            for (int j = from[1]; j <= to[1]; j++)
                for (int i = from[0]; i <= to[0]; i++) {
                    int *at = &next[i + s->n[0] * (j + s->n[1] * k)];
                    if (!meets(s, c, (const int[3]){i, j, k})) continue;
                    if (list) list[*at] = c;
                    ++*at;
                }
    }
}

static status make_buckets(struct cell_sides *s, int cells) {
    double high[3], size = 1;
    for (int k = 0; k < s->dim; k++) {
        s->low[k] = HUGE_VAL;
        high[k] = -HUGE_VAL;
        for (int c = 0; c < cells; c++) {
            s->low[k] = fmin(s->low[k], s->bounds[c][k]);
            high[k] = fmax(high[k], s->bounds[c][3 + k]);
        }
        size *= high[k] - s->low[k];
    }
    size = pow(size / (4. * cells), 1. / s->dim);
    s->slack = 1e-9 * size;
    for (int k = 0; k < 3; k++) {
        s->n[k] = k < s->dim ? (int)fmin(fmax((high[k] - s->low[k]) / size, 1), 1e5) : 1;
        s->per[k] = k < s->dim ? s->n[k] / (high[k] - s->low[k]) : 0;
    }
    const long n = (long)s->n[0] * s->n[1] * s->n[2];
    TRY(pool_take(&s->pool, &s->cell_start, n + 2, sizeof(int), "cells by place"));
    fill_buckets(s, cells, s->cell_start + 2, NULL);
    for (long i = 1; i <= n; i++) s->cell_start[i + 1] += s->cell_start[i];
    TRY(pool_take(&s->pool, &s->cell, s->cell_start[n + 1], sizeof(int), "cells by place"));
    fill_buckets(s, cells, s->cell_start + 1, s->cell);
    return OK;
}

status cell_sides_make(const struct polymesh *m, int dim, const int axis[3], const double (*bounds)[6],
                       struct cell_sides **out) {
    struct cell_sides *s;
    *out = NULL;
    TRY(allocate(&s, 1, sizeof *s, "cells by place"));
    s->dim = dim;
    s->bounds = bounds;
    status e = make_planes(s, m, axis);
    const bool convex = !e && all_convex(s, m, axis);
    if (convex) e = make_buckets(s, m->ncells);
    if (convex && !e)
        *out = s;
    else
        cell_sides_free(s);
    return e;
}

void cell_sides_free(struct cell_sides *s) {
    if (!s) return;
    pool_free(&s->pool);
    free(s);
}

static inline bool holds(const struct cell_sides *s, int c, const double x[3]) {
    for (int i = s->plane_start[c]; i < s->plane_start[c + 1]; i++) {
        const struct half_space *p = &s->plane[i];
        if (p->normal[0] * x[0] + p->normal[1] * x[1] + p->normal[2] * x[2] > p->offset + s->slack) return false;
    }
    return true;
}

long cell_sides_find(const struct cell_sides *s, const double x[3], bool *inside) {
    int at[3] = {0};
    long nearest = -1;
    double least = HUGE_VAL;
    for (int k = 0; k < s->dim; k++) at[k] = bucket_along(s, k, x[k]);
    const int bucket = at[0] + s->n[0] * (at[1] + s->n[1] * at[2]);
    const int *first = s->cell + s->cell_start[bucket], *end = s->cell + s->cell_start[bucket + 1];
    *inside = true;
    for (const int *c = first; c < end; c++)
        if (holds(s, *c, x)) return *c;
    *inside = false;
    for (const int *c = first; c < end; c++) {
        const double h = beyond(s, *c, x);
        if (h >= least) continue;
        least = h;
        nearest = *c;
    }
    return nearest;
}
