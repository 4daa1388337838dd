/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities that the gas carries (models/carried.h; docs/physics.md 7.5). In the stages of an attempt at a step the
 * engine sums up the mass that crosses each face. When the step stands, all quantities move at once by that mass, from
 * the state before to that behind it, so that refused, repeated and limited stages need no care:
 *     rho' phi' V = rho phi V - sum_f [M_f phi_f + P_f phi_from (1 - phi_to) - K_f (phi_out - phi)],   M_f outwards,
 * M_f being the mass (Lin & Rood, Mon. Weather Rev. 124, 2046, 1996, carry tracers so), P_f = dt A rho f d.n and K_f =
 * dt A rho D/h. As rho' V = rho V - sum M_f, a cell computes
 *     phi' = phi - sum_f [M_f (phi_f - phi) + ..]/(rho' V),
 * and a uniform phi keeps its bits. phi_f is that of the cell that mass leaves: linear in the cell, at the middle of
 * what leaves it in the step, phi + s.(x_f - x - u dt/2), which is of second order in space and time.
 *
 * Bounds. Let out = sum_f (mass out of the cell + |P_f| + K_f). What stays behind, rho phi V - sum of what leaves, must
 * be a mixture of the values in the cell and around it: the slope of a cell is multiplied by the greatest factor <= 1
 * for which that is so, and for which each phi_f lies between the least and the largest of these values. For out <= rho
 * V phi' is then a mean of values of phi, with weights >= 0. What percolates makes a mixture richer than its
 * neighbours, but no less than 0 and no more than 1, as small grains leave a cell as P_f phi_f at most, and large ones
 * as P_f (1 - phi_f). On polyhedra K_f counts twice: gradients bring at most as much as would take phi to its bounds. A
 * step in which more leaves a cell is cut into equal parts.
 *
 * Nothing here costs anything in a gas that carries nothing: g->carried is NULL. */
#ifndef LIBCORE_GAS_CARRIED_H
#define LIBCORE_GAS_CARRIED_H

#include "libcore/gas/gas.h"

struct carried_quantity {
    struct carried_choice choice;
    unsigned terms;           /* bits of enum carried_terms */
    const struct rule **rule; /* [npatches] of phi; the rules are borrowed */
    double **phi;             /* [blocks][size] with a layer of ghosts */
};
struct carried {
    int n;
    struct carried_quantity *quantity; /* [n] */
    unsigned terms;                    /* of all of them */
    double up[MAX_DIM];                /* unit, against gravity; 0 without it */
    /* [blocks][g->blocks.faces]: the mass through the faces in the last stage, later what carries phi; the mass in the
     * attempt so far (kg; on a lattice per area); P and K of the quantity in hand */
    double **flux, **mass, **exchange, **spread;
    /* [blocks][size], with a layer of ghosts: rho, the less of before and behind the step; D; f. NULL without terms.
     * rho T and its slope along `up`; NULL unless a kind asks for it */
    double **rho, **D, **f, **stress, **rise;
    bool clear; /* are exchange and spread 0? */
};

struct carried_part {       /* of a step, which is cut into equal parts */
    double from, to, share; /* begin, end and length as fractions of the step */
};

struct carried_hooks {                       /* of an engine; kernels, whose ghosts are filled */
    void (*rise)(struct gas *g);             /* computes g->carried->rise of the line `stress` */
    void (*terms)(struct gas *g, double dt); /* computes P and K of the lines rho, D and f */
    /* Returns the largest over the cells of this rank of what carried_share says. */
    double (*most_out)(const struct gas *g);
    /* Moves phi over a part of a step. Collective. */
    void (*move)(struct gas *g, const struct carried_quantity *q, struct carried_part part);
};

/* Into how many parts must a step be cut in which `out` leaves a cell, whose mass goes from `before` to `now` in equal
 * steps? At the begin of each part the cell must have at least out/parts; so it has, if the first and the last do. */
static inline double carried_share(double out, double before, double now) {
    const double first = out / before, last = (out - (before - now)) / now;
    return first > last ? first : last;
}

status carried_make(struct gas *g);
void carried_free(struct gas *g);
void carried_begin(struct gas *g);               /* an attempt at a step begins */
void carried_keep(struct gas *g, double weight); /* a stage is done, of which the time `weight` (s) reaches the end */
/* The step of dt from t on stands: g->V has the state before, g->U that behind it. Collective. */
status carried_move(struct gas *g, double t, double dt);

#endif
