/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gradients of cells. Gauss's theorem with the mean of both cells on a face, G_0 = 1/V sum A n (q_j - q_i)/2, is the
 * transpose of the sum over faces by which a cell gains from the mean of both cells' fluxes. So in a flux that holds
 * gradients the operator of diffusion is symmetric, its modes decay without turning, and no number of stages makes them
 * grow. But G_0 finds the gradient c of a linear field only where the line of centres passes the middle of each face;
 * else it finds C c with a matrix C of the cell. The gradient is C^-1 G_0: exact for linear fields, and nearly
 * symmetric where meshes are nearly regular. (Least squares, also exact, are not symmetric on regular triangles
 * either.) */
#include "libcore/polyhedral/cells_gradient.h"

#include <stdlib.h>

/* Two cells are alike from the ratio ALIKE of their T, or rho, on, and not at all below UNLIKE. */
static const double UNLIKE = 0.0625, ALIKE = 0.25;
static const double TWISTED = 0.2; /* determinant of C below which least squares are taken */

/* The member of cell i's stencil across entry j of its list of faces. */
static int member_across(const struct polyhedra *m, int i, int j, double out[MAX_DIM]) {
    const bool right = m->face_of_cell[j] < 0;
    const int face = right ? ~m->face_of_cell[j] : m->face_of_cell[j];
    const int cell = right ? m->face.left[face] : m->face.right[face], p = m->face.point_start[face];
    int found = -1;
    double least = HUGE_VAL;
    for (int at = m->stencil_start[i]; at < m->stencil_start[i + 1] && m->ring[at] == 1; at++) {
        double square = 0;
        if (m->stencil[at] != cell) continue;
        for (int k = 0; k < m->dim; k++) { /* in a short periodic domain a cell may be a member twice */
            const double e = m->point.arm[0][k][p] - m->point.arm[1][k][p];
            const double off = m->offset[k][at] - (right ? -e : e);
            square += off * off;
        }
        if (square < least) found = at - m->stencil_start[i];
        least = smaller(least, square);
    }
    for (int k = 0; k < m->dim; k++)
        out[k] = (right ? -0.5 : 0.5) * m->face.area[face] * m->face.normal[k][face] / m->volume[i];
    return found;
}

/* W <- C^-1 W by Gauss-Jordan elimination. Returns false, with W spoilt, if C is too far from 1. */
static bool divide(int dim, int n, double (*C)[MAX_DIM], double *W) {
    double determinant = 1;
    for (int k = 0; k < dim; k++) {
        const double pivot = C[k][k];
        determinant *= pivot;
        if (!(pivot > 0)) return false;
        for (int a = 0; a < dim; a++) C[k][a] /= pivot;
        for (int j = 0; j < n; j++) W[k * n + j] /= pivot;
        for (int row = 0; row < dim; row++) {
            const double factor = C[row][k];
            if (row == k) continue;
            for (int a = 0; a < dim; a++) C[row][a] -= factor * C[k][a];
            for (int j = 0; j < n; j++) W[row * n + j] -= factor * W[k * n + j];
        }
    }
    return determinant > TWISTED;
}

/* The weights W[k][n] of the n first members of own cell i. Returns false where least squares must be taken. */
static bool gauss_weights(const struct polyhedra *m, int i, int n, double *W) {
    double C[MAX_DIM][MAX_DIM] = {{0}};
    memset(W, 0, (size_t)(m->dim * n) * sizeof *W);
    for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
        double w[MAX_DIM];
        const int member = member_across(m, i, j, w);
        if (member < 0 || member >= n) return false;
        for (int k = 0; k < m->dim; k++) {
            W[k * n + member] += w[k];
            for (int a = 0; a < m->dim; a++) C[k][a] += w[k] * m->offset[a][m->stencil_start[i] + member];
        }
    }
    return divide(m->dim, n, C, W);
}

