/* One solver at a time on a case: two would remove and replace each other's times. Readers need no lock. */
#ifndef SOLVERS_LOCK_H
#define SOLVERS_LOCK_H

#include "mesh/base/status.h"

struct lock;
/* Takes CASE/.haff.lock, which says who holds it. The kernel drops the lock when the process ends, however it ends: a
 * file that a killed run left behind is no obstacle. ERR_INPUT: another run holds it; ERR_SYSTEM: the folder cannot be
 * written to. *out stays NULL, with a warning, where the file system knows no locks. */
status lock_take(const char *case_dir, const char *program, struct lock **out);
void lock_release(struct lock *l); /* removes the file; NULL is allowed */

#endif
