/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values by cell on a forest (the lattice cut into tiles, forest.h): gathered in the order of the polyMesh, summed,
 * found by place. */
#include <math.h>
#include <stdlib.h>

#include "mesh/base/share.h"
#include "mesh/lattice/forest_private.h"

status forest_gather(const struct forest *f, const double *values, double *all) {
    const struct share s = share_make(f->comm, f->ncells_all);
    return share_gather(&s, 1, f->hidden->ncells, f->hidden->cell, values, all);
}

status forest_sum(const struct forest *f, const double *per_block, double *sum) {
    double *all = NULL, *ordered = NULL;
    *sum = 0;
    TRY(comm_gather(f->comm, per_block, f->nblocks, &all, NULL));
    status s = all ? allocate(&ordered, f->nblocks_all, sizeof *ordered, "sums of the blocks") : OK;
    for (int b = 0; ordered && b < f->nblocks_all; b++) ordered[f->hidden->block[b].id] = all[b];
    for (int b = 0; ordered && b < f->nblocks_all; b++) *sum += ordered[b];
    free(all);
    free(ordered);
    TRY(comm_agree(f->comm, s));
    comm_broadcast(f->comm, sum, sizeof *sum);
    return OK;
}

/* Finds the one or two lattice positions along axis k that a coordinate may belong to, the upper one first; returns how
 * many. */
static int candidates(const struct forest *f, int k, double x, int position[2]) {
    double s = (x - f->origin[k]) / f->width[k], plane = round(s);
    if (!(s > -1 && s < f->hidden->n[k] + 1.0)) return 0;
    position[0] = (int)floor(s);
    if (fabs(s - plane) > 1e-6) return 1;
    position[0] = (int)plane;
    position[1] = (int)plane - 1;
    return 2;
}

static int find_block(const struct forest_private *h, const int i[3]) {
    int piece[3];
    for (int k = 0; k < 3; k++) {
        if (i[k] < 0 || i[k] >= h->n[k]) return -1;
        int low = 0, high = h->pieces[k];
        while (high - low > 1) {
            int middle = (low + high) / 2;
            if (h->start[k][middle] <= i[k])
                low = middle;
            else
                high = middle;
        }
        piece[k] = low;
    }
    return h->id[piece[0] + h->pieces[0] * (piece[1] + (long)h->pieces[1] * piece[2])];
}

/* Returns the place of a cell in a block, or -1; without a branch in the loop, which then takes vectors. */
static int place_in(const struct forest_block *b, int cell) {
    const int n = b->n[0] * b->n[1] * b->n[2];
    int found = 0;
    for (int i = 0; i < n; i++) found += b->cell[i] == cell ? i + 1 : 0;
    return found - 1;
}

void forest_place(const struct forest *f, long cell, double x[3]) {
    double place[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    for (int b = 0; b < f->nblocks; b++) {
        const struct forest_block *here = &f->block[b];
        const int *n = here->n, i = place_in(here, (int)cell), at[3] = {i % n[0], i / n[0] % n[1], i / n[0] / n[1]};
        for (int k = 0; i >= 0 && k < f->dim; k++)
            place[k] = f->origin[k] + f->width[k] * ((double)(here->low[k] + at[k]) + 0.5);
    }
    comm_min(f->comm, place, 3);
    for (int k = 0; k < f->dim; k++) x[f->axis[k]] = place[k];
}

void forest_locate(const struct forest *f, const double point[3], int *block, int *cell) {
    int choice[3][2] = {{0}}, n[3] = {1, 1, 1}, id = -1, i[3] = {0};
    for (int k = 0; k < f->dim; k++) n[k] = candidates(f, k, point[f->axis[k]], choice[k]);
    for (int pick = 0; pick < 8 && id < 0; pick++) {
        bool valid = true;
        for (int k = 0; k < 3; k++) {
            i[k] = choice[k][pick >> k & 1];
            valid = valid && (pick >> k & 1) < n[k];
        }
        if (valid) id = find_block(f->hidden, i);
    }
    *cell = *block = -1;
    for (int b = 0; b < f->nblocks; b++) {
        const struct forest_block *here = &f->block[b];
        if (here->id != id) continue;
        *block = b;
        *cell = i[0] - here->low[0] + here->n[0] * (i[1] - here->low[1] + here->n[1] * (i[2] - here->low[2]));
    }
}
