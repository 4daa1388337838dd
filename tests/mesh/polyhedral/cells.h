/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Perturbed meshes of lines, quads, triangles, hexahedra, prisms, tetrahedra or pyramids in a box, or of hexahedra,
 * prisms and pyramids side by side (MIXED): for the tests of the polyhedra. */
#ifndef TESTS_CELLS_H
#define TESTS_CELLS_H

#include "mesh/format/polymesh.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/checks.h" /* last */

enum cell_shape { BOXES, PRISMS, TETS, PYRAMIDS, MIXED };
struct cells_recipe {
    const char *name;
    int dim;
    enum cell_shape shape;
    int n[3];       /* boxes along the recipe's axes; the first dim are solved */
    int axis[3];    /* physical axis of each */
    double noise;   /* of inner points, in boxes */
    bool cyclic[3]; /* recipe's axes */
};

struct soup { /* faces of cells, each inner one twice */
    const struct cells_recipe *r;
    struct polymesh *m;
    int n;
    struct soup_face {
        int key[4], point[4], n, cell;
    } * face;
};

static inline int soup_point(const struct cells_recipe *r, const int at[3]) {
    return at[0] + (r->n[0] + 1) * (at[1] + (r->n[1] + 1) * at[2]);
}

static inline void soup_place(const struct cells_recipe *r, const int at[3], double *x) {
    unsigned solved = 0;
    bool inner = true;
    for (int k = 0; k < r->dim; k++) {
        solved = 1000 * solved + (unsigned)at[k] + 1;
        inner = inner && at[k] > 0 && at[k] < r->n[k];
    }
    for (int k = 0; k < 3; k++) {
        double shake = sin(12.9898 * (solved % 7919) + 78.233 * (k + 1) + 0.1 * solved) * 43758.5453;
        shake = 2 * (shake - floor(shake)) - 1;
        x[r->axis[k]] = 0.1 * (k + 1) * (at[k] + (inner && k < r->dim ? r->noise * shake : 0));
    }
}

static inline void soup_add(struct soup *s, int cell, int n, const int *point) {
    struct soup_face *f = &s->face[s->n++];
    *f = (struct soup_face){.key = {-1, -1, -1, -1}, .n = n, .cell = cell};
    for (int i = 0; i < n; i++) {
        int j = i;
        f->point[i] = point[i];
        for (; j > 0 && f->key[j - 1] > point[i]; j--) f->key[j] = f->key[j - 1];
        f->key[j] = point[i];
    }
}

static inline int soup_order(const void *a, const void *b) {
    return memcmp(((const struct soup_face *)a)->key, ((const struct soup_face *)b)->key, sizeof(int[4]));
}

/* Six pyramids whose apex is a new point, the mean of the corners. */
static inline void soup_pyramids(struct soup *s, const int corner[8], const int sides[6][4]) {
    struct polymesh *m = s->m;
    int apex = m->npoints++;
    for (int i = 0; i < 24; i++) m->points[3 * apex + i % 3] += m->points[3 * corner[i / 3] + i % 3] / 8;
    for (int f = 0; f < 6; f++, m->ncells++) {
        int p[4];
        for (int i = 0; i < 4; i++) p[i] = corner[sides[f][i]];
        soup_add(s, m->ncells, 4, p);
        for (int i = 0; i < 4; i++) soup_add(s, m->ncells, 3, (int[]){p[i], p[(i + 1) % 4], apex});
    }
}

/* Mixed meshes have columns of prisms along the third axis, and elsewhere hexahedra and pyramids in turn. */
static inline enum cell_shape soup_shape(const struct cells_recipe *r, const int at[3]) {
    if (r->shape != MIXED) return r->shape;
    return (at[0] + 2 * at[1]) % 3 == 0 ? PRISMS : (at[0] + at[1] + at[2]) % 2 ? BOXES : PYRAMIDS;
}

