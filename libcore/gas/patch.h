/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The edge of the domain as both engines see it: states beyond patches for the fluxes, and sums beyond patches for
 * diffusion, by the boundary types of libcore/models/boundary.h: open patches (docs/physics.md 5.2) and walls of a gas
 * with transport (docs/physics.md 5.3). */
#ifndef LIBCORE_PATCH_H
#define LIBCORE_PATCH_H

#include "libcore/gas/gas_private.h"

struct patch_line {        /* n ghosts along a patch */
    int n;                 /* <= BATCH */
    int normal;            /* component along the normal, if the patch reflects */
    const int *face;       /* [n] faces within the patch */
    const double *outflow; /* [n] m/s: velocity out of the domain, if the patch needs values */
    int layer;             /* of ghosts, as in struct ghost_line; 0: the states on the patch are wanted */
    double (*next)[BATCH]; /* [nvar][n] with layer > 0: the cells behind `inner`; may be changed. NULL: unknown */
};
/* Computes the ghosts of a patch from `inner`, which may be changed, by its rules: conserved variables [nvar][n]. */
void patch_ghosts(const struct gas *g, const struct patch_rules *r, const struct patch_line *l, double (*inner)[BATCH],
                  double (*ghost)[BATCH]);

/* Returns the coefficient of friction of packed gas on a face of a patch (wall_friction): 0 if it is no wall. velocity:
 * of the wall there, [components]. */
double patch_wall_friction(const struct gas *g, int patch, int face, double velocity[MAX_DIM]);

struct fed_faces { /* n <= BATCH faces of a patch that feeds */
    int n;
    const int *face;        /* [n] faces within the patch */
    const double *into;     /* [n] what patch_feed gives along the normals into the domain */
    const double *U;        /* conserved variables, g->size apart */
    const int *in, *beyond; /* [n] places of the cells inside and of those beyond */
    double (*flux)[BATCH];  /* [nvar][n] into the domain */
};
/* Gives the fluxes through faces of a patch that feeds (patch_feeds) the mass that it gives: what is missing comes with
 * velocity and enthalpy of the gas beyond, and what is too much goes back as gas of the cell, so that either keeps an
 * admissible cell admissible. The pressure on the faces stays the flux's own. */
void feed_fluxes(const struct gas *g, const struct patch_rules *r, const struct fed_faces *f);

struct sum_line {              /* n <= BATCH cells along a patch, and S (diffusion.h) of one variable beyond them */
    int n, components, normal; /* normal: component along the normal, -1 for a scalar */
    const int *face;           /* [n] faces within the patch */
    double weight;             /* the value of S if q were 1 throughout */
    const double *share;       /* [n] at a wall the share of drag, from wall_shares; beyond an open patch the inflow */
    /* [components][n] inner: S in the cells; start: q_0 beyond the patch; ghost, the result: S beyond the patch */
    double (*inner)[BATCH], (*start)[BATCH], (*ghost)[BATCH];
};
/* Returns the share of a face of an open patch: 1 where gas flows in, else 0. outflow: velocity out of the domain. */
static inline double inflow_share(double outflow) {
    return outflow < 0 ? 1 : 0;
}
/* Compute S beyond a patch, by its rules. Beyond a wall of the share a of drag and the velocity w
 *     S_n = -S_n inside,  S_t = (1 - a) S_t inside + a weight w_t,
 * so that the jump across the face gives the stress, and the mean of both sides is the velocity of the gas on the wall
 * itself. Components are in the frame of the face at a wall, and in the axes of the mesh at other patches
 * (libcore/polyhedral/cells_edge.c). sums_beyond leaves out the term of w; carry_sums adds it afterwards, in the axes
 * of the mesh. reflect_sums is for derivatives along the wall, which have no such term.
 * Where heat crosses a wall (wall_conducts) sums_beyond gives S of the wall itself, and the heat that enters is
 *     share * heat (S_wall - S)/d,  d: from the cell to its mirror image. */
void sums_beyond(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l);
void carry_sums(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l);
void reflect_sums(const struct patch_rules *rules, const struct sum_line *l);

#endif
