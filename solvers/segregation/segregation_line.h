/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A mesh with one solved axis as a line for libcore/segregation/segregation.h: its cells in order, the places of faces
 * and values, f and D. */
#ifndef SOLVERS_SEGREGATION_LINE_H
#define SOLVERS_SEGREGATION_LINE_H

#include "mesh/base/pool.h"
#include "solvers/case/case.h"
#include "solvers/segregation/segregation_flow.h"

struct segregation_setup {
    struct pool *pool; /* has the lists */
    int axis;          /* physical axis of the line */
    double origin[3];  /* centre of a cell, m: expressions take the other two coordinates from it */
    int *cell;         /* [n] polyMesh cell of each cell of the line, by ascending coordinate */
    int *place;        /* [ncells] its inverse */
    double *centre;    /* [ncells][3] m, centres of the cells; those of the end cells lie on the walls if asked for */
    double *face, *node, *speed, *diffusivity; /* the arrays of `line` */
    double *shear_rate;                        /* [n + 1] 1/s, at the faces; NULL: no law asks for it */
    const struct segregation_models *models;
    struct segregation_line line;
};
/* Makes the line of a mesh; its lists are in the pool. */
status segregation_setup_make(struct pool *pool, const struct setup *s, const struct segregation_models *m,
                              struct segregation_setup *out);
/* Sets f and D of the line. */
status segregation_setup_laws(const struct setup *s, const struct segregation_flow *flow, struct segregation_setup *l);

#endif
