/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The flow that carries a mixture: U of the start folder or of a time of another case, and the other fields of a flow
 * that the laws of segregation want. */
#ifndef SOLVERS_SEGREGATION_FLOW_H
#define SOLVERS_SEGREGATION_FLOW_H

#include "solvers/case/case.h"
#include "solvers/segregation/segregation_models.h"
#include "solvers/segregation/segregation_places.h"

/* The arrays are of the cells of a line, in the order of the mesh, or of the places of a lattice. */
struct segregation_flow {
    /* the start folder's U with its patches; NULL: the mixture is at rest, or U comes from another case */
    struct field *given;
    double *U;                  /* [n][3] m/s; NULL: the mixture is at rest */
    double *density;            /* [n] the weight, kg/m^3; NULL: 1 */
    double *shear_rate;         /* [n] sqrt(2 S:S), 1/s, if a law asks for it; else NULL */
    double *percolation;        /* [n] m/s, from the kinetic stress, with two or three solved axes; else NULL */
    char source[2 * TIME_NAME]; /* "0/U", "time 0.04 of that case" */
};
/* Reads the flow, on a lattice in the given places (NULL: a line). On a line its component along the line is 0, because
 * the line ends in walls; on a lattice only the solved axes count. U of the start folder is read in slices; with a law
 * of the shear rate, and from another case, every rank reads all of it and keeps its part. Fills *out; call
 * segregation_flow_free after success and failure. Collective. */
status segregation_flow_read(const struct setup *s, const struct segregation_models *m,
                             const struct segregation_places *p, struct segregation_flow *out);
void segregation_flow_free(struct segregation_flow *f);

/* Computes (q/rho) d(rho T)/dy, m/s, at node[n] (m, ascending, along the physical axis), from fields of a granularGas
 * run, averaged over the other axes. The error names what is missing. */
status stress_velocity(const struct setup *s, const struct segregation_models *m, int axis, int n, const double *node,
                       double *out);

#endif
