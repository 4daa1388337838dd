/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cells as closures see them, the laws of transport (transport.h) and of cooling (cooling.h). A law says in its row
 * what it needs besides density and temperature; the engines compute that for laws that ask, and for no others. */
#ifndef LIBCORE_CLOSURE_H
#define LIBCORE_CLOSURE_H

#include "libcore/models/eos.h"

enum grains_shape { GRAINS_DISKS = 1, GRAINS_SPHERES = 2, GRAINS_BOTH = GRAINS_DISKS | GRAINS_SPHERES };
static inline enum grains_shape shape_of(const struct material *m) {
    return m->disks ? GRAINS_DISKS : GRAINS_SPHERES;
}

enum { NEEDS_SHEAR_RATE = 1 }; /* bits of `needs` in the row of a law */

struct closure_line { /* n <= BATCH cells */
    const struct eos *eos;
    const struct material *material;
    int n;
    const double *rho; /* > 0 */
    const double *T;   /* > 0; NULL for laws of cooling, which advance eps */
    /* 1/s, frozen over a half step: sqrt(2 D':D') with D' = D - tr(D)/d I the deviatoric part of the rate of strain D,
     * d = 2 for disks and 3 for spheres; in a shear flow (y gamma, 0, 0) that is |gamma|. Exactly 0 in uniform gas, so
     * a law must bear 0. NULL unless the law needs it. */
    const double *shear_rate;
    /* 1 - s, the share of the stress that impacts carry where contacts with friction carry the share s, 0 to 1; NULL: 1
     * everywhere. Correlations between impacts fade with it. */
    const double *by_impacts;
    /* Is this the second half of a step? What depends on T as a coefficient is frozen at the end of the half step then,
     * else at its start, so that both halves together are of second order. */
    bool late;
};

#endif
