/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A mesh of any cells as grains see it: cells with volumes, and the facets of its walls. Axes are computational. */
#ifndef SOLVERS_GRAINS_MESH_H
#define SOLVERS_GRAINS_MESH_H

#include "libcore/grains/grain_mesh.h"
#include "libcore/grains/grains.h"
#include "mesh/base/pool.h"
#include "mesh/grid/search.h"
#include "solvers/case/case.h"

struct grains_mesh {
    struct grain_mesh base; /* first */
    const struct setup *setup;
    struct search *search; /* NULL: all cells are convex, and `sides` say where they are */
    struct cell_sides *sides;
    struct facets *facets; /* NULL: there are no walls */
    const bool *open;
    struct pool pool;
    double low[3], high[3]; /* m: the box around the mesh */
    bool periodic[3];
};
/* Makes the cells and the facets of a mesh for grains of a diameter (m); open: [patches] do grains leave there? A wall
 * has the number of its patch; `face` of a facet is a face of the mesh. Fails on cyclic patches that are not the ends
 * of an axis. */
status grains_mesh_make(const struct setup *s, double diameter, const bool *open, struct grains_mesh **out);
void grains_mesh_free(struct grains_mesh *m);

#endif
