/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks a polyMesh before a run (polymesh_check): cells are closed, volumes positive, normals point out of the owner,
 * no cell is all but flat beside the others,
 * `empty` and cyclic patches are sound. Lists the first defects with their places. */
#include "mesh/format/polymesh.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SHOWN = 3, TEXT = 1400 };
static const double CLOSED = 1e-6; /* |sum of area vectors| / sum of |areas|: OpenFOAM's closedThreshold */
static const double FLAT = 1e-6;   /* largest 1 - |cosine| between the normal of an empty face and its axis */
static const double FAR = 1e60;    /* largest |coordinate|, m: products of five of them are still finite */
static const double LEAST = 1e-12; /* V/A of a cell beside the median: beyond it steps have no end */
static const double MATCH = 1e-4;  /* tolerance of positions for cyclic faces, times the square root of the area */

struct check {
    const struct polymesh *m;
    const struct polymesh_geometry *g;
    const bool *whole;         /* of a part of a mesh: has a cell all its faces? NULL: each has */
    const double (*offset)[3]; /* [npatches] from a cyclic patch to its other half, m; NULL: find it */
    bool axes[3];              /* axes that empty patches close */
    char *covered;             /* [ncells][6] empty faces per axis and side */
    long defects;
    char text[TEXT]; /* the first defects */
};

