/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a step takes out of the gas through the faces of patches, for the forces on patches and the budget
 * (docs/physics.md 5.7), to the round-off of the state itself: the fluxes of
 * the Runge-Kutta stages by the weights with which they reach the end of the step, what the halves of diffusion pass
 * on, and what a bed of implicit acoustics exchanges. It is kept on request (gas_tally), else it costs nothing; the gas
 * has the same bits with it.
 *
 * An engine has a line of numbers over the faces of patches of this rank's cells, in an order of its own, and adds to
 * the lines of the attempt in hand wherever it moves the state by such a face. What leaves the gas counts positive.
 * Parts that are done again are taken back to the last note; a step that stands becomes the `last` one. */
#ifndef LIBCORE_TALLY_H
#define LIBCORE_TALLY_H

#include "libcore/gas/gas.h"

struct tally {
    int faces;                /* on this rank */
    int *first;               /* belongs to the engine: where its parts begin in the lines, or NULL */
    double *stage[MAX_VAR];   /* [nvar][faces] fluxes of the stage in hand */
    bool borrowed;            /* do the lines of `stage` belong to the engine? */
    double *flow[MAX_VAR];    /* [nvar][faces] by the stages and the bed: mass, momentum, energy */
    double *passed[MAX_VAR];  /* [nvar][faces] by diffusion: momentum, work of the stress, heat */
    double *mark[MAX_VAR];    /* `passed` at the last note */
    double *warm;             /* [faces] the heat in `passed` before conduction */
    double *last[2][MAX_VAR]; /* flow and passed of the last step that stands */
    double dt;                /* s: its length; 0: there is none yet */
};

struct tally_hooks {
    /* Sets t->faces and, if it has them, t->first and t->stage. */
    status (*make)(const struct gas *g, struct tally *t);
    /* Takes from `flow` weight times what the fluxes of the last stage have of gas at rest; NULL: nothing. */
    void (*still)(struct gas *g, double weight);
    /* Sets `flow` through the faces of cells of the bed, whose stages are given up, to what the bed exchanged over dt.
     * In an explicit step it adds that instead, which is friction alone.
     */
    void (*bed)(struct gas *g, double dt);
    /* Visits the faces of a block with their values in the last step (gas_tally_faces). */
    void (*visit)(const struct gas *g, int block, gas_face_visitor *visit, void *context);
    /* Sums what a state at rest is balanced with in the last stage, force[dim] (N). Collective; NULL: nothing. */
    status (*rest)(const struct gas *g, double force[MAX_DIM]);
};

/* The parts, in the order of a step. All do nothing if g->books.tally is NULL. */
void tally_begin(struct gas *g); /* an attempt at a step begins */
void tally_stage(struct gas *g, double weight);
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
/* Fills a face's numbers from place i of the lines: rates of the last step, times `scale`. */
void tally_face(const struct gas *g, int i, double scale, struct gas_face *out);

#endif
