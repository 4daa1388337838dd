/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A mesh with two or three solved axes as a lattice for libcore/segregation/segregation_lattice.h: flow, percolation
 * and diffusivity on its faces. */
#ifndef SOLVERS_SEGREGATION_BOX_H
#define SOLVERS_SEGREGATION_BOX_H

#include "libcore/segregation/segregation_lattice.h"
#include "libcore/segregation/solenoidal.h"
#include "mesh/base/pool.h"
#include "solvers/case/case.h"
#include "solvers/segregation/segregation_flow.h"

struct segregation_box {
    struct pool *pool;                  /* has the lists */
    struct segregation_lattice lattice; /* the slab of this rank */
    long cells;                         /* number of places in the slab, holes included */
    /* [faces] of each axis; weight: [cells] capacity, kg/m^3; NULL: 1 */
    double *u[3], *f[3], *D[3], *value[3], *weight;
    /* [faces][5] of each axis, NULL without D(phi): the other variables of D: x, shear rate, weight */
    double *around[3];
    /* [faces] of each axis: is the face inside the mesh? on a patch with a given phi? */
    bool *open[3], *fixed[3];
    bool through; /* does a patch let something through? */
    const struct segregation_models *models;
    bool flows;                     /* is U not 0 somewhere? */
    struct face_flow_change change; /* how U was made free of divergence, if it flows */
};
/* Fails unless the mesh and the choices are those that segregation on a lattice takes. */
status segregation_box_check(const struct setup *s, const struct segregation_models *m);
/* Fills *out for the field phi as it was read; its lists are in the pool. Collective. */
status segregation_box_make(struct pool *pool, const struct setup *s, const struct segregation_models *m,
                            const struct segregation_places *p, const struct field *phi,
                            const struct segregation_flow *flow, struct segregation_box *out);

#endif
