/* What the dictionaries of granularSegregation choose: constant/segregationProperties, system/fvSchemes, fvSolution. */
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
    struct dict *properties, *schemes, *solution, *g; /* g: NULL where it is not there */
    enum percolation percolation;
    struct expr *velocity_law;    /* of x y z; m/s */
    struct expr *diffusivity_law; /* of x y z phi shearRate; m^2/s; NULL: the number */
    bool sheared;                 /* it has shearRate */
    double velocity, diffusivity;
    double A, B, q, rho;       /* (q/rho) d/dy A exp(B|y|) */
    bool has_direction;        /* with two or three solved axes */
    double direction[3];       /* unit vector along which f is counted, physical axes; default: against g */
    const char *case_dir;      /* of a granularGas run whose rho T is the kinetic stress */
    double time;               /* s, of it; NAN: the latest */
    const char *velocity_case; /* of a granularGas run whose U carries; NULL: the start folder's U */
    double velocity_time;      /* s, of it; NAN: the latest */
    bool weighted;             /* its rho is the weight */
    struct segregation_scheme scheme;
    bool on_walls;         /* the end cells' values stand on the walls: the paper's line */
    int damped;            /* steps at the start of the case */
    double time_tolerance; /* of an adaptive step */
};
status segregation_models_read(const char *case_dir, struct segregation_models **out);
void segregation_models_free(struct segregation_models *m);
void segregation_models_list(FILE *f);
void segregation_boundaries_list(FILE *f);
void segregation_models_print(FILE *f, const struct segregation_models *m);
double segregation_diffusivity(const struct segregation_models *m, const double x[3], double phi, double shear_rate);
/* Is it a number of 0 or more there, whatever phi? */
status segregation_diffusivity_check(const struct segregation_models *m, const double x[3], double shear_rate);
const char *segregation_closure_name(const struct segregation_models *m);
const char *segregation_iteration_name(const struct segregation_models *m);

#endif
