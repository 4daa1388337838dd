/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A child process with all that it has started, as /proc shows them. */
#ifndef SOLVERS_DEM_CHILD_H
#define SOLVERS_DEM_CHILD_H

#include <sys/types.h>

pid_t child_stopped(pid_t pid); /* returns the first of them that a signal has stopped (SIGSTOP), or 0 */
void child_kill(pid_t pid);     /* ends them all by SIGKILL, which stopped processes obey, too */

#endif
