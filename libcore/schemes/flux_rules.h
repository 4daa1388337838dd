/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the sensors of the rules of single faces share (docs/physics.md 6.12; flux_private.h states the rules): those of
 * lattices in flux_rules.c, those of polyhedra in libcore/polyhedral/cells_rules.c. */
#ifndef LIBCORE_FLUX_RULES_H
#define LIBCORE_FLUX_RULES_H

#include "libcore/schemes/flux.h"

#include <string.h>

#define STEEP   1.5 /* ratio of the pressures of two cells from which on they are no contact, but may be an expansion */
#define STRONG  30. /* ratio of the pressures of a strong shock */
#define DENSER  2.  /* ratio of the Grueneisen coefficients from which on cells are a contact */
#define LOOSE   0.25 /* share by which the Hugoniot relation may fail within a shock */
#define PARTING 0.5  /* share of the sum of both speeds of sound below which two cells part in an expansion */
#define SIMPLE  0.3  /* share of |dp|/(rho c), the rise of the velocity in a simple wave, above which they do */
#define FRONT   2.   /* ratio of the pressures of two cells from which on they may be a front */

enum rule_switch { RULE_OFF, RULE_ON, RULE_LATTICES }; /* the last: on lattices, off on polyhedra */

struct common_rules { /* parameters of the flux `common` */
    enum rule_switch shocks, expansions, contacts, fronts;
    bool smooth; /* do smooth faces take the linear scheme? */
};
OWN_PARAMS_FIT(struct common_rules);

static inline bool rule_is_wanted(enum rule_switch is, bool lattice) {
    return is == RULE_ON || (is == RULE_LATTICES && lattice);
}
struct wanted_rules {
    bool shocks, expansions, contacts; /* which the flux finds by its stencil */
    bool fronts;                       /* which the engine finds, for struct faces' floor */
    bool smooth;                       /* on lattices, not under gravity: rest is kept by the fluxes, not the states */
};
/* Returns the rules that `common` has with these parameters (NULL: none) on a lattice or on polyhedra; falls: under
 * gravity. */
static inline struct wanted_rules rules_wanted(const struct own_params *params, bool lattice, bool falls) {
    struct common_rules is = {RULE_OFF, RULE_OFF, RULE_OFF, RULE_OFF, false};
    if (params) memcpy(&is, params, sizeof is);
    return (struct wanted_rules){.shocks = rule_is_wanted(is.shocks, lattice),
                                 .expansions = rule_is_wanted(is.expansions, lattice) && !falls,
                                 .contacts = rule_is_wanted(is.contacts, lattice),
                                 .fronts = rule_is_wanted(is.fronts, lattice),
                                 .smooth = is.smooth && lattice && !falls};
}

/* The same of any flux. */
static inline struct wanted_rules rules_of(const struct flux *flux, const struct own_params *params, bool lattice,
                                           bool falls) {
    return flux->ruled ? rules_wanted(params, lattice, falls) : (struct wanted_rules){0};
}

/* Conditions are numbers 0 or 1, which & and | join without a branch. */
ALWAYS_INLINE int exceeds(double ratio, double a, double b) {
    return larger(a, b) > ratio * smaller(a, b);
}

/* Do two cells part, at the speed du, as in a steep expansion? impedance: rho c of both. */
ALWAYS_INLINE int expands(double du, double cl, double cr, const double impedance[2], double pl, double pr) {
    const double wave = 2 * SIMPLE * fabs(pr - pl);
    return (du > 0) & (du < PARTING * (cl + cr)) & (du * (impedance[0] + impedance[1]) > wave) & exceeds(STEEP, pl, pr);
}

/* Do two states a, b, whose velocities differ by the square du2, nearly fulfil du^2 = dp (1/rho_low - 1/rho_high)? */
ALWAYS_INLINE int near_hugoniot(double du2, double rho_a, double rho_b, double pa, double pb) {
    const double jump = (pb - pa) * (rho_b - rho_a), square = du2 * (rho_a * rho_b);
    return (jump > 0) & exceeds(STRONG, pa, pb) & (square > (1 - LOOSE) * jump) & (square < (1 + LOOSE) * jump);
}

/* Returns the speed (m/s) that entropy and shears get beside the front of a shock between two cells that close in at
 * the speed du; 0 where there is no front: the pressures differ FRONT times, and the cells close in as fast as in a
 * simple wave, so that the weight of gas at rest is none. The jumps of u and c are those of an H-correction (Sanders,
 * Morano & Druguet 1998), half of the jump of an acoustic speed. */
ALWAYS_INLINE double front_speed(double du, double cl, double cr, const double impedance[2], double pl, double pr) {
    const double wave = 2 * SIMPLE * fabs(pr - pl);
    const int front = (du > 0) & exceeds(FRONT, pl, pr) & (du * (impedance[0] + impedance[1]) > wave);
    return select_masked(-(uint64_t)front, 0.5 * (du + fabs(cl - cr)), 0);
}

#endif
