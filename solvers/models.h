/* What the dictionaries choose: constant/granularProperties, g and shaking, system/fvSchemes and fvSolution. */
#ifndef SOLVERS_MODELS_H
#define SOLVERS_MODELS_H

#include "libcore/gas.h"
#include "solvers/dict.h"
#include <stdio.h>

struct case_models {
    struct gas_models gas;
    double gravity[3];   /* m/s^2, physical axes */
    double min_fraction; /* of the calm time step: below it the gas has collapsed */
    struct dict *properties, *schemes, *solution;
    struct dict *g, *shaking; /* NULL: no such file */
};
/* dim and axis: of the mesh, for gravity in computational axes. Misspelt keys are errors. */
status models_read(const char *case_dir, int dim, const int axis[3], struct case_models **out);
void models_free(struct case_models *m);

void models_list(FILE *f);                               /* every model with its line and parameters */
void boundaries_list(FILE *f);                           /* every boundary condition */
void models_print(FILE *f, const struct case_models *m); /* what was chosen, value by value */

#endif
