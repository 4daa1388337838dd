/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solves a system of all rows directly, by Cholesky's factors inside the envelope. */
#include "libcore/multigrid/multigrid_private.h"

status multigrid_direct_lay(const struct level *l, struct direct *d) {
    d->rows = l->rows;
    TRY(ARRAYS_GROW(&d->arrays, d->low, l->rows));
    TRY(ARRAYS_GROW(&d->arrays, d->start, l->rows + 1));
    TRY(ARRAYS_GROW(&d->arrays, d->inverse, l->rows));
    d->start[0] = 0;
    for (int i = 0; i < l->rows; i++) {
        int low = i;
        for (int k = l->first[3 * i]; k < l->first[3 * i + 1]; k++)
            if (l->link[k] < low) low = l->link[k];
        d->low[i] = low;
        d->start[i + 1] = d->start[i] + i - low;
    }
    return ARRAYS_GROW(&d->arrays, d->entry, d->start[l->rows]);
}

static double dot(int n, const double *a, const double *b) {
    double s[4] = {0, 0, 0, 0};
    int i = 0;
    for (; i + 4 <= n; i += 4)
        for (int k = 0; k < 4; k++) s[k] += a[i + k] * b[i + k];
    for (; i < n; i++) s[0] += a[i] * b[i];
    return (s[0] + s[1]) + (s[2] + s[3]);
}

/* A pivot that round-off has left of nothing belongs to a sum over rows that b does not fix: it is left out. */
void multigrid_factor(const struct level *l, struct direct *d) {
    const double nothing = 1e-15;
    for (int i = 0; i < d->rows; i++) {
        double *row = d->entry + d->start[i] - d->low[i], square = 0;
        for (int j = d->low[i]; j < i; j++) row[j] = 0;
        for (int k = l->first[3 * i]; k < l->first[3 * i + 1]; k++) row[l->link[k]] = -l->weight[k];
        for (int j = d->low[i]; j < i; j++) {
            const double *other = d->entry + d->start[j] - d->low[j];
            const int low = d->low[i] > d->low[j] ? d->low[i] : d->low[j];
            row[j] = (row[j] - dot(j - low, row + low, other + low)) * d->inverse[j];
            square += row[j] * row[j];
        }
        const double pivot = l->diagonal[i] - square;
        d->inverse[i] = pivot > nothing * l->diagonal[i] ? 1 / sqrt(pivot) : 0;
    }
}

void multigrid_direct_solve(const struct direct *d, const double *r, double *x) {
    for (int i = 0; i < d->rows; i++) {
        const int low = d->low[i];
        x[i] = (r[i] - dot(i - low, d->entry + d->start[i], x + low)) * d->inverse[i];
    }
    for (int i = d->rows - 1; i >= 0; i--) {
        const double *row = d->entry + d->start[i] - d->low[i];
        x[i] *= d->inverse[i];
        for (int j = d->low[i]; j < i; j++) x[j] -= row[j] * x[i];
    }
}
