/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How sound is advanced in dense gas: a family of three rows, `explicit` (sound limits dt everywhere), `implicit`
 * (dense cells take an implicit acoustic step, libcore/acoustics/bed.h, and dt follows the flow) and `automatic` (they
 * do so where they can rest and cooling does not hold dt: libcore/gas/dense.c; which cells, and when: docs/physics.md
 * 9.2). */
#ifndef LIBCORE_ACOUSTICS_H
#define LIBCORE_ACOUSTICS_H

#include "libcore/models/param.h"

struct acoustics {
    struct model model;       /* its parameters fill a struct acoustics_params */
    bool implicit, automatic; /* are there implicit steps? only in beds that come to rest? */
};
extern const struct acoustics acoustics_table[];
extern const int acoustics_count;
const struct acoustics *acoustics_find(const char *name); /* NULL: there is none */

struct acoustics_params {
    double dense;    /* fraction of alphaMax; cells above it are implicit */
    double thin;     /* fraction of alphaMax; cells below it are implicit where they would limit dt */
    double gain;     /* dt over dt of the explicit scheme from which on a step is implicit */
    double governor; /* dt times the rate of cooling in the dense cells is at most this */
    double soft;     /* s of bed.h: keeps cells from moving against their faces */
    double keep;     /* b of bed.h: part of eps that a step may take beyond p dV */
};
struct acoustics_params acoustics_params(const struct own_params *own);

#endif
