/* SPDX-License-Identifier: GPL-3.0-or-later */
/* checkCase: checks all that a solver's -dry-run checks. */
#include "solvers/programs/anycase.h"

static const char HELP[] =
    "checkCase [-case] DIR [-strict] [-fix [-write]] [-help] [-version]\n\n"
    "Reads and checks the whole case: dictionaries, mesh, fields, function objects. Writes nothing, but with "
    "-write.\n\n"
    "  -strict   warnings are errors, but for those of  acceptWarnings (NAME ..);  in system/controlDict\n"
    "  -fix      shows the changes that cure mistakes for certain, file by file, each line before and after: misnamed\n"
    "            files, misspelt words, wrong headers, maxDeltaT beside adjustTimeStep no, writeInterval beyond the "
    "end\n"
    "  -write    with -fix: makes these changes, and checks again until there are no more\n"
    "  -help     this text\n"
    "  -version  version, compiler, licence\n\n"
    "Exit code 0: sound, or with warnings, which it counts; 1: not.\n";

int main(int argc, char **argv) {
    return anycase_main(argc, argv, HELP, run_check, true);
}
