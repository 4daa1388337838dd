/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warnings about runs that would take very long: some cells are far narrower than the others, the number of steps to
 * endTime is huge, or ranks have nothing to do. */
#ifndef SOLVERS_OUTLOOK_H
#define SOLVERS_OUTLOOK_H

#include "solvers/case/case.h"

struct outlook {     /* of one run; starts as zeros */
    double first;    /* number of steps to endTime that the first step foretold */
    double too_many; /* the number that is said next; 0: none has been foretold yet */
};

/* Says on the root, once, if the number of steps from t to endTime exceeds a million at the first call, or 1000 times
 * that of the first call (or 100,000, if that is more) later on. The message says which cell or
 * model limits the step, and what can be done about that. Collective. */
void outlook_steps(struct outlook *o, const struct setup *s, const struct pace *pace, double t);

/* Warns of a maxDeltaT that does not count, of more than 1e7 steps to endTime, and of a writeInterval that
 * is beyond the end or makes more than 1e5 times.
 * Collective. */
status outlook_control(struct setup *s, const struct pace *pace);

/* Warns of a cell whose V/A is so small beside that of the others that it alone makes the steps short. */
status outlook_mesh(struct setup *s);

/* Warns of more ranks than the mesh has parts that can be dealt to them. Collective. */
status outlook_ranks(struct setup *s);

#endif
