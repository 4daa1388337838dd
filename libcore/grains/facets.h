/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Walls of any shape, and what bounds flight among them (docs/physics.md 10.2): facets, which are segments (dim 2) or
 * triangles (dim 3), bound the space of the grains.
 *
 * A facet is a convex set, and the distance D(x) of a point to it is a convex function of x with |grad D| = 1. So along
 * a path with |x''| <= G the distance has D'' >= -G, past sides and corners, too: D(t + d) >= D + D' d - G d^2/2. A
 * search whose steps end where that bound reaches the radius never passes the first contact (grains_facets.c). The
 * distance to all walls is the least of the distances to their facets, so facets of one plane act as that plane, and
 * convex sides and corners need no list of their own.
 */
#ifndef LIBCORE_FACETS_H
#define LIBCORE_FACETS_H

#include "mesh/base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct facet { /* the caller gives corner, wall, face and open; facets_make sets the others */
    /* m, [dim]. dim 2: the grains are on the left of the way from corner 0 to 1; dim 3: the corners are right-handed
     * about the normal that leads away from the grains. */
    double corner[3][3];
    int wall, face;              /* the wall that it is a part of, from 0; a number of the caller's */
    bool open;                   /* a grain whose centre comes there leaves */
    double normal[3], out[3][3]; /* unit: towards the grains; in the facet's plane, out of its side j */
    double low[3], high[3];      /* m: the box around it */
};
struct facet_space { /* the space that the facets bound */
    int dim;
    double low[3], high[3]; /* m: a box that holds all facets */
    bool periodic[3];       /* along such an axis the box is one period */
    double volume;          /* m^3 (disks: m^2) that centres and surfaces of grains have between the facets */
    double reach;           /* m: the largest radius of the grains */
    int walls;
};
struct facets {
    struct facet_space space;
    int n, own;          /* the first `own` are the caller's, the others their images */
    struct facet *facet; /* [n] */
    unsigned long sum;   /* checksum of corners, walls and what is open */
    bool opens;          /* is any facet open? */
};
/* Makes facets from a copy of `list`. Fails with ERR_INPUT on a facet without area, on one that is not in the box, and
 * on a gap: a side (dim 2: a corner) that no other facet continues, and that lies on no periodic end. */
status facets_make(const struct facet_space *space, int n, const struct facet *list, struct facets **out);
void facets_free(struct facets *f);

/* Returns the distance of x to facet f; *normal gets the unit vector from its nearest point to x. */
double facet_distance(const struct facet *f, int dim, const double x[3], double normal[3]);

/* The facets near each of n[0] x n[1] x n[2] equal cells. */
struct facet_cells {
    int n[3];
    double low[3], width[3];
    int32_t *start, *list; /* [cells + 1]; facets, ascending */
};
/* Lists, for cells of the given n, low and width, the facets that a point of the cell can have within `radius`, if
 * their displacement along each axis is at most `swing` (m). The caller frees c, also after an error. */
status facet_cells_make(const struct facets *f, double radius, const double swing[3], struct facet_cells *c);
void facet_cells_free(struct facet_cells *c);
long facet_cells_at(const struct facet_cells *c, int dim, const double x[3]); /* the cell of x, or the nearest one */
/* Returns the least distance of x to facets, without those that are open unless `shut`, if it is no more than the
 * radius of c; else HUGE_VAL. */
double facet_cells_nearest(const struct facets *f, const struct facet_cells *c, const double x[3], bool shut);
/* Is x, whose distance to all facets is at least `free`, between the facets? */
bool facet_cells_inside(const struct facets *f, const struct facet_cells *c, const double x[3], double free);

#endif
