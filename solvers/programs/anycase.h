/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The main of programs that take a case of any solver: PROGRAM DIR [-strict] [-help] [-version]. */
#ifndef SOLVERS_ANYCASE_H
#define SOLVERS_ANYCASE_H

#include "solvers/programs/run.h"

/* What a program does with the case in `dir`, of the medium that controlDict names: run_check, run_initial. */
typedef status anycase_action(const char *dir, const struct medium_type *type, struct case_reading how,
                              const struct comm *c);
/* mends: the program offers -fix and -write (fix.h). */
int anycase_main(int argc, char **argv, const char *help_text, anycase_action *action, bool mends);

#endif
