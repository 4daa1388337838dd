/* Face values from cell averages: a table of one-dimensional reconstructions.
 *
 * face: right-face value of the middle cell of five (q[2] holds the cell, q[3] its downwind neighbour), for n cells; a
 * left-face value is the same function on the mirrored stencil. Exact for constants, to the last bit. */
#ifndef LIBCORE_RECONSTRUCT_H
#define LIBCORE_RECONSTRUCT_H

#include "libcore/models/kernel.h"
#include "libcore/models/param.h"

struct faces; /* libcore/schemes/flux.h */
struct bases; /* libcore/schemes/characteristic.h, as is winds */
struct winds;

struct reconstruct {
    struct model model;
    int reach; /* cells used on each side: 0, 1 or 2 */
    void (*face)(int n, const double *const q[5], double *restrict out);
    /* Amplitudes a[field] of the nodal fluxes projected on the faces' eigenbases, for faces from <= i < to (all lines
     * are those of the batch): of faces that split no field, without the ones of speed `drop`; of faces that split
     * some; what comes from one side of such faces. */
    void (*upwind)(int from, int to, const struct faces *f, const struct bases *restrict b,
                   const struct winds *restrict w, double drop, double (*restrict a)[BATCH]);
    void (*split)(int from, int to, const struct faces *f, const struct bases *restrict b,
                  const struct winds *restrict w, double (*restrict a)[BATCH]);
    void (*sided)(int from, int to, const struct faces *f, const struct bases *restrict b,
                  const struct winds *restrict w, double side, double (*restrict a)[BATCH]);
};

extern const struct reconstruct reconstruct_table[];
extern const int reconstruct_count;
const struct reconstruct *reconstruct_find(const char *name); /* NULL: none */

#endif
