/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds and loads the module that solves the linear systems of implicit diffusion. */
#ifndef SOLVERS_LINEAR_H
#define SOLVERS_LINEAR_H

#include "libcore/gas/implicit.h"

/* Loads the module, and PETSc with it, from where build_companion finds it; a further call returns the same one. The
 * text of an error (ERR_INPUT) follows a dictionary's "key 'type' is implicit;". */
status linear_load(const struct linear_module **out);

#endif
