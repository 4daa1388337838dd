/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The choices in the dictionaries of granularSegregation: constant/segregationProperties, system/fvSchemes,
 * fvSolution. Percolation velocities and diffusivities: docs/physics.md 11.2. */
#ifndef SOLVERS_SEGREGATION_MODELS_H
#define SOLVERS_SEGREGATION_MODELS_H

#include "libcore/segregation/segregation.h"
#include "solvers/case/fields.h"
#include "solvers/dict/dict.h"
#include "solvers/dict/expr.h"
#include <stdio.h>

extern const struct field_kind segregation_phi;

enum percolation { PERCOLATION_CONSTANT, PERCOLATION_EXPRESSION, PERCOLATION_EXPONENTIAL, PERCOLATION_STRESS };
struct segregation_models {
    struct dict *properties, *schemes, *solution, *g; /* g: NULL without constant/g */
    enum percolation percolation;
    struct expr *velocity_law;    /* f(x, y, z), m/s; NULL: a number or another type */
    struct expr *diffusivity_law; /* D(x, y, z, phi, shearRate), m^2/s; NULL: the number */
    bool sheared;                 /* does D depend on the shear rate? */
    double velocity, diffusivity;
    int diffusivity_kind;      /* 0: the number, 1: the law */
    double A, B, q, rho;       /* f = (q/rho) d/dy A exp(B|y|): kg/m/s^2, 1/m, s, kg/m^3 */
    bool has_direction;        /* is `direction` set? needed with two or three solved axes */
    double direction[3];       /* unit vector along which f is counted, physical axes; default: against g */
    const char *case_dir;      /* case of a granularGas run whose rho T is the kinetic stress */
    double time;               /* s, time of that case; NAN: the latest */
    const char *velocity_case; /* case of a granularGas run whose U carries; NULL: the start folder's U */
    double velocity_time;      /* s, time of that case; NAN: the latest */
    bool weighted;             /* is its rho the weight? */
    struct segregation_scheme scheme;
    bool on_walls;         /* do the end cells' values stand on the walls, as on the paper's line? */
    int damped;            /* number of damped steps at the start of the case */
    double time_tolerance; /* error allowed to an adaptive step (segregation_advance) */
};
status segregation_models_read(const char *case_dir, struct segregation_models **out);
void segregation_models_free(struct segregation_models *m);
void segregation_models_list(FILE *f);
void segregation_models_keywords(struct keywords *k); /* goes through all that a run of segregation reads */
void segregation_boundaries_list(FILE *f);
void segregation_models_print(FILE *f, const struct segregation_models *m);
/* Returns D at the place x (m), m^2/s; shear_rate in 1/s. */
double segregation_diffusivity(const struct segregation_models *m, const double x[3], double phi, double shear_rate);
/* Fails unless D at x is a number of 0 or more for every phi. */
status segregation_diffusivity_check(const struct segregation_models *m, const double x[3], double shear_rate);
const char *segregation_closure_name(const struct segregation_models *m);
const char *segregation_iteration_name(const struct segregation_models *m);

#endif
