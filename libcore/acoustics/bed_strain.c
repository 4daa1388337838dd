/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gradients of the velocity in the cells of a bed, for the strain on its faces (bed_friction.c; docs/physics.md 9.3):
 * by least squares over packed neighbours and walls, exact for linear velocities. */
#include "libcore/acoustics/bed_friction_private.h"

/* A cell's matrix of least squares gains a part of its trace, a, for cells with neighbours along one axis alone. Its
 * inverse B gains a B B, on other meshes than boxes also a a B B B, so that derivatives elsewhere are exact to
 * round-off. Boxes have neighbours along axes or none; those of other cells may nearly lie in a plane, where less would
 * be lost in round-off. */
static const double ALONE = 1e-9, FLAT = 1e-6;
static const double EVEN = 0.1; /* evenness from which on a gradient is trusted in full */

double bed_fit_weight(const struct bed *b, const struct bed_side *s, int across, double to[MAX_DIM]) {
    double *const *const mid[2] = {bed_middle(b, 0), bed_middle(b, 1)};
    double square = 0, weight = 1;
    const bool wall = b->set.kind[s->face] == BED_WALL, slips = wall && !bed_rubs_at(b, s->face);
    if (!wall && b->set.kind[s->face] != BED_INNER) return 0;
    if (!wall) weight = b->rub->share[across];
    for (int k = 0; k < b->dim; k++) {
        to[k] = mid[s->right][k][s->shape] - (wall && !slips ? 0 : mid[!s->right][k][s->shape]);
        square += to[k] * to[k];
    }
    return weight / square;
}

static void multiply(int dim, double A[MAX_DIM][MAX_DIM], double B[MAX_DIM][MAX_DIM], double out[MAX_DIM][MAX_DIM]) {
    for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++) {
            out[i][j] = 0;
            for (int k = 0; k < dim; k++) out[i][j] += A[i][k] * B[k][j];
        }
}

static void invert(int dim, bool boxes, double A[MAX_DIM][MAX_DIM], double out[MAX_DIM][MAX_DIM]) {
    double more = 0, B[MAX_DIM][MAX_DIM], square[MAX_DIM][MAX_DIM], cube[MAX_DIM][MAX_DIM] = {{0}};
    for (int k = 0; k < dim; k++) more += (boxes ? ALONE : FLAT) * A[k][k];
    for (int k = 0; k < 3; k++) A[k][k] = k < dim ? A[k][k] + more : 1;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int p = (i + 1) % 3, q = (i + 2) % 3, u = (j + 1) % 3, w = (j + 2) % 3;
            B[j][i] = A[p][u] * A[q][w] - A[p][w] * A[q][u];
        }
    const double determinant = A[0][0] * B[0][0] + A[0][1] * B[1][0] + A[0][2] * B[2][0];
    const double per = determinant > 0 ? 1 / determinant : 0;
    multiply(dim, B, B, square);
    if (!boxes) multiply(dim, square, B, cube);
    for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++)
            out[i][j] = per * (B[i][j] + more * per * (square[i][j] + more * per * cube[i][j]));
}

/* Returns how evenly neighbours stand around a cell, 0 .. 1: 0 if they lie on a line or in a plane. */
static double evenness(int dim, double B[MAX_DIM][MAX_DIM]) {
    if (dim < 2) return 1;
    const double trace = B[0][0] + B[1][1] + (dim > 2 ? B[2][2] : 0);
    if (dim == 2) return 4 * (B[0][0] * B[1][1] - B[0][1] * B[0][1]) / (trace * trace);
    return 27 / (trace * trace * trace) *
           (B[0][0] * (B[1][1] * B[2][2] - B[1][2] * B[1][2]) - B[0][1] * (B[0][1] * B[2][2] - B[1][2] * B[0][2]) +
            B[0][2] * (B[0][1] * B[1][2] - B[1][1] * B[0][2]));
}

/* Gradients of cells whose neighbours stand unevenly are taken for less: a fit to cells nearly on a line, or of which
 * one counts little, would amplify a small velocity beyond what the stages are stable for. */
