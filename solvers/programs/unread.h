/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warns of files that lie where a case has its dictionaries and fields, and that nothing reads: their names are
 * misspelt, they lie in the wrong folder, or they belong to what haff does not have. */
#ifndef SOLVERS_UNREAD_H
#define SOLVERS_UNREAD_H

#include "solvers/case/case.h"

/* Looks through constant, system and the folder of the start, unless a run wrote that, on the root; and in the case
 * itself for files that belong in one of them. Files of known
 * tools, notes, backups and what another file includes are no mistakes. Collective. */
status unread_warn(struct setup *s);

/* Puts the misnamed files of a case that cannot be read in front of its error, and notes their cures: one of them may
 * be what is missing. Local. */
status unread_hint(const char *dir, const struct medium_type *type, struct cures *cures, status error);

#endif
