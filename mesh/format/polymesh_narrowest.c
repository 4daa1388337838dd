/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds how narrow the narrowest cell of a mesh is beside the others (polymesh.h): the steps of a run go by it. */
#include "mesh/format/polymesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Adds up the surfaces of cells, without `empty` faces, which nothing crosses. */
static void add_surfaces(const struct polymesh *m, const double *area, double *surface) {
    int patch = -1;
    bool empty = false;
    for (int f = 0; f < m->nfaces; f++) {
        while (patch + 1 < m->npatches && f >= m->patch[patch + 1].start)
            empty = !strcmp(m->patch[++patch].type, "empty");
        if (empty) continue;
        const double *a = area + 3L * f, size = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
        surface[m->owner[f]] += size;
        if (f < m->ninternal) surface[m->neighbour[f]] += size;
    }
}

void polymesh_widths(const struct polymesh *m, const double *area, const double *volume, double *width) {
    for (long i = 0; i < m->ncells; i++) width[i] = 0;
    add_surfaces(m, area, width);
    for (long i = 0; i < m->ncells; i++) width[i] = volume[i] / width[i];
}

status polymesh_narrowest(const struct polymesh *m, const double *area, const double *volume, struct narrowest *out) {
    double *width, sum = 0;
    TRY(allocate(&width, m->ncells, sizeof *width, "cells"));
    polymesh_widths(m, area, volume, width);
    *out = (struct narrowest){.width = HUGE_VAL};
    for (long i = 0; i < m->ncells; i++) {
        sum += width[i];
        if (!(width[i] < out->width)) continue;
        out->cell = i;
        out->width = width[i];
    }
    /* half of all are no less than the median, which thus is no more than twice the mean: mostly that is enough */
    out->ratio = out->width / (2 * sum / m->ncells);
    if (out->ratio < 1e-3) {
        qsort(width, (size_t)m->ncells, sizeof *width, ascending);
        out->ratio = out->width / width[m->ncells / 2];
    }
    free(width);
    return OK;
}
