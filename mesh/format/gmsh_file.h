/* What a .msh file says, before anything is made of it. */
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
    signed char face[6][4]; /* of a volume element: nodes in cyclic order, -1: a triangle */
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
    char *path;
    long npoints;
    double *points; /* [npoints][3] */
    long nelements, capacity;
    struct gmsh_element *element; /* one that is in two groups stands here twice */
    int ngroups;
    struct gmsh_group *group;
};
status gmsh_file_read(const char *path, struct gmsh_file **out);
void gmsh_file_free(struct gmsh_file *f);
status gmsh_file_add(struct gmsh_file *f, const struct gmsh_element *e);
/* The group with this dimension and number, made if there is none. */
status gmsh_file_group(struct gmsh_file *f, int dim, int tag, int *index);

#endif