static void defect(struct check *k, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void defect(struct check *k, const char *format, ...) {
    if (k->defects++ >= SHOWN) return;
    size_t used = strlen(k->text);
    used += (size_t)snprintf(k->text + used, TEXT - used, "\n  ");
    va_list args;
    va_start(args, format);
    vsnprintf(k->text + used, TEXT - used, format, args);
    va_end(args);
}

static status verdict(struct check *k, const char *what) {
    if (k->defects == 0) return OK;
    return fail(ERR_INPUT, "mesh: %ld %s%s%s", k->defects, what, k->text, k->defects > SHOWN ? "\n  ..." : "");
}

static double size3(const double *v) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static double dot3(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

status polymesh_check_points(const struct polymesh *m) {
    for (long p = 0; p < m->npoints; p++) {
        const double *x = m->points + 3 * p;
        for (int k = 0; k < 3; k++)
            if (!(fabs(x[k]) <= FAR))
                return fail(
                    ERR_INPUT,
                    "mesh: point %ld is at (%g, %g, %g); coordinates lie between -%g and %g, or volumes would be "
                    "no numbers: choose another unit of length",
                    p, x[0], x[1], x[2], FAR, FAR);
    }
    return OK;
}

static bool is_whole(const struct check *k, long cell) {
    return !k->whole || k->whole[cell];
}

static status check_faces(struct check *k) {
    const struct polymesh *m = k->m;
    for (long f = 0; f < m->nfaces; f++) {
        const double *c = k->g->face_centre + 3 * f, *a = k->g->face_area + 3 * f,
                     *o = k->g->cell_centre + 3L * m->owner[f];
        double d[3];
        for (int i = 0; i < 3; i++)
            d[i] = (f < m->ninternal ? k->g->cell_centre[3L * m->neighbour[f] + i] : c[i]) - o[i];
        if (!(size3(a) > 0))
            defect(k, "face %ld at (%g, %g, %g) has no area", f, c[0], c[1], c[2]);
        else if (!(dot3(a, d) > 0))
            defect(k, "face %ld at (%g, %g, %g): its normal does not point out of its owner, cell %d", f, c[0], c[1],
                   c[2], m->owner[f]);
    }
    return verdict(k, "bad faces");
}

static status check_cells(struct check *k) {
    const struct polymesh *m = k->m;
    double *sum;
    TRY(allocate(&sum, 4L * m->ncells, sizeof *sum, "cells"));
    for (long f = 0; f < m->nfaces; f++)
        for (int side = 0; side < (f < m->ninternal ? 2 : 1); side++) {
            double *s = sum + 4L * (side ? m->neighbour[f] : m->owner[f]);
            for (int i = 0; i < 3; i++) s[i] += (side ? -1 : 1) * k->g->face_area[3 * f + i];
            s[3] += size3(k->g->face_area + 3 * f);
        }
    for (long c = 0; c < m->ncells; c++) {
        const double *x = k->g->cell_centre + 3 * c, *s = sum + 4 * c;
        if (!is_whole(k, c)) continue;
        if (!(size3(s) <= CLOSED * s[3]))
            defect(k, "cell %ld at (%g, %g, %g) is not closed: its faces leave a gap of %g of its surface", c, x[0],
                   x[1], x[2], size3(s) / s[3]);
        else if (!(k->g->volume[c] > 0))
            defect(k, "cell %ld at (%g, %g, %g) has the volume %g", c, x[0], x[1], x[2], k->g->volume[c]);
    }
    free(sum);
    return verdict(k, "bad cells");
}

/* ---- how narrow cells are: the steps of a run go by it ----------------------------------------------------------- */

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Adds up the surfaces of cells, without `empty` faces, which nothing crosses. */
static void add_surfaces(const struct polymesh *m, const double *area, double *surface) {
    int patch = -1;
    bool empty = false;
    for (int f = 0; f < m->nfaces; f++) {
        while (patch + 1 < m->npatches && f >= m->patch[patch + 1].start)
            empty = !strcmp(m->patch[++patch].type, "empty");
        if (empty) continue;
        const double *a = area + 3L * f, size = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
        surface[m->owner[f]] += size;
        if (f < m->ninternal) surface[m->neighbour[f]] += size;
    }
}

void polymesh_widths(const struct polymesh *m, const double *area, const double *volume, double *width) {
    for (long i = 0; i < m->ncells; i++) width[i] = 0;
    add_surfaces(m, area, width);
    for (long i = 0; i < m->ncells; i++) width[i] = volume[i] / width[i];
}

status polymesh_narrowest(const struct polymesh *m, const double *area, const double *volume, struct narrowest *out) {
    double *width, sum = 0;
    TRY(allocate(&width, m->ncells, sizeof *width, "cells"));
    polymesh_widths(m, area, volume, width);
    *out = (struct narrowest){.width = HUGE_VAL};
    for (long i = 0; i < m->ncells; i++) {
        sum += width[i];
        if (!(width[i] < out->width)) continue;
        out->cell = i;
        out->width = width[i];
    }
    /* half of all are no less than the median, which thus is no more than twice the mean: mostly that is enough */
    out->ratio = out->width / (2 * sum / m->ncells);
    if (out->ratio < 1e-3) {
        qsort(width, (size_t)m->ncells, sizeof *width, ascending);
        out->ratio = out->width / width[m->ncells / 2];
    }
    free(width);
    return OK;
}

static status check_widths(const struct check *k) {
    struct narrowest n;
    TRY(polymesh_narrowest(k->m, k->g->face_area, k->g->volume, &n));
    const double *x = k->g->cell_centre + 3 * n.cell;
    if (n.ratio > LEAST) return OK;
    return fail(ERR_INPUT,
                "mesh: cell %ld at (%g, %g, %g) has V/A = %.3g m, %.3g of the median of all cells; %g is the least: a "
                "run would go by steps for this cell and never end; make the mesh even there (points that should be "
                "one, or a layer of no thickness)",
                n.cell, x[0], x[1], x[2], n.width, n.ratio, LEAST);
}

/* ---- empty patches ----------------------------------------------------------------------------------------------- */

static void cover(struct check *k, const struct patch *p) {
    for (long f = p->start; f < p->start + p->nfaces; f++) {
        const double *a = k->g->face_area + 3 * f, *c = k->g->face_centre + 3 * f;
        int axis = 0;
        for (int i = 1; i < 3; i++)
            if (fabs(a[i]) > fabs(a[axis])) axis = i;
        if (fabs(a[axis]) < (1 - FLAT) * size3(a)) {
            defect(k, "face %ld at (%g, %g, %g) of patch '%s' is not normal to x, y or z", f, c[0], c[1], c[2],
                   p->name);
            continue;
        }
        k->axes[axis] = true;
        char *n = &k->covered[6L * k->m->owner[f] + 2 * axis + (a[axis] > 0)];
        *n = (char)(*n < 2 ? *n + 1 : 2);
    }
}

static status check_empty(struct check *k) {
    const struct polymesh *m = k->m;
    TRY(allocate(&k->covered, 6L * m->ncells, 1, "cells"));
    for (int i = 0; i < m->npatches; i++)
        if (strcmp(m->patch[i].type, "empty") == 0) cover(k, &m->patch[i]);
    TRY(verdict(k, "faces of empty patches in the wrong direction"));
    if (k->axes[0] && k->axes[1] && k->axes[2])
        return fail(ERR_INPUT, "mesh: empty patches close x, y and z; an axis to solve along must be left");
    for (long c = 0; c < m->ncells; c++)
        for (int axis = 0; axis < 3; axis++) {
            const char *n = k->covered + 6 * c + 2L * axis;
            const double *x = k->g->cell_centre + 3 * c;
            if (is_whole(k, c) && k->axes[axis] && (n[0] != 1 || n[1] != 1))
                defect(k, "cell %ld at (%g, %g, %g) has %d empty faces below and %d above along %c", c, x[0], x[1],
                       x[2], n[0], n[1], "xyz"[axis]);
        }
    return verdict(k,
                   "cells that empty patches do not close on both sides: the mesh must be one cell thick there (gmsh: "
                   "Layers{1}), and both sides must be in empty patches");
}

/* ---- cyclic patches ---------------------------------------------------------------------------------------------- */

static void match_faces(struct check *k, const struct patch *p, const struct patch *q, long i) {
    const struct polymesh *m = k->m;
    long a = p->start + i, b = q->start + i;
    const double *ca = k->g->face_centre + 3 * a, *cb = k->g->face_centre + 3 * b;
    const double *c0 = k->g->face_centre + 3L * p->start, *d0 = k->g->face_centre + 3L * q->start;
    const double found[3] = {d0[0] - c0[0], d0[1] - c0[1], d0[2] - c0[2]},
                 *shift = k->offset ? k->offset[p - m->patch] : found;
    double tolerance = MATCH * sqrt(size3(k->g->face_area + 3 * a)), off = 0, points = 0;
    int n = m->face_start[a + 1] - m->face_start[a];
    if (m->face_start[b + 1] - m->face_start[b] != n) points = INFINITY;
    for (int j = 0; j < 3; j++) off = fmax(off, fabs((cb[j] - ca[j]) - shift[j]));
    for (int v = 0; v < n && points < INFINITY; v++)
        for (int j = 0; j < 3; j++)
            points = fmax(points, fabs(m->points[3L * m->face_points[m->face_start[b] + (n - v) % n] + j] -
                                       m->points[3L * m->face_points[m->face_start[a] + v] + j] - shift[j]));
    if (!(fmax(off, points) <= 2 * tolerance))
        defect(k, "face %ld of '%s' at (%g, %g, %g) and face %ld of '%s' at (%g, %g, %g)", i, p->name, ca[0], ca[1],
               ca[2], i, q->name, cb[0], cb[1], cb[2]);
}

static status check_cyclic(struct check *k) {
    const struct polymesh *m = k->m;
    for (int i = 0; i < m->npatches; i++) {
        const struct patch *p = &m->patch[i];
        if (strcmp(p->type, "cyclic") != 0) continue;
        int j = p->neighbour ? polymesh_find_patch(m, p->neighbour) : -1;
        if (j < 0) return fail(ERR_INPUT, "mesh: the cyclic patch '%s' has no other half", p->name);
        const struct patch *q = &m->patch[j];
        if (p->nfaces != q->nfaces)
            return fail(ERR_INPUT, "mesh: the cyclic patches '%s' and '%s' have %d and %d faces; they must match",
                        p->name, q->name, p->nfaces, q->nfaces);
        for (long f = 0; f < p->nfaces && i < j; f++) match_faces(k, p, q, f);
    }
    return verdict(k, "pairs of cyclic faces do not match: face i of one half must be face i of the other moved by one "
                      "vector, point 0 opposite to point 0 (OpenFOAM's createPatch -overwrite sorts them)");
}

static status check_all(struct check *k) {
    TRY(check_cells(k));
    TRY(check_faces(k));
    TRY(check_empty(k));
    if (!k->whole) TRY(check_widths(k));
    return check_cyclic(k);
}

status polymesh_check_geometry(const struct polymesh *m, struct polymesh_geometry *g) {
    struct check k = {.m = m, .g = g};
    *g = (struct polymesh_geometry){0};
    if (m->boxes) return polymesh_geometry_make(m, g); /* boxes were checked when the mesh was made of them */
    TRY(polymesh_check_points(m));
    TRY(polymesh_geometry_make(m, g));
    status s = check_all(&k);
    free(k.covered);
    return s;
}

status polymesh_check_part(const struct polymesh *m, const struct polymesh_geometry *g, const bool *whole,
                           const bool closed[3], const double (*offset)[3]) {
    struct check k = {.m = m, .g = g, .whole = whole, .offset = offset, .axes = {closed[0], closed[1], closed[2]}};
    status s = check_all(&k);
    free(k.covered);
    return s;
}

status polymesh_check(const struct polymesh *m) {
    struct polymesh_geometry g;
    if (m->boxes) return OK;
    status s = polymesh_check_geometry(m, &g);
    polymesh_geometry_free(&g);
    return s;
}
