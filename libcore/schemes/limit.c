/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Limits fluxes and states to the admissible set and applies the floors. limit.h states the theorem, its proof and
 * sources. */
#include "libcore/schemes/limit.h"

/* Does every state keep its distance, so that none has to move? (NaN: no) */
KERNEL static bool all_stay(int n, int dim, double least, double limit, const double (*restrict average)[BATCH],
                            const double (*restrict at)[BATCH]) {
    double square[2][BATCH];
    int stay = 1;
    for (int i = 0; i < n; i++) {
        const double mean = average[0][i], high = mean + (1 - KEPT) * (limit - mean);
        const double low = smaller(least + KEPT * (mean - least), mean);
        stay &= (at[0][i] >= low) & (at[0][i] <= high);
        square[0][i] = square[1][i] = 0;
    }
    for (int k = dim; k >= 1; k--)
        for (int i = 0; i < n; i++) {
            square[0][i] += average[k][i] * average[k][i];
            square[1][i] += at[k][i] * at[k][i];
        }
    for (int i = 0; i < n; i++) {
        const double mean = average[dim + 1][i] - 0.5 * square[0][i] / average[0][i];
        stay &= (mean > 0) & (at[dim + 1][i] - 0.5 * square[1][i] / at[0][i] >= KEPT * mean);
    }
    return stay;
}

KERNEL static void move_towards(int n, int dim, double least, double limit, const double (*restrict average)[BATCH],
                                double (*restrict at)[BATCH], double *restrict theta) {
    double square[2][BATCH];
    for (int i = 0; i < n; i++) {
        double mean = average[0][i], rho = at[0][i], high = mean + (1 - KEPT) * (limit - mean);
        /* an average below the floor: the state may not be lower than it */
        double low = smaller(least + KEPT * (mean - least), mean);
        double down = (mean - low) / (mean - rho), up = (high - mean) / (rho - mean);
        double share = rho < low ? down : rho > high ? up : 0; /* NaN: 0 */
        const bool inside = (rho >= low) & (rho <= high);
        theta[i] = inside ? 1 : share;
        square[0][i] = square[1][i] = 0;
    }
    for (int v = 0; v < dim + 2; v++)
        for (int i = 0; i < n; i++) {
            double mixed = fma(theta[i], at[v][i] - average[v][i], average[v][i]);
            at[v][i] = theta[i] < 1 ? mixed : at[v][i];
        }
    for (int k = dim; k >= 1; k--)
        for (int i = 0; i < n; i++) {
            square[0][i] += average[k][i] * average[k][i];
            square[1][i] += at[k][i] * at[k][i];
        }
    for (int i = 0; i < n; i++) { /* rho e is concave: on the way to the average it rises at least linearly */
        double mean = average[dim + 1][i] - 0.5 * square[0][i] / average[0][i];
        double here = at[dim + 1][i] - 0.5 * square[1][i] / at[0][i], low = KEPT * mean;
        double share = (mean - low) / (mean - here), some = here < low ? share : 0;
        some = here >= low ? 1 : some; /* NaN: 0 */
        square[0][i] = mean > 0 ? some : 0;
        theta[i] *= square[0][i];
    }
    for (int v = 0; v < dim + 2; v++)
        for (int i = 0; i < n; i++) {
            double mixed = fma(square[0][i], at[v][i] - average[v][i], average[v][i]);
            mixed = theta[i] > 0 ? mixed : average[v][i];
            at[v][i] = square[0][i] < 1 ? mixed : at[v][i];
        }
}

void limit_towards(int n, int dim, double least, double limit, const double (*average)[BATCH], double (*at)[BATCH],
                   double *theta) {
    if (!all_stay(n, dim, least, limit, average, (const double(*)[BATCH])at))
        move_towards(n, dim, least, limit, average, at, theta);
    else
        for (int i = 0; i < n; i++) theta[i] = 1;
}

KERNEL static void guaranteed_speed(int n, double limit, const struct faces *f, double *restrict s) {
    const double *restrict rl = f->state[0], *restrict rr = f->state[0] + f->stride;
    const double *restrict ml = f->state[1], *restrict mr = f->state[1] + f->stride;
    const double *restrict vl = f->velocity[0], *restrict vr = f->velocity[0] + f->stride;
    const double *restrict cl = f->c, *restrict cr = f->c + f->stride;
    for (int i = 0; i < n; i++) {
        double packing = (ml[i] - mr[i]) / (limit - larger(rl[i], rr[i]));
        s[i] = larger(larger(fabs(vl[i]) + cl[i], fabs(vr[i]) + cr[i]), packing);
    }
}

/* Computes F_L, ubar, ubar + D and ubar - D (limit.h) of variable v. */
KERNEL static void bar_line(const struct faces *f, int v, const double *restrict s, double *restrict low,
                            double *restrict bar, double *restrict up, double *restrict down) {
    const double *restrict fl = f->flux[v], *restrict fr = fl + f->stride, *restrict high = f->out[v];
    const double *restrict ul = f->state[v], *restrict ur = ul + f->stride;
    const int n = f->n;
    for (int i = 0; i < n; i++) {
        double F = 0.5 * (fl[i] + fr[i]) - 0.5 * s[i] * (ur[i] - ul[i]);
        double mean = 0.5 * (ul[i] + ur[i]) - 0.5 * (fr[i] - fl[i]) / s[i], D = (high[i] - F) / s[i];
        low[i] = F;
        bar[i] = mean;
        up[i] = mean + D;
        down[i] = mean - D;
    }
}

