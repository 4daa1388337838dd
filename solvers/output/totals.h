/* SPDX-License-Identifier: GPL-3.0-or-later */
/* TIME/uniform/totals: mass and energy at the start of the case, from which the log counts their changes. Each written
 * time has them, so that a restart goes on counting from the same start. */
#ifndef SOLVERS_TOTALS_H
#define SOLVERS_TOTALS_H

#include "solvers/case/case.h"

struct first_total { /* one of them */
    const char *name;
    double value;
};
/* Writes the file into the folder of a time. On the root. */
status totals_save(const struct first_total *first, int n, const char *folder, const char *location,
                   struct checksums *sums);
/* Replaces the totals, which are those of the state that the run starts from, by those of the folder of the start, if
 * it has them. Collective. */
status totals_resume(const struct setup *s, struct first_total *first, int n);

#endif
