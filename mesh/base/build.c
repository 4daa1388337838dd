/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Version, git hash, compiler and flags of this build come from macros that CMake sets (build.h). */
#include "mesh/base/build.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifndef HAFF_VERSION
#define HAFF_VERSION "unknown"
#endif
#ifndef HAFF_GIT
#define HAFF_GIT "unknown"
#endif
#ifndef HAFF_FLAGS
#define HAFF_FLAGS ""
#endif
#ifndef HAFF_PETSC
#define HAFF_PETSC 0
#endif
#if defined(__clang__)
#define COMPILER "clang " __clang_version__
#else
#define COMPILER "gcc " __VERSION__
#endif

enum { PATH = 4096 };

const char *build_version(void) {
    return HAFF_VERSION " (git " HAFF_GIT ")";
}
const char *build_number(void) {
    return HAFF_VERSION;
}
const char *build_compiler(void) {
    return COMPILER " " HAFF_FLAGS;
}
bool build_petsc(void) {
    return HAFF_PETSC;
}

/* Writes the folder of this program, with its '/'; "" where the system does not tell it. */
static void own_folder(char folder[PATH]) {
    const char *const given = getenv(BUILD_PROGRAMS);
    const ssize_t length =
        given ? snprintf(folder, PATH, "%.4000s/", given) : readlink("/proc/self/exe", folder, PATH - 1);
    folder[length > 0 ? length : 0] = 0;
    char *slash = strrchr(folder, '/');
    if (slash) slash[1] = 0;
}

bool build_companion(const char *name, size_t size, char *path) {
    static const char *const places[] = {"../lib/haff/", ""};
    char folder[PATH];
    own_folder(folder);
    for (int i = 0; i < 2; i++) {
        const int needs = snprintf(path, size, "%s%s%s", folder, places[i], name);
        if (needs > 0 && (size_t)needs < size && !access(path, R_OK)) return true;
    }
    return false;
}