KERNEL static void blend_line(int n, const double *restrict theta, const double *restrict low, double *restrict out) {
    for (int i = 0; i < n; i++) {
        double mixed = low[i] + theta[i] * (out[i] - low[i]), some = theta[i] > 0 ? mixed : low[i];
        out[i] = theta[i] < 1 ? some : out[i];
    }
}

void limit_faces(const struct faces *f, double least, double limit, double *theta) {
    double s[BATCH], low[MAX_VAR][BATCH], bar[MAX_VAR][BATCH], up[MAX_VAR][BATCH], down[MAX_VAR][BATCH], other[BATCH];
    guaranteed_speed(f->n, limit, f, s);
    for (int v = 0; v < f->dim + 2; v++) bar_line(f, v, s, low[v], bar[v], up[v], down[v]);
    limit_towards(f->n, f->dim, least, limit, (const double(*)[BATCH])bar, up, theta);
    limit_towards(f->n, f->dim, least, limit, (const double(*)[BATCH])bar, down, other);
    for (int i = 0; i < f->n; i++) theta[i] = smaller(theta[i], other[i]);
    for (int v = 0; v < f->dim + 2; v++) blend_line(f->n, theta, low[v], f->out[v]);
}

/* Marks states that are not admissible. The squares are summed from the last axis, so that two of three commute under a
 * swap of axes. */
KERNEL static bool mark_bad(int n, int dim, long size, double least, double limit, const double *restrict U,
                            double *restrict bad) {
    const double *restrict rho = U, *restrict E = U + (dim + 1) * size;
    const double *restrict m1 = U + size, *restrict m2 = U + 2 * size, *restrict m3 = U + 3 * size;
    uint64_t any = 0;
    for (int i = 0; i < n; i++) {
        double square = dim > 2 ? m3[i] * m3[i] : 0;
        if (dim > 1) square += m2[i] * m2[i];
        double kinetic = 0.5 * (square + m1[i] * m1[i]), internal = E[i] * rho[i] - kinetic;
        bool good = (rho[i] > least) & (rho[i] < limit) & (internal > ROUND * kinetic); /* NaN is bad */
        bad[i] = good ? 0 : 1;
        any |= bits_of(bad[i]);
    }
    return any != 0;
}

bool find_bad(int n, int dim, long size, double least, double limit, const double *restrict U, double *restrict bad) {
    return mark_bad(n, dim, size, least, limit, U, bad);
}

KERNEL static bool mark_crowded(int n, double limit, const double *restrict from, const double *restrict to,
                                double *restrict bad) {
    const double edge = (1 - CROWDED) * limit;
    uint64_t any = 0;
    for (int i = 0; i < n; i++) {
        const bool crowded = (to[i] > edge) & (to[i] > from[i]);
        const double mark = crowded ? 1 : 0;
        bad[i] += mark;
        any |= bits_of(mark);
    }
    return any != 0;
}

bool find_crowded(int n, double limit, const double *restrict from, const double *restrict to, double *restrict bad) {
    return mark_crowded(n, limit, from, to, bad);
}

int raise_density(int n, int dim, long size, double least, double limit, double *restrict U, double *restrict bad,
                  double (*restrict added)[BATCH]) {
    const double floor = least * (1 + 2 * ROUND);
    int count = 0;
    for (int i = 0; i < n; i++) {
        double rho = U[i], E = U[(dim + 1) * size + i], factor = floor / rho;
        added[0][i] = added[1][i] = 0;
        if (bad[i] == 0 || !(rho > 0 && rho <= least && factor < HUGE_VAL)) continue;
        for (int v = 1; v < dim + 2; v++) U[v * size + i] *= factor;
        U[i] = floor;
        added[0][i] = floor - rho;
        added[1][i] = U[(dim + 1) * size + i] - E;
        (void)mark_bad(1, dim, size, least, limit, U + i, bad + i);
        count++;
    }
    return count;
}

int raise_energy(int n, int dim, long size, double least, double limit, double *restrict U, double *restrict bad,
                 double *restrict raised) {
    const double *restrict rho = U;
    double *restrict E = U + (dim + 1) * size;
    int count = 0;
    for (int i = 0; i < n; i++) {
        double square = 0;
        for (int k = dim; k >= 1; k--) square += U[k * size + i] * U[k * size + i];
        double kinetic = 0.5 * square, missing = fabs(E[i] * rho[i] - kinetic);
        raised[i] = 0;
        if (bad[i] == 0 || !(rho[i] > least && rho[i] < limit && missing <= 10 * ROUND * kinetic)) continue;
        double floor = kinetic / rho[i] * (1 + 2 * ROUND);
        raised[i] = floor - E[i];
        E[i] = floor;
        bad[i] = 0;
        count++;
    }
    return count;
}