static double *place_of(const struct entries *r, int cell, int entry, int k) {
    return r->data + ((r->start[cell / LANES] + (long)entry) * r->width + k) * LANES + cell % LANES;
}

static int entries_of(const struct entries *r, int cell) {
    return r->start[cell / LANES + 1] - r->start[cell / LANES];
}

/* Takes the weights of near ghosts, whose faces this rank does not know, from their own ranks, entry by entry. */
static status fill_weights(const struct gas *g, struct entries *r) {
    struct polyhedra *m = g->cells->polyhedra;
    double *line[MAX_DIM] = {NULL}, most = 0;
    status s = OK;
    for (int b = 0; b < g->cells->fit->nbatches; b++) most = larger(most, r->start[b + 1] - r->start[b]);
    comm_max(g->comm, &most, 1);
    for (int k = 0; k < m->dim && !s; k++) s = allocate(&line[k], m->size, sizeof(double), "gradients");
    s = comm_agree(g->comm, s);
    for (int j = 0; j < (int)most && !s; j++) {
        for (int k = 0; k < m->dim; k++)
            for (int i = 0; i < m->nown; i++) line[k][i] = j < entries_of(r, i) ? *place_of(r, i, j, k) : 0;
        polyhedra_fill_start(m, m->dim, line);
        polyhedra_fill_finish(m);
        for (int k = 0; k < m->dim; k++)
            for (int i = m->nown; i < m->nnear; i++)
                if (j < entries_of(r, i)) *place_of(r, i, j, k) = line[k][i];
    }
    for (int k = 0; k < MAX_DIM; k++) free(line[k]);
    return s;
}

status cells_gradient_weights(const struct gas *g, struct entries *r) {
    const struct polyhedra *m = g->cells->polyhedra;
    double *W;
    int most = 1;
    TRY(fit_gradients(g->cells->fit, r));
    for (int i = 0; i < m->nown; i++) most = entries_of(r, i) > most ? entries_of(r, i) : most;
    TRY(allocate(&W, (long)m->dim * most, sizeof *W, "gradients"));
    for (int i = 0; i < m->nown; i++) {
        int n = 0;
        while (m->stencil_start[i] + n < m->stencil_start[i + 1] && m->ring[m->stencil_start[i] + n] == 1) n++;
        if (n > entries_of(r, i) || !gauss_weights(m, i, n, W)) continue;
        for (int j = 0; j < entries_of(r, i); j++)
            for (int k = 0; k < m->dim; k++) *place_of(r, i, j, k) = j < n ? W[k * n + j] : 0;
    }
    free(W);
    return fill_weights(g, r);
}

/* The gradients of a line in a batch of lanes whose lists have `count` entries. */
ALWAYS_INLINE void lane_gradients(int dim, int count, const int *restrict cell, const double *restrict w, int first,
                                  const double *restrict q, double *const *gradient, int step) {
    double change[6][LANES];
    for (int j = 0; j < count; j++)
        for (int l = 0; l < LANES; l++) change[j][l] = q[cell[j * LANES + l]] - q[first + l];
    for (int k = 0; k < dim; k++) {
        double *restrict out = gradient[k * step] + first;
        for (int l = 0; l < LANES; l++) {
            double sum = 0;
            UNROLL
            for (int j = 0; j < count; j++) sum = fma(w[(j * dim + k) * LANES + l], change[j][l], sum);
            out[l] = sum;
        }
    }
}

