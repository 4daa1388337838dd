/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Patches through which grains come in: a Poisson process in time and place, with the flux and the velocities of a
 * Maxwellian gas of the alpha, U and T that the case gives there (random.h). A grain begins with its centre on the
 * patch. Where another is in its way a new place and velocity are drawn, so that the flux is kept. */
#ifndef SOLVERS_GRAINS_INLETS_H
#define SOLVERS_GRAINS_INLETS_H

#include "solvers/grains/grains_start.h"
#include "solvers/grains/grains_state.h"

struct grains_inlets;
/* Finds the patches whose U gives a velocity (not on walls), notes them in m->feeds and m->open; returns whether there
 * is one. Fails unless alpha (or rho) and T are given there, too. */
status grains_inlets_find(const struct setup *s, const struct grains_start *start, struct grains_models *m, bool *any);
/* Makes the inlets from time t on; `saved`: of a run that goes on, else NULL. All but `saved` is borrowed. */
status grains_inlets_make(const struct setup *s, const struct grains_models *m, const struct grains_start *start,
                          const struct grain_box *box, double t, const struct grains_inflow *saved,
                          struct grains_inlets **out);
void grains_inlets_free(struct grains_inlets *in);
double grains_inlets_next(const struct grains_inlets *in); /* s: when grains_inlets_take is due */
/* Lets a grain come in, or takes new values of the patches. The grains stand at that time; they may be made anew. */
status grains_inlets_take(struct grains_inlets *in, struct grains **g);
const struct grains_inflow *grains_inlets_state(const struct grains_inlets *in);

#endif