/* The box at `at` as one box, two prisms along its third axis, six tetrahedra about its diagonal, or six pyramids. */
static inline void soup_box(struct soup *s, const int at[3]) {
    static const int sides[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
    static const int prisms[2][5][4] = {{{0, 1, 3, -1}, {4, 7, 5, -1}, {0, 4, 5, 1}, {1, 5, 7, 3}, {3, 7, 4, 0}},
                                        {{0, 3, 2, -1}, {4, 6, 7, -1}, {0, 3, 7, 4}, {3, 2, 6, 7}, {2, 0, 4, 6}}};
    static const int paths[6][2] = {{1, 3}, {1, 5}, {2, 3}, {2, 6}, {4, 5}, {4, 6}};
    const enum cell_shape shape = soup_shape(s->r, at);
    int corner[8], p[4];
    for (int c = 0; c < 8; c++)
        corner[c] = soup_point(s->r, (int[3]){at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2)});
    for (int f = 0; shape == BOXES && f < 6; f++) {
        for (int i = 0; i < 4; i++) p[i] = corner[sides[f][i]];
        soup_add(s, s->m->ncells, 4, p);
    }
    s->m->ncells += shape == BOXES;
    if (shape == PYRAMIDS) soup_pyramids(s, corner, sides);
    for (int half = 0; shape == PRISMS && half < 2; half++, s->m->ncells++)
        for (int f = 0; f < 5; f++) {
            for (int i = 0; i < 4; i++) p[i] = prisms[half][f][i] < 0 ? -1 : corner[prisms[half][f][i]];
            soup_add(s, s->m->ncells, p[3] < 0 ? 3 : 4, p);
        }
    for (int t = 0; shape == TETS && t < 6; t++, s->m->ncells++) {
        const int v[4] = {corner[0], corner[paths[t][0]], corner[paths[t][1]], corner[7]};
        for (int f = 0; f < 4; f++) soup_add(s, s->m->ncells, 3, (int[]){v[f], v[(f + 1) % 4], v[(f + 2) % 4]});
    }
}

static inline int soup_patch(const struct soup *s, const struct soup_face *f) {
    for (int k = 0; k < 3; k++)
        for (int side = 0; side < 2; side++) {
            bool all = true;
            double wall = side ? 0.1 * (k + 1) * s->r->n[k] : 0;
            for (int i = 0; i < f->n; i++)
                all = all && fabs(s->m->points[3 * f->point[i] + s->r->axis[k]] - wall) < 1e-9;
            if (all) return 2 * k + side;
        }
    return -1;
}

static inline void soup_patches(struct soup *s) {
    static const char *const names[6] = {"a0", "a1", "b0", "b1", "c0", "c1"};
    s->m->npatches = 6;
    s->m->patch = calloc(6, sizeof *s->m->patch);
    for (int i = 0; i < 6; i++) {
        bool cyclic = s->r->cyclic[i / 2];
        s->m->patch[i].name = strdup(names[i]);
        s->m->patch[i].type = strdup(i / 2 >= s->r->dim ? "empty" : cyclic ? "cyclic" : "wall");
        s->m->patch[i].neighbour = cyclic ? strdup(names[i ^ 1]) : NULL;
    }
}

static inline void soup_join(struct soup *s, int *patch) {
    struct polymesh *m = s->m;
    qsort(s->face, (size_t)s->n, sizeof *s->face, soup_order);
    for (int i = 0; i < s->n; i++) {
        int f = m->nfaces++;
        const struct soup_face *face = &s->face[i];
        m->face_start[f + 1] = m->face_start[f] + face->n;
        memcpy(m->face_points + m->face_start[f], face->point, (size_t)face->n * sizeof(int));
        m->owner[f] = face->cell;
        m->neighbour[f] = -1;
        if (i + 1 < s->n && soup_order(face, face + 1) == 0)
            m->neighbour[f] = s->face[++i].cell;
        else
            patch[f] = soup_patch(s, face);
    }
}

static inline struct polymesh *cells_make(const struct cells_recipe *r) {
    size_t boxes = (size_t)r->n[0] * (size_t)r->n[1] * (size_t)r->n[2], most = boxes * 30;
    struct soup s = {.r = r, .m = calloc(1, sizeof *s.m), .face = calloc(most, sizeof *s.face)};
    struct polymesh *m = s.m;
    m->npoints = (r->n[0] + 1) * (r->n[1] + 1) * (r->n[2] + 1);
    m->points = calloc(((size_t)m->npoints + boxes) * 3, sizeof *m->points);
    m->face_start = calloc(most + 1, sizeof *m->face_start);
    m->face_points = calloc(most * 4, sizeof *m->face_points);
    m->owner = calloc(most, sizeof *m->owner);
    m->neighbour = calloc(most, sizeof *m->neighbour);
    int *patch = calloc(most, sizeof *patch), at[3];
    for (at[2] = 0; at[2] <= r->n[2]; at[2]++)
        for (at[1] = 0; at[1] <= r->n[1]; at[1]++)
            for (at[0] = 0; at[0] <= r->n[0]; at[0]++) soup_place(r, at, m->points + 3 * soup_point(r, at));
    for (at[2] = 0; at[2] < r->n[2]; at[2]++)
        for (at[1] = 0; at[1] < r->n[1]; at[1]++)
            for (at[0] = 0; at[0] < r->n[0]; at[0]++) soup_box(&s, at);
    soup_join(&s, patch);
    soup_patches(&s);
    status fault = polymesh_order(m, patch);
    if (!fault) fault = polymesh_check(m);
    free(patch);
    free(s.face);
    if (fault) fail_msg("%s: %s", r->name, status_text(fault));
    return m;
}

#endif
