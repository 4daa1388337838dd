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
/* ghost <- the rules of a patch on `inner` (which may be changed): conserved variables [nvar]. */
void patch_ghosts(const struct gas *g, const struct patch_rules *r, const struct patch_line *l, double (*inner)[BATCH],
                  double (*ghost)[BATCH]);

struct sum_line {              /* n <= BATCH cells along a patch and what lies beyond them */
    int n, components, normal; /* component along the normal; of a scalar -1 */
    const int *face;           /* [n] within the patch */
    double weight;             /* of S when q is 1 */
    const double *share;       /* [n] of drag, from wall_shares; of a velocity beyond a wall */
    double (*inner)[BATCH], (*start)[BATCH], (*ghost)[BATCH]; /* S inside, q_0 beyond; the result */
};
/* S beyond a patch, by its rules. Beyond a wall of the share a of drag and velocity w
 *     S_n = -S_n inside,  S_t = (1 - a) S_t inside + a weight w_t,
 * so that the jump across the face is that of the stress and the mean of both sides the velocity of the gas on the wall
 * itself. There components are in the frame of the face, elsewhere in the axes of the mesh
 * (libcore/polyhedral/cells_edge.c). carry_sums comes after sums_beyond, in the axes of the mesh: it adds the term of
 * w. reflect_sums: without it, as of derivatives along the wall.
 * Where heat crosses a wall (wall_conducts) sums_beyond gives S of the wall itself, and the heat that enters is
 *     share * heat (S_wall - S)/d,  d: from the cell to its mirror image. */
void sums_beyond(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l);
void carry_sums(const struct patch_rules *rules, enum diffusing what, const struct sum_line *l);
void reflect_sums(const struct patch_rules *rules, const struct sum_line *l);

#endif
