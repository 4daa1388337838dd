/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads the module of implicit.h, which lies beside the program, when a case asks for implicit diffusion: PETSc's
 * hundred libraries take 30 ms to load. */
#define _GNU_SOURCE /* for RTLD_NODELETE */
#include "solvers/gas/linear.h"

#include "libcore/gas/diffusion.h"

#include <dlfcn.h>
#include <string.h>
#include <unistd.h>

#define MODULE  "haffimplicit.so" /* lies in the folder of the program */
#define PACKAGE "petsc-dev"

status linear_load(const struct linear_module **out) {
    char path[4096];
    const size_t room = sizeof path - sizeof MODULE;
    const ssize_t length = readlink("/proc/self/exe", path, room);
    char *end = length > 0 && (size_t)length < room ? path + length : path;
    while (end > path && end[-1] != '/') end--;
    memcpy(end, MODULE, sizeof MODULE);
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    *out = library ? dlsym(library, "haff_linear_module") : NULL;
    if (*out) return OK;
    return fail(ERR_INPUT,
                "it wants the module %s: %s\n"
                "  which is built where PETSc is installed: on Debian, apt-get install %s, then configure and build "
                "again; or choose %s",
                MODULE, dlerror(), PACKAGE, diffusion_table[0].model.name);
}
