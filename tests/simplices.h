/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes meshes of a box with perturbed points: quads, triangles, hexes, tets. They serve tests and benchmarks of code
 * for polyhedral meshes. */
#ifndef TESTS_SIMPLICES_H
#define TESTS_SIMPLICES_H

#include "mesh/format/polymesh.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum shape { QUADS, TRIANGLES, HEXES, TETS };
struct sample {
    enum shape shape;
    struct polymesh *mesh; /* patches x0 x1 y0 y1 z0 z1; flat shapes lie in x and y, z is empty */
    int *corner;           /* [ncells][8] points; in flat shapes the points at z = 0 come first */
};
struct sample_face {
    int key[4], point[4], n, cell;
};

static inline double sample_noise(long i, int k) { /* returns noise from -1 to 1, always the same for (i, k) */
    uint64_t x = (uint64_t)i * 3 + (uint64_t)k + 1;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return (double)((x ^ (x >> 31)) >> 11) * 0x1p-52 - 1;
}
static inline int sample_by_value(const void *a, const void *b) {
    return *(const int *)a - *(const int *)b;
}
static inline int sample_by_key(const void *a, const void *b) {
    const struct sample_face *f = a, *g = b;
    for (int i = 0; i < 4; i++)
        if (f->key[i] != g->key[i]) return f->key[i] < g->key[i] ? -1 : 1;
    return 0;
}
static inline bool sample_flat(enum shape s) {
    return s == QUADS || s == TRIANGLES;
}

/* Cuts the box at place (i, j, k) with corner points p[8] in binary order into cells: fills their corner lists; returns
 * how many. */
static inline int sample_cells(enum shape shape, int place, const int p[8], int cell[6][8]) {
    static const int order[6][2] = {{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}};
    static const int split[2][2][3] = {{{0, 1, 3}, {0, 3, 2}}, {{0, 1, 2}, {1, 3, 2}}};
    static const int round_box[8] = {0, 1, 3, 2, 4, 5, 7, 6};
    int n = shape == TRIANGLES ? 2 : shape == TETS ? 6 : 1;
    for (int c = 0; c < n; c++)
        for (int a = 0; a < 8; a++) {
            cell[c][a] = p[round_box[a]];
            if (shape == TETS) cell[c][a] = a < 4 ? p[a == 0 ? 0 : a == 3 ? 7 : order[c][a - 1]] : -1;
            if (shape == TRIANGLES)
                cell[c][a] = a < 6 ? p[split[sample_noise(place, 7) > 0][c][a % 3] + a / 3 * 4] : -1;
        }
    return n;
}

