/* Face velocities without divergence, as near as possible to given ones (segregation_lattice.h needs them). */
#ifndef LIBCORE_SOLENOIDAL_H
#define LIBCORE_SOLENOIDAL_H

#include "libcore/models/kernel.h"
#include "mesh/base/status.h"

struct face_flow {       /* faces of axis k: n[k] + 1 along it, axis 0 fastest; cells likewise */
    int dim, n[MAX_DIM]; /* 1 beyond dim */
    double width[MAX_DIM];
    double *u[MAX_DIM];        /* m/s; 0 on walls */
    const bool *open[MAX_DIM]; /* inner faces that are no walls; false on the boundary */
    bool cyclic[MAX_DIM];      /* the first and the last faces of the axis are the same: u and open are, too */
};
struct face_flow_change {
    double scaled;        /* what leaves through the boundary was multiplied by it, to be what enters */
    double largest;       /* change of an inner face's u, m/s */
    double before, after; /* largest |divergence|, 1/s */
    int iterations;
};
/* u <- u + grad p on the open faces, div u = 0: the least change in the sum of squares, by conjugate gradients. The
 * boundary's u stays but for `scaled`. ERR_INPUT: nothing leaves of what enters, or a closed room has an inlet. */
status face_flow_project(struct face_flow *flow, struct face_flow_change *change);

#endif
