/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tells what has changed since the time a run starts from was written: that time's uniform/provenance holds the mesh's
 * checksum and the dictionaries as they were read, macros expanded. */
#ifndef SOLVERS_CHANGES_H
#define SOLVERS_CHANGES_H

#include "solvers/case/case.h"
#include <stdio.h>

/* Writes the mesh's checksum and the dictionaries into a provenance file that is open. */
void changes_record(struct sink *o, const struct setup *s);
/* Fails if the mesh has another number of cells than then; OK also for times without provenance. */
status changes_check_mesh(const struct setup *s);
/* Prints the changes entry by entry, "constant/granularProperties: grain.restitution 0.97 -> 0.9"; prints nothing if
 * nothing has changed. */
void changes_print(FILE *f, const struct setup *s);

#endif
