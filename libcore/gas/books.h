/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Those who keep account of a step: the budget (libcore/step/audit.h) and what leaves through patches
 * (libcore/gas/tally.h). A part of a step says what it does; books.c alone says whom that concerns. Without a request
 * (gas_audit, gas_tally) all of this costs nothing; the gas has the same bits with it. All are collective. */
#ifndef LIBCORE_BOOKS_H
#define LIBCORE_BOOKS_H

#include "libcore/gas/gas.h"

struct state;

void books_begin(struct gas *g); /* an attempt at a step begins, from g->U */
/* Books the change since the last look to `now` under a cause. */
void books_part(struct gas *g, enum gas_cause cause, const struct state *now);
/* The sources of a plan are about to act on `from`; W is scratch. They have acted, and made `now`. */
void books_sources(struct gas *g, const struct source_plan *plan, const struct state *from);
void books_sourced(struct gas *g, const struct state *now);
/* A stage from `from` begins; its fluxes are those that count. Of what it does the time `weight` (s) reaches the end of
 * the step. */
void books_stage(struct gas *g, const struct state *from, double weight);
void books_staged(struct gas *g, double weight);
/* Limiting has changed a stage of which the fraction `share` reaches the end of the step. */
void books_limited(struct gas *g, double share);
void books_bed(struct gas *g, double dt);      /* a bed was advanced by dt */
void books_friction(struct gas *g, double dt); /* friction acted over dt, behind an explicit step */
/* Takes a note before a part of the step that may be done again. back: returns to the last note first, because the part
 * is done again. books_mark_heat does the same for conduction, within such a part. */
void books_mark(struct gas *g, bool back);
void books_mark_heat(struct gas *g, bool back);
/* The attempt stands: at what the floors gave, then at its end, behind which g->U is the result. */
status books_floors(struct gas *g);
status books_keep(struct gas *g, double dt);
void books_free(struct gas *g);

#endif
