/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inside of a fit (polynomial.h): polynomial_fit.c makes it, the kernels of polynomial.c apply it to LANES
 * polyhedral cells at a time.
 *
 * Cells of a batch have lists of different lengths (members, face points, sectors): all get as many entries as the
 * longest list has, number by number for the LANES cells together. A missing entry is the cell itself with weight 0. */
#ifndef LIBCORE_POLYNOMIAL_FIT_H
#define LIBCORE_POLYNOMIAL_FIT_H

#include "libcore/schemes/polynomial.h"

/* VECTOR lanes and PART coefficients are summed at a time: MAX_VAR times these, in vectors, fit the registers. */
enum { LANES = 32, VECTOR = 8, MAX_QUADRATIC = POLYHEDRA_MOMENTS };
enum { LABELS = 4 }; /* states that cells are compared with */

#define PART(coefficients) ((coefficients) > 5 ? 3 : (coefficients))

struct entries {
    int width;    /* numbers per entry */
    int *start;   /* [nbatches + 1] */
    int *cell;    /* [start[nbatches]][LANES] or NULL */
    double *data; /* [start[nbatches]][width][LANES] */
};
/* Sectors have single precision, in units of the scales of the cell: they count where the solution is not smooth, and
 * are of first order there. Where it is smooth, the polynomial holds their round-off, 1e-7, times the share of a sector
 * and times the square of (tau/(I + epsilon)): less than the round-off of the quadratic. */
struct sectors {
    int *start;      /* [nbatches + 1] the sectors of each batch */
    float *share;    /* [start[nbatches]][LANES] linear weight of each; 0: the cell has no such sector */
    int *first;      /* [start[nbatches] + 1] the entries of each */
    int *used;       /* [first[start[nbatches]]] which entries of `member` these are, of those of the batch */
    float *data;     /* [first[start[nbatches]]][dim][LANES] their weights in the gradient */
    float *change;   /* [entries][nvar][LANES] of one batch: changes in the frames of the cells, over the scales */
    float *taken;    /* [entries of one sector][nvar][LANES] those of its members */
    float *gradient; /* [sectors][nvar][dim][LANES] of one batch */
    float *weight;   /* [sectors][LANES] of one batch: smoothness, then nonlinear weights */
};
struct calm {               /* libcore/schemes/polynomial_calm.c */
    unsigned char *uniform; /* [nbatches LANES] of the last fit of a cell */
    /* NULL where no work is spared; [size] which of `state` a cell, ghost or mirror is, VARIED: none */
    unsigned char *label;
    unsigned char *known, *still; /* [nbatches LANES] is the stencil uniform; also of the cells across the faces? */
    int n;                        /* states; 0: known and still are not valid */
    double state[LABELS + 1][MAX_VAR]; /* one more for a candidate */
};
struct ahead {          /* libcore/schemes/polynomial_ahead.c: what memory is not yet asked for */
    const char *at[7];  /* pieces */
    long left[7], part; /* lines of the cache in each; how many are asked for at a time */
    int now, n;         /* the piece that is next; pieces */
};
struct fit {
    const struct polyhedra *polyhedra; /* borrowed */
    const struct polynomial *kind;
    int nvar, nbatches; /* nvar = components of u + 2 */
    /* Members of the stencil, with the weights of their values in every coefficient. In each batch these stand in the
     * order in which they are read: [LANES/VECTOR][width/PART][entries][PART][VECTOR]. */
    struct entries member;
    struct entries halfway; /* linear: half the offsets to first-ring members, over h; no cells */
    struct sectors sector;  /* CWENO3 */
    struct entries moment;  /* CWENO3: one entry, moments over h^2 */
    struct entries point;   /* face points of the cells, arms over h; no cells */
    double *change;         /* values of the members of one batch less the cell's own, [entries][nvar][LANES] */
    double *value;          /* [nvar][nvalues], those of a batch from entry slot[batch] on, entry by entry of `point` */
    long nvalues;           /* values of one variable */
    int *slot;              /* [nbatches] */
    double *held;           /* of fit_hold: the values of a batch; NULL */
    const double *rest[MAX_VAR], *near; /* of fit_rest, or NULL */
    struct calm *calm;                  /* of fit_watch, or NULL */
    const unsigned char *spared;        /* of fit_spare, or NULL */
    struct ahead *ahead;
    double least, most; /* of fit_keep; most 0: no density is kept in between */
    int *place[2];      /* [points] where a face point's value in the left and in the right cell stands */
};

/* Finds members and weights (1/m) of the unlimited gradients of linear fits in cells < nnear: to the neighbours across
 * faces, or to the whole stencil where these do not span the axes. The caller frees them by entries_free. */
status fit_gradients(const struct fit *f, struct entries *r);
void entries_free(struct entries *r);

/* Lists what the fit of a batch reads (none from nbatches on); asks memory for the next part of what is listed. */
void ahead_list(const struct fit *f, int batch);
void ahead_ask(const struct fit *f);

/* Are the stencils of all cells of a batch known to be uniform, or all cells spared? Then makes their polynomials
 * constants, as the fit of uniform cells does. */
bool calm_batch(const struct fit *f, int batch, const double *const *U);
void calm_free(struct calm *c);

#endif
