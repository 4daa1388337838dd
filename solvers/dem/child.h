/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A child process with all that it has started, as /proc shows them. */
#ifndef SOLVERS_DEM_CHILD_H
#define SOLVERS_DEM_CHILD_H

#include <sys/types.h>

struct child {
    char *const *command;     /* the program, sought in PATH, and its arguments; NULL behind the last */
    char *const *environment; /* likewise */
    int last;                 /* the signal that it gets when the thread that started it ends, even by SIGKILL */
    int in[2], out[2];        /* pipes: in[0] and out[1] are its standard input and output */
};

int child_start(const struct child *c, pid_t *pid); /* returns 0, or the errno of what failed */
pid_t child_stopped(pid_t pid); /* returns the first of them that a signal has stopped (SIGSTOP), or 0 */
void child_kill(pid_t pid);     /* ends them all by SIGKILL, which stopped processes obey, too */

#endif
