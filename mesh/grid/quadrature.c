/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fills quadrature points of cells (quadrature.h): cuts a cell into simplices about its centre and puts a symmetric
 * rule on each. The rules are Gauss's (1D), Dunavant's (2D) and Walkington's (3D); fill_rule cites them. */
#include "mesh/grid/quadrature.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_CORNERS = 4, MOST_POINTS = 14 };

struct simplex_rule { /* a rule for a simplex; point i is the sum of the simplex's corners times barycentric[i] */
    int npoints;
    double weight[MOST_POINTS], barycentric[MOST_POINTS][MOST_CORNERS];
};

/* Adds all points with the barycentric coordinate `one` at one corner and `rest` at the others. */
static void add_corners(struct simplex_rule *r, int dim, double one, double rest, double weight) {
    for (int c = 0; c <= dim; c++) {
        for (int k = 0; k <= dim; k++) r->barycentric[r->npoints][k] = k == c ? one : rest;
        r->weight[r->npoints++] = weight;
    }
}

/* Fills the rule of Gauss (1D, degree 5), Dunavant (2D, degree 4; Int. J. Numer. Methods Eng. 21, 1985) or Walkington
 * (3D, degree 5; 2000). */
static void fill_rule(struct simplex_rule *r, int dim) {
    *r = (struct simplex_rule){0};
    if (dim == 1) {
        const double a = 0.5 * (1 - sqrt(0.6));
        add_corners(r, 1, 1 - a, a, 5. / 18);
        r->barycentric[2][0] = r->barycentric[2][1] = 0.5;
        r->weight[r->npoints++] = 8. / 18;
    } else if (dim == 2) {
        const double a = 0.44594849091596488632, b = 0.09157621350977074346;
        add_corners(r, 2, 1 - 2 * a, a, 0.22338158967801146570);
        add_corners(r, 2, 1 - 2 * b, b, 0.10995174365532186764);
    } else {
        const double a = 0.31088591926330060980, b = 0.092735250310891226402, c = 0.045503704125649649492;
        add_corners(r, 3, 1 - 3 * a, a, 0.11268792571801585080);
        add_corners(r, 3, 1 - 3 * b, b, 0.073493043116361949544);
        for (int i = 0; i < 4; i++)
            for (int j = i + 1; j < 4; j++) {
                for (int k = 0; k < 4; k++) r->barycentric[r->npoints][k] = k == i || k == j ? 0.5 - c : c;
                r->weight[r->npoints++] = 0.042546020777081466438;
            }
    }
}

struct filler {
    const struct quadrature *q;
    struct simplex_rule rule;
    const double *apex, *centre; /* the corner that all simplices share, the centre of the cell */
    int n;
    double (*x)[3], *weight;
};

/* Adds the points of the simplex of the apex and dim corners. `volume` is in any unit, negative where the apex lies
 * outside the cell. */
static void add_simplex(struct filler *f, const double *const *corner, double volume) {
    const struct simplex_rule *r = &f->rule;
    for (int i = 0; i < r->npoints; i++, f->n++) {
        memcpy(f->x[f->n], f->centre, sizeof f->x[0]);
        for (int d = 0; d < f->q->dim; d++) {
            const int a = f->q->axis[d];
            double sum = r->barycentric[i][0] * f->apex[a];
            for (int k = 0; k < f->q->dim; k++) sum += r->barycentric[i][k + 1] * corner[k][a];
            f->x[f->n][a] = sum;
        }
        f->weight[f->n] = r->weight[i] * volume;
    }
}

static double height(const struct filler *f, const double *at, const double *area) {
    double sum = 0;
    for (int d = 0; d < f->q->dim; d++) sum += (at[f->q->axis[d]] - f->apex[f->q->axis[d]]) * area[f->q->axis[d]];
    return sum;
}

static double tet_volume(const double *o, const double *a, const double *b, const double *c) {
    double u[3], v[3], w[3];
    for (int k = 0; k < 3; k++) u[k] = a[k] - o[k], v[k] = b[k] - o[k], w[k] = c[k] - o[k];
    return (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] + (u[0] * v[1] - u[1] * v[0]) * w[2];
}

/* Finds the other end of a 2D mesh's face, an edge extruded along the empty axis: its ends are any point and the
 * farthest from it. */
static const double *far_end(const struct filler *f, int face) {
    const struct polymesh *m = f->q->mesh;
    const int x = f->q->axis[0], y = f->q->axis[1], first = m->face_start[face];
    const double *a = m->points + 3L * m->face_points[first], *far = a;
    double most = 0;
    for (int i = first + 1; i < m->face_start[face + 1]; i++) {
        const double *b = m->points + 3L * m->face_points[i];
        double away = hypot(b[x] - a[x], b[y] - a[y]);
        if (away > most) most = away, far = b;
    }
    return far;
}

