/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the grains gave to each face of the patches in the last step, for function objects (forces, surfaceFieldValue).
 */
#ifndef SOLVERS_GRAINS_FORCES_H
#define SOLVERS_GRAINS_FORCES_H

#include "solvers/case/case.h"
#include "solvers/grains/grains_box.h"

struct grains_forces;
/* mesh: NULL if the grains are in a box. All is borrowed. */
status grains_forces_make(const struct setup *s, const struct grains_mesh *mesh, const struct grain_box *box,
                          struct grains_forces **out);
void grains_forces_free(struct grains_forces *f);
/* Begins a step; end says how long it was (s). */
void grains_forces_begin(struct grains_forces *f);
void grains_forces_end(struct grains_forces *f, double dt);
double grains_forces_step(const struct grains_forces *f); /* the length of the last step that was noted; 0: none */
/* Returns the observer of impacts, which hands them on to `next` (NULL: to none). */
struct grain_observer *grains_forces_observer(struct grains_forces *f, struct grain_observer *next);
/* Visits the faces of all walls, in the order of the mesh; none before a step was noted. */
void grains_forces_visit(const struct grains_forces *f, crossing_visitor *visit, void *context);

#endif
