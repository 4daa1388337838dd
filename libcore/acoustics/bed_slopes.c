/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limited slopes in a bed: derivatives of the variables along the axes, by which values of a cell at its faces lie
 * between those of the cell and those around it, component by component. */
#include "libcore/acoustics/bed_private.h"

/* Determinant of the matrix of least squares, with offsets of length 1, below which a cell has no slopes. */
static const double FLAT = 1e-3;

/* ---- boxes: van Leer's monotonised central difference of each line of cells ---- */

/* Returns the limited difference over a cell, from the differences below and above it. */
static double limited(double below, double above) {
    const double least = 2 * smaller(fabs(below), fabs(above)), mean = 0.5 * (below + above);
    const double size = smaller(least, fabs(mean));
    return below * above > 0 ? (mean > 0 ? size : -size) : 0;
}

static void slopes_of_box(struct bed *b, double *const *of, int first, int end, int axis, int i) {
    const struct bed_side low = bed_side(b, b->set.face_start[i] + 2 * axis),
                          high = bed_side(b, b->set.face_start[i] + 2 * axis + 1);
    const int below = b->set.kind[low.face] == BED_INNER ? bed_across(b, &low) : i,
              above = b->set.kind[high.face] == BED_INNER ? bed_across(b, &high) : i;
    const double inverse = 0.5 / b->set.shapes->depth[0][low.shape];
    for (int v = first; v < end; v++) {
        const double *q = of[v];
        double under = q[i] - q[below], over = q[above] - q[i];
        if (v == axis + 1 && b->set.kind[low.face] == BED_WALL) under = 2 * q[i];
        if (v == axis + 1 && b->set.kind[high.face] == BED_WALL) over = -2 * q[i];
        b->lines->slope[axis][v][i] = inverse * limited(under, over);
    }
}

/* ---- other cells: least squares over the neighbours, limited as by Barth & Jespersen (AIAA 89-0366) ---- */

enum { SIDES = 64 }; /* of one cell; a cell with more has no slopes */
struct around {
    int n;
    struct bed_side side[SIDES];
    double to[SIDES]
             [MAX_DIM];   /* m: from the cell's centre to that of its neighbour, or of its mirror image at a wall */
    double weight[SIDES]; /* 1/m^2 */
    double inverse[MAX_DIM][MAX_DIM]; /* of sum_j weight to_a to_b */
};

/* Inverts the symmetric A; returns false if it is all but singular. */
static bool invert(int dim, double (*A)[MAX_DIM], double (*out)[MAX_DIM]) {
    if (dim == 1) out[0][0] = 1 / A[0][0];
    if (dim == 1) return A[0][0] > FLAT;
    if (dim == 2) A[2][2] = 1;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int p = (i + 1) % 3, q = (i + 2) % 3, r = (j + 1) % 3, s = (j + 2) % 3;
            out[j][i] = A[p][r] * A[q][s] - A[p][s] * A[q][r];
        }
    const double determinant = A[0][0] * out[0][0] + A[0][1] * out[1][0] + A[0][2] * out[2][0];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) out[i][j] /= determinant;
    return determinant > FLAT;
}

/* Lists what is around a cell. Returns false if the cell has no slopes. */
static bool look_around(const struct bed *b, int i, struct around *a) {
    double A[MAX_DIM][MAX_DIM] = {{0}};
    a->n = b->set.face_start[i + 1] - b->set.face_start[i];
    if (a->n > SIDES) return false;
    for (int j = 0; j < a->n; j++) {
        const struct bed_side s = a->side[j] = bed_side(b, b->set.face_start[i] + j);
        double square = 0;
        if (b->set.kind[s.face] != BED_INNER && b->set.kind[s.face] != BED_WALL) return false;
        for (int k = 0; k < b->dim; k++) {
            a->to[j][k] = b->set.shapes->arm[s.right][k][s.shape] - b->set.shapes->arm[!s.right][k][s.shape];
            square += a->to[j][k] * a->to[j][k];
        }
        a->weight[j] = 1 / square;
        for (int k = 0; k < b->dim; k++)
            for (int l = 0; l < b->dim; l++) A[k][l] += a->weight[j] * a->to[j][k] * a->to[j][l];
    }
    return invert(b->dim, A, a->inverse);
}

/* Returns variable v across side j of cell i. A wall mirrors the velocity; of other variables it gives the cell's
 * value.
 */
static double value_across(const struct bed *b, const struct around *a, int j, int i, double *const *of, int v) {
    const struct bed_side *s = &a->side[j];
    if (b->set.kind[s->face] == BED_INNER) return of[v][bed_across(b, s)];
    if (v < 1 || v > b->dim) return of[v][i];
    return of[v][i] - 2 * b->set.shapes->normal[v - 1][s->shape] * bed_normal_speed(b, of + 1, i, s->shape);
}

/* Lowers `share` until a reach stays between least and most. */
static void bound(double reach, double least, double most, double *share) {
    if (reach > most) *share = smaller(*share, most / reach);
    if (reach < least) *share = smaller(*share, least / reach);
}

static void slope_of_cell(struct bed *b, const struct around *a, double *const *of, int v, int i, double dt) {
    const double q = of[v][i];
    double most = 0, least = 0, sum[MAX_DIM] = {0}, share = 1;
    for (int j = 0; j < a->n; j++) {
        const double change = value_across(b, a, j, i, of, v) - q;
        most = larger(most, change);
        least = smaller(least, change);
        for (int k = 0; k < b->dim; k++) sum[k] += a->weight[j] * a->to[j][k] * change;
    }
    for (int k = 0; k < b->dim; k++) {
        double slope = 0;
        for (int l = 0; l < b->dim; l++) slope += a->inverse[k][l] * sum[l];
        b->lines->slope[k][v][i] = slope;
    }
    for (int j = 0; j < a->n; j++) {
        const double reach = bed_reach(b, &a->side[j], i, v);
        bound(reach, least, most, &share);
        if (dt > 0) bound(reach + bed_drift(b, of + 1, dt, i, v), least, most, &share);
    }
    for (int k = 0; k < b->dim; k++) b->lines->slope[k][v][i] *= share;
}

void bed_slopes(struct bed *b, double *const *of, int first, int end, double dt) {
    struct around a;
    if (b->set.shapes->boxes) {
        for (int k = 0; k < b->dim; k++)
            for (int i = 0; i < b->set.cells; i++)
                slopes_of_box(b, of, dt > 0 ? first : k + 1, dt > 0 ? end : k + 2, k, i);
        return;
    }
    for (int i = 0; i < b->set.cells; i++) {
        const bool sloped = look_around(b, i, &a);
        for (int v = first; v < end; v++) {
            for (int k = 0; k < b->dim; k++) b->lines->slope[k][v][i] = 0;
            if (sloped) slope_of_cell(b, &a, of, v, i, dt);
        }
    }
}
