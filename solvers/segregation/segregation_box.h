/* A mesh with two or three solved axes as a lattice for libcore/segregation/segregation_lattice.h: flow, percolation
 * and diffusivity on its faces. */
#ifndef SOLVERS_SEGREGATION_BOX_H
#define SOLVERS_SEGREGATION_BOX_H

#include "libcore/segregation/segregation_lattice.h"
#include "libcore/segregation/solenoidal.h"
#include "solvers/case/case.h"
#include "solvers/segregation/segregation_flow.h"

struct segregation_box {
    struct segregation_lattice lattice;
    long cells;                                      /* of the box, holes included */
    int *place;                                      /* [ncells] index in the box of each polyMesh cell */
    double *u[3], *f[3], *D[3], *inflow[3], *weight; /* weight: capacity of the cells; NULL: 1 */
    double *around[3]; /* with D(phi), else NULL: [faces][5] of what it depends on besides: x, shear rate, weight */
    bool *open[3];
    const struct segregation_models *models;
    bool flows;                     /* U is not 0 everywhere */
    struct face_flow_change change; /* what made U free of divergence, where it flows */
};
/* phi as read. Fills *out; segregation_box_free after success and failure. */
status segregation_box_make(const struct setup *s, const struct segregation_models *m, const struct field *phi,
                            const struct segregation_flow *flow, struct segregation_box *out);
void segregation_box_free(struct segregation_box *b);

#endif
