/* What granularMD reads of the time folder it starts from: the fields of the gas's 0/, for where grains are put and how
 * they move, and for the patches of what is written. */
#ifndef SOLVERS_PARTICLE_START_H
#define SOLVERS_PARTICLE_START_H

#include "libcore/packing.h"
#include "solvers/case.h"
#include "solvers/particle_models.h"

struct particle_start {
    struct field *field[FIELD_COUNT]; /* NULL: no such file */
    double *alpha, *T, *u[3];         /* [cells] of the lattice, axis 0 fastest; u along computational axes */
};
/* saved: the grains' own state is there, so that only the patches count. */
status particle_start_read(const struct setup *s, const struct particle_models *m, bool saved,
                           struct particle_start *out);
/* On walls no scalar has a value. */
status particle_start_check(const struct setup *s, const struct particle_start *p);
void particle_start_free(struct particle_start *p);
void particle_start_drop(struct particle_start *p); /* all but the patches */

struct grain_start {
    int n;
    double (*x)[3], (*u)[3]; /* computational axes */
    struct packing_report packing;
    bool from_cloud;
};
/* Of lagrangian/grains of the time folder, else from the fields. After an error, too, x and u are to be freed. */
status grain_start_make(const struct setup *s, const struct particle_models *m, const struct grain_box *box,
                        const struct particle_start *fields, struct grain_start *out);

#endif
