/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes boxes (boxes.h) from vertices and blocks: the lattice that their cells lie on, the box of each block, and which
 * blocks join. */
#include "mesh/format/boxes.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double TOLERANCE = 1e-6; /* of a cell: that of lattices in a polyMesh */

/* OpenFOAM's hexahedron: the corners of its sides, and the steps of each corner along its own axes. */
const int boxes_corner[6][4] = {{0, 4, 7, 3}, {1, 2, 6, 5}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 3, 2, 1}, {4, 5, 6, 7}};
static const int corner_step[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                      {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
static const int end_of_axis[3] = {1, 3, 4}; /* the corner one step from corner 0 along an own axis */

struct placing {
    const double *vertex; /* [][3] m */
    int nblocks;
    const struct boxes_block *block;
    struct boxes *out;
};

/* Finds the axes x, y, z along which the own axes of a block lie, and their lengths (m). */
static bool own_axes(const struct placing *p, int block, int axis[3], double length[3]) {
    const int *v = p->block[block].vertex;
    bool taken[3] = {false};
    for (int a = 0; a < 3; a++) {
        const double *from = p->vertex + 3L * v[0], *to = p->vertex + 3L * v[end_of_axis[a]];
        axis[a] = 0;
        for (int k = 1; k < 3; k++)
            if (fabs(to[k] - from[k]) > fabs(to[axis[a]] - from[axis[a]])) axis[a] = k;
        length[a] = fabs(to[axis[a]] - from[axis[a]]);
        if (taken[axis[a]] || !(length[a] > 0)) return false;
        taken[axis[a]] = true;
    }
    return true;
}

/* Chooses the lattice: its corners are those of all blocks, and its cells about as large as those of block 0. */
static status choose_lattice(const struct placing *p) {
    struct boxes *b = p->out;
    int axis[3];
    double length[3];
    if (!own_axes(p, 0, axis, length))
        return fail(ERR_INPUT, "block 0: its edges do not lie along x, y and z; blocks must be boxes along the axes");
    for (int a = 0; a < 3; a++) {
        const int k = axis[a];
        b->low[k] = INFINITY;
        b->high[k] = -INFINITY;
        for (int i = 0; i < 8 * p->nblocks; i++) {
            const double x = p->vertex[3L * p->block[i / 8].vertex[i % 8] + k];
            b->low[k] = fmin(b->low[k], x);
            b->high[k] = fmax(b->high[k], x);
        }
        const double cells = (b->high[k] - b->low[k]) / length[a] * p->block[0].n[a];
        if (!(cells < INT_MAX / 4))
            return fail(ERR_INPUT,
                        "block 0: with cells of %g m the mesh would be %g cells long along %c; %d are too many",
                        length[a] / p->block[0].n[a], cells, "xyz"[k], INT_MAX / 4);
        b->n[k] = (int)(cells + 0.5);
        b->width[k] = (b->high[k] - b->low[k]) / b->n[k];
    }
    return OK;
}

/* Finds the places of the corners of a block. */
static status find_corners(const struct placing *p, int block, int place[8][3]) {
    const struct boxes *b = p->out;
    for (int c = 0; c < 8; c++)
        for (int k = 0; k < 3; k++) {
            const int v = p->block[block].vertex[c];
            const double *x = p->vertex + 3L * v, i = (x[k] - b->low[k]) / b->width[k];
            place[c][k] = (int)floor(i + 0.5);
            if (fabs(i - place[c][k]) > TOLERANCE)
                return fail(
                    ERR_INPUT,
                    "block %d: vertex %d at (%.10g %.10g %.10g) lies %.2g of a cell beside the lattice along %c, "
                    "whose cells are %.10g m: all cells of all blocks must be equal boxes (expressions such as  "
                    "#eval{ 1.0/3 }  give all digits)",
                    block, v, x[0], x[1], x[2], fabs(i - place[c][k]), "xyz"[k], b -> width[k]);
        }
    return OK;
}

/* Fails unless the corners of a block are those of a box of as many cells as it says. */
static status check_corners(const struct placing *p, int block, int place[8][3], const int axis[3]) {
    const int *n = p->block[block].n;
    int sign = 1;
    for (int a = 0; a < 3; a++) {
        const int k = axis[a], cells = place[end_of_axis[a]][k] - place[0][k];
        if (abs(cells) != n[a])
            return fail(ERR_INPUT,
                        "block %d: %d cells along %c are %.10g m long, those of block 0 %.10g m; all cells must be "
                        "equal: give it %d cells there",
                        block, n[a], "xyz"[k], abs(cells) * p -> out -> width[k] / n[a], p -> out -> width[k],
                        abs(cells));
        if (cells < 0) sign = -sign;
    }
    for (int c = 0; c < 8; c++)
        for (int a = 0; a < 3; a++) {
            const int k = axis[a];
            if (place[c][k] != place[corner_step[c][a] ? end_of_axis[a] : 0][k])
                return fail(ERR_INPUT, "block %d: vertex %d is no corner of a box along the axes", block,
                            p->block[block].vertex[c]);
        }
    if ((axis[1] - axis[0] + 3) % 3 == 2) sign = -sign;
    if (sign > 0) return OK;
    return fail(
        ERR_INPUT,
        "block %d: it is inside out; the vertices of a hex go round its floor and then, in the same order, round "
        "its top, right-handed about the way from floor to top",
        block);
}

static status place_block(const struct placing *p, int block, long *cells) {
    struct brick *x = &p->out->box[block];
    int axis[3], place[8][3];
    double length[3];
    if (!own_axes(p, block, axis, length))
        return fail(ERR_INPUT, "block %d: its edges do not lie along x, y and z; blocks must be boxes along the axes",
                    block);
    TRY(find_corners(p, block, place));
    TRY(check_corners(p, block, place, axis));
    x->cell.start = *cells;
    double all = (double)*cells;
    for (int a = 0; a < 3; a++) {
        const int k = axis[a], from = place[0][k], to = place[end_of_axis[a]][k];
        x->low[k] = from < to ? from : to;
        x->n[k] = p->block[block].n[a];
        x->cell.axis[a] = k;
        x->cell.down[k] = to < from;
    }
    all += (double)x->n[0] * x->n[1] * x->n[2];
    if (all > INT_MAX)
        return fail(ERR_INPUT, "block %d: with it the mesh has %.0f cells; OpenFOAM's labels of 32 bits count %d",
                    block, all, INT_MAX);
    *cells = (long)all;
    return OK;
}

/* ---- neighbours ---- */

struct side_key { /* a side by its vertices, ascending */
    int vertex[4];
    struct brick_name name;
};

static int by_vertices(const void *a, const void *b) {
    return memcmp(((const struct side_key *)a)->vertex, ((const struct side_key *)b)->vertex,
                  sizeof((const struct side_key *)a)->vertex);
}

static int by_value(const void *a, const void *b) {
    return *(const int *)a - *(const int *)b;
}

/* Returns the side of a block along x, y, z that its own side is. */
static int side_of(const struct brick *x, int own) {
    const int k = x->cell.axis[own / 2];
    return 2 * k + ((own % 2 != 0) != x->cell.down[k]);
}

/* Joins the sides that have the same four vertices. */
static status join(const struct placing *p) {
    struct boxes *b = p->out;
    struct side_key *key;
    TRY(allocate(&key, 6L * p->nblocks, sizeof *key, "sides of blocks"));
    for (int i = 0; i < 6 * p->nblocks; i++) {
        for (int c = 0; c < 4; c++) key[i].vertex[c] = p->block[i / 6].vertex[boxes_corner[i % 6][c]];
        qsort(key[i].vertex, 4, sizeof(int), by_value);
        key[i].name = (struct brick_name){i / 6, side_of(&b->box[i / 6], i % 6)};
        b->box[i / 6].side[key[i].name.side] = (struct brick_side){.next = -1, .patch = -1};
    }
    qsort(key, 6 * (size_t)p->nblocks, sizeof *key, by_vertices);
    for (int i = 0; i + 1 < 6 * p->nblocks; i++) {
        if (by_vertices(&key[i], &key[i + 1])) continue;
        const struct brick_name one = key[i].name, other = key[i + 1].name;
        b->box[one.box].side[one.side].next = other.box;
        b->box[other.box].side[other.side].next = one.box;
    }
    free(key);
    return OK;
}

/* Fails if two blocks overlap, or touch where they are not joined: a wall without thickness would stand there. */
static status check_pair(const struct boxes *b, int i, int j) {
    const struct brick *x = &b->box[i], *y = &b->box[j];
    int inside = 0, touching = -1;
    for (int k = 0; k < 3; k++) {
        const int x_end = x->low[k] + x->n[k], y_end = y->low[k] + y->n[k];
        if (x->low[k] < y_end && y->low[k] < x_end)
            inside++;
        else if (x_end == y->low[k] || y_end == x->low[k])
            touching = 2 * k + (x_end == y->low[k]);
    }
    if (inside == 3) return fail(ERR_INPUT, "block %d: it overlaps block %d", j, i);
    if (inside < 2 || touching < 0 || x->side[touching].next == j) return OK;
    return fail(
        ERR_INPUT,
        "block %d: it touches block %d at %c = %.10g, but they do not share the four vertices of a side: a wall "
        "without thickness would stand there; cut the blocks so that whole sides meet, and name each vertex once",
        j, i, "xyz"[touching / 2],
        boxes_plane(b, touching / 2, x->low[touching / 2] + (touching % 2 ? x->n[touching / 2] : 0)));
}

static status place_all(const struct placing *p, int *culprit) {
    struct boxes *b = p->out;
    long cells = 0;
    TRY(allocate(&b->box, p->nblocks, sizeof *b->box, "blocks"));
    b->nboxes = p->nblocks;
    TRY(choose_lattice(p));
    for (*culprit = 0; *culprit < p->nblocks; ++*culprit) TRY(place_block(p, *culprit, &cells));
    TRY(join(p));
    for (*culprit = 1; *culprit < p->nblocks; ++*culprit)
        for (int i = 0; i < *culprit; i++) TRY(check_pair(b, i, *culprit));
    return OK;
}

status boxes_place(const double *vertex, int nblocks, const struct boxes_block *block, struct boxes **out,
                   int *culprit) {
    struct placing p = {vertex, nblocks, block, NULL};
    *out = NULL;
    *culprit = 0;
    TRY(allocate(&p.out, 1, sizeof *p.out, "blocks"));
    const status s = place_all(&p, culprit);
    if (s)
        boxes_free(p.out);
    else
        *out = p.out;
    return s;
}