ALWAYS_INLINE void batch_gradients(int dim, int lines, const struct entries *r, int batch, double *const *q,
                                   double *const *gradient) {
    const long first = (long)batch * LANES;
    for (int c = 0; c < lines; c++) {
        const double *restrict from = q[c];
        double own[LANES], sum[MAX_DIM][LANES] = {{0}};
        memcpy(own, from + first, sizeof own);
        for (int j = r->start[batch]; j < r->start[batch + 1]; j++) {
            const int *restrict cell = r->cell + (long)j * LANES;
            const double *restrict w = r->data + (long)j * dim * LANES;
            double change[LANES];
            for (int l = 0; l < LANES; l++) change[l] = from[cell[l]] - own[l];
            for (int k = 0; k < dim; k++)
                for (int l = 0; l < LANES; l++) sum[k][l] = fma(w[k * LANES + l], change[l], sum[k][l]);
        }
        for (int k = 0; k < dim; k++) memcpy(gradient[k * lines + c] + first, sum[k], sizeof own);
    }
}

/* Cells of triangles, quads and tetrahedra, and hexahedra, whose numbers of faces compilers may know, are done faster.
 */
#define GRADIENTS(dim)                                                                                                 \
    KERNEL static void gradients_##dim(int lines, const struct entries *r, int from, int to, double *const *q,         \
                                       double *const *gradient) {                                                      \
        for (int b = from; b < to; b++) {                                                                              \
            const int first = b * LANES, count = r->start[b + 1] - r->start[b];                                        \
            const int *cell = r->cell + (long)r->start[b] * LANES;                                                     \
            const double *w = r->data + (long)r->start[b] * dim * LANES;                                               \
            const bool known = count == 3 || count == 4 || count == 6;                                                 \
            if (!known) batch_gradients(dim, lines, r, b, q, gradient);                                                \
            for (int c = 0; c < lines && count == 3; c++)                                                              \
                lane_gradients(dim, 3, cell, w, first, q[c], gradient + c, lines);                                     \
            for (int c = 0; c < lines && count == 4; c++)                                                              \
                lane_gradients(dim, 4, cell, w, first, q[c], gradient + c, lines);                                     \
            for (int c = 0; c < lines && count == 6; c++)                                                              \
                lane_gradients(dim, 6, cell, w, first, q[c], gradient + c, lines);                                     \
        }                                                                                                              \
    }
GRADIENTS(1)
GRADIENTS(2)
GRADIENTS(3)

void cells_gradients(int dim, const struct entries *r, int lines, int from, int to, double *const *q,
                     double *const *gradient) {
    if (from < to)
        (dim == 1   ? gradients_1
         : dim == 2 ? gradients_2
                    : gradients_3)(lines, r, from / LANES, (to - 1) / LANES + 1, q, gradient);
}

static double alike_of(double a, double b) {
    const double ratio = smaller(a, b) / larger(a, b);
    return smaller(larger((ratio - UNLIKE) / (ALIKE - UNLIKE), 0), 1);
}

/* Finds how alike the two cells of n faces are. */
KERNEL static void cells_alike(int n, const int *restrict left, const int *restrict right, const double *restrict rho,
                               const double *restrict T, double *restrict out) {
    for (int i = 0; i < n; i++)
        out[i] = smaller(alike_of(T[left[i]], T[right[i]]), alike_of(rho[left[i]], rho[right[i]]));
}

/* The gradient of T in a cold cell beside hot gas is that of the jump between them, but across its other faces all is
 * cold. There a flux by the gradient would take heat from cells that have none. */
void cells_find_keep(struct gas *g, const double *rho, const double *T, double *alike, double *keep) {
    struct polyhedra *m = g->cells->polyhedra;
    cells_alike(m->face.n, m->face.left, m->face.right, rho, T, keep);
    for (int i = 0; i < m->nown; i++) {
        alike[i] = 1;
        for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++)
            alike[i] = smaller(alike[i], keep[m->face_of_cell[j] < 0 ? ~m->face_of_cell[j] : m->face_of_cell[j]]);
    }
    polyhedra_fill_start(m, 1, &alike);
    polyhedra_fill_finish(m);
    for (int f = 0; f < m->face.n; f++) {
        const double left = alike[m->face.left[f]];
        keep[f] = f < m->face.ninternal ? smaller(left, alike[m->face.right[f]]) : left;
    }
}
