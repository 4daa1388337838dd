/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The flow that carries a mixture: U of the start folder or of a time of another case, and the other fields of a flow
 * that the laws of segregation want. */
#ifndef SOLVERS_SEGREGATION_FLOW_H
#define SOLVERS_SEGREGATION_FLOW_H

#include "solvers/case/case.h"
#include "solvers/segregation/segregation_models.h"

struct segregation_flow {
    /* the start folder's U with its patches; NULL: the mixture is at rest, or U comes from another case */
    struct field *given;
    double *U;                  /* [ncells][3] m/s; NULL: the mixture is at rest */
    double *density;            /* [ncells] the weight, kg/m^3; NULL: 1 */
    double *shear_rate;         /* [ncells] sqrt(2 S:S), 1/s, if a law asks for it; else NULL */
    double *percolation;        /* [ncells] m/s, from the kinetic stress, with two or three solved axes; else NULL */
    char source[2 * TIME_NAME]; /* "0/U", "time 0.04 of that case" */
};
/* Reads the flow. On a line its component along the line is 0, because the line ends in walls; on a lattice only the
 * solved axes count. Fills *out; call segregation_flow_free after success and failure. */
status segregation_flow_read(const struct setup *s, const struct segregation_models *m, struct segregation_flow *out);
void segregation_flow_free(struct segregation_flow *f);

/* Computes (q/rho) d(rho T)/dy, m/s, at node[n] (m, ascending, along the physical axis), from fields of a granularGas
 * run, averaged over the other axes. The error names what is missing. */
status stress_velocity(const struct setup *s, const struct segregation_models *m, int axis, int n, const double *node,
                       double *out);

#endif
