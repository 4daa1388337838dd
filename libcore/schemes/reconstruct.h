/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Face values from cell averages: a table of one-dimensional reconstructions for lattices. Exact for constants, to the
 * last bit. */
#ifndef LIBCORE_RECONSTRUCT_H
#define LIBCORE_RECONSTRUCT_H

#include "libcore/models/kernel.h"
#include "libcore/models/param.h"

struct faces; /* libcore/schemes/flux.h */
struct bases; /* bases and winds: libcore/schemes/characteristic.h */
struct winds;

struct reconstruct {
    struct model model;
    int reach; /* cells used on each side: 0, 1 or 2 */
    /* Right-face values of the middle cells of n stencils of five (q[2] holds the cell, q[3] its downwind neighbour); a
     * left-face value is the same function on the mirrored stencil. */
    void (*face)(int n, const double *const q[5], double *restrict out);
    /* Amplitudes a[field] of the nodal fluxes projected on the faces' eigenbases, for faces from <= i < to (all lines
     * are those of the batch). `upwind` is for faces that split no field, `apart` the same on two bases, b[0] of the
     * left, b[1] of the right, of which each field takes that of its side: it is 0 on the other. `split` is for faces
     * that split no fields but those of `kind` (enum faces_kind) on one basis. `sided` gives the part that comes from
     * one side (+1: left, -1: right) of such faces. */
    void (*upwind)(int from, int to, const struct faces *f, const struct bases *restrict b,
                   const struct winds *restrict w, double (*restrict a)[BATCH]);
    void (*apart)(int from, int to, const struct faces *f, const struct bases *restrict b,
                  const struct winds *restrict w, double (*restrict left)[BATCH], double (*restrict right)[BATCH]);
    void (*split)(int from, int to, int kind, const struct faces *f, const struct bases *restrict b,
                  const struct winds *restrict w, double (*restrict a)[BATCH]);
    void (*sided)(int from, int to, const struct faces *f, const struct bases *restrict b,
                  const struct winds *restrict w, double side, double (*restrict a)[BATCH]);
};

extern const struct reconstruct reconstruct_table[];
extern const int reconstruct_count;
const struct reconstruct *reconstruct_find(const char *name); /* NULL: none */

#endif
