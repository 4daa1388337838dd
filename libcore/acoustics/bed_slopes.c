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
    int n, shape[SIDES], across[SIDES]; /* across: the neighbour; -1: a wall */
    double arm[SIDES][MAX_DIM];         /* m: from the cell's centre to that of the face */
    const double *pull;                 /* [n][dim] */
    const double *inverse;              /* [dim][dim] */
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

/* Finds the weights of the neighbours of a cell in its least squares: pull, the vector to a neighbour, or to the mirror
 * image at a wall, over its square, and the inverse of their matrix. Returns false if the cell has no slopes. */
static bool weigh_around(const struct bed *b, int i, double *pull, double *inverse) {
    double A[MAX_DIM][MAX_DIM] = {{0}}, out[MAX_DIM][MAX_DIM];
    const int first = b->set.face_start[i], n = b->set.face_start[i + 1] - first, dim = b->dim;
    if (n > SIDES) return false;
    for (int j = 0; j < n; j++) {
        const struct bed_side s = bed_side(b, first + j);
        double to[MAX_DIM], square = 0;
        if (b->set.kind[s.face] != BED_INNER && b->set.kind[s.face] != BED_WALL) return false;
        for (int k = 0; k < dim; k++) {
            to[k] = b->set.shapes->arm[s.right][k][s.shape] - b->set.shapes->arm[!s.right][k][s.shape];
            square += to[k] * to[k];
        }
        const double weight = 1 / square;
        for (int k = 0; k < dim; k++) {
            pull[j * dim + k] = weight * to[k];
            for (int l = 0; l < dim; l++) A[k][l] += pull[j * dim + k] * to[l];
        }
    }
    if (!invert(dim, A, out)) return false;
    for (int k = 0; k < dim; k++)
        for (int l = 0; l < dim; l++) inverse[k * dim + l] = out[k][l];
    return true;
}

/* Lists what is around a cell. */
ALWAYS_INLINE void look_around(const struct bed *b, int dim, int i, struct around *a) {
    const int first = b->set.face_start[i];
    a->n = b->set.face_start[i + 1] - first;
    a->pull = b->lines->pull + (long)first * dim;
    a->inverse = b->lines->inverse + (long)i * dim * dim;
    for (int j = 0; j < a->n; j++) {
        const struct bed_side s = bed_side(b, first + j);
        a->shape[j] = s.shape;
        a->across[j] = b->set.kind[s.face] == BED_INNER ? bed_across(b, &s) : -1;
        for (int k = 0; k < dim; k++) a->arm[j][k] = b->set.shapes->arm[s.right][k][s.shape];
    }
}

/* Returns variable v across side j of cell i. A wall mirrors the velocity; of other variables it gives the cell's
 * value.
 */
static double value_across(const struct bed *b, const struct around *a, int j, int i, double *const *of, int v) {
    if (a->across[j] >= 0) return of[v][a->across[j]];
    if (v < 1 || v > b->dim) return of[v][i];
    return of[v][i] - 2 * b->set.shapes->normal[v - 1][a->shape[j]] * bed_normal_speed(b, of + 1, i, a->shape[j]);
}

/* Returns the share at which a reach stays between least <= 0 and most >= 0, if it is below `share`, which is at most
 * 1; without a condition on the reach, which no processor foresees. NONE: a reach of 0 has no bound. */
#define NONE 0x1p-1000
ALWAYS_INLINE double bound(double reach, double least, double most, double share) {
    const double bounded = reach > 0 ? most : -least;
    return smaller((bounded + NONE) / (fabs(reach) + NONE), share);
}

ALWAYS_INLINE void slope_of_cell(struct bed *b, int dim, const struct around *a, double *const *of, int v, int i,
                                 double dt) {
    const double q = of[v][i];
    double most = 0, least = 0, sum[MAX_DIM] = {0}, slope[MAX_DIM], share = 1, drift = 0;
    for (int j = 0; j < a->n; j++) {
        const double change = value_across(b, a, j, i, of, v) - q;
        most = larger(most, change);
        least = smaller(least, change);
        for (int k = 0; k < dim; k++) sum[k] += a->pull[j * dim + k] * change;
    }
    for (int k = 0; k < dim; k++) {
        slope[k] = 0;
        for (int l = 0; l < dim; l++) slope[k] += a->inverse[k * dim + l] * sum[l];
    }
    for (int k = 0; k < dim && dt > 0; k++) drift += of[k + 1][i] * slope[k];
    drift *= -0.5 * dt;
    for (int j = 0; j < a->n; j++) {
        double reach = 0;
        for (int k = 0; k < dim; k++) reach += a->arm[j][k] * slope[k];
        share = bound(reach, least, most, share);
        if (dt > 0) share = bound(reach + drift, least, most, share);
    }
    for (int k = 0; k < dim; k++) b->lines->slope[k][v][i] = slope[k] * share;
}

ALWAYS_INLINE void slopes_of_cells(struct bed *b, int dim, double *const *of, int first, int end, double dt) {
    struct around a;
    for (int i = 0; i < b->set.cells; i++) {
        if (b->lines->sloped[i]) look_around(b, dim, i, &a);
        for (int v = first; v < end; v++)
            if (b->lines->sloped[i])
                slope_of_cell(b, dim, &a, of, v, i, dt);
            else
                for (int k = 0; k < dim; k++) b->lines->slope[k][v][i] = 0;
    }
}

/* The weights hold until the set changes. */
static void weigh_cells(struct bed *b) {
    struct bed_lines *x = b->lines;
    if (x->weighed) return;
    for (int i = 0; i < b->set.cells; i++)
        x->sloped[i] =
            weigh_around(b, i, x->pull + (long)b->set.face_start[i] * b->dim, x->inverse + (long)i * b->dim * b->dim);
    x->weighed = true;
}

void bed_slopes(struct bed *b, double *const *of, int first, int end, double dt) {
    if (b->set.shapes->boxes) {
        for (int k = 0; k < b->dim; k++)
            for (int i = 0; i < b->set.cells; i++)
                slopes_of_box(b, of, dt > 0 ? first : k + 1, dt > 0 ? end : k + 2, k, i);
        return;
    }
    weigh_cells(b);
    if (b->dim == 1) slopes_of_cells(b, 1, of, first, end, dt);
    if (b->dim == 2) slopes_of_cells(b, 2, of, first, end, dt);
    if (b->dim == 3) slopes_of_cells(b, 3, of, first, end, dt);
}
