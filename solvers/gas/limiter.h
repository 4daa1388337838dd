/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table postProcessing/limiter/<start>/limiter.dat: a row for every step in which something kept the state
 * admissible (libcore/schemes/limit.h). The file is made with its first row. Also what the log says of that which
 * limits steps: the cell, and beds. */
#ifndef SOLVERS_LIMITER_H
#define SOLVERS_LIMITER_H

#include "libcore/gas/gas.h"
#include "solvers/case/case.h"
#include "solvers/case/checksums.h"
#include "solvers/gas/models.h"

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
/* Prints which cell limits an explicit step to `text`: ", cell at ..", with its state; returns its alpha. Collective.
 */
double limiter_cell(struct gas *g, const struct gas_speed *speed, char *text, size_t size);
/* Prints that with what the user may change. Collective. */
void limiter_bound(struct gas *g, const struct gas_speed *speed, const struct gas_models *m, char *text, size_t size);
/* After each plan of a step, by gas_bed_step: says once in the log, `aloud`, why steps are explicit though gas is
 * dense. *steps: such steps in a row so far, 0 at the start; -1: it was said. Collective. */
void limiter_note_beds(long *steps, struct gas *g, bool aloud);
/* Says once, at a log entry to f or at the end of a run (f NULL), that implicit steps damp sound (libcore/gas/dense.c):
 * those that were asked for, by a warning; automatic ones are left out. Collective. */
status limiter_note_damped(bool *said, struct setup *s, const struct case_models *models, const struct gas_counts *n,
                           FILE *f);
void limiter_close(struct limiter_table *l);

#endif
