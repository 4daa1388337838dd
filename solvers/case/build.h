/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Says what these programs were built from, for the log and for provenance. */
#ifndef SOLVERS_BUILD_H
#define SOLVERS_BUILD_H

const char *build_version(void); /* "0.2.0 (git hash)" */
const char *build_number(void);  /* "0.2.0" */
/* Compiler, version and flags. */
const char *build_compiler(void);

#endif
