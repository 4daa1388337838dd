/* SPDX-License-Identifier: GPL-3.0-or-later */
/* LAMMPS as a child process: commands go to its standard input, answers come from its standard output. It is never
 * linked: Debian's LAMMPS is under GPL version 2 alone, and may not be one program with haff.
 *
 * Standard output must not be kept in a buffer, or both programs wait for each other: `stdbuf -oL` sees to that. A dump
 * to /dev/stdout comes the same way, so that no file lies between the programs. When haff ends, however it ends, the
 * standard input of LAMMPS ends, and so does LAMMPS. */
#ifndef SOLVERS_DEM_LAMMPS_H
#define SOLVERS_DEM_LAMMPS_H

#include "mesh/base/status.h"

#include <stdbool.h>

struct lammps;
struct lammps_abilities {
    char version[64]; /* "29 Sep 2021 - Update 2" */
    bool surface;     /* has it fix surface/global, of its package GRANSURF? */
};
/* Asks the program what it can. Fails with ERR_SYSTEM if it is missing, or lacks pair_style granular, fix wall/gran and
 * wall/gran/region, its package GRANULAR; the error names Debian's package. */
status lammps_ask(struct lammps_abilities *out);

/* Starts it, on several ranks by mpirun. While a signal has stopped it (SIGSTOP), all functions wait, and the log says
 * so; but they fail with ERR_SYSTEM, and end it, once `asked` says that the run is to end. NULL: it never is. */
status lammps_start(int ranks, bool (*asked)(void), struct lammps **out);
void lammps_free(struct lammps *l);        /* ends it */
bool lammps_lives(const struct lammps *l); /* has no function found its end? */

/* Sends a line; errors come with lammps_wait. */
void lammps_send(struct lammps *l, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Waits until all is done that was sent. Fails with ERR_SYSTEM and its own words if it has ended. */
status lammps_wait(struct lammps *l);
/* Reads the head of a dump that was sent for; *n is its number of rows, 0 or more. */
status lammps_dump(struct lammps *l, long *n);
/* Reads a row of it. Fails with ERR_SYSTEM if it has less numbers, or one that is not finite. */
status lammps_row(struct lammps *l, int columns, double *row);

#endif
