/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What hard and soft grains have in common as media (medium.h): their quantities, and the cells of their means. */
#ifndef SOLVERS_GRAINS_MEDIUM_H
#define SOLVERS_GRAINS_MEDIUM_H

#include "libcore/grains/coarse.h"
#include "solvers/case/case.h"
#include "solvers/grains/grains_start.h"

enum { GRAINS_QUANTITIES = 6 };
#define GRAINS_QUANTITY_ROWS                                                                                           \
    {"rho", 1, {1, -3, 0, 0, 0, 0, 0}, false}, {"alpha", 1, {0, 0, 0, 0, 0, 0, 0}, false},                             \
        {"U", 3, {0, 1, -1, 0, 0, 0, 0}, false}, {"T", 1, {0, 2, -2, 0, 0, 0, 0}, false},                              \
        {"p", 1, {1, -1, -2, 0, 0, 0, 0}, false}, {                                                                    \
        "TComponents", 3, {0, 2, -2, 0, 0, 0, 0}, false                                                                \
    }
extern const struct quantity grains_quantity[];             /* rho alpha U T p TComponents */
extern const enum coarse_field grains_coarse_of[];          /* of each */
extern const int grains_written[];                          /* all, ended by -1 */
int grains_components(const struct setup *s, int quantity); /* how many lie along solved axes */
/* Returns the entry of the start, NULL: the patch is calculated. */
const struct patch_field *grains_patch(const struct grains_start *start, int quantity, int patch);
/* Warns if the case's gas has grains of another shape than the mesh gives those that move here. */
status grains_check_shape(struct setup *s, const struct grains_models *m);

#endif
