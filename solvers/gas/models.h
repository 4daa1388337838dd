/* What the dictionaries choose: constant/granularProperties, g and shaking, system/fvSchemes and fvSolution. */
#ifndef SOLVERS_MODELS_H
#define SOLVERS_MODELS_H

#include "libcore/gas/gas.h"
#include "solvers/dict/dict.h"
#include <stdio.h>

struct mesh_engine {
    struct model model;
    bool polyhedral;
};
struct forces {               /* constant/g and constant/shaking */
    struct dict *g, *shaking; /* NULL: no such file */
    double gravity[3];        /* m/s^2, physical axes */
    struct sources source;    /* gravity in computational axes, and shaking */
};
struct case_models {
    const struct mesh_engine *engine; /* asked for, NULL: as the mesh is; whether it allows that is checked elsewhere */
    struct sources source;            /* of constant/granularProperties alone, vectors along physical axes */
    struct gas_models gas;
    struct forces forces;
    double min_fraction; /* of the calm time step: below it the gas has collapsed */
    struct dict *properties, *schemes, *solution;
};
/* dim and axis: of the mesh, for gravity in computational axes. Misspelt keys are errors. */
status models_read(const char *case_dir, int dim, const int axis[3], struct case_models **out);
void models_free(struct case_models *m);

/* Marks what constant/granularProperties says of these models as known, for programs without a use for it. */
status models_leave(struct dict *properties);

/* `out` zeroed; also after an error its dictionaries are to be freed. */
status forces_read(const char *case_dir, int dim, const int axis[3], struct forces *out);
void forces_free(struct forces *f);
void forces_list(FILE *f);
void forces_print(FILE *f, const struct forces *forces);

void models_list(FILE *f);     /* every model with its line and parameters */
void boundaries_list(FILE *f); /* every boundary condition */
/* What was chosen, value by value; polyhedral: with the polynomials of that engine, not the lattice's reconstruction.
 */
void models_print(FILE *f, const struct case_models *m, bool polyhedral);

#endif
