/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads the module of implicit.h when a case asks for implicit diffusion, and not before: PETSc's hundred libraries
 * take 30 ms to load. */
#define _GNU_SOURCE /* for RTLD_NODELETE */
#include "solvers/gas/linear.h"

#include "libcore/gas/diffusion.h"
#include "mesh/base/build.h"

#include <dlfcn.h>

#define MODULE  "haffimplicit.so"
#define PACKAGE "petsc-dev"

status linear_load(const struct linear_module **out) {
    char path[4096];
    build_companion(MODULE, sizeof path, path);
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
    *out = library ? dlsym(library, "haff_linear_module") : NULL;
    if (*out) return OK;
    return fail(
        ERR_INPUT,
        "it wants the module %s: %s\n"
        "  which the package haff-implicit holds, and which is built where PETSc is installed: on Debian, apt-get "
        "install %s, then configure and build again; or choose %s",
        MODULE, dlerror(), PACKAGE, diffusion_table[0].model.name);
}
