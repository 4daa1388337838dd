/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Says what these programs were built from, for -version, the log and provenance, and finds the files they come with.
 */
#ifndef MESH_BUILD_H
#define MESH_BUILD_H

#include <stdbool.h>
#include <stddef.h>

const char *build_version(void); /* "0.3.0 (git hash)" */
const char *build_number(void);  /* "0.3.0" */
/* Compiler, version and flags. */
const char *build_compiler(void);
bool build_petsc(void); /* was PETSc there, so that haffimplicit.so was built? */

/* Sets path (of `size` bytes) to the file `name` that comes with the programs. It lies in ../lib/haff of the folder of
 * the running program, as it is installed, or beside the program, as it is built. Links to the program are followed, so
 * that an installation may be linked to or moved. Returns false where it is in neither place; path is the second then.
 */
#define BUILD_PROGRAMS                                                                                                 \
    "HAFF_PROGRAMS" /* variable of the environment: their folder, where the running program is another */
bool build_companion(const char *name, size_t size, char *path);

#endif
