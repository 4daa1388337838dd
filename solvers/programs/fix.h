/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cures mistakes in the files of a case where the cure is certain: what warnings noted (solvers/case/warnings.h), and
 * the word that an error says was meant. */
#ifndef SOLVERS_FIX_H
#define SOLVERS_FIX_H

#include "solvers/case/warnings.h"

/* Adds the cure of an error "FILE:LINE: .. did you mean 'WORD'?", if that line has one word for which it may stand. */
void fix_from_error(status error, struct cures *cures);

/* Prints the cures that the files of the case allow: file, line, the line before and after. With `write` the files are
 * changed, and no run may be at work on the case. Links are left alone, and so are zipped files. *n: how many cures. */
status fix_files(const char *dir, const struct cures *cures, bool write, int *n);

#endif
