/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers and places of the cells and faces of a mesh of boxes (boxes.h), by arithmetic. */
#include "mesh/format/boxes.h"

#include <stdlib.h>

void boxes_free(struct boxes *b) {
    if (!b) return;
    free(b->box);
    free(b->side);
    free(b->first);
    free(b);
}

/* Returns the number of item i of n. */
static long number_of(const struct brick_numbers *m, const int n[3], const int i[3]) {
    long number = 0;
    for (int a = 2; a >= 0; a--) {
        const int k = m->axis[a];
        number = number * n[k] + (m->down[k] ? n[k] - 1 - i[k] : i[k]);
    }
    return m->start + number;
}

static void place_of(const struct brick_numbers *m, const int n[3], long number, int i[3]) {
    number -= m->start;
    for (int a = 0; a < 3; a++) {
        const int k = m->axis[a], rest = (int)(number % n[k]);
        i[k] = m->down[k] ? n[k] - 1 - rest : rest;
        number /= n[k];
    }
}

int boxes_find(const struct boxes *b, const int at[3]) {
    for (int i = 0; i < b->nboxes; i++) {
        const struct brick *x = &b->box[i];
        bool inside = true;
        for (int k = 0; k < 3; k++) inside &= at[k] >= x->low[k] && at[k] < x->low[k] + x->n[k];
        if (inside) return i;
    }
    return -1;
}

static long cell_of(const struct brick *x, const int at[3]) {
    const int i[3] = {at[0] - x->low[0], at[1] - x->low[1], at[2] - x->low[2]};
    return number_of(&x->cell, x->n, i);
}

long boxes_cell(const struct boxes *b, const int at[3]) {
    const int i = boxes_find(b, at);
    return i < 0 ? -1 : cell_of(&b->box[i], at);
}

void boxes_at(const struct boxes *b, long cell, int at[3]) {
    int low = 0, high = b->nboxes;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (b->box[middle].cell.start <= cell)
            low = middle;
        else
            high = middle;
    }
    const struct brick *x = &b->box[low];
    place_of(&x->cell, x->n, cell, at);
    for (int k = 0; k < 3; k++) at[k] += x->low[k];
}

void boxes_centre(const struct boxes *b, long cell, double x[3]) {
    int at[3];
    boxes_at(b, cell, at);
    for (int k = 0; k < 3; k++) x[k] = b->low[k] + b->width[k] * (at[k] + 0.5);
}

/* Sets the cells along the axes of a side. */
static void side_extent(const struct brick *x, int side, int n[3]) {
    for (int k = 0; k < 3; k++) n[k] = k == side / 2 ? 1 : x->n[k];
}

int boxes_patch(const struct boxes *b, const int at[3], int side, long *face) {
    const struct brick *x = &b->box[boxes_find(b, at)];
    const struct brick_side *s = &x->side[side];
    const int k = side / 2;
    int n[3], i[3] = {at[0] - x->low[0], at[1] - x->low[1], at[2] - x->low[2]};
    *face = -1;
    if (i[k] != (side % 2 ? x->n[k] - 1 : 0) || s->patch < 0) return -1;
    side_extent(x, side, n);
    i[k] = 0;
    *face = number_of(&s->face, n, i);
    return s->patch;
}

void boxes_face_at(const struct boxes *b, int patch, long i, int at[3], int *side) {
    int low = b->first[patch], high = b->first[patch + 1], n[3];
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        const struct brick_name *name = &b->side[middle];
        if (b->box[name->box].side[name->side].face.start <= i)
            low = middle;
        else
            high = middle;
    }
    const struct brick *x = &b->box[b->side[low].box];
    *side = b->side[low].side;
    side_extent(x, *side, n);
    place_of(&x->side[*side].face, n, i, at);
    at[*side / 2] = *side % 2 ? x->n[*side / 2] - 1 : 0;
    for (int k = 0; k < 3; k++) at[k] += x->low[k];
}

double boxes_plane(const struct boxes *b, int axis, int i) {
    return i == b->n[axis] ? b->high[axis] : b->low[axis] + b->width[axis] * i;
}

void boxes_corners(const struct boxes *b, const int at[3], int side, double corner[4][3]) {
    const int k = side / 2, p = (k + 1) % 3, q = (k + 2) % 3; /* p, q, k: right-handed */
    for (int j = 0; j < 4; j++) {
        const int turn = side % 2 ? j : (4 - j) % 4; /* the first corner is the lowest, so that cyclic halves match */
        corner[j][k] = boxes_plane(b, k, at[k] + side % 2);
        corner[j][p] = boxes_plane(b, p, at[p] + (turn == 1 || turn == 2));
        corner[j][q] = boxes_plane(b, q, at[q] + (turn >= 2));
    }
}
