/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How much of its motion by sound a step takes from a bed (bed.h: struct bed_blur; docs/physics.md 9.2). */
#include "libcore/acoustics/bed_private.h"

/* The sums over the cells of a block: L, V rho |u|^2/2, V rho eps, V rho, V rho u. */
enum { LOST, MOTION, HEAT, MASS, MOMENTUM, SUMS = MOMENTUM + MAX_DIM };
/* SLIGHT of the heat counts as motion: in a bed at rest both are round-off. QUIET of the mean motion of the bed counts
 * as that of each block: nobody sees what is lost where next to nothing moves. */
static const double SLIGHT = 1e-10, QUIET = 0.01;
_Static_assert((int)SUMS == (int)BLUR_SUMS, "the memory has room for the sums");

/* Finds the pressures of n states that have densities and energies per mass. */
static void find_pressure(const struct bed *b, int n, const double *rho, const double *eps, double *p) {
    double c2[BATCH], gruneisen[BATCH];
    b->eos->state(b->material, n, rho, eps, p, c2, gruneisen);
}

/* Finds the pressures at the start of the whole step in n cells from `at` on. */
static void find_start(const struct bed *b, int at, int n, double *p) {
    const int components = b->components;
    double rho[BATCH], eps[BATCH];
    for (int i = 0; i < n; i++) {
        double square = 0;
        rho[i] = b->start[0][at + i];
        for (int k = components; k >= 1; k--) square += b->start[k][at + i] * b->start[k][at + i];
        eps[i] = (b->start[components + 1][at + i] - 0.5 * square / rho[i]) / rho[i];
    }
    find_pressure(b, n, rho, eps, p);
}

/* Returns the least of |du|^2 and |du - g dt|^2, for du the change of a cell's velocity since acoustics and since the
 * step began. */
static double least_change(const struct bed *b, double dt, const double gravity[MAX_DIM], int cell) {
    const struct bed_lines *x = b->lines;
    double square[4] = {0, 0, 0, 0};
    for (int k = 0; k < b->dim; k++) {
        const double u = x->after[k + 1][cell], fall = dt * gravity[k];
        const double change[4] = {u - x->u[k][cell], u - x->u[k][cell] - fall,
                                  u - b->start[k + 1][cell] / b->start[0][cell],
                                  u - b->start[k + 1][cell] / b->start[0][cell] - fall};
        for (int i = 0; i < 4; i++) square[i] += change[i] * change[i];
    }
    return smaller(smaller(square[0], square[1]), smaller(square[2], square[3]));
}

/* Finds L/V of n cells. */
static void find_loss(const struct bed *b, double dt, const double gravity[MAX_DIM], int at, int n, double *loss) {
    const struct bed_lines *x = b->lines;
    double before[BATCH], start[BATCH];
    find_pressure(b, n, x->rho + at, x->eps + at, before);
    find_start(b, at, n, start);
    for (int i = 0; i < n; i++) {
        const double rho = x->rho[at + i], z = x->c[at + i], p = x->p[at + i];
        const double change[2] = {p - before[i], p - start[i]};
        const double least = smaller(change[0] * change[0], change[1] * change[1]);
        loss[i] = 0.5 * (least / (rho * z * z) + rho * least_change(b, dt, gravity, at + i));
    }
}

static void add_cell(const struct bed *b, int cell, double loss, double sum[SUMS]) {
    const struct bed_lines *x = b->lines;
    const double V = b->shapes->volume[b->body[cell]], mass = V * x->rho[cell];
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
    b->peak[block] = b->peak_cell[block] = 0;
    for (int at = b->first[block], n; at < b->first[block + 1]; at += n) {
        n = b->first[block + 1] - at < BATCH ? b->first[block + 1] - at : BATCH;
        find_loss(b, dt, gravity, at, n, loss);
        for (int i = 0; i < n; i++) {
            add_cell(b, at + i, loss[i], sum);
            if (!(loss[i] > b->peak[block])) continue;
            b->peak[block] = loss[i];
            b->peak_cell[block] = at + i - b->first[block];
        }
    }
}

void bed_note_start(struct bed *b) {
    for (int v = 0; v < b->components + 2; v++) memcpy(b->start[v], b->U[v], (size_t)b->cells * sizeof(double));
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
    for (int block = 0; block < b->blocks; block++)
        sum_block(b, dt, gravity, block, b->lines->block_sums + SUMS * block);
    multigrid_sum_blocks(b->multigrid, b->blocks, SUMS, b->lines->block_sums, all);
    const double moving = motion_of(b, all, all), heat = SLIGHT * all[HEAT];
    for (int block = 0; block < b->blocks; block++) {
        const double *sum = b->lines->block_sums + SUMS * block, part = sum[MASS] / all[MASS];
        const double energy = motion_of(b, sum, all) + part * (QUIET * moving + heat);
        if (sum[LOST] > 0) local = larger(local, sum[LOST] / energy);
    }
    comm_max(b->comm, &local, 1);
    b->blur = (struct bed_blur){all[LOST] > 0 ? all[LOST] / (moving + heat) : 0, local};
}
