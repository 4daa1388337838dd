/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The streams to and from LAMMPS; a test puts files in their place. */
#ifndef SOLVERS_DEM_LAMMPS_PRIVATE_H
#define SOLVERS_DEM_LAMMPS_PRIVATE_H

#include "solvers/dem/lammps.h"

#include <stdio.h>
#include <sys/types.h>

struct lammps {
    FILE *to, *from;
    pid_t pid;
    char line[16384]; /* the last one read, or a piece of a longer one: rows have some 200 numbers at most */
    char error[512];  /* its last error */
};

#endif
