/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Surfaces for function objects: the faces of patches, or what a plane cuts out of the cells; and the values of fields
 * there. A surface is a list of pieces, each in one cell, in the order of the polyMesh's faces or cells; every rank has
 * all of it, so that what is summed over it has the same bits on any number of ranks. */
#ifndef SOLVERS_FUNCTIONS_PIECES_H
#define SOLVERS_FUNCTIONS_PIECES_H

#include "solvers/functions/functions_patches.h"

struct piece {
    int slot;               /* of its cell, among the cells whose values are gathered */
    double area, normal[3]; /* m^2, unit: out of the mesh, or that of the plane */
    int first, count;       /* of its neighbours: */
};
struct surface {
    int n;
    struct piece *piece; /* [n] */
    int *near;           /* slots of neighbours */
    double *weight;      /* of their differences from the cell: value = cell + sum weight (neighbour - cell) */
    struct picks picks;
    double area;         /* m^2 */
    struct edges *edges; /* of patches: makes their values of those in the cells; else NULL */
    struct patch_run {
        int patch, n;
    } * run; /* [nruns] the patches that the pieces are faces of, one after the other; else NULL */
    int nruns;
};

/* The faces of patches, with the values on them, by the patches' rules. */
status surface_of_patches(const struct function *f, const struct patch_choice *c, struct surface *out);
/* Makes the polygons that a plane through a point cuts out of the cells, with values of second order: those of the cell
 * and its least squares gradient, within the range of the cell and its neighbours. A plane along faces has the cells on
 * their lower side. */
status surface_of_plane(const struct function *f, const double point[3], const double normal[3], struct surface *out);
/* Makes ready what decides on the values of patches at the present state, before they are sampled. Collective. */
status surface_renew(struct surface *s);
/* Gathers a quantity's values in the pieces on every rank: [n][components], along physical axes; malloc'd.
 * Collective. */
status surface_sample(const struct surface *s, const struct function *f, int quantity, double **out);
void surface_free(struct surface *s);

#endif
