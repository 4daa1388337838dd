/* Values by cell on a forest (the lattice cut into tiles, forest.h): moved to and from the order of the polyMesh,
 * summed, found by place. */
#include <math.h>
#include <stdlib.h>

#include "mesh/lattice/forest_private.h"

static long row_offset(const struct forest *f, int j, int k) {
    return f->first + j * f->stride[1] + k * f->stride[2];
}

status forest_gather(const struct forest *f, const double *const *data, int variable, double *all) {
    double *mine = NULL, *values = NULL, *next;
    long ncells = 0;
    for (int t = 0; t < f->ntiles; t++) ncells += (long)f->tile[t].n[0] * f->tile[t].n[1] * f->tile[t].n[2];
    TRY(comm_agree(f->comm, allocate(&mine, ncells, sizeof *mine, "the cells of this rank")));
    next = mine;
    for (int t = 0; t < f->ntiles; t++) {
        const int *n = f->tile[t].n;
        const double *block = data[t] + variable * f->size;
        for (int k = 0; k < n[2]; k++)
            for (int j = 0; j < n[1]; j++)
                for (int i = 0; i < n[0]; i++) *next++ = block[row_offset(f, j, k) + i];
    }
    status s = comm_gather(f->comm, mine, ncells, &values, NULL);
    free(mine);
    TRY(s);
    if (comm_root(f->comm))
        for (int c = 0; c < f->ncells_all; c++) all[f->hidden->order[c]] = values[c];
    free(values);
    return OK;
}

void forest_scatter(const struct forest *f, const double *all, int variable, double *const *data) {
    for (int t = 0; t < f->ntiles; t++) {
        const int *n = f->tile[t].n, *cell = f->tile[t].cell;
        double *block = data[t] + variable * f->size;
        for (int k = 0; k < n[2]; k++)
            for (int j = 0; j < n[1]; j++)
                for (int i = 0; i < n[0]; i++) block[row_offset(f, j, k) + i] = all[*cell++];
    }
}

status forest_sum(const struct forest *f, const double *per_tile, double *sum) {
    double *all = NULL;
    long n = 0;
    *sum = 0;
    TRY(comm_gather(f->comm, per_tile, f->ntiles, &all, &n));
    for (long t = 0; t < n; t++) *sum += all[t];
    free(all);
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

static int find_tile(const struct forest_private *h, const int i[3]) {
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

void forest_locate(const struct forest *f, const double point[3], int *tile, long *offset) {
    int choice[3][2] = {{0}}, n[3] = {1, 1, 1}, id = -1, i[3] = {0};
    *tile = -1;
    *offset = -1;
    for (int k = 0; k < f->dim; k++) n[k] = candidates(f, k, point[f->axis[k]], choice[k]);
    for (int pick = 0; pick < 8 && id < 0; pick++) {
        bool valid = true;
        for (int k = 0; k < 3; k++) {
            i[k] = choice[k][pick >> k & 1];
            valid = valid && (pick >> k & 1) < n[k];
        }
        if (valid) id = find_tile(f->hidden, i);
    }
    if (id < f->hidden->trees->first || id >= f->hidden->trees->first + f->ntiles) return;
    *tile = id - f->hidden->trees->first;
    *offset = f->first;
    for (int k = 0; k < 3; k++) *offset += (i[k] - f->tile[*tile].low[k]) * f->stride[k];
}
