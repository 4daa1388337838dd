/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Kinds of carried quantities (docs/physics.md 7.5): scalars phi, a value per mass, that ride with the gas and do not
 * act on it:
 *     (rho phi)_t + div(rho u phi + rho f phi (1 - phi) d - rho D grad phi) = 0,
 * d being the unit vector against gravity. A kind is a row of carried_table with the function that gives D and f. */
#ifndef LIBCORE_CARRIED_H
#define LIBCORE_CARRIED_H

#include "libcore/models/eos.h"
#include "libcore/models/kernel.h"
#include "libcore/models/param.h"

enum { CARRIED_MOST = 8 }; /* quantities that a gas may carry */

/* What a kind has besides being carried, and what it asks for. */
enum carried_terms {
    CARRIED_DIFFUSES = 1,   /* D is not 0 */
    CARRIED_PERCOLATES = 2, /* f is not 0: there must be gravity */
    CARRIED_STRESS = 4      /* it asks for the slope of the kinetic stress rho T along d */
};

struct carried_line { /* n <= BATCH cells */
    int n;
    const struct material *material;
    const double *rho, *T; /* [n] kg/m^3, m^2/s^2 */
    const double *slope;   /* [n] Pa/m: d(rho T)/dd; NULL unless CARRIED_STRESS */
};

struct carried_kind {
    struct model model; /* its parameters fill a struct of the kind's own */
    double low, high;   /* phi of the start and of patches lies within; the scheme keeps it there */
    unsigned (*terms)(const struct own_params *params); /* bits of enum carried_terms */
    /* Computes D (m^2/s, >= 0) and f (m/s) of a line of cells; called if there are terms. */
    void (*coefficients)(const struct own_params *params, const struct carried_line *cells, double *restrict D,
                         double *restrict f);
};
extern const struct carried_kind carried_table[];
extern const int carried_count;

struct carried_choice { /* a quantity of a case */
    const char *name;   /* its field; owned by the dictionary */
    const struct carried_kind *kind;
    struct own_params params;
};

#endif
