/* What has changed since the time a run starts from was written: its uniform/provenance holds the mesh's checksum and
 * the dictionaries as they were read, macros expanded. */
#ifndef SOLVERS_CHANGES_H
#define SOLVERS_CHANGES_H

#include "solvers/case/case.h"
#include <stdio.h>

/* Mesh and dictionaries into a provenance file that is being written. */
void changes_record(struct sink *o, const struct setup *s);
/* Is the mesh one of as many cells? OK also for times without provenance. */
status changes_check_mesh(const struct setup *s);
/* Entry by entry, "constant/granularProperties: grain.restitution 0.97 -> 0.9"; nothing where nothing has changed. */
void changes_print(FILE *f, const struct setup *s);

#endif