static void add_face(struct filler *f, int face, double sign) {
    const struct polymesh *m = f->q->mesh;
    const int *p = m->face_points + m->face_start[face], n = m->face_start[face + 1] - m->face_start[face];
    const double *first = m->points + 3L * p[0], *area = f->q->face_area + 3L * face;
    if (f->q->dim < 3) {
        const double *ends[2] = {first, f->q->dim == 2 ? far_end(f, face) : NULL};
        add_simplex(f, ends, sign * height(f, first, area));
        return;
    }
    for (int i = 0; i < (n == 3 ? 1 : n); i++) {
        const double *corner[3] = {n == 3 ? first : f->q->face_centre + 3L * face, m->points + 3L * p[n == 3 ? 1 : i],
                                   m->points + 3L * p[n == 3 ? 2 : (i + 1) % n]};
        add_simplex(f, corner, sign * tet_volume(f->apex, corner[0], corner[1], corner[2]));
    }
}

static bool solved(const struct quadrature *q, int face) {
    const double *a = q->face_area + 3L * face;
    double along = 0;
    for (int d = 0; d < q->dim; d++) along += a[q->axis[d]] * a[q->axis[d]];
    return along > 0.5 * (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/* Lists the solved faces of a cell in `face`; returns how many. */
static int list_faces(const struct quadrature *q, int cell, int *face) {
    int n = 0;
    for (int i = q->cell_start[cell]; i < q->cell_start[cell + 1]; i++)
        if (solved(q, q->cell_face[i])) face[n++] = q->cell_face[i];
    return n;
}

static int corners(const struct quadrature *q, int face) {
    return q->dim < 3 ? q->dim : q->mesh->face_start[face + 1] - q->mesh->face_start[face];
}

static bool is_simplex(const struct quadrature *q, int n, const int *face) {
    bool all = n == q->dim + 1;
    for (int i = 0; i < n && all; i++) all = corners(q, face[i]) == q->dim;
    return all;
}

/* Finds the corner of a simplex that is not on `face`: of another face's points the farthest from `face`. */
static const double *corner_beyond(const struct filler *f, int face, int other) {
    const struct polymesh *m = f->q->mesh;
    const double *a = m->points + 3L * m->face_points[m->face_start[face]], *area = f->q->face_area + 3L * face,
                 *far = a;
    double most = 0;
    for (int i = m->face_start[other]; i < m->face_start[other + 1]; i++) {
        const double *b = m->points + 3L * m->face_points[i];
        double away = fabs(height(f, b, area) - height(f, a, area));
        if (away > most) most = away, far = b;
    }
    return far;
}

int quadrature_cell(const struct quadrature *q, int cell, double (*x)[3], double *weight) {
    const double *centre = q->centre + 3L * cell;
    struct filler f = {.q = q, .apex = centre, .centre = centre, .x = x, .weight = weight};
    int *face = q->list, n = list_faces(q, cell, face);
    double sum = 0;
    fill_rule(&f.rule, q->dim);
    if (is_simplex(q, n, face)) {
        f.apex = corner_beyond(&f, face[0], face[1]);
        n = 1;
    }
    for (int i = 0; i < n; i++) add_face(&f, face[i], q->mesh->owner[face[i]] == cell ? 1 : -1);
    for (int i = 0; i < f.n; i++) sum += weight[i];
    for (int i = 0; i < f.n; i++) weight[i] /= sum;
    return f.n;
}

static status fill(struct quadrature *q) {
    const struct polymesh *m = q->mesh;
    struct simplex_rule rule;
    fill_rule(&rule, q->dim);
    TRY(allocate(&q->face_centre, 6L * m->nfaces, sizeof(double), "the quadrature"));
    q->face_area = q->face_centre + 3L * m->nfaces;
    polymesh_face_geometry(m, q->face_centre, q->face_area);
    TRY(polymesh_cell_faces(m, &q->cell_start, &q->cell_face));
    for (int c = 0; c < m->ncells; c++) {
        int faces = q->cell_start[c + 1] - q->cell_start[c], simplices = 0;
        for (int i = q->cell_start[c]; i < q->cell_start[c + 1]; i++)
            simplices += q->dim < 3 ? 1 : corners(q, q->cell_face[i]);
        if (faces > q->most_faces) q->most_faces = faces;
        if (simplices * rule.npoints > q->most) q->most = simplices * rule.npoints;
    }
    return allocate(&q->list, q->most_faces, sizeof *q->list, "the quadrature");
}

status quadrature_make(const struct polymesh *m, const double *centre, int dim, const int axis[3],
                       struct quadrature **out) {
    struct quadrature *q = NULL;
    *out = NULL;
    TRY(allocate(&q, 1, sizeof *q, "the quadrature"));
    q->mesh = m;
    q->centre = centre;
    q->dim = dim;
    for (int k = 0; k < dim; k++) q->axis[k] = axis[k];
    status s = fill(q);
    if (s)
        quadrature_free(q);
    else
        *out = q;
    return s;
}

void quadrature_free(struct quadrature *q) {
    if (!q) return;
    free(q->face_centre);
    free(q->cell_start);
    free(q->cell_face);
    free(q->list);
    free(q);
}
