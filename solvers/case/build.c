/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Version, git hash, compiler and flags of this build, from macros that CMake sets (build.h). */
#include "solvers/case/build.h"

#ifndef HAFF_VERSION
#define HAFF_VERSION "unknown"
#endif
#ifndef HAFF_GIT
#define HAFF_GIT "unknown"
#endif
#ifndef HAFF_FLAGS
#define HAFF_FLAGS ""
#endif
#if defined(__clang__)
#define COMPILER "clang " __clang_version__
#else
#define COMPILER "gcc " __VERSION__
#endif

const char *build_version(void) {
    return HAFF_VERSION " (git " HAFF_GIT ")";
}
const char *build_number(void) {
    return HAFF_VERSION;
}
const char *build_compiler(void) {
    return COMPILER " " HAFF_FLAGS;
}
