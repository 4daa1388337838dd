/* The time loop of a case, and its check without one. */
#ifndef SOLVERS_RUN_H
#define SOLVERS_RUN_H

#include "solvers/case/case.h"

/* Reads and checks everything; prints mesh, models, keys, memory; writes nothing. Collective. */
status run_check(const char *dir, const struct medium_type *type, const struct comm *c);

/* Runs the case to its end, or until stopAt, SIGTERM, SIGINT, SIGHUP, SIGXCPU or SIGUSR1 (the state is then written, OK
 * is returned). The case is locked meanwhile (lock.h).
 * ERR_STATE: the medium left the admissible states; the last good state was written unless onError abort. */
status run_case(const char *dir, const struct medium_type *type, const struct comm *c);

#endif
