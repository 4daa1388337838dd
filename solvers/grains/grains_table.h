/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes postProcessing/grains/<start>/grains.dat: totals over all grains, a row for the start and for every step. */
#ifndef SOLVERS_GRAINS_TABLE_H
#define SOLVERS_GRAINS_TABLE_H

#include "libcore/grains/grains.h"
#include "solvers/case/case.h"

struct grains_totals {                      /* all in the frame of the box */
    double t;                               /* s */
    double T;                               /* m^2/s^2: variance of a velocity component over all grains */
    double kinetic, potential, momentum[3]; /* J, kg m/s along computational axes */
    struct grain_counts counts;
    const double (*impulse)[3]; /* of grains_impulses */
    double kind_T[GRAIN_KINDS]; /* of grains_kinds_T */
};
struct grains_totals grains_totals(const struct grains *g, const struct grain_box *box, double mass);

struct grains_table {           /* a zeroed table has no row yet */
    struct grains_totals start; /* totals at the start of this run */
    FILE *file;
    int kinds;
    const char *const *kind_name; /* [kinds] of a mixture */
};
status grains_table_row(struct grains_table *p, const struct setup *s, const struct grain_box *box,
                        const struct grains_totals *now);
void grains_table_close(struct grains_table *p);

#endif
