/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table postProcessing/limiter/<start>/limiter.dat: a row for every step in which something kept the state
 * admissible (libcore/schemes/limit.h). The file is made with its first row. */
#ifndef SOLVERS_LIMITER_H
#define SOLVERS_LIMITER_H

#include "libcore/gas/gas.h"
#include "solvers/case/case.h"
#include "solvers/case/checksums.h"

struct limiter_table {        /* zeroed: there is no row yet */
    struct gas_counts counts; /* counts at the last row */
    bool fills;               /* is there a density floor? Then the table has columns for it */
    FILE *file;               /* on the root; NULL: not open */
};
/* Writes a row for the step that ended at `now`, if there is anything to say. Collective. Fails (ERR_SYSTEM) if the
 * file cannot be written. */
status limiter_record(struct limiter_table *l, const struct setup *s, const struct gas *g, const struct moment *now);
/* Saves the counts into a time folder, as uniform/limiter, if there are any: rows of a restarted run are those of a run
 * that went through. On the root. */
status limiter_save(const struct gas *g, const char *folder, const char *location, struct checksums *sums);
/* Lets the gas, and the table, go on from the counts and the field `limited` of the time that the run starts from. */
status limiter_resume(struct limiter_table *l, const struct setup *s, struct gas *g);
void limiter_close(struct limiter_table *l);

#endif
