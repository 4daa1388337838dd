/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes postProcessing/grains/<start>/grains.dat of soft grains: a row for the start of a run and for every sample. */
#ifndef SOLVERS_DEM_TABLE_H
#define SOLVERS_DEM_TABLE_H

#include "solvers/dem/dem_run.h"

struct dem_table { /* a zeroed table has no row yet */
    FILE *file;
};
status dem_table_row(struct dem_table *p, const struct dem_run *r);
void dem_table_close(struct dem_table *p);

#endif
