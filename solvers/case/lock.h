/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lets only one solver at a time work on a case: two would remove and replace each other's times. Readers need no
 * lock. */
#ifndef SOLVERS_LOCK_H
#define SOLVERS_LOCK_H

#include "mesh/base/status.h"

struct lock;
/* Takes CASE/.haff.lock, which says who holds it. The kernel drops the lock when the process ends, however it ends: a
 * file that a killed run left behind is no obstacle. Fails with ERR_INPUT if another run holds it, with ERR_SYSTEM if
 * the folder cannot be written to. *out stays NULL, with a note, where the file system knows no locks. */
status lock_take(const char *case_dir, const char *program, struct lock **out);
void lock_release(struct lock *l); /* removes the file; NULL is allowed */

#endif
