/* SPDX-License-Identifier: GPL-3.0-or-later */
/* granularMD: event-driven hard disks and spheres on a case directory. */
#include "solvers/case/medium.h"
#include "solvers/programs/program.h"

int main(int argc, char **argv) {
    return solver_main(argc, argv, &grains_medium);
}
