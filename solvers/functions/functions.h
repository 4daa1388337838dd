/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Function objects, the entries of controlDict's `functions`, with OpenFOAM's names and file formats. Each type is one
 * row of a table. */
#ifndef SOLVERS_FUNCTIONS_H
#define SOLVERS_FUNCTIONS_H

#include "solvers/case/case.h"
#include <stdio.h>

struct functions;
/* Reads the dictionary and checks all of it; opens no file. Collective. */
status functions_make(const struct setup *s, struct functions **out);
void functions_free(struct functions *f);
void functions_list(const struct medium_type *m, FILE *f); /* prints every type with its line */

void functions_keywords(struct keywords *k, const struct medium_type *m); /* goes through all their keywords */

/* Returns the first time after t at which a function object wants a step to end; INFINITY: none does. Of a medium whose
 * steps make its bits, only writeControl adjustable does; averages take values between the ends of a step. */
double functions_next(const struct functions *f, double t);
/* Lets averages keep what they need of the start of a step from t to `end`. Collective. */
status functions_prepare(const struct functions *f, double t, double end);
/* Lets averages take in the end of a step, before any of it is written; before NULL: the start. Collective. */
status functions_collect(struct functions *f, const struct moment *before, const struct moment *now);
/* Saves the sums that averages need at a restart into the time folder that w writes. Collective. */
status functions_save(const struct functions *f, const struct field_writer *w, struct checksums *sums);
/* Executes the function objects that are due; before NULL: the start, when all are. name: of the time, for files.
 * Collective. */
status functions_execute(struct functions *f, const struct moment *before, const struct moment *now, const char *name);
/* Does one of them read the times that the run writes, as soon as they are written? */
bool functions_read_times(const struct functions *f);

#endif
