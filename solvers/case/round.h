/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads `axis` of system/meshDict: the mesh then stands for a body of revolution (struct round of
 * mesh/format/polymesh.h; docs/physics.md 5.9).
 *   axis { origin (0 0 0); direction (1 0 0); } */
#ifndef SOLVERS_ROUND_H
#define SOLVERS_ROUND_H

#include "solvers/case/case.h"
#include "solvers/dict/keywords.h"

/* Sets s->mesh->round and s->mesh_dict, behind the axes of the mesh. Refuses, by line, an axis that is none of the
 * mesh: oblique, of 3D cells, across the plane; and a mesh across it or below it, cyclic across the radius, or with
 * another patch than a symmetry plane on it. */
status round_read(struct setup *s);
/* Returns the error of `what`, which the solver does not know in round flow; cure: what to do. */
status round_refuse(const struct setup *s, const char *what, const char *cure);
void round_keywords(struct keywords *k);

#endif
