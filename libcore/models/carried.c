/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of kinds of carried quantities (carried.h; docs/physics.md 7.5). */
#include "libcore/models/carried.h"

struct passive {
    double diffusivity;
};
OWN_PARAMS_FIT(struct passive);
#define PARAM_STRUCT struct passive
static const struct param passive_param[] = {
    NUMBER("diffusivity", diffusivity, 0, FROM_TO(0, HUGE_VAL), UNIT(0, 2, -1), "D"),
};
#undef PARAM_STRUCT

static unsigned passive_terms(const struct own_params *params) {
    struct passive own;
    memcpy(&own, params, sizeof own);
    return own.diffusivity > 0 ? CARRIED_DIFFUSES : 0;
}

static void passive_coefficients(const struct own_params *params, const struct carried_line *cells, double *restrict D,
                                 double *restrict f) {
    struct passive own;
    memcpy(&own, params, sizeof own);
    for (int i = 0; i < cells->n; i++) {
        D[i] = own.diffusivity;
        f[i] = 0;
    }
}

/* The fraction phi of the small grains of a mixture (docs/physics.md 11.1 and 11.2): f is a constant, or the slope of
 * the kinetic stress, f = (q/rho_s) d(rho T)/dd, rho_s being the density of the grains. */
enum percolation_law { BY_SPEED, BY_STRESS };
struct segregation_kind {
    double velocity, q, grains, diffusivity;
    enum percolation_law law;
};
OWN_PARAMS_FIT(struct segregation_kind);
#define PARAM_STRUCT struct segregation_kind
static const char *const percolation_words[] = {"constant", "kineticStress", NULL};
static const struct param segregation_param[] = {
    CHOICE("percolation", law, 0, percolation_words,
           "what f is, counted against gravity: velocity, or (q/rho) d(rho T)"),
    NUMBER("velocity", velocity, 0, ANY_NUMBER, UNIT(0, 1, -1), "f with percolation constant; < 0: small grains fall"),
    NUMBER("q", q, 0, ANY_NUMBER, UNIT(0, 0, 1), "of percolation kineticStress"),
    NUMBER("rho", grains, 1, POSITIVE, UNIT(1, -3, 0), "density of the grains, of percolation kineticStress"),
    NUMBER("diffusivity", diffusivity, 0, FROM_TO(0, HUGE_VAL), UNIT(0, 2, -1), "D"),
};
#undef PARAM_STRUCT

static unsigned segregation_terms(const struct own_params *params) {
    struct segregation_kind own;
    memcpy(&own, params, sizeof own);
    const bool stress = own.law == BY_STRESS && own.q != 0, speed = own.law == BY_SPEED && own.velocity != 0;
    return (own.diffusivity > 0 ? CARRIED_DIFFUSES : 0) | (stress ? CARRIED_PERCOLATES | CARRIED_STRESS : 0) |
           (speed ? CARRIED_PERCOLATES : 0);
}

static void segregation_coefficients(const struct own_params *params, const struct carried_line *cells,
                                     double *restrict D, double *restrict f) {
    struct segregation_kind own;
    memcpy(&own, params, sizeof own);
    for (int i = 0; i < cells->n; i++) {
        D[i] = own.diffusivity;
        f[i] = cells->slope ? own.q / own.grains * cells->slope[i] : own.velocity;
    }
}

const struct carried_kind carried_table[] = {
    {MODEL_WITH("passive", "scalar that the gas carries, with a diffusivity", passive_param), -HUGE_VAL, HUGE_VAL,
     passive_terms, passive_coefficients},
    {MODEL_WITH("segregation", "fraction of the small grains of a mixture, which percolate along gravity",
                segregation_param),
     0, 1, segregation_terms, segregation_coefficients},
};
const int carried_count = sizeof carried_table / sizeof *carried_table;
