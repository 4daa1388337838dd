/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of its motion by sound a step takes from a bed (bed.h: struct bed_blur; docs/physics.md 9.2). */
#include "libcore/acoustics/bed_private.h"

/* The sums over the cells of a block: L, V rho |u|^2/2, V rho eps, V rho, V rho u. */
enum { LOST, MOTION, HEAT, MASS, MOMENTUM, SUMS = MOMENTUM + MAX_DIM };
/* SLIGHT of the heat counts as motion: in a bed at own both are round-off. QUIET of the mean motion of the bed counts
 * as that of each block: nobody sees what is lost where next to nothing moves. */
static const double SLIGHT = 1e-10, QUIET = 0.01;
_Static_assert((int)SUMS == (int)BLUR_SUMS, "the memory has room for the sums");

/* Finds velocity u and eps of n states U. */
KERNEL static void blur_primitives(int n, int components, const double *const *U, int at, double (*u)[BATCH],
                                   double *restrict rho, double *restrict eps) {
    double inverse[BATCH], square[BATCH];
    for (int i = 0; i < n; i++) {
        rho[i] = U[0][at + i];
        inverse[i] = 1 / rho[i];
        square[i] = 0;
    }
    for (int k = components - 1; k >= 0; k--) {
        const double *restrict mom = U[k + 1] + at;
        for (int i = 0; i < n; i++) {
            u[k][i] = mom[i] * inverse[i];
            square[i] += u[k][i] * u[k][i];
        }
    }
    for (int i = 0; i < n; i++) eps[i] = U[components + 1][at + i] * inverse[i] - 0.5 * square[i];
}

/* Adds to |du|^2 and |du - fall|^2 the part of an axis along which the velocity changes from u to `after`. */
KERNEL static void blur_change(int n, double fall, const double *restrict u, const double *restrict after,
                               double *restrict square, double *restrict less) {
    for (int i = 0; i < n; i++) {
        const double du = after[i] - u[i], own = du - fall;
        square[i] += du * du;
        less[i] += own * own;
    }
}

KERNEL static void blur_loss(int n, const double *restrict rho, const double *restrict c, const double *restrict p,
                             const double *restrict before, const double *restrict start, double (*square)[BATCH],
                             double *restrict loss) {
    for (int i = 0; i < n; i++) {
        const double dp = p[i] - before[i], all = p[i] - start[i], least = smaller(dp * dp, all * all);
        const double motion = smaller(smaller(square[0][i], square[1][i]), smaller(square[2][i], square[3][i]));
        loss[i] = 0.5 * (least / (rho[i] * c[i] * c[i]) + rho[i] * motion);
    }
}

/* Finds L/V of n cells. */
static void find_loss(const struct bed *b, double dt, const double gravity[MAX_DIM], int at, int n, double *loss) {
    const struct bed_lines *x = b->lines;
    double u[MAX_DIM][BATCH], rho[BATCH], eps[BATCH], square[8][BATCH];
    blur_primitives(n, b->components, (const double *const *)b->set.start, at, u, rho, eps);
    for (int i = 0; i < 8; i++) memset(square[i], 0, (size_t)n * sizeof(double));
    for (int k = 0; k < b->dim; k++) {
        const double fall = dt * gravity[k];
        const double *after = x->after[k + 1] + at;
        double freely[BATCH]; /* without friction, which takes its energy from no wave */
        blur_change(n, fall, x->u[k] + at, after, square[0], square[1]);
        blur_change(n, fall, u[k], after, square[2], square[3]);
        if (!b->rub) continue;
        for (int i = 0; i < n; i++) freely[i] = after[i] - x->rubbed[k][at + i];
        blur_change(n, fall, x->u[k] + at, freely, square[4], square[5]);
        blur_change(n, fall, u[k], freely, square[6], square[7]);
    }
    for (int j = 0; j < 4 && b->rub; j++)
        for (int i = 0; i < n; i++) square[j][i] = smaller(square[j][i], square[j + 4][i]);
    blur_loss(n, x->rho + at, x->c + at, x->p + at, x->first_p + at, x->start_p + at, square, loss);
}

