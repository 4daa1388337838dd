/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the cell that holds a point (search.h): the cells of a bucket are cut into tetrahedra of the cell's centre, the
 * mean of a face and one of its edges. */
#include "mesh/grid/search.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Barycentric coordinates from -TOLERANCE on count as inside: cells share the points between them. */
static const double TOLERANCE = 1e-6;

struct search {
    const struct polymesh *m;
    const double *centre; /* [ncells][3] */
    const bool *among;    /* [ncells] the cells that count; NULL: all */
    int dim, axis[3];
    int *face_start, *face;  /* [ncells + 1], faces of each cell */
    double low[3], width[3]; /* lower corner of the first bucket and size of a bucket, along the solved axes, m */
    int n[3];                /* number of buckets along the solved axes, 1 beyond */
    int *cell_start, *cell;  /* [buckets + 1], cells that may hold a point of a bucket, ascending */
};

static double solve(const double a[3], const double b[3], const double c[3]) { /* a . (b x c) */
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Is x in the tetrahedron of 0, a, b, c? */
static bool in_tetrahedron(const double a[3], const double b[3], const double c[3], const double x[3]) {
    double all = solve(a, b, c);
    if (all == 0) return false;
    double p = solve(x, b, c) / all, q = solve(a, x, c) / all, r = solve(a, b, x) / all;
    return p >= -TOLERANCE && q >= -TOLERANCE && r >= -TOLERANCE && p + q + r <= 1 + TOLERANCE;
}

static bool holds(const struct search *s, int c, const double point[3]) {
    const struct polymesh *m = s->m;
    const double *o = s->centre + 3L * c;
    double x[3] = {0}; /* position from the cell's centre, 0 along the empty axes */
    for (int k = 0; k < s->dim; k++) x[s->axis[k]] = point[s->axis[k]] - o[s->axis[k]];
    for (int i = s->face_start[c]; i < s->face_start[c + 1]; i++) {
        int f = s->face[i], n = m->face_start[f + 1] - m->face_start[f];
        const int *p = m->face_points + m->face_start[f];
        double mean[3] = {0}, a[3], b[3];
        for (int j = 0; j < n; j++)
            for (int k = 0; k < 3; k++) mean[k] += m->points[3L * p[j] + k] / n;
        for (int k = 0; k < 3; k++) mean[k] -= o[k];
        for (int j = 0; j < n; j++) {
            for (int k = 0; k < 3; k++) {
                a[k] = m->points[3L * p[j] + k] - o[k];
                b[k] = m->points[3L * p[(j + 1) % n] + k] - o[k];
            }
            if (in_tetrahedron(mean, a, b, x)) return true;
        }
    }
    return false;
}

static int bucket_of(const struct search *s, int k, double x) {
    double i = floor((x - s->low[k]) / s->width[k]);
    return i < 0 ? 0 : i >= s->n[k] ? s->n[k] - 1 : (int)i;
}

/* Finds the buckets, low to high, that a cell's box and some slack touch along each axis. */
static void buckets_of_cell(const struct search *s, int c, int low[3], int high[3]) {
    const struct polymesh *m = s->m;
    double from[3] = {INFINITY, INFINITY, INFINITY}, to[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int i = s->face_start[c]; i < s->face_start[c + 1]; i++)
        for (int j = m->face_start[s->face[i]]; j < m->face_start[s->face[i] + 1]; j++)
            for (int k = 0; k < s->dim; k++) {
                double x = m->points[3L * m->face_points[j] + s->axis[k]];
                from[k] = fmin(from[k], x);
                to[k] = fmax(to[k], x);
            }
    for (int k = 0; k < 3; k++) {
        double slack = 2 * TOLERANCE * (to[k] - from[k]);
        low[k] = k < s->dim ? bucket_of(s, k, from[k] - slack) : 0;
        high[k] = k < s->dim ? bucket_of(s, k, to[k] + slack) : 0;
    }
}

/* Chooses the buckets, about one per cell. */
static void lay_out(struct search *s) {
    const struct polymesh *m = s->m;
    double extent[3], size = 1;
    for (int k = 0; k < s->dim; k++) {
        double high = -INFINITY;
        s->low[k] = INFINITY;
        for (int i = 0; i < m->npoints; i++) {
            s->low[k] = fmin(s->low[k], m->points[3L * i + s->axis[k]]);
            high = fmax(high, m->points[3L * i + s->axis[k]]);
        }
        extent[k] = high - s->low[k];
        size *= extent[k];
    }
    size = pow(size / m->ncells, 1. / s->dim);
    for (int k = 0; k < 3; k++) {
        s->n[k] = k < s->dim ? (int)fmin(fmax(extent[k] / size, 1), m->ncells) : 1;
        s->width[k] = k < s->dim ? extent[k] / s->n[k] : 1;
    }
}

/* Counts the cells of every bucket in next[] or, if `list`, writes the cells where next[] points and moves it on. */
static void fill_buckets(struct search *s, int *next, bool list) {
    for (int c = 0; c < s->m->ncells; c++) {
        int low[3], high[3];
        if (s->among && !s->among[c]) continue;
        buckets_of_cell(s, c, low, high);
        for (int k = low[2]; k <= high[2]; k++)
            for (int j = low[1]; j <= high[1]; j++)
                for (int i = low[0]; i <= high[0]; i++) {
                    int *at = &next[i + s->n[0] * (j + s->n[1] * k)];
                    if (list) s->cell[*at] = c;
                    ++*at;
                }
    }
}

static status make_buckets(struct search *s) {
    lay_out(s);
    long n = (long)s->n[0] * s->n[1] * s->n[2];
    TRY(allocate(&s->cell_start, n + 2, sizeof *s->cell_start, "a search by place"));
    fill_buckets(s, s->cell_start + 2, false);
    for (long i = 1; i <= n; i++) s->cell_start[i + 1] += s->cell_start[i];
    TRY(allocate(&s->cell, s->cell_start[n + 1], sizeof *s->cell, "a search by place"));
    fill_buckets(s, s->cell_start + 1, true);
    return OK;
}

status search_make(const struct polymesh *m, const double *centre, int dim, const int axis[3], struct search **out) {
    return search_make_among(m, centre, dim, axis, NULL, out);
}

status search_make_among(const struct polymesh *m, const double *centre, int dim, const int axis[3], const bool *among,
                         struct search **out) {
    struct search *s = NULL;
    *out = NULL;
    TRY(allocate(&s, 1, sizeof *s, "a search by place"));
    s->m = m;
    s->centre = centre;
    s->among = among;
    s->dim = dim;
    memcpy(s->axis, axis, sizeof s->axis);
    status e = polymesh_cell_faces(m, &s->face_start, &s->face);
    if (!e) e = make_buckets(s);
    if (e) {
        search_free(s);
        return e;
    }
    *out = s;
    return OK;
}

void search_free(struct search *s) {
    if (!s) return;
    free(s->face_start);
    free(s->face);
    free(s->cell_start);
    free(s->cell);
    free(s);
}

int search_cell(const struct search *s, const double point[3]) {
    int at[3] = {0};
    for (int k = 0; k < s->dim; k++) {
        double x = point[s->axis[k]], over = (x - s->low[k]) / s->width[k] / s->n[k];
        if (!(over > -0.5 && over < 1.5)) return -1;
        at[k] = bucket_of(s, k, x);
    }
    int bucket = at[0] + s->n[0] * (at[1] + s->n[1] * at[2]);
    for (int i = s->cell_start[bucket]; i < s->cell_start[bucket + 1]; i++)
        if (holds(s, s->cell[i], point)) return s->cell[i];
    return -1;
}
