/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values of all cells of a mesh (or of any things with numbers from 0 on) in slices, one a rank, in the order of their
 * numbers: in what files hold, each rank reads and writes its slice. No rank holds more than its slice and what it asks
 * for. */
#ifndef MESH_SHARE_H
#define MESH_SHARE_H

#include "mesh/base/delivery.h"

struct share {
    const struct comm *comm;
    long n;          /* cells of all ranks */
    long first, end; /* the slice of this rank: first .. end - 1 */
};
struct share share_make(const struct comm *c, long n);
struct share share_at_rank(const struct share *s, int rank); /* as another rank has it */
int share_rank(const struct share *s, long cell);            /* the rank whose slice has the cell */

/* Sends record[n][ints], which begin with cells, to the ranks whose slices have these (delivery.h). Collective. */
status share_deliver(const struct share *s, long n, int ints, const int *record, const char *what,
                     struct delivery *out);
/* Sets out[n][components] to the values of the cells whose numbers are listed, from the ranks' slices. Collective:
 * every rank lists those it wants, or none. */
status share_fetch(const struct share *s, int components, const double *slice, long n, const int *cell, double *out);
/* Puts values[n][components] of the cells listed into the ranks' slices. Collective: each cell is listed by one rank at
 * most. */
status share_store(const struct share *s, int components, long n, const int *cell, const double *values, double *slice);
/* Gathers what share_store would put into the slices in the root's all[n][components], which is NULL on the other
 * ranks. Collective. */
status share_gather(const struct share *s, int components, long n, const int *cell, const double *values, double *all);
/* The same of slices. */
void share_collect(const struct share *s, int components, const double *slice, double *all);

#endif
