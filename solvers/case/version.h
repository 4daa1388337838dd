/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The version of haff that a case was written for: `haffVersion 0.3;` of system/controlDict. A case of a newer version
 * is refused; where an entry that an older case leaves out means another thing since, there is a warning. */
#ifndef SOLVERS_VERSION_H
#define SOLVERS_VERSION_H

#include "mesh/base/status.h"

struct version {
    int major, minor;
};
struct dict;
struct setup;

/* Reads haffVersion of controlDict; *out is 0.0 where it is missing. Fails if it is newer than these programs. */
status version_read(struct dict *control, struct version *out);
/* Warns of each entry that the case leaves out and whose default has changed since the case's version. Collective. */
status version_warn(struct setup *s);

#endif
