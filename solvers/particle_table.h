/* postProcessing/grains/<start>/grains.dat: what all grains have together, a row for the start and for every step. */
#ifndef SOLVERS_PARTICLE_TABLE_H
#define SOLVERS_PARTICLE_TABLE_H

#include "libcore/grains.h"
#include "solvers/case.h"

struct particle_totals {                    /* all in the frame of the box */
    double t;                               /* s */
    double T;                               /* m^2/s^2: variance of a velocity component over all grains */
    double kinetic, potential, momentum[3]; /* J, kg m/s along computational axes */
    struct grain_counts counts;
};
struct particle_totals particle_totals(const struct grains *g, const struct grain_box *box, double mass);

struct particle_table {           /* zeroed: no row yet */
    struct particle_totals start; /* of this run */
    FILE *file;
};
status particle_table_row(struct particle_table *p, const struct setup *s, const struct grain_box *box,
                          const struct particle_totals *now);
void particle_table_close(struct particle_table *p);

#endif
