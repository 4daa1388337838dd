/* granularMD: event-driven hard disks and spheres on a case directory. */
#include "solvers/medium.h"
#include "solvers/program.h"

int main(int argc, char **argv) {
    return solver_main(argc, argv, &particle_medium);
}
