/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Face values from cell averages: a table of one-dimensional reconstructions for lattices. Exact for constants, to the
 * last bit. */
#ifndef LIBCORE_RECONSTRUCT_H
#define LIBCORE_RECONSTRUCT_H

#include "libcore/models/kernel.h"
#include "libcore/models/param.h"

struct reconstruct {
    struct model model;
    int reach; /* cells used on each side: 0, 1 or 2 */
    /* Right-face values of the middle cells of n stencils of five (q[2] holds the cell, q[3] its downwind neighbour); a
     * left-face value is the same function on the mirrored stencil. */
    void (*face)(int n, const double *const q[5], double *restrict out);
};

extern const struct reconstruct reconstruct_table[];
extern const int reconstruct_count;
const struct reconstruct *reconstruct_find(const char *name); /* NULL: none */

#endif
