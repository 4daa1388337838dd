/* The line that a mesh with one solved axis is: its cells in order, where faces and values stand, f and D on it. */
#ifndef SOLVERS_SEGREGATION_LINE_H
#define SOLVERS_SEGREGATION_LINE_H

#include "solvers/case/case.h"
#include "solvers/segregation/segregation_flow.h"

struct segregation_setup {
    int axis;         /* physical */
    double origin[3]; /* of a cell: where expressions take the other two coordinates */
    int *cell;        /* [n] polyMesh cell of each cell of the line, ascending coordinate */
    int *place;       /* [ncells] its inverse */
    double *centre;   /* [ncells][3] as the mesh has it, but those of the end cells on the walls if asked for */
    double *face, *node, *speed, *diffusivity; /* of line */
    double *shear_rate;                        /* [n + 1] at its faces; NULL: no law asks for it */
    const struct segregation_models *models;
    struct segregation_line line;
};
/* Fills *out; segregation_setup_free after success and failure. */
status segregation_setup_make(const struct setup *s, const struct segregation_models *m, struct segregation_setup *out);
/* f and D. */
status segregation_setup_laws(const struct setup *s, const struct segregation_flow *flow, struct segregation_setup *l);
void segregation_setup_free(struct segregation_setup *l);

#endif
