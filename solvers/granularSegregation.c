/* granularSegregation: the segregation of a bidisperse granular mixture on a case directory. */
#include "solvers/medium.h"
#include "solvers/program.h"

int main(int argc, char **argv) {
    return solver_main(argc, argv, &segregation_medium);
}
