/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Friction of grains that stay in contact: a table of laws for its coefficient mu(I). docs/physics.md 4.10 has the
 * equations.
 *
 * Where gas is packed, contacts that last carry shear. Their stress tau obeys
 *     |tau| <= s(alpha) (mu(I) p + cohesion),  |tau| = sqrt(tau:tau/2),
 * with p of the equation of state, and has the direction of the strain rate D' where the grains slide. The inertial
 * number I = 2 |D'| sigma sqrt(rho_grain/p) compares the shear rate with the rate at which p rearranges grains. The
 * share s rises from 0 at alphaFriction to 1 at alphaSolid. The viscosities of the collisions fade as 1 - s, as they
 * would count the same stress twice. */
#ifndef LIBCORE_FRICTION_H
#define LIBCORE_FRICTION_H

#include "libcore/models/closure.h"

struct friction_params {                /* of any row; what a row does not have has its default */
    double mu_static, mu_dynamic, I0;   /* mu at I = 0 and at large I; the I half way between. Coulomb: equal mu */
    double alpha_friction, alpha_solid; /* packing fractions between which s rises from 0 to 1, linearly */
    double modulus;                     /* shear modulus of packed gas, in units of the greatest pressure of the bed */
    double cohesion;                    /* Pa, for disks N/m: adds to the yield stress */
    double surface_cohesion;            /* k of the numerical cohesion of surface cells */
    double heating;                     /* part of the work of friction that heats the gas; 0 .. 1 */
};

struct friction {
    struct model model; /* its parameters fill a struct friction_entries */
    bool on;            /* false: there is no friction */
    /* Computes mu of n <= BATCH places of inertial number >= 0. NULL where `on` is false. */
    void (*coefficient)(const struct friction_params *p, int n, const double *restrict inertia, double *restrict mu);
};

extern const struct friction friction_table[];
extern const int friction_count;
const struct friction *friction_find(const char *name); /* NULL: there is no such law */
static inline bool friction_acts(const struct friction *f) {
    return f && f->on;
}

/* Returns the parameters that the entries of a row mean, with the defaults that depend on others. own: as the row's
 * table fills it, or zeros for a row without parameters. */
struct friction_params friction_params(const struct own_params *own, const struct material *m);
/* Puts these defaults into the entries, for a log that prints them. */
void friction_complete(struct own_params *own, const struct material *m);
/* Returns what is wrong with parameters together, which the ranges of their tables cannot tell; NULL: nothing. */
const char *friction_objection(const struct friction_params *p);
/* Computes s of n densities. */
void friction_share(const struct friction_params *p, const struct material *m, int n, const double *restrict rho,
                    double *restrict share);

#endif
