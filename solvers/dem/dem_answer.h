/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grains and contacts of a moment from the dumps that LAMMPS answers with (dem_deck.h has their columns). The answer
 * may be wrong, as a program of any version writes it: what is no moment of the grains is an error. */
#ifndef SOLVERS_DEM_ANSWER_H
#define SOLVERS_DEM_ANSWER_H

#include "solvers/dem/dem_engine.h"

/* Reads three dumps: grains, their contacts with walls (unless there are no walls), contacts of grains; index[nold + 1]
 * is room for the grain of each number. Fails with ERR_SYSTEM if numbers are not finite, grains or partners are not
 * there, grains are far from the box, or some are missing where none can leave. */
status dem_answer_take(struct lammps *from, const struct dem_law *law, int *index, struct dem_moment *out);

#endif
