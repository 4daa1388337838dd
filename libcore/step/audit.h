/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The budget of mass, momentum and energy: the change by each part of the steps. It is kept on request (gas_audit),
 * else it costs nothing; the gas has the same bits with it.
 *
 * Totals are taken behind every part of a step, and the change belongs to the part's cause. The change of energy by
 * each source follows from its own formula (`gained` in libcore/models/source.h) or, if it has none, from the change
 * that the formulas of the sources acting with it leave; conduction counts as heat of walls, stress as work of walls,
 * the stages less the work of gravity in them as flow through open patches. Where such a cause is missing (no wall that
 * exchanges heat, none that moves, no cooling, no open patch) the scheme promises that nothing changes, and a change is
 * booked as unaccounted. A step that is done again counts once.
 *
 * Momentum is booked where it is made: the weight in the stages and in a bed by its own sum over the cells, with the
 * forces that balance a state at rest on polyhedra (it is what they stand in for); that of sources by the change of the
 * totals; what crosses the faces of patches by libcore/gas/tally.h. What is left is round-off, so that it shows whether
 * all of these are complete. */
#ifndef LIBCORE_AUDIT_H
#define LIBCORE_AUDIT_H

#include "libcore/gas/gas.h"

struct state;
struct audit;

/* The parts, in the order of a step. All do nothing if g->books.audit is NULL; collective. */
void audit_begin(struct gas *g); /* an attempt at a step begins, from g->U */
/* Books the change from the last look to `now` under a cause. */
void audit_part(struct gas *g, enum gas_cause cause, const struct state *now);
/* audit_sources is called before the sources of a plan act on `from`, audit_sourced behind them. If the energy of a
 * source must be measured apart from that of the sources after it, audit_sources applies the plan up to that source to
 * `from` and puts the result into `scratch`; `from` stays as it is, so that the gas has the same bits. */
void audit_sources(struct gas *g, const struct source_plan *plan, const struct state *from,
                   const struct state *scratch);
void audit_sourced(struct gas *g, const struct state *now);
/* Book the work of gravity, and its momentum, in a stage from `from`, of which the share `part` of dt reaches the end
 * of the step; and what drop_row added to it. The next audit_part books what else the stages do. */
void audit_weight(struct gas *g, const struct state *from, double part);
void audit_dropped(struct gas *g, double part);
/* Books the forces (N) that balanced a state at rest in the last stage (cells_rest.c), of which `part` reaches the end,
 * or the error of their sum. */
void audit_rest(struct gas *g, double part, const double force[MAX_DIM], status failed);
/* Books the momentum that the density floor gave in a step that stands. */
status audit_filled(struct gas *g);
/* Books the work of gravity, and its momentum, in the bed of a step with implicit acoustics. */
void audit_bed(struct gas *g);
void audit_friction(struct gas *g); /* friction has acted on the cells of a bed */
/* Notes the account before a part that may be done again. back: returns to the last note first, because the part is
 * done again. */
void audit_mark(struct gas *g, bool back);
/* Keeps the account of an attempt that stands. Returns the first error of its sums. */
status audit_keep(struct gas *g);
void audit_free(struct audit *a);

#endif
