/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a matrix of sums over aggregates (Galerkin's with constants): first its pattern, then its numbers. */
#include "libcore/multigrid/multigrid_private.h"

struct matrix multigrid_matrix(const struct level *l) {
    return (struct matrix){.rows = l->rows,
                           .ghosts = l->ghosts,
                           .blocks = l->blocks,
                           .stride = 3,
                           .block = l->block,
                           .first = l->first,
                           .link = l->link,
                           .weight = l->weight,
                           .excess = l->excess};
}

/* Marks the columns of a row as they are found: slot[c] is c's place in the row whose stamp it bears. */
struct marks {
    int *stamp, *slot, *found;
    int n;
};

static void find(const struct matrix *a, const int *aggregate, int i, int row, struct marks *k, int *map) {
    for (int l = a->first[a->stride * i]; l < a->first[a->stride * (i + 1)]; l++) {
        const int c = aggregate ? aggregate[a->link[l]] : a->link[l];
        map[l] = c == row ? INSIDE : c;
        if (c == row || c < 0 || k->stamp[c] == row) continue;
        k->stamp[c] = row;
        k->found[k->n++] = c;
    }
}

/* Lays out a row's links: lower ones of the block [begin, end), higher ones, others. */
static void sort_row(struct level *to, int row, int begin, int end, struct marks *k) {
    int at = to->links;
    for (int kind = 0; kind < 3; kind++) {
        to->first[3 * row + kind] = at;
        for (int f = 0; f < k->n; f++) {
            const int c = k->found[f];
            if ((c < begin || c >= end ? 2 : c > row) != kind) continue;
            k->slot[c] = at;
            to->link[at++] = c;
        }
    }
    if (at > to->first[3 * row + 2]) to->edge[to->edges++] = row;
    to->links = at;
}

static void lay_rows(const struct matrix *a, const struct level *fine, struct level *to, struct marks *k) {
    const int *aggregate = fine ? fine->aggregate : NULL;
    for (int c = 0; c < to->rows + to->ghosts; c++) k->stamp[c] = -1;
    to->links = to->edges = 0;
    for (int b = 0; b < to->blocks; b++)
        for (int row = to->block[b]; row < to->block[b + 1]; row++) {
            const int begin = fine ? fine->member_first[row] : row, end = fine ? fine->member_first[row + 1] : row + 1;
            k->n = 0;
            for (int j = begin; j < end; j++) find(a, aggregate, fine ? fine->member[j] : j, row, k, to->map);
            sort_row(to, row, to->block[b], to->block[b + 1], k);
            for (int j = begin; j < end; j++) {
                const int i = fine ? fine->member[j] : j;
                for (int l = a->first[a->stride * i]; l < a->first[a->stride * (i + 1)]; l++)
                    if (to->map[l] >= 0) to->map[l] = k->slot[to->map[l]];
            }
        }
    to->first[3 * to->rows] = to->links;
}

status multigrid_lay(const struct matrix *a, const struct level *fine, struct level *to) {
    struct marks k = {0};
    const long links = a->first[a->stride * a->rows], columns = (long)to->rows + to->ghosts;
    TRY(ARRAYS_GROW(&to->arrays, to->map, links));
    TRY(ARRAYS_GROW(&to->arrays, to->first, 3L * to->rows + 1));
    TRY(ARRAYS_GROW(&to->arrays, to->link, links));
    TRY(ARRAYS_GROW(&to->arrays, to->weight, links));
    TRY(ARRAYS_GROW(&to->arrays, to->excess, 3L * to->rows));
    to->diagonal = to->excess + to->rows;
    to->inverse = to->diagonal + to->rows;
    TRY(ARRAYS_GROW(&to->arrays, to->edge, to->rows));
    TRY(ARRAYS_GROW(&to->arrays, to->marks, 2 * columns + links));
    k.stamp = to->marks;
    k.slot = k.stamp + columns;
    k.found = k.slot + columns;
    lay_rows(a, fine, to, &k);
    TRY(ARRAYS_GROW(&to->arrays, to->damp, 2L * to->edges));
    to->kept = to->damp + to->edges;
    return OK;
}

void multigrid_sum(const struct matrix *a, const int *aggregate, struct level *to) {
    for (int i = 0; i < to->rows; i++) to->excess[i] = 0;
    for (int l = 0; l < to->links; l++) to->weight[l] = 0;
    for (int i = 0; i < a->rows; i++) {
        const int row = aggregate ? aggregate[i] : i;
        if (row < 0) continue;
        double excess = a->excess[i];
        for (int l = a->first[a->stride * i]; l < a->first[a->stride * (i + 1)]; l++) {
            if (to->map[l] >= 0)
                to->weight[to->map[l]] += a->weight[l];
            else if (to->map[l] == DROPPED)
                excess += a->weight[l];
        }
        to->excess[row] += excess;
    }
}

/* Sweeps with other blocks' old values converge if the diagonal holds half of the links to them in addition: then M +
 * M' - A is positive. */
void multigrid_smoother(struct level *l, const double *diagonal) {
    for (int i = 0; i < l->rows; i++) {
        double sum = l->excess[i];
        for (int k = l->first[3 * i]; k < l->first[3 * i + 3]; k++) sum += l->weight[k];
        l->diagonal[i] = diagonal ? diagonal[i] : sum;
        l->inverse[i] = l->diagonal[i] > 0 ? 1 / l->diagonal[i] : 0;
    }
    for (int e = 0; e < l->edges; e++) {
        const int i = l->edge[e];
        double out = 0;
        for (int k = l->first[3 * i + 2]; k < l->first[3 * i + 3]; k++) out += l->weight[k];
        l->damp[e] = 0.5 * out;
        l->inverse[i] = l->diagonal[i] > 0 ? 1 / (l->diagonal[i] + l->damp[e]) : 0;
    }
}

status multigrid_vectors(struct level *l) {
    const long n = ((long)l->rows + l->ghosts + 7) / 8 * 8;
    TRY(ARRAYS_GROW(&l->arrays, l->r, 4 * n));
    l->x = l->r + n;
    l->c = l->x + n;
    l->v = l->c + n;
    return OK;
}
