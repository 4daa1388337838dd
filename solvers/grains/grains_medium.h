/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What hard and soft grains have in common as media (medium.h): patches and shape. */
#ifndef SOLVERS_GRAINS_MEDIUM_H
#define SOLVERS_GRAINS_MEDIUM_H

#include "solvers/case/case.h"
#include "solvers/grains/grains_start.h"

/* Returns the entry of the start, NULL: the patch is calculated. */
const struct patch_field *grains_patch(const struct grains_start *start, int quantity, int patch);
/* Warns if the case's gas has grains of another shape than the mesh gives those that move here. */
status grains_check_shape(struct setup *s, const struct grains_models *m);

#endif
