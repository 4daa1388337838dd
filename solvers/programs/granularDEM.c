/* SPDX-License-Identifier: GPL-3.0-or-later */
/* granularDEM: soft spheres with friction, moved by LAMMPS, on a case directory. */
#include "solvers/case/medium.h"
#include "solvers/programs/program.h"

int main(int argc, char **argv) {
    return solver_main(argc, argv, &dem_medium);
}