static inline void sample_add_faces(enum shape shape, const int *corner, int cell, struct sample_face *face, int *n) {
    static const int hex[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    static const int prism[5][4] = {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
    static const int tet[4][4] = {{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}};
    const int(*list)[4] = shape == TETS ? tet : shape == TRIANGLES ? prism : hex;
    for (int f = 0; f < (shape == TETS ? 4 : shape == TRIANGLES ? 5 : 6); f++) {
        struct sample_face *to = &face[(*n)++];
        *to = (struct sample_face){.cell = cell};
        for (int a = 0; a < 4; a++) {
            to->point[a] = to->key[a] = list[f][a] < 0 ? -1 : corner[list[f][a]];
            to->n += list[f][a] >= 0;
        }
        qsort(to->key, 4, sizeof(int), sample_by_value);
    }
}

/* Returns the patch of a face on the boundary: all its points have the same outermost lattice place. */
static inline int sample_patch(const struct sample_face *f, const int n[3]) {
    for (int side = 0; side < 6; side++) {
        int k = side / 2, all = 1;
        for (int a = 0; a < f->n; a++) {
            int p = f->point[a], at[3] = {p % (n[0] + 1), p / (n[0] + 1) % (n[1] + 1), p / (n[0] + 1) / (n[1] + 1)};
            all = all && at[k] == (side % 2 ? n[k] : 0);
        }
        if (all) return side;
    }
    return -1;
}

static inline void sample_points(struct polymesh *m, bool flat, const int n[3], const double length[3], double noise) {
    m->npoints = (n[0] + 1) * (n[1] + 1) * (n[2] + 1);
    m->points = calloc(3 * (size_t)m->npoints, sizeof(double));
    for (int p = 0; p < m->npoints; p++) {
        int at[3] = {p % (n[0] + 1), p / (n[0] + 1) % (n[1] + 1), p / (n[0] + 1) / (n[1] + 1)};
        for (int k = 0; k < 3; k++) {
            double move =
                at[k] > 0 && at[k] < n[k] ? noise * sample_noise(flat ? p % ((n[0] + 1) * (n[1] + 1)) : p, k) : 0;
            m->points[3 * p + k] = length[k] / n[k] * (at[k] + move);
        }
    }
}

/* Joins equal faces of two cells; returns the patch of each face of the mesh. */
static inline int *sample_join(struct polymesh *m, struct sample_face *face, int nfaces, const int n[3]) {
    int *patch = calloc((size_t)nfaces, sizeof *patch);
    m->face_start = calloc((size_t)nfaces + 1, sizeof(int));
    m->face_points = calloc(4 * (size_t)nfaces, sizeof(int));
    m->owner = calloc((size_t)nfaces, sizeof(int));
    m->neighbour = calloc((size_t)nfaces, sizeof(int));
    qsort(face, (size_t)nfaces, sizeof *face, sample_by_key);
    for (int i = 0; i < nfaces; i++) {
        if (i > 0 && sample_by_key(&face[i - 1], &face[i]) == 0) {
            m->neighbour[m->nfaces - 1] = face[i].cell;
            continue;
        }
        int f = m->nfaces++;
        for (int a = 0; a < face[i].n; a++) m->face_points[m->face_start[f] + a] = face[i].point[a];
        m->face_start[f + 1] = m->face_start[f] + face[i].n;
        m->owner[f] = face[i].cell;
        m->neighbour[f] = -1;
        patch[f] = sample_patch(&face[i], n);
    }
    return patch;
}

/* Makes a mesh of n boxes along each axis (flat shapes: n[2] = 1), with points moved by up to `noise` boxes along each
 * axis. */
static inline status sample_make(struct sample *s, enum shape shape, const int n[3], const double length[3],
                                 double noise) {
    static const char *const names[6] = {"x0", "x1", "y0", "y1", "z0", "z1"};
    int boxes = n[0] * n[1] * n[2], nfaces = 0;
    struct polymesh *m = calloc(1, sizeof *m);
    struct sample_face *face = calloc((size_t)boxes * (shape == TETS ? 24 : 12), sizeof *face);
    *s = (struct sample){.shape = shape, .corner = calloc((size_t)boxes * 48, sizeof(int))};
    sample_points(m, sample_flat(shape), n, length, noise);
    for (int b = 0; b < boxes; b++) {
        int p[8], cell[6][8], at[3] = {b % n[0], b / n[0] % n[1], b / n[0] / n[1]};
        for (int c = 0; c < 8; c++)
            p[c] = at[0] + c % 2 + (n[0] + 1) * (at[1] + c / 2 % 2 + (n[1] + 1) * (at[2] + c / 4));
        int cells = sample_cells(shape, b, p, cell);
        for (int c = 0; c < cells; c++, m->ncells++) {
            memcpy(s->corner + 8 * m->ncells, cell[c], sizeof cell[c]);
            sample_add_faces(shape, cell[c], m->ncells, face, &nfaces);
        }
    }
    int *patch = sample_join(m, face, nfaces, n);
    m->patch = calloc(6, sizeof *m->patch);
    for (int i = 0; i < 6; i++)
        m->patch[m->npatches++] =
            (struct patch){.name = strdup(names[i]), .type = strdup(sample_flat(shape) && i > 3 ? "empty" : "patch")};
    status error = polymesh_order(m, patch);
    if (!error) error = polymesh_check(m);
    free(face);
    free(patch);
    s->mesh = m;
    return error;
}
static inline void sample_free(struct sample *s) {
    polymesh_free(s->mesh);
    free(s->corner);
}

#endif
