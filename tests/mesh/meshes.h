/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Meshes of boxes built face by face, in an order that polymesh_order has to sort: for the tests of mesh/. */
#ifndef TESTS_MESHES_H
#define TESTS_MESHES_H

#include "mesh/format/polymesh.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/checks.h" /* last */

struct recipe {
    int n[3];
    double origin[3], width[3];
    bool (*hole)(int i, int j, int k);
    const char *type[6]; /* of x0 x1 y0 y1 z0 z1; NULL: patch. A cyclic side's other half is the opposite side */
    double noise;        /* of coordinates, in cells */
    int crack[2];        /* lattice places of two cells along x with a wall between them, if not equal */
};

static inline bool has_cell(const struct recipe *r, int i, int j, int k) {
    return i >= 0 && j >= 0 && k >= 0 && i < r->n[0] && j < r->n[1] && k < r->n[2] && !(r->hole && r->hole(i, j, k));
}

static inline void add_box_face(struct polymesh *m, const int *cell, const struct recipe *r, const int at[3], int side,
                                int *patch) {
    static const int around[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const int *n = r->n;
    int axis = side / 2, f = m->nfaces++, to[3] = {at[0], at[1], at[2]};
    to[axis] += side % 2 ? 1 : -1;
    for (int c = 0; c < 4; c++) {
        int p[3] = {at[0], at[1], at[2]};
        p[axis] += side % 2;
        p[(axis + 1) % 3] += around[c][0];
        p[(axis + 2) % 3] += around[c][1];
        m->face_points[4 * f + c] = p[0] + (n[0] + 1) * (p[1] + (n[1] + 1) * p[2]);
    }
    m->face_start[f + 1] = 4 * (f + 1);
    m->owner[f] = cell[at[0] + n[0] * (at[1] + n[1] * at[2])];
    int other = has_cell(r, to[0], to[1], to[2]) ? cell[to[0] + n[0] * (to[1] + n[1] * to[2])] : -1;
    bool cracked =
        r->crack[0] != r->crack[1] && axis == 0 && at[1] == 0 && at[2] == 0 && at[0] + side % 2 == r->crack[1];
    m->neighbour[f] = cracked ? -1 : other;
    patch[f] = to[axis] < 0 || to[axis] >= n[axis] ? side : 6;
}

/* Patches x0 x1 y0 y1 z0 z1 and `inner` (wall), faces from the last cell to the first. */
static inline status mesh_make(const struct recipe *r, struct polymesh **out) {
    static const char *const names[7] = {"x0", "x1", "y0", "y1", "z0", "z1", "inner"};
    const int *n = r->n;
    long places = (long)n[0] * n[1] * n[2], np = (n[0] + 1L) * (n[1] + 1L) * (n[2] + 1L);
    struct polymesh *m = calloc(1, sizeof *m);
    int *cell = calloc((size_t)places, sizeof *cell), *patch = calloc((size_t)places * 6, sizeof *patch);
    m->npoints = (int)np;
    m->points = calloc((size_t)np * 3, sizeof *m->points);
    m->face_start = calloc((size_t)places * 6 + 1, sizeof *m->face_start);
    m->face_points = calloc((size_t)places * 24, sizeof *m->face_points);
    m->owner = calloc((size_t)places * 6, sizeof *m->owner);
    m->neighbour = calloc((size_t)places * 6, sizeof *m->neighbour);
    for (long p = 0; p < np; p++) {
        long at[3] = {p % (n[0] + 1), p / (n[0] + 1) % (n[1] + 1), p / (n[0] + 1) / (n[1] + 1)};
        for (int k = 0; k < 3; k++)
            m->points[3 * p + k] =
                r->origin[k] + r->width[k] * ((double)at[k] + r->noise * (double)((7 * p + 3 * k) % 11 - 5) / 5);
    }
    int at[3];
    for (long c = 0; c < places; c++)
        if (has_cell(r, (int)(c % n[0]), (int)(c / n[0] % n[1]), (int)(c / n[0] / n[1]))) cell[c] = m->ncells++;
    for (long c = places - 1; c >= 0; c--) {
        at[0] = (int)(c % n[0]), at[1] = (int)(c / n[0] % n[1]), at[2] = (int)(c / n[0] / n[1]);
        for (int side = 5; side >= 0 && has_cell(r, at[0], at[1], at[2]); side--) {
            add_box_face(m, cell, r, at, side, patch);
            if (side % 2 == 0 && m->neighbour[m->nfaces - 1] >= 0) m->nfaces--; /* made from the other side */
        }
    }
    m->patch = calloc(7, sizeof *m->patch);
    for (int i = 0; i < 7; i++) {
        const char *type = i < 6 ? r->type[i] ? r->type[i] : "patch" : "wall";
        m->patch[m->npatches++] = (struct patch){
            strdup(names[i]), strdup(type), strcmp(type, "cyclic") ? NULL : strdup(names[i ^ 1]), 0, 0, NULL, NULL};
    }
    status s = polymesh_order(m, patch);
    free(cell);
    free(patch);
    if (s)
        polymesh_free(m);
    else
        *out = m;
    return s;
}

static inline bool step_hole(int i, int j, int k) {
    (void)k;
    return i >= 3 && j < 2;
}

#endif
