/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bed of boxes or of triangles, for tests. */
#ifndef TESTS_BOX_BED_H
#define TESTS_BOX_BED_H

#include "libcore/acoustics/bed_private.h"

#include <math.h>
#include <stdlib.h>

#include "tests/checks.h" /* last: cmocka.h defines fail() */

struct box_form { /* n[0] x n[1] x n[2] boxes, or n[0] x n[1] pairs of triangles, in a box of walls, or periodic */
    int n[3];
    int components; /* of the velocity; 0: as many as there are axes with more than one cell */
    double width;
    bool periodic[3], triangles; /* along each axis; triangles may be periodic along x */
    double askew;                /* how far inner points of triangles are moved, over the width; 0: 0.15 */
    struct friction_use friction;
};
struct box {
    struct material material;
    struct bed bed;
    struct box_form form;
    struct bed_shapes shapes;
    double *memory, (*centre)[3]; /* [cells] */
};

static inline void make_shapes(struct box *x, int cells, int faces) {
    struct bed_shapes *s = &x->shapes;
    double **lines[] = {&s->area,      &s->depth[0],  &s->depth[1],  &s->normal[0], &s->normal[1], &s->normal[2],
                        &s->arm[0][0], &s->arm[0][1], &s->arm[0][2], &s->arm[1][0], &s->arm[1][1], &s->arm[1][2]};
    enum { LINES = sizeof lines / sizeof *lines };
    *s = (struct bed_shapes){.boxes = !x->form.triangles};
    s->volume = x->memory = calloc((size_t)(cells + LINES * faces), sizeof(double));
    assert_non_null(x->memory);
    for (int i = 0; i < LINES; i++) *lines[i] = x->memory + cells + i * faces;
    x->centre = calloc((size_t)cells, sizeof *x->centre);
    assert_non_null(x->centre);
}

/* The faces of boxes along an axis: the lower ones of each line of cells, then one above each cell. */
static inline int link_boxes(struct box *x, int axis, int faces) {
    struct bed_set *b = &x->bed.set;
    const int *all = x->form.n, n = all[axis], step = (axis > 0 ? all[0] : 1) * (axis > 1 ? all[1] : 1);
    const bool periodic = x->form.periodic[axis];
    for (int i = 0; i < b->cells; i++)
        for (int above = i / step % n > 0 || periodic; above < 2; above++) {
            const bool end = i / step % n == n - 1 && above;
            const int other = !above || (end && !periodic) ? -1 : end ? i - (n - 1) * step : i + step, f = faces++;
            b->left[f] = above ? i : -1;
            b->right[f] = above ? other : i;
            b->kind[f] = above && other >= 0 ? BED_INNER : BED_WALL;
            b->shape[f] = axis;
            b->face_of_cell[2 * (x->bed.dim * i + axis) + above] = above ? f : ~f;
            if (above && other >= 0) b->face_of_cell[2 * (x->bed.dim * other + axis)] = ~f;
        }
    return faces;
}

static inline int make_boxes(struct box *x) {
    struct bed_shapes *s = &x->shapes;
    const double width = x->form.width;
    const int *n = x->form.n;
    int faces = 0;
    for (int i = 0; i < x->bed.set.cells; i++) {
        const int at[3] = {i % n[0], i / n[0] % n[1], i / n[0] / n[1]};
        for (int k = 0; k < x->bed.dim; k++) x->centre[i][k] = width * (at[k] + 0.5);
        x->bed.set.body[i] = 0;
    }
    for (int i = 0; i <= x->bed.set.cells; i++) x->bed.set.face_start[i] = 2 * x->bed.dim * i;
    s->volume[0] = width * width; /* areas and volumes have a common factor */
    for (int k = 0; k < x->bed.dim; k++) {
        s->area[k] = width;
        s->normal[k][k] = 1;
        for (int side = 0; side < 2; side++) {
            s->depth[side][k] = 0.5 * width;
            s->arm[side][k][k] = side ? -0.5 * width : 0.5 * width;
        }
        faces = link_boxes(x, k, faces);
    }
    return faces;
}

