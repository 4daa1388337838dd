/* Boundary conditions: a table of types by OpenFOAM's names. A patch has one rule for each of density, velocity and
 * temperature; a rule is a row of the table and what a case gives for it.
 *
 * The inviscid gas sees ghost cells beyond a patch. Where the rule of the velocity is that of a wall every ghost is
 * the mirror image of a cell, so that mass is conserved to round-off. In a gas with transport every wall is a plain
 * mirror to the fluxes of the inviscid gas, which then pass on its pressure and nothing else. Whatever a wall does
 * besides is viscous stress and heat conduction, by two numbers of each of its faces: with d the distance of the cell
 * to its mirror image, u and T of the cell, u_w and T_w of the wall,
 *     stress along the wall = drag shear (u_w - u)/d,
 *     heat that enters      = heat conductivity (T_w - T)/d.
 * The shares `drag` and `heat` are 2 where the gas on the wall itself has the wall's velocity or temperature, and 0
 * where the wall does nothing. A wall is a row with the functions below and a table of parameters; the engines call
 * the functions at the foot of this file and ask for no property of a row. */
#ifndef LIBCORE_BOUNDARY_H
#define LIBCORE_BOUNDARY_H

#include "libcore/models/eos.h"
#include "libcore/models/kernel.h"
#include "libcore/models/param.h"

struct rule;
struct patch_rules;
struct ghost_line { /* n ghost cells of one layer along a patch, one field */
    int n, components;
    const int *face;        /* [n] face within the patch */
    const double *inner[3]; /* [n] cell the ghost is made from: the mirror image at a wall, else the first cell */
    const double *outflow;  /* [n] velocity of the first cell out of the domain */
    int normal;             /* component along the normal (vectors) */
    double *ghost[3];       /* [n] result */
};

struct wall_line { /* n <= BATCH cells at a wall of a gas with transport */
    int n;
    const int *face; /* [n] face within the patch */
    const struct eos *eos;
    const struct material *material;
    const double *rho, *T;      /* [n] of the cells */
    const double *push;         /* [n] what pulls the gas onto the wall, m/s^2 */
    const double *d;            /* [n] from a cell to its mirror image, m */
    const double *shear, *heat; /* [n] viscosity and conductivity between the cell and the wall */
    const double *slip;         /* [n] square of the cell's velocity along the wall, less the wall's own, m^2/s^2 */
    double surface[BATCH];      /* T of the gas on the wall itself */
    double warmth[BATCH];       /* by how much the heat of friction would raise `surface` if the wall took no heat */
};

struct boundary_type {
    struct model model;   /* its parameters, numbers and vectors without defaults, are those of a rule */
    bool scalar, vector;  /* fields the row is allowed for */
    const char *value[2]; /* keyword of the values that a scalar, or a vector, needs besides; NULL: none */
    bool transport;       /* the row is for gases with transport only */
    bool wall;            /* the row of a velocity that gas does not pass */
    void (*ghost)(const struct rule *rule, const struct ghost_line *line);
    /* The velocity of a wall at a face, m/s; NULL: the wall is at rest. */
    void (*velocity)(const struct rule *rule, int components, int face, double out[3]);
    /* share <- the wall's share of drag, by line->surface; NULL: there is no friction. */
    void (*drag)(const struct rule *rule, const struct wall_line *line, double *share);
    /* share <- the wall's share of heat, by line->warmth, in the row of a temperature; NULL: no heat crosses. */
    void (*heat)(const struct rule *rule, const struct wall_line *line, double *share);
    /* The temperature of a wall at a face; NULL: the wall takes heat in proportion to the T of the gas alone. */
    double (*temperature)(const struct rule *rule, int face);
    /* Returns why the rules of a patch cannot stand together, NULL if they can; a NULL function never objects. */
    const char *(*objection)(const struct patch_rules *rules);
};
extern const struct boundary_type boundary_table[];
extern const int boundary_count;
extern const struct boundary_type *const boundary_mirror;    /* the plainest wall */
const struct boundary_type *boundary_find(const char *name); /* NULL: none; constraint types are the mesh's */

/* For those who read and check a case. t may be NULL, the type of a constraint. */
bool boundary_is_wall(const struct boundary_type *t);
bool boundary_is_smooth(const struct boundary_type *t);                    /* is t a wall without friction? */
bool boundary_gives(const struct boundary_type *t);                        /* has t parameters or values? */
bool boundary_takes(const struct boundary_type *t, int components);        /* is t for such a field? */
const char *boundary_value(const struct boundary_type *t, int components); /* keyword of such a field's values; NULL */

struct rule {
    const struct boundary_type *type;
    struct own_params params; /* filled by the type's table; vectors in computational axes, as all vectors here */
    double uniform[3];        /* value where values is NULL */
    const double *values;     /* [faces of the patch][components], or NULL; borrowed */
};
struct patch_rules {         /* of one patch; unused for empty and cyclic patches (type NULL) */
    struct rule density;     /* value: rho */
    struct rule velocity;    /* values in computational axes (dim components, struct forest's axis[]) */
    struct rule temperature; /* value: T, or p if pressure */
    bool pressure;           /* `temperature` holds p */
};

bool rule_holds(const struct rule *rule); /* are given values beyond the patch those of the gas there? */
bool patch_is_wall(const struct patch_rules *r);
bool patch_needs_values(const struct patch_rules *r); /* are the patch's ghosts made from rho, u and T? */

/* For a gas with transport: what a patch does if it is a wall; any other patch does none of this. */
bool wall_drags(const struct patch_rules *r);
bool wall_holds(const struct patch_rules *r);  /* has the gas on the wall the wall's velocity? */
bool wall_slides(const struct patch_rules *r); /* does the wall drag gas that slips along it, and heat it? */
bool wall_works(const struct patch_rules *r);  /* may the drag change the energy of the gas? */
bool wall_conducts(const struct patch_rules *r);
void wall_velocity(const struct patch_rules *r, int components, int face, double out[3]);
double wall_temperature(const struct patch_rules *r, int face);
/* drag, heat <- the shares of the line's faces; line->surface <- T of the gas on the wall itself, line->warmth. Where
 * gas slips along a wall friction heats it, so that the drag follows from that T, and that T from the drag. */
void wall_shares(const struct patch_rules *r, struct wall_line *line, double *drag, double *heat);

#endif
