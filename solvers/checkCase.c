/* checkCase: everything granularGas -dry-run checks. */
#include "solvers/program.h"
#include "solvers/run.h"

#include <string.h>

int main(int argc, char **argv) {
    struct comm *c = NULL;
    if (argc != 2 || !strcmp(argv[1], "-help") || !strcmp(argv[1], "--help")) {
        fprintf(argc == 2 ? stdout : stderr,
                "checkCase DIR\n\nReads and checks the whole case: dictionaries, mesh, fields, "
                "function objects. Writes nothing.\nExit code 0: sound; 1: not.\n");
        return argc != 2;
    }
    status s = comm_start(&argc, &argv, &c);
    if (!s) s = run_check(argv[1], c);
    return program_end(c, s, false);
}
