/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The contents of a gmsh .msh file (formats 2.2 and 4.1, ascii and binary): nodes, elements, physical groups, as they
 * stand in the file. gmsh.c makes a polyMesh of them. */
#ifndef MESH_GMSH_FILE_H
#define MESH_GMSH_FILE_H

#include "mesh/base/status.h"

enum gmsh_kind {
    GMSH_POINT,
    GMSH_LINE,
    GMSH_TRIANGLE,
    GMSH_QUAD,
    GMSH_TET,
    GMSH_HEX,
    GMSH_PRISM,
    GMSH_PYRAMID,
    GMSH_KINDS
};
struct gmsh_shape {
    const char *name;
    int type; /* gmsh's number */
    int dim, nodes, faces;
    signed char face[6][4]; /* faces of a volume element: nodes in cyclic order; -1 ends a triangle */
};
extern const struct gmsh_shape gmsh_shapes[GMSH_KINDS];

struct gmsh_group {
    int dim, tag;
    char *name; /* NULL: the group has a number only */
};
struct gmsh_element {
    int kind;
    int group;   /* index in group[], or -1 */
    int node[8]; /* index in points[]; -1 beyond the shape's nodes */
};
struct gmsh_file {
    double thickness; /* m: to extrude by; 0: the typical size of a cell */
    char *path;
    long npoints;
    double *points; /* [npoints][3] */
    long nelements, capacity;
    struct gmsh_element *element; /* [nelements]; an element that is in two groups stands here twice */
    int ngroups;
    struct gmsh_group *group;
};
/* gmsh_file_read fails with the line (ascii) or byte (binary) on everything that is not a sound .msh file.
 * gmsh_file_add appends a copy of an element. */
status gmsh_file_read(const char *path, struct gmsh_file **out);
void gmsh_file_free(struct gmsh_file *f);
status gmsh_file_add(struct gmsh_file *f, const struct gmsh_element *e);
/* Finds the group with this dimension and number, or adds it; *index is its place in group[]. */
status gmsh_file_group(struct gmsh_file *f, int dim, int tag, int *index);

#endif
