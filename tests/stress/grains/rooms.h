/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random rooms of facets for hard grains, and where a point is in them, by code that the engine does not share. */
#ifndef STRESS_ROOMS_H
#define STRESS_ROOMS_H

#include "libcore/grains/facets.h"
#include "tests/stress/seed.h"

enum room_shape { STAR, SHELL, LATHE, POLYGON, PIPE, ROOM_SHAPES };
enum { MOST_FACETS = 1000 };
struct room {
    enum room_shape shape;
    struct facet_space space; /* its reach is set with the grains */
    int n;
    struct facet facet[MOST_FACETS];
};

/* Sets a room of a size of about 2, not empty, from the numbers that follow. STAR: a sphere of triangles whose corners
 * are drawn inwards; SHELL: around another one; LATHE: rings of corners about an axis, of any radii; POLYGON (dim 2):
 * of 3 to 24 corners, at times around another one; PIPE: a polygon along the periodic axis 0. All but pipes are turned
 * and stretched. */
void room_make(enum room_shape shape, struct seed *s, struct room *r);
/* Returns the distance of x to the walls; negative: x is outside, by the sum of the angles that the facets fill. */
double room_depth(const struct room *r, const double x[3]);

#endif
