/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes points, faces, owner and neighbour of a mesh of boxes (boxes.h), for what reads them. */
#include "mesh/format/boxes.h"
#include "mesh/format/polymesh.h"

#include <limits.h>
#include <stdlib.h>

struct filling {
    struct polymesh *m;
    const struct boxes *b;
    int *point; /* [n0+1][n1+1][n2+1], x fastest: the point there, counted from 1; 0: none */
    int face;   /* the next one */
};

static int *point_at(const struct filling *f, const int at[3]) {
    const int *n = f->b->n;
    return &f->point[at[0] + (n[0] + 1L) * (at[1] + (n[1] + 1L) * at[2])];
}

/* Numbers the points as blockMesh does, block by block and along the block's own axes, and counts them. */
static long number_points(struct filling *f) {
    long points = 0;
    for (int b = 0; b < f->b->nboxes; b++) {
        const struct brick *x = &f->b->box[b];
        const int *axis = x->cell.axis;
        for (int i[3] = {0}; i[2] <= x->n[axis[2]]; i[2]++)
            for (i[1] = 0; i[1] <= x->n[axis[1]]; i[1]++)
                for (i[0] = 0; i[0] <= x->n[axis[0]]; i[0]++) {
                    int here[3];
                    for (int a = 0; a < 3; a++) {
                        const int k = axis[a];
                        here[k] = x->low[k] + (x->cell.down[k] ? x->n[k] - i[a] : i[a]);
                    }
                    int *point = point_at(f, here);
                    if (!*point) *point = (int)++points;
                }
    }
    return points;
}

static void place_points(const struct filling *f) {
    const int *n = f->b->n;
    for (int at[3] = {0}; at[2] <= n[2]; at[2]++)
        for (at[1] = 0; at[1] <= n[1]; at[1]++)
            for (at[0] = 0; at[0] <= n[0]; at[0]++) {
                const long point = *point_at(f, at) - 1L;
                for (int k = 0; k < 3 && point >= 0; k++) f->m->points[3 * point + k] = boxes_plane(f->b, k, at[k]);
            }
}

/* Sets the points of a face in the order of boxes_corners. */
static void set_face(const struct filling *f, long face, const int at[3], int side) {
    const int k = side / 2, p = (k + 1) % 3, q = (k + 2) % 3;
    f->m->face_start[face] = (int)(4 * face);
    for (int j = 0; j < 4; j++) {
        const int turn = side % 2 ? j : (4 - j) % 4;
        int here[3] = {at[0], at[1], at[2]};
        here[k] += side % 2;
        here[p] += turn == 1 || turn == 2;
        here[q] += turn >= 2;
        f->m->face_points[4 * face + j] = *point_at(f, here) - 1;
    }
}

/* Appends the faces between a cell and those of higher numbers, in the order of these. */
static void append_faces(struct filling *f, int cell) {
    int at[3], side[6], n = 0;
    long next[6];
    boxes_at(f->b, cell, at);
    for (int i = 0; i < 6; i++) {
        int there[3] = {at[0], at[1], at[2]};
        there[i / 2] += i % 2 ? 1 : -1;
        const long other = boxes_cell(f->b, there);
        if (other < cell) continue;
        int j = n++;
        for (; j > 0 && next[j - 1] > other; j--) {
            next[j] = next[j - 1];
            side[j] = side[j - 1];
        }
        next[j] = other;
        side[j] = i;
    }
    for (int i = 0; i < n; i++, f->face++) {
        f->m->owner[f->face] = cell;
        f->m->neighbour[f->face] = (int)next[i];
        set_face(f, f->face, at, side[i]);
    }
}

static status fill(struct filling *f) {
    struct polymesh *m = f->m;
    const int *n = f->b->n;
    TRY(allocate(&f->point, (n[0] + 1L) * (n[1] + 1L) * (n[2] + 1L), sizeof *f->point, "points"));
    const long points = number_points(f);
    TRY(allocate(&m->points, 3 * points, sizeof *m->points, "points"));
    TRY(allocate(&m->face_start, m->nfaces + 1L, sizeof *m->face_start, "faces"));
    TRY(allocate(&m->face_points, 4L * m->nfaces, sizeof *m->face_points, "faces"));
    TRY(allocate(&m->owner, m->nfaces, sizeof *m->owner, "faces"));
    TRY(allocate(&m->neighbour, m->ninternal, sizeof *m->neighbour, "faces"));
    m->npoints = (int)points;
    place_points(f);
    for (int c = 0; c < m->ncells; c++) append_faces(f, c);
    m->face_start[m->nfaces] = 4 * m->nfaces;
    for (int p = 0; p < m->npatches; p++)
        for (int i = 0; i < m->patch[p].nfaces; i++) {
            int at[3], side;
            boxes_face_at(f->b, p, i, at, &side);
            m->owner[m->patch[p].start + i] = (int)boxes_cell(f->b, at);
            set_face(f, m->patch[p].start + (long)i, at, side);
        }
    return OK;
}

status boxes_complete(struct polymesh *m) {
    struct filling f = {.m = m, .b = m->boxes};
    if (f.b->nfaces > INT_MAX / 4)
        return fail(
            ERR_INPUT,
            "the mesh has %ld faces; what needs all of them counts %d at most (OpenFOAM's labels are of 32 bits): "
            "leave it out",
            f.b->nfaces, INT_MAX / 4);
    const status s = fill(&f);
    free(f.point);
    return s;
}
