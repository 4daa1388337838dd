/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the seconds of a run went: laps of the clock of this rank, which follow one another without a gap. Waiting for
 * other ranks counts where the rank waits. */
#ifndef SOLVERS_TIMING_H
#define SOLVERS_TIMING_H

#include "solvers/case/medium.h"

enum lap { LAP_START, LAP_PLAN, LAP_STEP, LAP_LOG, LAP_OUTPUT, LAPS };
struct timing {
    double clock; /* s: the end of the last lap */
    double spent[LAPS];
};

void timing_start(struct timing *t);
void timing_lap(struct timing *t, enum lap lap); /* the time since the last lap went to this one */
/* Prints a table of seconds and shares: the laps, and of the steps the parts that the medium knows. */
void timing_print(const struct timing *t, const struct medium *m, FILE *f);

#endif
