/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Differences on a lattice, and fits of quadratic functions on polyhedra (gradient.h). */
#include "mesh/grid/gradient.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- a lattice ---- */

/* Calls visit for each row of cells of this rank along axis 0: its place in the lines, the block, and its first cell in
 * the tile. */
struct lattice_row {
    const struct forest_block *block;
    long at, offset;
    int j, k;
};
typedef void lattice_visitor(const struct forest *f, const struct lattice_row *row, double *const *tiles,
                             const double *const *from, double *const *to, int lines);

static void visit_rows(const struct forest *f, lattice_visitor *visit, double *const *tiles, const double *const *from,
                       double *const *to, int lines) {
    struct lattice_row row = {.at = 0};
    for (int b = 0; b < f->nblocks; b++) {
        row.block = &f->block[b];
        for (row.k = 0; row.k < row.block->n[2]; row.k++)
            for (row.j = 0; row.j < row.block->n[1]; row.j++) {
                row.offset = f->first + row.j * f->step[1] + row.k * f->step[2];
                visit(f, &row, tiles, from, to, lines);
                row.at += row.block->n[0];
            }
    }
}

static void put_row(const struct forest *f, const struct lattice_row *row, double *const *tiles,
                    const double *const *from, double *const *to, int lines) {
    (void)to;
    for (int c = 0; c < lines; c++) {
        double *q = tiles[row->block->tile] + c * f->size + row->offset;
        for (int i = 0; i < row->block->n[0]; i++) q[i * f->step[0]] = from[c][row->at + i];
    }
}

/* Returns the derivative at *q. Its neighbours are `step` apart in memory and `width` (m) in space; `below` and `above`
 * say how many there are on either side. */
static double slope(const double *q, long step, int below, int above, double width) {
    if (below >= 1 && above >= 1) return (q[step] - q[-step]) / (2 * width);
    const long inward = above ? step : -step;
    if (!above && !below) return 0;
    const double one = q[inward] - *q, end = above ? width : -width;
    return above >= 2 || below >= 2 ? (4 * one - (q[2 * inward] - *q)) / (2 * end) : one / end;
}

/* How many cells in a row stand beside place i of a tile, on its lower (0) or upper side, as far as two. */
static int cells_beside(const struct tile *t, int axis, int i, int upper) {
    const int inside = upper ? t->n[axis] - 1 - i : i;
    return inside + (t->side[2 * axis + upper].patch < 0 ? 2 : 0);
}

static void difference_row(const struct forest *f, const struct lattice_row *row, double *const *tiles,
                           const double *const *from, double *const *to, int lines) {
    const struct tile *t = &f->tile[row->block->tile];
    (void)from;
    for (int k = 0; k < f->dim; k++)
        for (int i = 0; i < row->block->n[0]; i++) {
            const int along[3] = {i, row->j, row->k}, place = f->step[k] ? along[k] : 0;
            const int below = cells_beside(t, k, place, 0), above = cells_beside(t, k, place, 1);
            for (int c = 0; c < lines; c++)
                to[k * lines + c][row->at + i] =
                    slope(tiles[row->block->tile] + c * f->size + row->offset + i * f->step[0], f->stride[k], below,
                          above, f->width[k]);
        }
}

static status of_forest(struct forest *f, int lines, const double *const *values, double *const *gradient) {
    double **tiles = NULL, *room = NULL;
    status s = allocate(&tiles, f->ntiles + 1L, sizeof *tiles, "gradients");
    if (!s) s = allocate(&room, f->ntiles * lines * f->size + 1, sizeof *room, "gradients");
    s = comm_agree(f->comm, s);
    if (!s) {
        for (int t = 0; t < f->ntiles; t++) tiles[t] = room + t * lines * f->size;
        visit_rows(f, put_row, tiles, values, gradient, lines);
        forest_fill_layers(f, 2, lines, tiles);
        visit_rows(f, difference_row, tiles, values, gradient, lines);
    }
    free(tiles);
    free(room);
    return s;
}

/* ---- polyhedra ---- */

enum { MOST_TERMS = 9, MOST_DIM = 3 }; /* of a quadratic function in 3D without the constant; axes */
/* A column of a fit of which less is left than this part of its length, beyond those before it, is left out: linear
 * ones, where the mesh is flat, and quadratic ones, where it is two cells wide. */
static const double FLAT[2] = {1e-6, 1e-2};

struct fitting { /* of one cell at a time, by Gram and Schmidt: column t = sum_s Q_s R[s][t] */
    const struct polyhedra *m;
    int n, terms;
    int *member;                      /* [most members] places in the stencil, without mirrors */
    double *weight;                   /* [most members] */
    double *column[MOST_TERMS];       /* [most members] */
    double R[MOST_TERMS][MOST_TERMS]; /* R[t][t] = 0: column t is left out */
    double right[MOST_TERMS];         /* scratch */
};

/* The terms x_a and x_a x_b of the quadratic function, as means over a member less those over the cell i: with offset d
 * and moments M of both cells these are d_a and d_a d_b + M_ab(member) - M_ab(i). */
