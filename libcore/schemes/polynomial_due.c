/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits of single cells, for local time steps: the other cells of a batch keep their values. */
#include "libcore/schemes/polynomial_fit.h"

#include <string.h>

KERNEL static void list_places(int n, const int *restrict point, const int *restrict place, int *restrict out) {
    for (int i = 0; i < n; i++) out[i] = place[point[i]];
}
KERNEL static void take_places(int n, const int *restrict place, const double *restrict from, double *restrict to) {
    for (int i = 0; i < n; i++) to[i] = from[place[i]];
}
void fit_faces(const struct fit *f, int side, int n, const int *point, const double *const *U, double *const *out) {
    int place[BATCH];
    list_places(n, point, f->place[side], place);
    for (int v = 0; v < f->nvar; v++) take_places(n, place, f->kind->cells ? f->value + v * f->nvalues : U[v], out[v]);
}

static long numbers_of(const struct fit *f, int batch) {
    return (long)(f->point.start[batch + 1] - f->point.start[batch]) * LANES;
}

status fit_hold(struct fit *f) {
    long most = 0;
    for (int b = 0; b < f->nbatches; b++) most = numbers_of(f, b) > most ? numbers_of(f, b) : most;
    return allocate(&f->held, f->nvar * most, sizeof *f->held, "values at face points");
}

/* Gives the cells of a batch that are not due the values that they had. */
static void give_back(struct fit *f, int batch, const bool *due) {
    const long n = numbers_of(f, batch), first = (long)f->slot[batch] * LANES;
    for (int v = 0; v < f->nvar; v++)
        for (long i = 0; i < n; i++)
            if (!due[batch * LANES + i % LANES]) f->value[v * f->nvalues + first + i] = f->held[v * n + i];
}

void fit_due(struct fit *f, const bool *due, const double *const *U) {
    for (int b = 0; b < f->nbatches && f->kind->cells; b++) {
        const int cells = f->polyhedra->nnear - b * LANES < LANES ? f->polyhedra->nnear - b * LANES : LANES;
        const long n = numbers_of(f, b), first = (long)f->slot[b] * LANES;
        int count = 0;
        for (int i = 0; i < cells; i++) count += due[b * LANES + i];
        if (count == 0) continue;
        for (int v = 0; v < f->nvar && count < cells; v++)
            memcpy(f->held + v * n, f->value + v * f->nvalues + first, (size_t)n * sizeof(double));
        f->kind->cells(f, b, U);
        if (count < cells) give_back(f, b, due);
    }
}
