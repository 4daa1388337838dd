/* Boundary conditions: a table of types by OpenFOAM's names. A patch has one rule for each of density, velocity and
 * temperature; a rule is a row of the table and what a case gives for it.
 *
 * To the inviscid gas a patch is ghost cells. Where the rule of the velocity is that of a wall every ghost is the
 * mirror image of a cell, so that mass is conserved to round-off. In a gas with transport all walls are plain mirrors
 * to the fluxes of the inviscid gas, which then pass on its pressure and nothing else. What walls do besides is the
 * business of viscous stress and heat conduction, and is all in two numbers of each wall face, the shares in which the
 * jump from the cell to the wall over the distance d of the cell to its mirror image counts: drag * shear (u_w - u)/d
 * is the stress along the wall,  heat * conductivity (T_w - T)/d  the heat that enters; 2 where the gas at the wall
 * itself has the wall's velocity or temperature, 0 where the wall does nothing. So a wall is a row with the functions
 * below and a table of parameters; nothing else asks which one it is. */
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
    double warmth[BATCH];       /* what friction on the wall would raise that by, were all of it to reach the cell */
};

struct boundary_type {
    struct model model;   /* its parameters, numbers and vectors that must be given, fill the rule's */
    bool scalar, vector;  /* fields it is allowed for */
    const char *value[2]; /* keyword of the values it needs besides, of a scalar and of a vector; or NULL */
    bool transport;       /* is nothing to a gas without transport */
    bool wall;            /* of the velocity: gas does not pass */
    void (*ghost)(const struct rule *rule, const struct ghost_line *line);
    /* Of a wall, for the velocity. velocity: its own, of a face; NULL: it rests. drag: its share; NULL: no friction. */
    void (*velocity)(const struct rule *rule, int components, int face, double out[3]);
    void (*drag)(const struct rule *rule, const struct wall_line *line, double *share);
    /* Of a wall, for the temperature. heat: its share, at l->warmth; NULL: no heat crosses.
     * temperature: of the wall at a face; NULL: heat is lost in proportion to the T of the gas alone. */
    void (*heat)(const struct rule *rule, const struct wall_line *line, double *share);
    double (*temperature)(const struct rule *rule, int face);
    /* Why the rules of a patch cannot stand together; NULL, or returns it: they can. */
    const char *(*objection)(const struct patch_rules *rules);
};
extern const struct boundary_type boundary_table[];
extern const int boundary_count;
extern const struct boundary_type *const boundary_mirror;    /* the plainest wall */
const struct boundary_type *boundary_find(const char *name); /* NULL: none; constraint types are the mesh's */

/* Of a type that may be NULL, as that of a constraint is: for those who check a case. */
bool boundary_is_wall(const struct boundary_type *t);
bool boundary_is_smooth(const struct boundary_type *t); /* a wall without friction */
bool boundary_takes(const struct boundary_type *t, int components);
bool boundary_gives(const struct boundary_type *t); /* does a case say more of it than its name? */
/* The keyword of the values of a field of so many components, or NULL. */
const char *boundary_value(const struct boundary_type *t, int components);

struct rule {
    const struct boundary_type *type;
    struct own_params params; /* by the type's table; vectors in computational axes, as all here */
    double uniform[3];        /* value where values is NULL */
    const double *values;     /* [faces of the patch][components], or NULL; borrowed */
};
struct patch_rules {         /* of one patch; unused for empty and cyclic patches (type NULL) */
    struct rule density;     /* value: rho */
    struct rule velocity;    /* values in computational axes (dim components, struct forest's axis[]) */
    struct rule temperature; /* value: T, or p if pressure */
    bool pressure;           /* `temperature` holds p */
};

/* Does the rule hold what it is for at given values, so that these are needed beyond the patch? */
bool rule_holds(const struct rule *rule);
bool patch_is_wall(const struct patch_rules *r);
bool patch_needs_values(const struct patch_rules *r); /* are its ghosts made from rho, u and T? */

/* Of patches that are walls, in a gas with transport. */
bool wall_drags(const struct patch_rules *r);
bool wall_holds(const struct patch_rules *r);  /* has the gas on the wall the wall's velocity? */
bool wall_slides(const struct patch_rules *r); /* does it drag gas that slips along it, and heat it by that? */
bool wall_works(const struct patch_rules *r);  /* may it change the energy of the gas by dragging it? */
bool wall_conducts(const struct patch_rules *r);
void wall_velocity(const struct patch_rules *r, int components, int face, double out[3]);
double wall_temperature(const struct patch_rules *r, int face);
/* Both shares of n faces, and the T of the gas on the wall itself in line->surface. Friction on a wall that gas slips
 * along heats the gas there, and so what the wall drags follows from T and T from that. */
void wall_shares(const struct patch_rules *r, struct wall_line *line, double *drag, double *heat);

#endif
