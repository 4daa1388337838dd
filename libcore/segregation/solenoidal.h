/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Projects face velocities on a lattice to the nearest ones without divergence (segregation_lattice.h and
 * docs/physics.md 11.4 need them). */
#ifndef LIBCORE_SOLENOIDAL_H
#define LIBCORE_SOLENOIDAL_H

#include "libcore/models/kernel.h"
#include "mesh/base/comm.h"

struct face_flow {       /* faces of axis k: n[k] + 1 along it, axis 0 fastest; cells likewise */
    int dim, n[MAX_DIM]; /* n: cells along each axis, 1 beyond dim */
    /* NULL: n counts all cells; else those of this rank's slab, as in segregation_lattice.h, and the projection is
     * collective */
    const struct comm *comm;
    double width[MAX_DIM];
    double *u[MAX_DIM];        /* [faces of axis k] m/s; 0 on walls */
    const bool *open[MAX_DIM]; /* [faces of axis k] is the face an inner one and no wall? false on the boundary */
    bool cyclic[MAX_DIM];      /* the first and the last faces of the axis are the same: u and open are, too */
};
struct face_flow_change {
    double scaled;        /* factor on the outflow through the boundary that made it equal the inflow */
    double largest;       /* largest change of an inner face's u, m/s */
    double before, after; /* largest |divergence| before and after, 1/s */
    int iterations;
};
/* Adds grad p to u on the open faces so that div u = 0: the least change in the sum of squares, by conjugate gradients.
 * The boundary's u stays but for `scaled`. Fails with ERR_INPUT if flow enters but none leaves (or the reverse), or if
 * a closed room has an inlet. */
status face_flow_project(struct face_flow *flow, struct face_flow_change *change);

#endif
