/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Boundary conditions: a table of types by OpenFOAM's names. A patch has one rule for each of density, velocity and
 * temperature; a rule is a row of the table and what a case gives for it.
 *
 * docs/physics.md 5.1 and 5.3 have the mirror walls and the walls of a gas with transport.
 *
 * The inviscid gas sees ghost cells beyond a patch. Where the rule of the velocity is that of a wall every ghost is
 * the mirror image of a cell, so that mass is conserved to round-off. In a gas with transport every wall is a plain
 * mirror to the fluxes of the inviscid gas, which then pass on its pressure and nothing else. Whatever a wall does
 * besides is viscous stress and heat conduction, by two numbers of each of its faces: with d the distance of the cell
 * to its mirror image, u and T of the cell, u_w and T_w of the wall,
 *     stress along the wall = drag shear (u_w - u)/d,
 *     heat that enters      = heat conductivity (T_w - T)/d,
 * the latter with what the gradient of rho at the wall adds to it.
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
struct ghost_line { /* n ghost cells of one layer along a patch, for one field */
    int n, components;
    const int *face;        /* [n] faces within the patch */
    const double *inner[3]; /* [components][n] cells for the ghosts: at a wall the mirror images, else the first ones */
    const double *outflow;  /* [n] m/s: velocities of the first cells out of the domain */
    const double *rho;      /* [n] of the ghosts, for a velocity; NULL: no rule of the patch gives values */
    int layer;              /* 1, 2, ..: the ghosts lie layer - 1/2 widths of a cell beyond the patch; 0: on it */
    const double *next[3];  /* [components][n] with layer > 0: the cells behind `inner`; NULL: unknown */
    int normal;             /* component along the normal; -1: the field is a scalar */
    double *ghost[3];       /* [components][n] out */
};

struct wall_line { /* n <= BATCH cells at a wall of a gas with transport */
    int n;
    const int *face; /* [n] faces within the patch */
    const struct eos *eos;
    const struct material *material;
    const double *rho, *T;      /* [n] of the cells */
    const double *push;         /* [n] m/s^2: acceleration that pulls the gas onto the wall */
    const double *d;            /* [n] m: distance from a cell to its mirror image */
    const double *shear, *heat; /* [n] viscosity and conductivity between the cell and the wall */
    const double *slip;         /* [n] m^2/s^2: square of the cell's velocity along the wall, relative to the wall */
    const double *cross;        /* [n] coefficients of grad rho in the heat flux (transport.h); NULL: there are none */
    /* wall_shares sets the others. */
    double surface[BATCH]; /* T of the gas on the wall itself */
    double warmth[BATCH];  /* rise of `surface` by friction, and by `fed`, if the wall took no heat */
    double lift[BATCH];    /* what these add to T of the mirror image, beside the jump share (T_w - T) */
    double stays[BATCH];   /* part of the heat of friction on the wall that goes into the gas */
    double through[BATCH]; /* conductivity towards the wall when rho follows T there; heat, if cross is NULL */
    double fed[BATCH];     /* W/m^2: heat that enters at any T, as rho has a gradient where `push` is not 0 */
    double denser[BATCH];  /* rho of the mirror image less rho of the cell, with the gradient of rho at the wall */
};

/* How a case writes the values of a row: as OpenFOAM's lists and uniform values, as a function of time (a constant or
 * `table ((t v) ..)`), as expressions in OpenFOAM's grammar, as the rate of a flow, a function of time, or as an
 * angular velocity, a function or an expression of time. */
enum giving { BY_LIST, BY_FUNCTION, BY_EXPRESSION, BY_RATE, BY_ROTATION };

struct boundary_type {
    struct model model;   /* its parameters, numbers and vectors, fill the params of a rule */
    bool scalar, vector;  /* is the row allowed for scalars? for vectors? */
    const char *value[2]; /* keyword of the values that a scalar, or a vector, needs besides; NULL: it needs none */
    enum giving giving;
    bool transport; /* is the row for gases with transport only? */
    bool wall;      /* is a patch whose velocity has this row a wall, which no gas passes? */
    /* Computes the ghosts of a line. */
    void (*ghost)(const struct rule *rule, const struct ghost_line *line);
    /* Computes the velocity (m/s) of a wall at a face; NULL: the wall is at rest. */
    void (*velocity)(const struct rule *rule, int components, int face, double out[3]);
    /* Computes the wall's shares of drag, from line->surface; NULL: there is no friction. */
    void (*drag)(const struct rule *rule, const struct wall_line *line, double *share);
    /* In the row of a temperature: computes the wall's shares of heat, from line->warmth; NULL: no heat crosses. */
    void (*heat)(const struct rule *rule, const struct wall_line *line, double *share);
    /* Returns T of a wall at a face; NULL: the wall takes heat in proportion to T of the gas alone. */
    double (*temperature)(const struct rule *rule, int face);
    /* Returns the coefficient of friction of packed gas on the wall, < 0: it says nothing; NULL: it never does. */
    double (*friction)(const struct rule *rule);
    /* Returns why the rules of a patch cannot stand together, NULL if they can; a NULL function never objects. */
    const char *(*objection)(const struct patch_rules *rules);
};
extern const struct boundary_type boundary_table[];
extern const int boundary_count;
extern const struct boundary_type *const boundary_mirror;    /* slip, the plainest wall */
const struct boundary_type *boundary_find(const char *name); /* NULL: there is none, as for constraints */