/* Finds the face whose middle is at m, along x perhaps a period away; -1: there is none. */
static inline int face_at(const struct box *x, const double (*middle)[2], int faces, const double m[2]) {
    const double period = x->form.n[0] * x->form.width;
    for (int f = 0; f < faces; f++) {
        const double off = fabs(middle[f][0] - m[0]);
        if (fabs(middle[f][1] - m[1]) < 1e-9 && (off < 1e-9 || (x->form.periodic[0] && fabs(off - period) < 1e-9)))
            return f;
    }
    return -1;
}

/* Adds the edge from a to b of a triangle with the centre c. */
static inline int add_edge(struct box *x, double (*middle)[2], int *faces, int cell, const double a[2],
                           const double b[2], const double c[2]) {
    struct bed_shapes *s = &x->shapes;
    const double m[2] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])};
    int f = face_at(x, (const double(*)[2])middle, *faces, m);
    const bool right = f >= 0;
    if (!right) {
        f = (*faces)++;
        memcpy(middle[f], m, sizeof m);
        s->area[f] = hypot(b[0] - a[0], b[1] - a[1]);
        s->normal[0][f] = (b[1] - a[1]) / s->area[f];
        s->normal[1][f] = (a[0] - b[0]) / s->area[f];
        x->bed.set.shape[f] = f;
        x->bed.set.kind[f] = BED_WALL;
    }
    for (int k = 0; k < 2; k++) s->arm[right][k][f] = m[k] - c[k];
    s->depth[right][f] = fabs((m[0] - c[0]) * s->normal[0][f] + (m[1] - c[1]) * s->normal[1][f]);
    if (right) x->bed.set.kind[f] = BED_INNER;
    x->bed.set.left[f] = right ? x->bed.set.left[f] : cell;
    x->bed.set.right[f] = right ? cell : -1;
    return right ? ~f : f;
}

/* Two triangles a box, whose diagonals alternate. The inner points of the grid are moved, alike in every period. */
static inline int make_triangles(struct box *x) {
    static const int corner[2][2][3] = {{{0, 1, 3}, {0, 3, 2}}, {{0, 1, 2}, {1, 3, 2}}};
    struct bed_set *b = &x->bed.set;
    const int *n = x->form.n;
    const double askew = x->form.askew > 0 ? x->form.askew : 0.15;
    double(*middle)[2] = calloc((size_t)(3 * b->cells), sizeof *middle);
    int faces = 0;
    assert_non_null(middle);
    for (int i = 0; i < b->cells; i++) {
        const int box = i / 2, at[2] = {box % n[0], box / n[0]}, *use = corner[(at[0] + at[1]) % 2][i % 2];
        double p[3][2], *c = x->centre[i];
        for (int j = 0; j < 3; j++) {
            const int place[2] = {at[0] + use[j] % 2, at[1] + use[j] / 2};
            const bool inner = place[1] > 0 && place[1] < n[1] && place[0] % n[0] > 0;
            for (int k = 0; k < 2; k++) {
                p[j][k] = x->form.width * (place[k] + (inner ? askew * sin(7 * place[0] + 3 * place[1] + k) : 0));
                c[k] += p[j][k] / 3;
            }
        }
        b->body[i] = i;
        b->face_start[i] = 3 * i;
        for (int j = 0; j < 3; j++)
            b->face_of_cell[3 * i + j] = add_edge(x, middle, &faces, i, p[j], p[(j + 1) % 3], c);
        x->shapes.volume[i] =
            0.5 * ((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) - (p[2][0] - p[0][0]) * (p[1][1] - p[0][1]));
    }
    b->face_start[b->cells] = 3 * b->cells;
    free(middle);
    return faces;
}

/* Beyond walls the arms are those of mirror images. */
static inline void make_mirrors(struct box *x) {
    struct bed_shapes *s = &x->shapes;
    for (int f = 0; f < x->bed.set.faces && x->form.triangles; f++) {
        if (x->bed.set.right[f] >= 0) continue;
        for (int k = 0; k < 2; k++) s->arm[1][k][f] = s->arm[0][k][f] - 2 * s->depth[0][f] * s->normal[k][f];
        s->depth[1][f] = s->depth[0][f];
    }
}

