/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The places of a lattice that a rank has: its slab, some layers across the last solved axis, and the layers of other
 * ranks beside them, where there are any. Files have values in slices (mesh/base/share.h); here they go from the one to
 * the other. */
#ifndef SOLVERS_SEGREGATION_PLACES_H
#define SOLVERS_SEGREGATION_PLACES_H

#include "mesh/base/share.h"
#include "solvers/case/case.h"

struct segregation_places {
    const struct lattice *lattice; /* borrowed */
    double first[3];               /* m: the centre of cell 0, for axes that are not solved */
    struct share share;            /* the slices of all cells */
    int layer, layers;             /* position of the slab's first layer along the last axis; number of its layers */
    int below, above;              /* 0 or 1: the layers of other ranks that stand in front of it and behind it */
    long across;                   /* places of a layer */
    long n, own_first, nown;       /* all places; the first one of the slab and how many it has */
    int *cell;                     /* [n] number in the mesh, -1 in a hole */
    long ncells;                   /* of these, not counting holes and layers of other ranks */
};
/* Deals the layers of the case's lattice to the ranks; fails if there are fewer than ranks. Collective. Call
 * segregation_places_free after success and failure. */
status segregation_places_make(const struct setup *s, struct segregation_places *out);
void segregation_places_free(struct segregation_places *p);
/* Position of a place in the whole lattice, and its centre (m). */
void segregation_places_at(const struct segregation_places *p, long place, int at[3]);
void segregation_places_centre(const struct segregation_places *p, long place, double x[3]);

/* Allocates out[n][components] and sets it to the values of the cells, 0 in holes; from slices, or from whole[cells of
 * the mesh][components], which every rank has. The first is collective. */
status segregation_places_fetch(const struct segregation_places *p, int components, const double *slice, double **out);
status segregation_places_take(const struct segregation_places *p, int components, const double *whole, double **out);
/* Sets the slices to own[nown][components], the values in the slab. Collective. */
status segregation_places_store(const struct segregation_places *p, int components, const double *own, double *slice);

#endif
