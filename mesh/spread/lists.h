/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The lists of a polyMesh folder in slices, one a rank, in the order of the files. */
#ifndef MESH_LISTS_H
#define MESH_LISTS_H

#include "mesh/base/share.h"
#include "mesh/format/polymesh.h"

struct lists {
    struct share points, faces;
    long ninternal, ncells; /* of the whole mesh */
    double *point;          /* [points of the slice][3] m */
    int *start,
        *corner;      /* [faces of the slice + 1] into corner, from 0 on; points by their numbers in the whole mesh */
    int first_corner; /* corners of the faces before the slice */
    int *owner, *neighbour; /* [faces of the slice] cells; neighbour: -1 on the boundary */
};
/* Reads the slice of each rank. Plain binary lists each rank reads by itself; ascii and zipped ones the root reads in
 * pieces, which it sends on. *sound is false, on all ranks, where an entry is not as writers put it or names what is
 * not there: polymesh_read then tells what is wrong, or reads the mesh all the same. Refuses lists that labels of 32
 * bits cannot count. Collective; the caller frees the slices, also after an error. */
status lists_read(const char *dir, const struct comm *c, struct lists *out, bool *sound);
void lists_free(struct lists *s);
void lists_agree(const struct comm *c, bool *sound); /* is it so on all ranks? Collective */

#endif
