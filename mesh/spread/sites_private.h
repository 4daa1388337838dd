/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files that find the sites of a lattice in slices of its polyMesh: sites_find.c (cells),
 * sites_walls.c (faces on patches). */
#ifndef MESH_SITES_PRIVATE_H
#define MESH_SITES_PRIVATE_H

#include "mesh/format/sites.h"
#include "mesh/spread/spread_private.h"

struct placed { /* a face on the grid */
    int axis;   /* across its plane */
    bool up;    /* does its normal point to higher places? */
    int at[3];  /* its lowest corner; along `axis` the number of its plane */
    int turn;   /* of its first corner, as in struct site_face */
};
struct finder {
    const struct lists *lists;
    struct polymesh *mesh; /* counts, patches, outline */
    struct sites *sites;
    double near[3]; /* farthest that a point may lie beside the grid, in cells */
    char *sides;    /* [cells of the slice] bits of the sides whose faces have come */

    const double *x; /* [points of a round][3] m: all of the one rank, or `fetched` */
    double *fetched;
    int *node;           /* [points of a round][3] places on the grid; the first is -1 for a point beside it */
    int *name, *corner;  /* the points of a round by their numbers; the corners of its faces, by places in x */
    int nclaims, *claim; /* what the faces of a round say: cell, place, side */

    bool walled[3], closed[3]; /* axes across which faces of this rank lie on patches, on empty ones */
    int patch;                 /* of the last face */
    long nwalls, wall_room;    /* faces of the slice on patches that are not empty, as outline_walls takes them */
    double *wall;
};

/* Notes a face on a patch; claim: its cell, the cell's place, the side. */
status wall_add(struct finder *f, long face, const int *corner, const int claim[3], int turn);
/* Gives all ranks the faces on patches, and finds out whether patches are those of a lattice and sound. */
status walls_take(struct finder *f, bool *good);

#endif
