/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where the cells of a polyMesh lie that is a lattice (a union of equal boxes along the axes), of which no rank has all
 * cells: each rank knows the places of a slice of the cells, in the order of their numbers, and the cells at a slice of
 * the places. Every rank knows the faces on patches. mesh/spread finds the sites, mesh/lattice makes a lattice of them.
 */
#ifndef MESH_SITES_H
#define MESH_SITES_H

#include "mesh/base/share.h"

struct site_face { /* a face on a patch that is not empty */
    int place;     /* of its cell */
    short side;    /* of the cell: 2*axis + (0 low, 1 high) */
    short turn;    /* where its first point lies: bit 0: high along the axis behind the side's; bit 1: the one behind */
    int patch, face; /* face: number within the patch */
};
struct sites {
    struct share cells, places;
    int n[3];                 /* places along x, y, z; place i + n[0] (j + n[1] k) is at (i, j, k) */
    double low[3], extent[3]; /* of the box around all, m */
    double width[3];          /* of a cell, m */
    double middle[3];         /* centre of cell 0, m; all cells have it along closed axes */
    bool closed[3];           /* by empty patches */
    bool periodic[3];         /* wrapped by cyclic patches */
    int *place;               /* [cells of the slice]; NULL after sites_drop */
    double *cell;             /* [places of the slice] the cell there, -1: a hole; NULL after sites_drop */
    int nfaces;
    struct site_face *face; /* [nfaces] by place, then side */
};
void sites_free(struct sites *s);
void sites_drop(struct sites *s); /* frees the places of cells and the cells at places */
/* Sorts the faces of patches, which come in any order. */
void sites_sort(struct sites *s);

long sites_place(const struct sites *s, const int at[3]);
void sites_at(const struct sites *s, long place, int at[3]);
/* Sets x (m) to the centre of a cell of this rank's slice. */
void sites_centre(const struct sites *s, long cell, double x[3]);
/* The patch at a side of the cell at a place, with the face's number in it, or -1: another cell follows. */
int sites_patch(const struct sites *s, const int at[3], int side, long *face);
/* Replaces n places by the cells that are there. Collective. */
status sites_name(const struct sites *s, long n, int *place);

#endif
