/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The streams to and from LAMMPS; a test puts files in their place. */
#ifndef SOLVERS_DEM_LAMMPS_PRIVATE_H
#define SOLVERS_DEM_LAMMPS_PRIVATE_H

#include "solvers/dem/lammps.h"

#include <stdio.h>
#include <sys/types.h>

struct lammps;
struct lammps_pipe { /* the end of a pipe behind a stream */
    struct lammps *of;
    int file;
};
struct lammps {
    FILE *to, *from;
    struct lammps_pipe pipe[2]; /* of these */
    pid_t pid;
    bool (*asked)(void); /* is the run to end? NULL: it is not asked */
    bool told, left;     /* was it said that LAMMPS is stopped? was it left because of that? */
    char line[16384];    /* the last one read, or a piece of a longer one: rows have some 200 numbers at most */
    char error[512];     /* its last error */
};

#endif
