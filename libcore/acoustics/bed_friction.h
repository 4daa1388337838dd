/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Friction in the step of a bed (bed_friction.c; docs/physics.md 9.3), between its files. */
#ifndef LIBCORE_BED_FRICTION_H
#define LIBCORE_BED_FRICTION_H

#include "libcore/acoustics/bed_private.h"

status bed_friction_make(struct bed *b); /* nothing, if the bed has no law of friction */
void bed_friction_free(struct bed_friction *r);
/* Finds what friction does over dt: lines rubbed, push and traction; sets b->set.stress. Its pressures are those of
 * b->set.pressure. *done: false, on all ranks, if dt is too long. Collective. */
status bed_rub(struct bed *b, double dt, const double gravity[MAX_DIM], bool *done);

#endif
