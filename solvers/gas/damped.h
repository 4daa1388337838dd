/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Says that implicit acoustics damps sound (libcore/gas/dense.c). */
#ifndef SOLVERS_DAMPED_H
#define SOLVERS_DAMPED_H

#include "libcore/gas/gas.h"
#include "solvers/case/case.h"
#include "solvers/gas/models.h"

#include <stdio.h>

/* Says once, at a log entry to f or at the end of a run (f NULL), that implicit steps damp sound: those that were asked
 * for, by a warning; automatic ones are left out. Collective. */
status damped_say(bool *said, struct setup *s, const struct case_models *models, const struct gas_counts *n, FILE *f);

#endif
