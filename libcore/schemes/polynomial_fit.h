/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inside of a fit (polynomial.h): polynomial_fit.c makes it, the kernels of polynomial.c apply it to LANES
 * polyhedral cells at a time.
 *
 * Cells of a batch have lists of different lengths (members, face points, sectors): all get as many entries as the
 * longest list has, number by number for the LANES cells together. A missing entry is the cell itself with weight 0. */
#ifndef LIBCORE_POLYNOMIAL_FIT_H
#define LIBCORE_POLYNOMIAL_FIT_H

#include "libcore/schemes/polynomial.h"

enum { LANES = 32, MAX_QUADRATIC = POLYHEDRA_MOMENTS };

struct entries {
    int width;    /* numbers per entry */
    int *start;   /* [nbatches + 1] */
    int *cell;    /* [start[nbatches]][LANES] or NULL */
    double *data; /* [start[nbatches]][width][LANES] */
};
struct fit {
    const struct polyhedra *polyhedra; /* borrowed */
    const struct polynomial *kind;
    int nvar, nbatches;     /* nvar = components of u + 2 */
    struct entries member;  /* members of the stencil, with the weights of their values in every coefficient */
    struct entries halfway; /* linear: half the offsets to first-ring members, over h; no cells */
    struct entries share;   /* CWENO3: linear weight of each sector; 0: the sector is left out */
    int *uses;              /* CWENO3: [share.start[nbatches]] how many entries of `member` a sector has */
    struct entries sector;  /* CWENO3: their weights in the gradients of the sectors, sector by sector; no cells */
    int *used;              /* CWENO3: [sector.start[nbatches]] which these are, of those of the batch */
    struct entries moment;  /* CWENO3: one entry, moments over h^2 */
    struct entries point;   /* face points of the cells, arms over h; no cells */
    int *all;               /* [most entries] 0, 1, .. */
    double *change;         /* values of the members of one batch less the cell's own, [entries][nvar][LANES] */
    double *gradient;       /* CWENO3: gradients of the sectors of one batch, [nvar][sectors][dim][LANES] */
    double *weight;         /* CWENO3: nonlinear weights of the sectors of one batch, [sectors][LANES] */
    double *value;          /* [nvar][nvalues], those of a batch from entry slot[batch] on, entry by entry of `point` */
    long nvalues;           /* values of one variable */
    int *slot;              /* [nbatches] */
    const double *rest[MAX_VAR], *near; /* of fit_rest, or NULL */
    double least, most;                 /* of fit_keep; most 0: no density is kept in between */
    int *place[2]; /* [points] where a face point's value in the left and in the right cell stands */
};

/* Finds members and weights (1/m) of the unlimited gradients of linear fits in cells < nnear: to the neighbours across
 * faces, or to the whole stencil where these do not span the axes. The caller frees them by entries_free. */
status fit_gradients(const struct fit *f, struct entries *r);
void entries_free(struct entries *r);

#endif
