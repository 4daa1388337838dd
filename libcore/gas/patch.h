/* The edge of the domain as both engines see it: states beyond patches for the fluxes, and sums beyond them for
 * diffusion, by the boundary types of libcore/models/boundary.h. */
#ifndef LIBCORE_PATCH_H
#define LIBCORE_PATCH_H

#include "libcore/gas/gas_private.h"

struct patch_line {        /* ghosts along a patch */
    int n;                 /* <= BATCH */
    int normal;            /* component along the normal, where the patch reflects */
    const int *face;       /* [n] within the patch */
    const double *outflow; /* [n] velocity out of the domain, where the patch needs values */
};
bool patch_needs_values(const struct patch_rules *r);
/* ghost <- the rules of a patch on `inner` (which may be changed): conserved variables [nvar]. */
void patch_ghosts(const struct gas *g, const struct patch_rules *r, const struct patch_line *l, double (*inner)[BATCH],
                  double (*ghost)[BATCH]);

struct sum_line {              /* n <= BATCH cells along a patch and what lies beyond them */
    int n, components, normal; /* component along the normal; of a scalar -1 */
    const int *face;           /* [n] within the patch */
    double weight;             /* of S when q is 1 */
    double (*inner)[BATCH], (*start)[BATCH], (*ghost)[BATCH]; /* S inside, q_0 beyond; the result */
};
/* S beyond a patch, by its rules; reflect_sums: as for a velocity without a value. Where a rule reflects, components
 * are in the frame of the face, else in the axes of the mesh (libcore/polyhedral/cells_edge.c). carry_sums comes after
 * sums_beyond, in the axes of the mesh: it adds the wall's own velocity to `ghost`.
 * Heat crosses some walls (wall_conducts): of these sums_beyond gives S of the wall itself, and the heat that enters is
 *     share * heat (S_wall - S)/d,  d: from the cell to its mirror image,
 * share from wall_shares, by the density and the temperature inside that the coefficients are those of; push: what
 * pulls the gas onto the wall, m/s^2. */
void sums_beyond(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l);
void carry_sums(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l);
bool wall_conducts(const struct patch_rules *rules);
void wall_shares(const struct gas *g, const struct patch_rules *rules, int n, const double *rho, const double *T,
                 const double *push, const double *d, const double *heat, double *share);
void reflect_sums(const struct patch_rules *rules, const struct sum_line *l);

#endif
