/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values on the faces of patches, for all that write or read them: function objects and the files of fields. A medium
 * makes them of those in the cells beside the faces, by the rules of the patches (`edge` in medium.h); they are the
 * same on all ranks. */
#ifndef SOLVERS_EDGES_H
#define SOLVERS_EDGES_H

#include "solvers/case/case.h"

struct edges;
/* Lists the faces of the patches that `takes` chooses ([patches of the mesh]; NULL: of all), but for empty and cyclic
 * ones. *out is NULL if the medium has no rules for them. Collective. */
status edges_make(const struct setup *s, const bool *takes, struct edges **out);
void edges_free(struct edges *e);
/* Gathers what decides on the values, in the present state. Collective. */
status edges_find(struct edges *e);
/* Replaces a quantity's values in the cells beside n faces of a patch, [n][components] along physical axes, by those on
 * the faces. face[n]: faces within the patch; NULL: the first n. e may be NULL: nothing changes. */
void edges_values(const struct edges *e, int quantity, int patch, int n, const int *face, double *values);
/* Sets at_point[npoints] to a component of a quantity, as the mean of the faces around, at points of the mesh on listed
 * patches that give the quantity; to NAN elsewhere. count[npoints]: room. The mesh must be complete. */
void edges_points(const struct edges *e, int quantity, int component, double *at_point, int *count);

#endif
