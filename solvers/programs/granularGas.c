/* SPDX-License-Identifier: GPL-3.0-or-later */
/* granularGas: the Euler or Navier-Stokes equations of a granular gas on a case directory. */
#include "solvers/case/medium.h"
#include "solvers/programs/program.h"

int main(int argc, char **argv) {
    return solver_main(argc, argv, &gas_medium);
}
