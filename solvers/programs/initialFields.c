/* SPDX-License-Identifier: GPL-3.0-or-later */
/* initialFields: writes the state that a case begins with, for a look at it before a run. */
#include "solvers/programs/anycase.h"

static const char HELP[] =
    "initialFields [-case] DIR [-strict] [-help] [-version]\n\n"
    "Writes DIR/0 from DIR/0.orig: expressions, settledLayer, perturbation become values, in the format of "
    "controlDict,\n"
    "which caseToVTK, foamToVTK and ParaView read. A run that starts at 0.orig does the same before its first step.\n\n"
    "  -strict   warnings are errors, but for those of  acceptWarnings (NAME ..);  in system/controlDict\n"
    "  -help     this text\n"
    "  -version  version, compiler, licence\n\n"
    "Exit codes: 0 written; 1 the case is wrong, nothing was written; 3 disk, memory or MPI.\n";

int main(int argc, char **argv) {
    return anycase_main(argc, argv, HELP, run_initial, false);
}
