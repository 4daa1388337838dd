/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The walls of soft grains from the faces of a case's patches, each of one restitution and friction: flat rectangles,
 * or the triangles of a patch (fix surface/global of LAMMPS). All lengths are in m along computational axes, the solved
 * ones first. */
#ifndef SOLVERS_DEM_WALLS_H
#define SOLVERS_DEM_WALLS_H

#include "solvers/case/case.h"
#include "solvers/grains/grains_mesh.h"
#include "solvers/grains/grains_models.h"

enum { DEM_MOST_WALLS = 50 }; /* each costs some 14 ns per grain and step, wherever the grain is */

struct dem_wall {
    int patch;                    /* the first of those that it is made of */
    double corner[3], edge[2][3]; /* the rectangle: corner + s edge[0] + t edge[1], 0 <= s, t <= 1; 0 of triangles */
    double normal[3];             /* unit, out of the grains */
    int axis, side;               /* is it a whole side of the box: its axis, 0 low or 1 high; else axis is -1 */
    double velocity[3];           /* m/s, along itself; of whole sides alone */
    struct contact_law law;       /* of a grain on it */
};
struct dem_walls {
    int dim;
    double low[3], high[3]; /* the box around the mesh */
    bool periodic[3];
    bool open; /* may grains leave through a patch? */
    /* Triangles; each wall is one patch, whose number they have as `wall`. Borrowed; NULL: all walls are rectangles */
    const struct facets *facets;
    int n;
    struct dem_wall wall[DEM_MOST_WALLS];
};

/* Finds the walls; `laws` has type, material and defaults. Patches of U that are walls hold grains, zeroGradient lets
 * them out. Without facets it fails with file, line and cure on curved walls, on other shapes than rectangles, and
 * where walls of different laws meet in one plane, whose joint a grain would feel twice. With facets, which outlive the
 * walls, it fails beside cyclic patches, of which LAMMPS documents nothing, and on walls that move. Three axes are
 * solved then. */
status dem_walls_make(const struct setup *s, const struct grains_models *m, const struct field *U,
                      const struct facets *facets, struct dem_walls *out);
/* Returns the wall that is nearest to x. */
int dem_wall_at(const struct dem_walls *w, const double x[3]);
/* Does a wall go on beyond an end (0 or 1) of its edge j: is that end a border of periodic space, or no axis solved? */
bool dem_wall_goes_on(const struct dem_walls *w, const struct dem_wall *wall, int j, int end);
/* Returns the point of a wall that is nearest to x. */
void dem_wall_nearest(const struct dem_walls *w, int wall, const double x[3], double out[3]);

#endif