static inline void box_make_of(struct box *x, const struct comm *comm, const char *eos, double e,
                               const struct box_form *form) {
    const struct eos *row = eos_find(eos);
    const int *n = form->n,
              dim = n[2] > 1   ? 3
                    : n[1] > 1 ? 2
                               : 1,
              cells = n[0] * n[1] * n[2] * (form->triangles ? 2 : 1), sides = cells * (form->triangles ? 3 : 2 * dim);
    *x = (struct box){.form = *form};
    x->material = (struct material){.diameter = 1,
                                    .mass = 1,
                                    .restitution = e,
                                    .gamma = 5. / 3,
                                    .alpha_max = 0.64,
                                    .freezing = 0.49,
                                    .smoothing = 0.01,
                                    .disks = row->disks};
    if (row->disks) x->material.gamma = 2;
    x->bed = (struct bed){.eos = row,
                          .material = &x->material,
                          .comm = comm,
                          .dim = dim,
                          .components = form->components ? form->components : dim,
                          .limit = density_limit(row, &x->material),
                          .params = {.dense = 0.9, .gain = 4, .governor = 1, .soft = 0.2, .keep = 0.05},
                          .friction = form->friction};
    make_shapes(x, cells, sides);
    ok(bed_make(&x->bed, n[1])); /* room for blocks of rows */
    x->bed.set.shapes = &x->shapes;
    x->bed.set.blocks = 1;
    x->bed.set.first[0] = x->bed.set.number[0] = 0;
    x->bed.set.first[1] = cells;
    ok(bed_list(&x->bed, sides));
    x->bed.set.faces = form->triangles ? make_triangles(x) : make_boxes(x);
    make_mirrors(x);
}

static inline void box_make(struct box *x, const struct comm *comm, const char *eos, double e, int nx, int ny,
                            double width, bool periodic, bool triangles) {
    box_make_of(x, comm, eos, e,
                &(struct box_form){.n = {nx, ny, 1}, .width = width, .periodic = {periodic}, .triangles = triangles});
}

static inline void box_free(struct box *x) {
    bed_free(&x->bed);
    free(x->memory);
    free(x->centre);
}

static inline double volume_of(const struct box *x, int i) {
    return x->shapes.volume[x->bed.set.body[i]];
}

/* Sets a cell to a packing fraction, a temperature and a velocity of `components`. */
static inline void set_moving(struct box *x, int i, double alpha, double T, const double *u) {
    double **U = x->bed.set.U, square = 0;
    const double rho = alpha / packing_per_density(&x->material);
    for (int k = 0; k < x->bed.components; k++) {
        U[k + 1][i] = rho * u[k];
        square += u[k] * u[k];
    }
    U[0][i] = rho;
    U[x->bed.components + 1][i] = rho * (eps_of(&x->material, T) + 0.5 * square);
}

static inline void set(struct box *x, int i, double alpha, double T, double u, double v) {
    set_moving(x, i, alpha, T, (const double[]){u, v, 0});
}

/* Finds alpha of the cell above one of pressure p and density rho, both of temperature T, by bisection, so that
 * p - p_above = (rho + rho_above) weight with weight = g h/2. */
static inline double above(const struct box *x, double p, double rho, double T, double weight) {
    const double eps = eps_of(&x->material, T);
    double low = 0, high = rho;
    for (int times = 0; times < 200; times++) {
        const double middle = 0.5 * (low + high);
        double q, c2, gruneisen;
        x->bed.eos->state(&x->material, 1, &middle, &eps, &q, &c2, &gruneisen);
        *(q + weight * middle > p - weight * rho ? &high : &low) = middle;
    }
    return 0.5 * (low + high) * packing_per_density(&x->material);
}

/* A number in 0 .. 1 that looks random. */
static inline double chance(unsigned *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return (*seed >> 8) / 16777216.;
}

#endif
