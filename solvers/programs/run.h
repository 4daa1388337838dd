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

/* ---- a run whose steps its caller asks for (solvers/python/haffgas.c) ---- */

struct run;
/* Locks, reads and starts a case as run_case does, but catches no signals. Collective, as all functions here. */
status run_open(const char *dir, const struct medium_type *type, struct case_reading how, const struct comm *c,
                struct run **out);
/* Takes one step, which ends at `until` (s) at the latest, with all that run_case does at its end: log, function
 * objects, written times. Not after run_ended. An error ends the run. */
status run_step(struct run *r, double until);
bool run_ended(const struct run *r); /* has it reached endTime or stopAt, or failed? */
const struct moment *run_now(const struct run *r);
const struct setup *run_setup(const struct run *r);
status run_write(struct run *r); /* writes the time now, unless it is on the disk, and waits until it is */
status run_close(struct run *r); /* ends the log, waits for written times, frees all */

#endif