/* For the code that reads and checks a case; t may be NULL, as it is for a constraint. */
bool boundary_is_wall(const struct boundary_type *t);
bool boundary_is_smooth(const struct boundary_type *t); /* is t a wall without friction? */
bool boundary_gives(const struct boundary_type *t);     /* has t parameters or values? */
bool boundary_rotates(const struct boundary_type *t);   /* may the wall be given an angular velocity? */
/* Is t allowed for fields of that number of components? Returns the keyword of their values; NULL: t needs none. */
bool boundary_takes(const struct boundary_type *t, int components);
const char *boundary_value(const struct boundary_type *t, int components);

/* Values that change in time are renewed by whoever owns the rules (gas_vary in libcore/gas/gas.h). */
struct rule {
    const struct boundary_type *type;
    struct own_params params; /* filled by the type's table; vectors in computational axes, as all vectors here */
    double uniform[3];        /* the value, if `values` is NULL */
    const double *values;     /* [faces of the patch][components], or NULL; borrowed */
    bool changes;             /* do the values change in time? */
    /* Of a velocity only: are the values of a flow rate u, and not rho u? Does the patch let nothing through faces
     * where its given velocity is 0 or, unless density and temperature are given, too, leads along them? (Gas comes in
     * elsewhere, or at other times.) */
    bool volume, shuts;
};
struct patch_rules {         /* the rules of one patch; an empty or cyclic patch has none (type NULL) */
    struct rule density;     /* its values are rho */
    struct rule velocity;    /* its values are u, with all components that the gas has (libcore/gas/gas.h), or rho u */
    struct rule temperature; /* its values are T, or p */
    bool pressure;           /* are they p? */
    const struct rule *carried; /* of the carried quantities, one each; borrowed */
};

bool rule_holds(const struct rule *rule);    /* does the rule give values to the gas beyond the patch? */
bool rule_switches(const struct rule *rule); /* does it so only where gas flows in? */
bool patch_is_wall(const struct patch_rules *r);
/* Does the patch give the mass that flows in, by a flow rate, or as 0 where its velocity leads along it (`shuts`)?
 * patch_feed returns the given velocity at a face along one axis, or rho u. */
bool patch_feeds(const struct patch_rules *r);
double patch_feed(const struct patch_rules *r, int components, int face, int axis);
/* At faces of such a patch: into[n] is what patch_feed gives along their normals into the domain, rho[n] the density on
 * the patch. Turns flux[n], the mass per area and time (kg/m^2 s) that would flow in, into what does. */
void patch_feed_mass(const struct patch_rules *r, int components, int n, const int *face, const double *into,
                     const double *rho, double *flux);
bool rule_fixes(const struct rule *rule); /* are values given whatever the gas does, as by fixedValue? */
/* Is the whole state given, that of the gas outside? */
bool patch_gives_outside(const struct patch_rules *r);
/* Does u lead along a face, up to round-off, if its component along the normal is `through`? */
bool leads_along(int components, const double *u, double through);
bool patch_needs_values(const struct patch_rules *r); /* are the patch's ghosts made from rho, u and T? */

/* Walls in a gas with transport; the answers are false for any other patch. */
bool wall_drags(const struct patch_rules *r);    /* is there friction along the wall? */
bool wall_holds(const struct patch_rules *r);    /* has the gas on the wall the wall's velocity? */
bool wall_slides(const struct patch_rules *r);   /* does the wall drag gas that slips along it, and heat it? */
bool wall_works(const struct patch_rules *r);    /* may the drag change the energy of the gas? */
bool wall_conducts(const struct patch_rules *r); /* does heat cross the wall? */
/* Velocity (m/s) and T of a wall at a face; 0 where the functions of the rows are NULL. */
void wall_velocity(const struct patch_rules *r, int components, int face, double out[3]);
double wall_temperature(const struct patch_rules *r, int face);
/* Returns the coefficient of friction of packed gas that slips on a wall (docs/physics.md 5.9): `muWall`, as the
 * velocity or else the temperature has it; else HUGE_VAL on a wall that drags, where the gas yields before it slips,
 * and 0 on a smooth one. */
double wall_friction(const struct patch_rules *r);
/* Does a rule say that coefficient? */
bool rule_rubs(const struct rule *rule);
/* Computes the shares `drag` and `heat` of the line's faces, and the line's results. Where gas slips along a wall
 * friction heats it, so that its T on the wall follows from the drag, and the drag from that T. */
void wall_shares(const struct patch_rules *r, struct wall_line *line, double *drag, double *heat);

#endif
