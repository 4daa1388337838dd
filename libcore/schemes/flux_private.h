/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of the fluxes share: states that are reconstructed to faces, and the fluxes that have a file of their
 * own. */
#ifndef LIBCORE_FLUX_PRIVATE_H
#define LIBCORE_FLUX_PRIVATE_H

#include "libcore/schemes/characteristic.h"
#include "libcore/schemes/flux_rules.h"

struct face_states { /* states at n faces, from one side */
    ALIGNED double rho[BATCH], u[MAX_DIM][BATCH], eps[BATCH], p[BATCH], c[BATCH] /* c^2, not c */, gruneisen[BATCH];
    double good[BATCH];
};

/* Reconstructs states to the faces from one side (+1: left, -1: right), rho, u and T (as eps) by the same operator. A
 * state that is not admissible is replaced by the cell's. */
void flux_sided_states(const struct faces *f, const struct eos *eos, const struct material *m, int side,
                       const struct reconstruct *r, struct face_states *s);

/* Reconstructs lines of cells to the faces, line[2] beside them and line[3] beyond; where f->flat, takes line[2]. */
void flux_reconstruct_lines(const struct faces *f, const struct reconstruct *r, const double *const line[5],
                            double *out);

/* Reconstructs a line q of cells to the faces from one side (+1: left, -1: right). */
void flux_reconstruct(const struct faces *f, const double *q, int side, const struct reconstruct *r, double *out);

/* Does so with component k of u. Tangential ones are taken relative to the cell beside the face: the epsilon of the
 * weights follows the values, and the result must not depend on a speed along the face that all gas has. */
void flux_sided_velocity(const struct faces *f, int k, int side, const struct reconstruct *r, double *out);

/* Does so with p. Under gravity it subtracts the pressures of gas at rest first, and adds that of the face afterwards.
 */
void flux_sided_pressure(const struct faces *f, int side, const struct reconstruct *r, double *out);

/* ---- rules of single faces (flux_rules.c; docs/physics.md 6.12) ----
 *
 * Four kinds of faces of the flux `common` follow a rule of their own (commonCoeffs; by default on lattices, that of
 * fronts everywhere); all others keep their flux to the bit, but for smooth faces (flux_smooth.c). The fluxes stay
 * consistent and single, so everything is conserved. No rule but the last acts where all waves run one way. Numbers and
 * reasons: postprocessing/reports/denseShocks.md.
 * - Strong shocks (the pressure rises 30 times over four cells that nearly fulfil the Hugoniot relation; and the faces
 *   beside): the entropy is split with max(|u| + c), and reconstructed by PHM. Upwinded, entropy is not damped inside
 *   of a shock, and what each crossed cell leaves of it stays behind as noise of the density.
 * - Steep expansions (the pressure of one cell is 1.5 times that of the other, and they part, slower than half of the
 *   sum of both speeds of sound, faster than 0.3 |dp|/(rho c)): the fields u - c and u + c are split with 0.5 of their
 *   larger speed, with less in dense gas, and with more near packing. While the expansion of dense gas lies within a
 * few cells, full damping heats the gas, which then pushes the shock ahead of it. Faster, gas makes a void, and less
 *   damping would have to be limited. Not under gravity: a bed that is thrown up has steep pressures for long, and less
 *   damping makes it less accurate.
 * - Contacts of dense gas (g = p_eps/rho changes 2 times over four cells, p less than 1.5 times; never in a perfect
 *   gas): HLLC of reconstructed rho, u, p. One eigenbasis does not keep p and u where g jumps.
 * - Faces beside the front of a shock (struct faces' floor, which the engines find: a face across which the gas closes
 *   in and the pressure differs 2 times gives its cells a speed, and the other faces of these cells and of those beside
 *   take it): entropy and shears are split with that speed. Else nothing damps them along a front that stands along a
 *   line of the mesh, and it breaks up (the carbuncle of Quirk 1994). Where waves run both ways, and cells differ. */
struct face_span { /* faces from .. to - 1 of a batch; none if from >= to */
    int from, to;
};
struct rules { /* 1 where a face follows a rule, else 0 */
    double shock[BATCH], expansion[BATCH], contact[BATCH];
    struct face_span shocks, contacts; /* the faces outside follow no such rule; the arrays are set inside */
};

/* Gives the faces beside fronts, f->floor, another wind of entropy and shears. */
void rules_fronts(const struct faces *f, struct winds *w);
/* Finds the faces that follow a rule and gives those of expansions other winds. */
void rules_find(const struct faces *f, struct winds *w, struct rules *r);
/* Computes the fluxes f->out of contacts. */
void rules_contacts(const struct faces *f, const struct eos *eos, const struct material *m, const struct reconstruct *r,
                    const struct rules *rules);

/* Returns the faces of a span alone. The rules that the caller has found are read no more. */
struct faces faces_of_span(const struct faces *f, struct face_span s);

/* ---- smooth faces (flux_smooth.c; docs/physics.md 6.12) ---- */

/* Marks the faces that are not smooth (1, else 0); returns how many they are, f->n if there are no others. */
int smooth_find(const struct faces *f, double *rough);
/* Makes s the next run of whole vectors that holds rough faces, from s->to on; returns whether there is one. */
bool smooth_ends(int n, const double *rough, struct face_span *s);
/* Computes the fluxes of all faces but the rough ones by the linear scheme of fifth order. */
void smooth_through(const struct faces *f, const double *rough);

/* ---- centred fluxes (flux_force.c) ---- */

struct musta {        /* parameters of MUSTA */
    double tolerance; /* it stops when F changes by less than this part of itself */
    int stages;       /* most times that the two states are advanced */
};
OWN_PARAMS_FIT(struct musta);

void flux_force(const struct faces *f, const struct eos *eos, const struct material *m, const struct reconstruct *r);
void flux_musta(const struct faces *f, const struct eos *eos, const struct material *m, const struct reconstruct *r);

#endif
