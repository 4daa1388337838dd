/* SPDX-License-Identifier: GPL-3.0-or-later */
/* checkCase: checks all that a solver's -dry-run checks. */
#include "solvers/programs/anycase.h"

static const char HELP[] =
    "checkCase [-case] DIR [-strict] [-help] [-version]\n\nReads and checks the whole case: dictionaries, mesh, "
    "fields, "
    "function objects. Writes "
    "nothing.\n\n"
    "  -strict   warnings are errors, but for those of  acceptWarnings (NAME ..);  in system/controlDict\n"
    "  -help     this text\n"
    "  -version  version, compiler, licence\n\n"
    "Exit code 0: sound, or with warnings, which it counts; 1: not.\n";

int main(int argc, char **argv) {
    return anycase_main(argc, argv, HELP, run_check);
}
