/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the fluxes share: states that are reconstructed to faces, and the fluxes that have a file of their
 * own. */
#ifndef LIBCORE_FLUX_PRIVATE_H
#define LIBCORE_FLUX_PRIVATE_H

#include "libcore/schemes/characteristic.h"

struct face_states { /* states at n faces, from one side */
    double rho[BATCH], u[MAX_DIM][BATCH], eps[BATCH], p[BATCH], c[BATCH] /* c^2, not c */, gruneisen[BATCH];
    double good[BATCH];
};

/* Reconstructs states to the faces from one side (+1: left, -1: right), rho, u and T (as eps) by the same operator. A
 * state that is not admissible is replaced by the cell's. */
void flux_sided_states(const struct faces *f, const struct eos *eos, const struct material *m, int side,
                       const struct reconstruct *r, struct face_states *s);

/* ---- centred fluxes (flux_force.c) ---- */

struct musta {        /* parameters of MUSTA */
    double tolerance; /* it stops when F changes by less than this part of itself */
    int stages;       /* most times that the two states are advanced */
};
OWN_PARAMS_FIT(struct musta);

void flux_force(const struct faces *f, const struct eos *eos, const struct material *m, const struct reconstruct *r);
void flux_musta(const struct faces *f, const struct eos *eos, const struct material *m, const struct reconstruct *r);

#endif
