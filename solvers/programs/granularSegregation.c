/* SPDX-License-Identifier: GPL-3.0-or-later */
/* granularSegregation: the segregation of a bidisperse granular mixture on a case directory. */
#include "solvers/case/medium.h"
#include "solvers/programs/program.h"

int main(int argc, char **argv) {
    return solver_main(argc, argv, &segregation_medium);
}
