/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bed of a body of revolution, for tests: x lies along the axis, y along the radius. */
#ifndef TESTS_ROUND_BED_H
#define TESTS_ROUND_BED_H

#include "tests/libcore/acoustics/friction_bed.h"

struct round_box {
    struct box box;
    struct bed_round round;
    double inner, *memory; /* m: radius of y = 0 */
};

static const double ON_AXIS = 1e-200; /* m: the radius that a face on the axis counts with */

/* Gives each face and each cell a shape of its own. */
static inline void part_shapes(struct box *x) {
    struct bed_shapes *s = &x->shapes;
    double area[2], normal[2][2], depth[2], arm[2][2][2];
    for (int a = 0; a < 2; a++) {
        area[a] = s->area[a];
        depth[a] = s->depth[0][a];
        for (int k = 0; k < 2; k++) {
            normal[k][a] = s->normal[k][a];
            for (int side = 0; side < 2; side++) arm[side][k][a] = s->arm[side][k][a];
        }
    }
    for (int f = 0; f < x->bed.set.faces; f++) {
        const int a = x->bed.set.shape[f];
        s->area[f] = area[a];
        for (int side = 0; side < 2; side++) s->depth[side][f] = depth[a];
        for (int k = 0; k < 2; k++) {
            s->normal[k][f] = normal[k][a];
            for (int side = 0; side < 2; side++) s->arm[side][k][f] = arm[side][k][a];
        }
        x->bed.set.shape[f] = f;
    }
    for (int i = 0; i < x->bed.set.cells; i++) {
        x->bed.set.body[i] = i;
        s->volume[i] = x->form.width * x->form.width;
    }
}

/* Weights a face by the radius: its middle is known from a cell with the centre c in the plane. */
static inline void turn_face(struct round_box *x, int f, const double middle[2]) {
    struct bed_shapes *s = &x->box.shapes;
    const double r = middle[1] + x->inner, n[2] = {s->normal[0][f], s->normal[1][f]}, L = s->area[f];
    const bool on_axis = r < 1e-9, triangles = x->box.form.triangles;
    const double per = on_axis || !triangles ? 0 : L * L / (12 * r);
    const int cell[2] = {x->box.bed.set.left[f], x->box.bed.set.right[f]};
    x->round.flat[f] = L;
    s->area[f] = L * (on_axis ? ON_AXIS : r);
    for (int side = 0; side < 2; side++) {
        const double *c = x->box.centre[cell[side] >= 0 ? cell[side] : cell[!side]];
        const double to[2] = {middle[0] - c[0], middle[1] - c[1]}, sign = side ? -1 : 1;
        const double across = to[0] * n[0] + to[1] * n[1];
        const double back = cell[side] < 0 ? 2 * across : 0; /* to the mirror image */
        s->depth[side][f] = sign * (across - back);
        for (int k = 0; k < 2; k++) {
            x->round.mid[side][k][f] = to[k] - back * n[k];
            s->arm[side][k][f] = x->round.mid[side][k][f] + (k == 1 ? n[0] * n[0] : -n[0] * n[1]) * per;
        }
    }
}

/* Turns a bed of walls into a body of revolution. */
static inline void turn(struct round_box *x, double inner) {
    struct box *b = &x->box;
    struct bed_set *set = &b->bed.set;
    const int faces = set->faces, cells = set->cells;
    double(*middle)[2] = calloc((size_t)faces, sizeof *middle);
    x->inner = inner;
    x->memory = calloc((size_t)(cells + 5 * faces), sizeof(double));
    assert_non_null(middle);
    assert_non_null(x->memory);
    x->round = (struct bed_round){.radial = 1, .radius = x->memory, .flat = x->memory + cells};
    for (int i = 0; i < 4; i++) x->round.mid[i / 2][i % 2] = x->memory + cells + (1 + i) * faces;
    if (!b->form.triangles) part_shapes(b);
    for (int f = 0; f < faces; f++) {
        const int right = set->left[f] < 0, i = right ? set->right[f] : set->left[f];
        for (int k = 0; k < 2; k++) middle[f][k] = b->centre[i][k] + b->shapes.arm[right][k][f];
    }
    for (int i = 0; i < cells; i++) {
        const double r = b->centre[i][1] + inner, c[2] = {b->centre[i][0], b->centre[i][1]};
        x->round.radius[i] = r;
        b->shapes.volume[i] *= r;
        for (int j = set->face_start[i]; j < set->face_start[i + 1] && b->form.triangles; j++) {
            const double *m = middle[bed_side(&b->bed, j).face];
            for (int k = 0; k < 2; k++) b->centre[i][k] += (m[k] - c[k]) * (m[1] - c[1]) / (3 * r);
        }
    }
    for (int f = 0; f < faces; f++) turn_face(x, f, middle[f]);
    b->shapes.round = &x->round;
    free(middle);
}

static inline void round_free(struct round_box *x) {
    box_free(&x->box);
    free(x->memory);
}

#endif
