/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lattice that is cut into slabs, one a rank: each rank has some of its layers across the last axis, those of rank 0
 * first. What lies beyond the first and the last of them comes from the ranks beside. */
#ifndef LIBCORE_SLAB_H
#define LIBCORE_SLAB_H

#include "mesh/base/comm.h"

struct slab {
    const struct comm *comm; /* NULL: one rank has all layers */
    bool low, high;          /* does another rank have the layer below the first, above the last? */
    long layer;              /* values of a layer */
    /* [layer] what slab_swap has brought from there; 0 where no rank is */
    double *below, *above, *first, *last;
    struct comm_link link[2];
    struct comm_exchange *exchange;
};
/* Makes a slab; `cyclic` says that the last layer of all borders on the first one. c is borrowed and may be NULL. Call
 * slab_free after success and failure. */
status slab_make(const struct comm *c, bool cyclic, long layer, struct slab *out);
void slab_free(struct slab *s);
/* Sends the values of this rank's first and last layers to the ranks beside. Collective. */
void slab_swap(struct slab *s, const double *first, const double *last);
/* As comm_max, comm_take_turn and comm_end_turn. */
void slab_max(const struct slab *s, double *value, int n);
void slab_take_turn(const struct slab *s, double *value, int n);
void slab_end_turn(const struct slab *s, double *value, int n);

#endif
