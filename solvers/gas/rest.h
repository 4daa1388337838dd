/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a case says to be at rest: a hydrostatic settledLayer, without its perturbation, of the folder that the case
 * started from. */
#ifndef SOLVERS_REST_H
#define SOLVERS_REST_H

#include "libcore/gas/gas.h"
#include "solvers/case/case.h"

/* Tells a gas on polyhedra under gravity (gas_rest) what is at rest, if a settledLayer was the start; the state of the
 * gas is lost. That start is the newest time folder, up to the one that this run starts from, which no run has written:
 * so a restart has the same balance. *missing: is there no such folder, so that nothing is known? Collective. */
status rest_lay(const struct setup *s, const struct gas_models *models, struct gas *g, bool *missing);

#endif
