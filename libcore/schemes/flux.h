/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numerical fluxes through a batch of faces: a table. A flux sees the stencil of its faces as line pointers, so rows of
 * tiles and gathered faces of any mesh serve alike. */
#ifndef LIBCORE_FLUX_H
#define LIBCORE_FLUX_H

#include "libcore/models/eos.h"
#include "libcore/models/kernel.h"
#include "libcore/schemes/reconstruct.h"

/* The rules that single faces of the flux `common` may follow (flux_private.h). */
enum face_rule { NO_RULE, SHOCK_RULE, EXPANSION_RULE, CONTACT_RULE };

/* n faces between the cells "left" and "right". A pointer stands at the left cell of face 0; cell m of a face's stencil
 * (m = -2 .. 3; left is 0, right is 1) is `stride` further per m. Components of vectors: normal first. */
struct faces {
    int n, dim;  /* dim: components of velocity, as many as the gas has */
    int beyond;  /* of these, the last ones, which lie along axes that the mesh lacks */
    int padding; /* of the n faces, the last ones that only fill a vector: their fluxes are not read */
    long stride;
    const double *state[MAX_VAR]; /* rho, rho u_normal, rho u_tangential .., E */
    const double *flux[MAX_VAR];  /* physical fluxes of the cells, along the normal */
    const double *velocity[MAX_DIM];
    const double *p; /* pressure of the cells; NULL: no face follows a rule of its own (flux_private.h) */
    /* [n] an enum face_rule each, where the caller has found them, and p those of contacts; NULL: the flux finds them.
     */
    const unsigned char *rule;
    /* [n] m/s: the least speed with which entropy and shears are split, for single faces beside the front of a
     * shock (docs/physics.md 6.12, rules of faces), 0: none; NULL: none at all */
    const double *floor;
    /* [n] 1 where the values of the cells take the place of reconstructed ones (first order), else 0; NULL: 0 */
    const double *flat;
    const double *eps, *c, *gruneisen; /* internal energy J/kg, sound speed, p_eps/rho of the cells */
    /* The pressure of gas at rest, which is taken from the flux of momentum: base[0], base[1] [n] in the left and the
     * right cells, and its rises from the other cells of a stencil to the next ones, as the other lines. on [n]: 1,
     * or 0 where nothing is taken, and both base are 0. NULL: nothing is taken. */
    const double *base[2], *rise, *on;
    const double *rest; /* [n] that pressure on the face itself, which the caller adds to the result; NULL likewise */
    bool falls;         /* does the gas feel gravity? */
    double fastest;     /* max |u_normal| + c of the whole domain (global Lax-Friedrichs) */
    const double *pace; /* [n] dt/dx, dt that of the Runge-Kutta step, for fluxes that are `paced`; may be NULL else */
    const struct own_params *params; /* of the flux; NULL: it has none */
    double *out[MAX_VAR];            /* [n] face fluxes */
};

/* A row of the table: `through` computes f->out, the fluxes through f's faces, with the reconstruction r. */
struct flux {
    struct model model;
    void (*through)(const struct faces *f, const struct eos *eos, const struct material *m,
                    const struct reconstruct *r);
    bool paced; /* does it depend on the time step? */
    bool damps; /* does it damp jumps of gas at rest? */
    bool means; /* are `state` in differences alone? Then means over the points of a face, and those of `flux`, serve */
    bool ruled; /* has it rules for single faces (flux_rules.h)? */
};

extern const struct flux flux_table[];
extern const int flux_count;
const struct flux *flux_find(const char *name); /* NULL: none */

/* Does what flux->through does under gravity (f->rise), but where gas is at rest by the flux `common` if the flux damps
 * jumps (flux_undamped.c). */
void flux_undamped(const struct flux *flux, const struct faces *f, const struct eos *eos, const struct material *m,
                   const struct reconstruct *r);

/* The first-order flux with a bound of the wave speeds (Rusanov 1961); eos, m and r are ignored. */
void flux_rusanov(const struct faces *f, const struct eos *eos, const struct material *m, const struct reconstruct *r);

/* Computes left (rows) and right (columns) eigenvectors of the Jacobian along the normal for one state, normal
 * component first, in the order u - c, entropy, shears, u + c (docs/physics.md 6.1). Tests look at the bases of the
 * fluxes by this function. */
struct basis { /* the state of one face, as the eigenvectors need it */
    double u[MAX_DIM], c, h /* total enthalpy */, b1 /* p_eps / (rho c^2) */;
};
void flux_eigenvectors(int dim, const struct basis *b, double left[MAX_VAR][MAX_VAR], double right[MAX_VAR][MAX_VAR]);

#endif