static void trust(int dim, double B[MAX_DIM][MAX_DIM]) {
    const double part = smaller(1, larger(evenness(dim, B), 0) / EVEN);
    for (int i = 0; i < dim; i++)
        for (int j = 0; j < dim; j++) B[i][j] *= part;
}

void bed_fit_cell(const struct bed *b, int i) {
    const struct bed_friction *r = b->rub;
    double A[MAX_DIM][MAX_DIM] = {{0}}, inverse[MAX_DIM][MAX_DIM], to[MAX_DIM];
    const int first = b->set.face_start[i], last = b->set.face_start[i + 1];
    for (int j = first; j < last; j++) {
        const struct bed_side s = bed_side(b, j);
        const double w = bed_fit_weight(b, &s, bed_across(b, &s), to);
        for (int k = 0; k < b->dim && w > 0; k++)
            for (int l = 0; l < b->dim; l++) A[k][l] += w * to[k] * to[l];
    }
    invert(b->dim, b->set.shapes->boxes, A, inverse);
    if (!b->set.shapes->boxes) trust(b->dim, inverse);
    for (int k = 0, at = 0; k < b->dim && !b->set.shapes->boxes; k++)
        for (int l = k; l < b->dim; l++, at++) r->inverse[at][i] = inverse[k][l];
    for (int j = first; j < last; j++) {
        const struct bed_side s = bed_side(b, j);
        const double w = bed_fit_weight(b, &s, bed_across(b, &s), to);
        for (int k = 0; k < b->dim; k++) {
            double sum = 0;
            for (int l = 0; l < b->dim && w > 0; l++) sum += inverse[k][l] * w * to[l];
            r->fit[k][j] = sum;
        }
    }
}

/* Returns the difference of component m of V from cell i to what is across a side: a wall with friction,
 * which on other meshes than boxes counts along itself alone if it is not rough; the mirror image at others. */
ALWAYS_INLINE double change_across(const struct bed *b, const struct bed_side *s, int i, double *const *V, int m) {
    if (b->set.kind[s->face] == BED_INNER) return V[m][bed_across(b, s)] - V[m][i];
    if (bed_rubs_at(b, s->face)) {
        const double change = b->set.wall_speed[m][s->face] - V[m][i];
        if (b->set.shapes->boxes || bed_is_rough(b, s->face) || m >= b->dim) return change;
        return change -
               b->set.shapes->normal[m][s->shape] *
                   (bed_normal_speed(b, b->set.wall_speed, s->face, s->shape) - bed_normal_speed(b, V, i, s->shape));
    }
    if (m >= b->dim) return 0;
    return -2 * b->set.shapes->normal[m][s->shape] * bed_normal_speed(b, V, i, s->shape);
}

ALWAYS_INLINE void gradients_with(const struct bed *b, double *const *V, struct sizes n) {
    const struct bed_friction *r = b->rub;
    for (int i = 0; i < b->set.cells; i++) {
        double sum[MAX_DIM][MAX_DIM] = {{0}};
        const int last = r->share[i] > 0 ? b->set.face_start[i + 1] : b->set.face_start[i]; /* a face may read 0 */
        for (int j = b->set.face_start[i]; j < last; j++) {
            const struct bed_side s = bed_side(b, j);
            if (b->set.kind[s.face] > BED_WALL) continue;
            for (int m = 0; m < n.components; m++) {
                const double change = change_across(b, &s, i, V, m);
                for (int k = 0; k < n.dim; k++) sum[k][m] += r->fit[k][j] * change;
            }
        }
        for (int k = 0; k < n.dim; k++)
            for (int m = 0; m < n.components; m++) r->gradient[k][m][i] = sum[k][m];
    }
}

void bed_find_gradients(const struct bed *b, double *const *V) {
    bed_fill(b, b->components, V);
    WITH_SIZES(gradients_with, b, V)
    for (int k = 0; k < b->dim; k++) bed_fill(b, b->components, b->rub->gradient[k]);
    if (!b->set.shapes->boxes) bed_gauss_gradients(b, V);
}
