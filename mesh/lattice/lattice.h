/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A lattice is a mesh of equal axis-parallel boxes (holes allowed), as the fast engine needs one. It is recognised in a
 * polyMesh, whose cells and faces then stand in tables, or made of a mesh that is said by boxes (boxes.h), whose
 * numbers follow from places, or of one of which each rank knows a slice of the sites (sites.h). */
#ifndef MESH_LATTICE_H
#define MESH_LATTICE_H

#include "mesh/base/comm.h"
#include "mesh/format/boxes.h"
#include "mesh/format/polymesh.h"
#include "mesh/format/sites.h"

struct lattice {
    int dim;          /* 1..3, number of axes that `empty` patches leave */
    int axis[3];      /* [dim] physical axis (0 x, 1 y, 2 z) of computational axis k, ascending */
    int n[3];         /* cells along computational axis k of the bounding box; 1 for k >= dim */
    double origin[3]; /* lower corner along computational axis k, m */
    double width[3];  /* cell size along computational axis k, m; for k >= dim the thickness of the mesh there */
    const struct boxes *boxes; /* the mesh's, which has no tables until lattice_complete; or NULL */
    const struct sites *sites; /* the same */
    int *cell;                 /* [n0*n1*n2], axis 0 fastest: polyMesh cell, or -1 in a hole */
    int *face;                 /* [ncells][6] by polyMesh cell: face at side 2*k + (0 low, 1 high); -1 for k >= dim */
    double thickness; /* product of the mesh's extents along the empty axes, m^(3-dim): volume = product(width) */
    bool periodic[3]; /* axis k is wrapped by cyclic patches */
    bool uniform[3];  /* the forest shall hold one layer of cells along axis k, which stands for all. lattice_recognise
                         sets none; who sets it knows that all values are the same along k, and keeps them so */
    bool even;        /* shall two ranks have as many cells even if there are few tiles? Set by who knows that a step
                         sends messages for so many stages that ranks do not catch up with each other */
};

/* Makes the lattice of a mesh. If the mesh is sound but no lattice, *out is NULL and why[] says the reason (e.g. "cell
 * 17 is no box"). Fails only on a mesh that no engine could run. Tolerance of coordinates: 1e-6 of a cell, or
 * what rounding does where the coordinates have at most 12 digits, if that is below a tenth of a cell. */
status lattice_recognise(const struct polymesh *m, struct lattice **out, char why[256]);
struct lattice_part { /* a part of a mesh that is spread over the ranks: some cells with all their faces */
    const struct comm *comm;
    const struct polymesh *mesh;
    const bool *whole;      /* [cells of the part] the cells that it is about */
    const int *cell, *face; /* their numbers in the whole mesh */
    long ncells, nfaces;    /* of that */
};
/* Finds out, without the whole mesh on any rank, that a mesh cannot be a lattice; why[] then says the reason that
 * lattice_recognise would say. Where *ruled_out is false the mesh may be one. Collective. */
status lattice_rule_out(const struct lattice_part *part, bool *ruled_out, char why[256]);
/* Makes the lattice of a mesh of boxes, or of one with sites, which must outlive it. */
status lattice_of_boxes(const struct polymesh *m, struct lattice **out);
status lattice_of_sites(const struct polymesh *m, struct lattice **out);
/* Makes the tables of cells and faces, and the arrays of the mesh, where they are not there yet. */
status lattice_complete(struct lattice *l, struct polymesh *m);
void lattice_free(struct lattice *l);

/* Are cells found by place and places by cell on this rank alone, or are there only slices of sites? */
bool lattice_is_local(const struct lattice *l);
/* The cell at a place, or -1: a hole is there. lattice_row lists those of n places from there on along axis 0. Only of
 * local lattices; of others lattice_row lists what lattice_name makes cells of, a collective call. */
long lattice_cell(const struct lattice *l, const int at[3]);
void lattice_row(const struct lattice *l, const int at[3], int n, int *cell);
status lattice_name(const struct lattice *l, long n, int *cell);
/* Sets before[] to the cells one place lower along axis k, of the slice of cells of a lattice that is not local; -1:
 * none. Collective. */
status lattice_before(const struct lattice *l, int k, int *before);
/* The patch at a side (2*k + 0/1, k < dim) of the cell at a place, cyclic ones too, with the face's number in it; -1:
 * another cell follows. */
int lattice_patch(const struct lattice *l, const struct polymesh *m, const int at[3], int side, long *face);
double lattice_volume(const struct lattice *l); /* of a cell, m^3 */
/* Frees the table of faces, which the forest does without; lattice_patch then needs boxes or sites. */
void lattice_drop_faces(struct lattice *l);
void lattice_drop(struct lattice *l); /* frees both tables, of a lattice of sites */
/* The place of a cell of a mesh of boxes, or of one of this rank's slice of sites. */
void lattice_at(const struct lattice *l, long cell, int at[3]);
/* Sets the solved axes of x (m) to the centre of a cell. In a table it looks for the cell from end to end. */
void lattice_centre(const struct lattice *l, long cell, double x[3]);

/* Sets the centres [ncells][3] (m) of the cells along the solved axes from their places, so that a layer of cells has
 * one coordinate, to the bit, and expressions in it one value. For lattices with tables. */
void lattice_centres(const struct lattice *l, double *centre);

/* Can the lattice be uniform along axis k? It must be a periodic box without holes, and more than one cell long. */
bool lattice_may_be_uniform(const struct lattice *l, const struct polymesh *m, int k);

#endif
