/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Runs or checks a case: the time loop, from the reading of the case to its last written time. */
#ifndef SOLVERS_RUN_H
#define SOLVERS_RUN_H

#include "solvers/case/case.h"

/* Reads and checks everything; prints mesh, models, keys, memory, unless cures are wanted; writes nothing. Collective.
 */
status run_check(const char *dir, const struct medium_type *type, struct case_reading how, const struct comm *c);

/* Writes the time 0 from 0.orig (times.h) as a run would before its first step. The case is locked meanwhile.
 * Collective.
 */
status run_initial(const char *dir, const struct medium_type *type, struct case_reading how, const struct comm *c);

/* Runs the case to its end, or until stopAt, SIGTERM, SIGINT, SIGHUP, SIGXCPU or SIGUSR1 (it then writes the state and
 * returns OK). The case is locked meanwhile (lock.h). Collective.
 * Fails with ERR_STATE if the medium left the admissible states; the last good state was written, unless controlDict
 * says onError abort. */
status run_case(const char *dir, const struct medium_type *type, struct case_reading how, const struct comm *c);

#endif
