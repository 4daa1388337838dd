/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Face values from cell averages: a table of one-dimensional reconstructions for lattices. Exact for constants, to the
 * last bit. */
#ifndef LIBCORE_RECONSTRUCT_H
#define LIBCORE_RECONSTRUCT_H

#include "libcore/models/kernel.h"
#include "libcore/models/param.h"

/* The speed of a field at a face: from which side it comes, or the speed alpha >= 0 of a Lax-Friedrichs split. */
#define UPWIND_LEFT  (-1.)
#define UPWIND_RIGHT (-2.)

struct projected { /* a characteristic field at faces i: in cell m = -2 .. 3 of a face's stencil (left 0, right 1) it is
                    * scale factor[i] x[i + m x_stride] + y[i + m y_stride] */
    double scale;
    const double *factor, *x, *y;
    long x_stride, y_stride;
};

struct reconstruct {
    struct model model;
    int reach; /* cells used on each side: 0, 1 or 2 */
    /* Right-face values of the middle cells of n stencils of five (q[2] holds the cell, q[3] its downwind neighbour); a
     * left-face value is the same function on the mirrored stencil. */
    void (*face)(int n, const double *const q[5], double *restrict out);
    /* The values of a field q at n faces: `upwind` where none of them splits it, `apart` the same on two bases, 0 on
     * the side that it does not come from; `split` the sum of the parts of both sides, with w, the field of the states;
     * `sided` the part of one side (+1: left; -1: right, with q and w of mirrored stencils). */
    void (*upwind)(int n, const double *speed, const struct projected *q, double *restrict out);
    void (*apart)(int n, const double *speed, const struct projected q[2], double *restrict left,
                  double *restrict right);
    void (*split)(int n, const double *speed, const struct projected *q, const struct projected *w,
                  double *restrict out);
    void (*sided)(int n, const double *speed, double side, const struct projected *q, const struct projected *w,
                  double *restrict out);
};

extern const struct reconstruct reconstruct_table[];
extern const int reconstruct_count;
const struct reconstruct *reconstruct_find(const char *name); /* NULL: none */

#endif
