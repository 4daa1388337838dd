/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What function objects that look at patches share: which patches they take, and sums over the faces of patches that
 * have the same bits on any number of ranks. */
#ifndef SOLVERS_FUNCTIONS_PATCHES_H
#define SOLVERS_FUNCTIONS_PATCHES_H

#include "solvers/functions/functions_private.h"

struct patch_choice { /* of patches with faces in the solved space, neither empty nor cyclic */
    int n;
    bool *takes; /* [patches of the mesh] */
};
/* Reads the names of patches, or quoted regular expressions, at a key. */
status patches_read(const struct function *f, struct dict *d, const char *key, struct patch_choice *out);

/* Lets the medium note what leaves it through patches; *dt is the length of the last step (s), 0 before the first.
 * Collective. */
status patches_follow(const struct function *f, double *dt);
/* Visits the chosen faces block by block: add(context, face, sum) adds to sum[n], whose totals are out[n] on all ranks.
 * Collective. */
enum { PATCH_SUMS = 16 };
typedef void patch_adder(const void *context, const struct crossing *face, double *sum);
status patches_sum(const struct function *f, const struct patch_choice *c, patch_adder *add, const void *context, int n,
                   double out[PATCH_SUMS]);

enum { PRESSURE, VISCOUS, FORCE_PARTS };
struct force { /* on patches, N and N m */
    double force[FORCE_PARTS][3], moment[FORCE_PARTS][3];
};
/* Finds the force on patches, mean over the last step, less that of a uniform pressure (Pa), and its moment about a
 * point (m). Collective. */
status patches_force(const struct function *f, const struct patch_choice *c, const double centre[3], double pressure,
                     struct force *out);

#endif
