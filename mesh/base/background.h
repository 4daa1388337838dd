/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Work beside the program, in threads: waiting for disks. It calls no MPI and prints nothing, and what it touches is
 * touched by no one else until it has ended. */
#ifndef MESH_BACKGROUND_H
#define MESH_BACKGROUND_H

#include "mesh/base/status.h"

struct background;
/* Starts work(context) in a thread. Where the system gives no thread, the work is done before this returns. Signals
 * stay with the threads of the program. */
status background_start(void (*work)(void *context), void *context, struct background **out);
bool background_ended(const struct background *b);
void background_finish(struct background *b); /* waits for the end, and frees */
/* Calls work(context, i) for i = 0 .. n - 1, some of them at a time, and returns when all have ended. */
void background_each(int n, void (*work)(void *context, int i), void *context);

#endif
