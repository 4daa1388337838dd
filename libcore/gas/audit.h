/* The budget of mass and energy: what each part of the steps changed. Kept on request (gas_audit), else it costs
 * nothing; the gas has the same bits with it.
 *
 * Totals are taken behind every part of a step. What a part changes belongs to its cause: what sources change to each
 * of them, by its own formula (`gained` in libcore/models/source.h) or, where it has none, by what the formulas of
 * those that act with it leave; conduction to the walls' heat, stress to the walls' work, the stages to what flows
 * through open patches. Where there is no such cause, no wall that has a temperature, none that moves, no cooling, no
 * open patch, the scheme says that nothing may change: what does is unaccounted. A step that is done again counts once.
 */
#ifndef LIBCORE_AUDIT_H
#define LIBCORE_AUDIT_H

#include "libcore/gas/gas.h"

struct state;
struct audit;

/* The parts, in the order of a step. All do nothing where g->audit is NULL; collective. */
void audit_begin(struct gas *g); /* an attempt at a step, from g->U */
void audit_part(struct gas *g, enum gas_cause cause, const struct state *now);
/* audit_sources is called before the sources of a plan act on `from`, audit_sourced behind them. If the energy of a
 * source must be measured apart from that of the sources after it, audit_sources applies the plan up to that source to
 * `from` and puts the result into `scratch`; `from` stays as it is, so that the gas has the same bits. */
void audit_sources(struct gas *g, const struct source_plan *plan, const struct state *from,
                   const struct state *scratch);
void audit_sourced(struct gas *g, const struct state *now);
void audit_mark(struct gas *g, bool back); /* what follows may be done again; back: it is */
/* The attempt stands. */
status audit_keep(struct gas *g);
void audit_free(struct audit *a);

#endif
