/* granularGas: the inelastic Euler equations of a granular gas on a case directory. */
#include "solvers/functions.h"
#include "solvers/program.h"
#include "solvers/run.h"

static void help(void) {
    printf(
        "granularGas -case DIR [-np N] [-dry-run] [-debug] [-listModels] [-listBCs] [-help]\n\n"
        "Solves the hydrodynamics of a granular gas on the case in DIR (default: here).\n\n"
        "  -np N        on N ranks, the same as  mpirun -np N granularGas ...; the results are the same to the bit\n"
        "  -dry-run     reads and checks everything, says what a run would do, writes nothing (see checkCase)\n"
        "  -listModels  models, schemes and function objects with their parameters\n"
        "  -listBCs     boundary conditions\n"
        "  -debug       the way an error took through the program\n\n"
        "SIGTERM, SIGINT, SIGHUP, SIGXCPU, SIGUSR1, or stopAt writeNow in system/controlDict: the state is written "
        "and\n"
        "the run ends. One run at a time works on a case (DIR/.haff.lock); checkCase and caseToVTK may read "
        "meanwhile.\n"
        "Exit codes: 0 done or stopped as asked; 1 the case or the command line is wrong, nothing was written; 2 the "
        "gas\n"
        "left the admissible states (e.g. inelastic collapse; the last good state was written); 3 disk, memory or "
        "MPI.\n");
}

int main(int argc, char **argv) {
    struct options o;
    struct comm *c = NULL;
    status s = options_read(argc, argv, &o);
    if (s) return program_end(NULL, s, false);
    if (o.help || o.list_models || o.list_boundaries) {
        if (o.help) help();
        if (o.list_models) {
            models_list(stdout);
            printf("\nsystem/controlDict: functions\n");
            functions_list(stdout);
        }
        if (o.list_boundaries) boundaries_list(stdout);
        return 0;
    }
    if (o.ranks > 1) return program_end(NULL, options_relaunch(argc, argv, &o), o.debug);
    s = comm_start(&argc, &argv, &c);
    if (!s) s = o.dry_run ? run_check(o.dir, c) : run_case(o.dir, c);
    return program_end(c, s, o.debug);
}
