/* What granularMD reads of the time folder it starts from: the fields of the gas's 0/, for where grains are put and how
 * they move, and for the patches of what is written. */
#ifndef SOLVERS_PARTICLE_START_H
#define SOLVERS_PARTICLE_START_H

#include "libcore/grains/packing.h"
#include "solvers/case/case.h"
#include "solvers/grains/grains_models.h"

struct grains_start {
    struct field *field[FIELD_COUNT]; /* NULL: no such file */
    double *alpha, *T, *u[3];         /* [cells] of the lattice, axis 0 fastest; u along computational axes */
};
/* saved: the grains' own state is there, so that only the patches count. */
status grains_start_read(const struct setup *s, const struct grains_models *m, bool saved, struct grains_start *out);
/* On walls no scalar has a value. */
status grains_start_check(const struct setup *s, const struct grains_start *p);
void grains_start_free(struct grains_start *p);
void grains_start_drop(struct grains_start *p); /* all but the patches */

struct grain_start {
    int n;
    double (*x)[3], (*u)[3]; /* computational axes */
    struct packing_report packing;
    bool from_cloud;
};
/* Of lagrangian/grains of the time folder, else from the fields. After an error, too, x and u are to be freed. */
status grain_start_make(const struct setup *s, const struct grains_models *m, const struct grain_box *box,
                        const struct grains_start *fields, struct grain_start *out);

#endif