static void add_cell(const struct bed *b, int cell, double loss, double sum[SUMS]) {
    const struct bed_lines *x = b->lines;
    const double V = b->set.shapes->volume[b->set.body[cell]], mass = V * x->rho[cell];
    double square = 0;
    for (int k = 0; k < b->dim; k++) {
        square += x->u[k][cell] * x->u[k][cell];
        sum[MOMENTUM + k] += mass * x->u[k][cell];
    }
    sum[LOST] += V * loss;
    sum[MOTION] += 0.5 * mass * square;
    sum[HEAT] += mass * x->eps[cell];
    sum[MASS] += mass;
}

/* Finds the sums of a block, and its cell of the greatest loss. */
static void sum_block(struct bed *b, double dt, const double gravity[MAX_DIM], int block, double sum[SUMS]) {
    double loss[BATCH];
    memset(sum, 0, SUMS * sizeof *sum);
    b->set.peak[block] = b->set.peak_cell[block] = 0;
    for (int at = b->set.first[block], n; at < b->set.first[block + 1]; at += n) {
        n = b->set.first[block + 1] - at < BATCH ? b->set.first[block + 1] - at : BATCH;
        find_loss(b, dt, gravity, at, n, loss);
        for (int i = 0; i < n; i++) {
            add_cell(b, at + i, loss[i], sum);
            if (!(loss[i] > b->set.peak[block])) continue;
            b->set.peak[block] = loss[i];
            b->set.peak_cell[block] = at + i - b->set.first[block];
        }
    }
}

void bed_find_start(struct bed *b) {
    double u[MAX_DIM][BATCH], rho[BATCH], eps[BATCH], c2[BATCH], gruneisen[BATCH];
    for (int at = 0, n; at < b->set.cells; at += n) {
        n = b->set.cells - at < BATCH ? b->set.cells - at : BATCH;
        blur_primitives(n, b->components, (const double *const *)b->set.start, at, u, rho, eps);
        b->eos->state(b->material, n, rho, eps, b->lines->start_p + at, c2, gruneisen);
    }
}

void bed_note_start(struct bed *b) {
    const struct bed_set *s = b->home;
    for (int v = 0; v < b->components + 2; v++) memcpy(s->start[v], s->U[v], (size_t)s->cells * sizeof(double));
}

/* Returns the energy of motion of a block about the mean velocity of the bed, or of the bed itself. */
static double motion_of(const struct bed *b, const double *sum, const double *all) {
    double along = 0, square = 0;
    for (int k = 0; k < b->dim; k++) {
        const double u = all[MOMENTUM + k] / all[MASS];
        along += sum[MOMENTUM + k] * u;
        square += u * u;
    }
    return larger(sum[MOTION] - along + 0.5 * sum[MASS] * square, 0);
}

void bed_find_blur(struct bed *b, double dt, const double gravity[MAX_DIM]) {
    double all[SUMS], local = 0;
    for (int block = 0; block < b->set.blocks; block++)
        sum_block(b, dt, gravity, block, b->lines->block_sums + SUMS * block);
    multigrid_sum_blocks(b->multigrid, b->set.blocks, SUMS, b->lines->block_sums, all);
    const double moving = motion_of(b, all, all), heat = SLIGHT * all[HEAT];
    for (int block = 0; block < b->set.blocks; block++) {
        const double *sum = b->lines->block_sums + SUMS * block, part = sum[MASS] / all[MASS];
        const double energy = motion_of(b, sum, all) + part * (QUIET * moving + heat);
        if (sum[LOST] > 0) local = larger(local, sum[LOST] / energy);
    }
    comm_max(b->comm, &local, 1);
    b->blur = (struct bed_blur){all[LOST] > 0 ? all[LOST] / (moving + heat) : 0, local};
}
