/* Boundary conditions as ghost cells: a table of types by OpenFOAM's names. A patch has one rule per field; a
 * reflecting velocity (a wall) makes every scalar's ghost the mirror image, so that mass is conserved to round-off.
 * With transport every wall is a mirror to the fluxes of the inviscid gas, which then pass on its pressure and nothing
 * else: that a wall drags, or has a temperature, counts for viscous stress and heat conduction only
 * (libcore/gas/diffusion_edges.c), and that it drags for the polynomials of the cells at it
 * (libcore/polyhedral/cells_edge.c). */
#ifndef LIBCORE_BOUNDARY_H
#define LIBCORE_BOUNDARY_H

#include <stdbool.h>

struct rule;
struct ghost_line { /* n ghost cells of one layer along a patch, one field */
    int n, components;
    const int *face;        /* [n] face within the patch */
    const double *inner[3]; /* [n] cell the ghost is made from: the mirror image at a wall, else the first cell */
    const double *outflow;  /* [n] velocity of the first cell out of the domain */
    int normal;             /* component along the normal (vectors) */
    double *ghost[3];       /* [n] result */
};
struct boundary_type {
    const char *name, *about;
    bool scalar, vector; /* fields it is allowed for */
    bool reflects;       /* a wall (vectors) */
    bool drags;          /* a wall that gives the gas at it its velocity: the value, along the patch, or 0 */
    bool viscous;        /* for a gas with transport only */
    bool absorbs;        /* at a wall takes heat as impacts do: the value is their restitution */
    const char *value;   /* keyword of the value it needs, or NULL */
    bool plain;          /* that is one for the patch, without `uniform` */
    void (*ghost)(const struct rule *rule, const struct ghost_line *line);
};
extern const struct boundary_type boundary_table[];
extern const int boundary_count;
extern const struct boundary_type *const boundary_mirror;    /* the plainest wall */
const struct boundary_type *boundary_find(const char *name); /* NULL: none; constraint types are the mesh's */

struct rule {
    const struct boundary_type *type;
    double uniform[3];    /* value where values is NULL */
    const double *values; /* [faces of the patch][components], or NULL; borrowed */
};
struct patch_rules {         /* of one patch; unused for empty and cyclic patches (type NULL) */
    struct rule density;     /* value: rho */
    struct rule velocity;    /* values in computational axes (dim components, struct forest's axis[]) */
    struct rule temperature; /* value: T, or p if pressure */
    bool pressure;           /* `temperature` holds p */
};

#endif
