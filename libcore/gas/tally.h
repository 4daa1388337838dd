/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a step takes out of the gas through the faces of patches, for the forces on patches and the budget
 * (docs/physics.md 5.7), to the round-off of the state itself: the fluxes of
 * the Runge-Kutta stages by the weights with which they reach the end of the step, what the halves of diffusion pass
 * on, and what a bed of implicit acoustics exchanges. It is kept on request (gas_tally), else it costs nothing; the gas
 * has the same bits with it.
 *
 * An engine adds to the lines of the attempt in hand wherever it moves the state by a face of a patch. What leaves the
 * gas counts positive.
 * Parts that are done again are taken back to the last note; a step that stands becomes the `last` one. */
#ifndef LIBCORE_TALLY_H
#define LIBCORE_TALLY_H

#include "libcore/gas/gas.h"

struct tally {
    int faces;                /* on this rank, in the order of g->patches.side */
    double *stage[MAX_VAR];   /* [nvar][faces] fluxes of the stage in hand */
    double *flow[MAX_VAR];    /* [nvar][faces] by the stages and the bed: mass, momentum, energy */
    double *passed[MAX_VAR];  /* [nvar][faces] by diffusion: momentum, work of the stress, heat */
    double *mark[MAX_VAR];    /* `passed` at the last note */
    double *warm;             /* [faces] the heat in `passed` before conduction */
    double *last[2][MAX_VAR]; /* flow and passed of the last step that stands */
    double dt;                /* s: its length; 0: there is none yet */
};

struct tally_hooks {
    /* Takes from `flow` weight times what the fluxes of the last stage have of gas at rest, and sums what such gas is
     * balanced with, force[dim] (N; NULL: it is not wanted). Collective if it is. NULL: there is none. */
    status (*rest)(struct gas *g, double weight, double *force);
};

/* The parts, in the order of a step. All do nothing if g->books.tally is NULL. */
void tally_begin(struct gas *g); /* an attempt at a step begins */
/* force: as tally_hooks.rest says. */
status tally_stage(struct gas *g, double weight, double *force);
void tally_bed(struct gas *g, double dt);
/* Notes the sums of diffusion before a part of it that may be done again. back: returns to the last note first, because
 * the part is done again. */
void tally_mark(struct gas *g, bool back);
/* Does the same for conduction, within such a part. */
void tally_mark_heat(struct gas *g, bool back);
void tally_keep(struct gas *g, double dt); /* the attempt stands */
void tally_free(struct tally *t);
/* Adds weight times a line of fluxes to a line. */
void tally_add(const struct tally *t, double weight, const double *flux, double *to);

#endif