static void set_columns(struct fitting *x, int i) {
    const struct polyhedra *m = x->m;
    x->n = 0;
    for (int j = m->stencil_start[i]; j < m->stencil_start[i + 1]; j++) {
        double square = 0;
        if (m->stencil[j] >= m->ncells) continue;
        for (int k = 0; k < m->dim; k++) square += m->offset[k][j] * m->offset[k][j];
        x->weight[x->n] = 1 / sqrt(square);
        x->member[x->n++] = j;
    }
    x->terms = x->n >= m->dim * (m->dim + 3) / 2 ? m->dim * (m->dim + 3) / 2 : m->dim;
    for (int r = 0; r < x->n; r++) {
        const int j = x->member[r];
        for (int k = 0; k < m->dim; k++) x->column[k][r] = x->weight[r] * m->offset[k][j];
        for (int a = 0, t = m->dim; a < m->dim; a++)
            for (int b = a; b < m->dim && t < x->terms; b++, t++) {
                const double *moment = m->moment[t - m->dim];
                x->column[t][r] =
                    x->weight[r] * (m->offset[a][j] * m->offset[b][j] + (moment[m->stencil[j]] - moment[i]));
            }
    }
}

static double product(int n, const double *a, const double *b) {
    double sum = 0;
    for (int r = 0; r < n; r++) sum += a[r] * b[r];
    return sum;
}

static void factorise(struct fitting *x) {
    for (int t = 0; t < x->terms; t++) {
        double *column = x->column[t];
        const double before = sqrt(product(x->n, column, column));
        for (int s = 0; s < t; s++) {
            x->R[s][t] = x->R[s][s] > 0 ? product(x->n, x->column[s], column) : 0;
            for (int r = 0; r < x->n && x->R[s][s] > 0; r++) column[r] -= x->R[s][t] * x->column[s][r];
        }
        const double left = sqrt(product(x->n, column, column));
        x->R[t][t] = left > FLAT[t >= x->m->dim] * before ? left : 0;
        for (int r = 0; r < x->n && x->R[t][t] > 0; r++) column[r] /= left;
    }
}

/* The gradient of a line of values in cell i. */
static void fit_line(struct fitting *x, int i, const double *q, double out[MOST_DIM]) {
    double *c = x->right;
    for (int t = 0; t < x->terms; t++) {
        c[t] = 0;
        for (int r = 0; r < x->n && x->R[t][t] > 0; r++)
            c[t] += x->column[t][r] * (x->weight[r] * (q[x->m->stencil[x->member[r]]] - q[i]));
    }
    for (int t = x->terms - 1; t >= 0; t--) {
        if (!(x->R[t][t] > 0)) continue;
        for (int s = t + 1; s < x->terms; s++) c[t] -= x->R[t][s] * c[s];
        c[t] /= x->R[t][t];
    }
    memcpy(out, c, sizeof(double) * (size_t)x->m->dim);
}

static status fitting_make(const struct polyhedra *m, struct fitting *x) {
    int most = 1;
    x->m = m;
    for (int i = 0; i < m->nown; i++)
        if (m->stencil_start[i + 1] - m->stencil_start[i] > most) most = m->stencil_start[i + 1] - m->stencil_start[i];
    TRY(allocate(&x->member, most, sizeof *x->member, "gradients"));
    TRY(allocate(&x->weight, most * (MOST_TERMS + 1L), sizeof *x->weight, "gradients"));
    for (int t = 0; t < MOST_TERMS; t++) x->column[t] = x->weight + (t + 1L) * most;
    return OK;
}

static void fit_all(struct fitting *x, int lines, double *const *q, double *const *gradient) {
    const struct polyhedra *m = x->m;
    for (int at = 0; at < m->nown; at++) {
        const int i = m->block_cell[at];
        double slopes[MOST_DIM];
        set_columns(x, i);
        factorise(x);
        for (int c = 0; c < lines; c++) {
            fit_line(x, i, q[c], slopes);
            for (int k = 0; k < m->dim; k++) gradient[k * lines + c][at] = slopes[k];
        }
    }
}

static status of_polyhedra(struct polyhedra *m, int lines, const double *const *values, double *const *gradient) {
    struct fitting x = {.n = 0};
    double *room = NULL, *q[GRADIENT_LINES];
    status s = fitting_make(m, &x);
    if (!s) s = allocate(&room, (long)lines * m->size + 1, sizeof *room, "gradients");
    s = comm_agree(m->comm, s);
    if (!s) {
        for (int c = 0; c < lines; c++) {
            q[c] = room + (long)c * m->size;
            for (int at = 0; at < m->nown; at++) q[c][m->block_cell[at]] = values[c][at];
        }
        polyhedra_fill_start(m, lines, q);
        polyhedra_fill_finish(m);
        fit_all(&x, lines, q, gradient);
    }
    free(x.member);
    free(x.weight);
    free(room);
    return s;
}

status grid_gradients(const struct grid *g, int lines, const double *const *values, double *const *gradient) {
    return g->polyhedra ? of_polyhedra(g->polyhedra, lines, values, gradient)
                        : of_forest(g->forest, lines, values, gradient);
}
