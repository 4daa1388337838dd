/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The choices of the dictionaries constant/granularProperties, g and shaking, system/fvSchemes and fvSolution. */
#ifndef SOLVERS_MODELS_H
#define SOLVERS_MODELS_H

#include "libcore/gas/gas.h"
#include "solvers/dict/keywords.h"
#include <stdio.h>

struct mesh_engine {
    struct model model;
    bool polyhedral;
};
struct forces {               /* the contents of constant/g and constant/shaking */
    struct dict *g, *shaking; /* NULL: there is no such file */
    double gravity[3];        /* m/s^2, along physical axes */
    int shaken;               /* is there shaking that is not of type none? */
    struct sources source;    /* gravity in computational axes, and shaking */
};
struct plate {                       /* the greatest that a shaken plate does, along gravity; zeros: it is not shaken */
    double amplitude;                /* acceleration over that of gravity, the greatest of a table */
    double way, speed, acceleration; /* m, to either side of the middle; m/s; m/s^2 */
};
struct case_models {
    const struct mesh_engine *engine; /* the engine asked for, which the mesh may forbid; NULL: as the mesh is */
    struct sources source;            /* sources of constant/granularProperties alone, vectors along physical axes */
    struct gas_models gas;
    struct own_params friction; /* the entries that gas.friction_params are made of, with their defaults */
    struct carried_choice carried[CARRIED_MOST]; /* those of `gas` */
    struct forces forces;
    double min_fraction; /* fraction of the time step of loose gas below which the gas has collapsed */
    bool skip_axes;      /* is an axis along which the run is uniform computed on one layer of cells? */
    struct dict *properties, *schemes, *solution;
};
/* Reads all these files. dim and axis are those of the mesh, for gravity in computational axes. Misspelt keys are
 * errors. */
status models_read(const char *case_dir, int dim, const int axis[3], struct case_models **out);
/* Marks the physical axes along which gravity or another source moves the gas. */
void models_move(const struct case_models *m, bool along[3]);
/* Turns the vectors of all sources to the axes of the velocity's components. */
void models_turn(struct case_models *m, int components, const int axis[3]);
/* Refuse what is not there in the flow about an axis; and what is not there beside swirl, where acoustics are explicit.
 */
struct setup;
status models_round(const struct setup *s, struct case_models *m);
status models_swirl(const struct setup *s, struct case_models *m);
/* Refuses what is not there with timeScheme local. */
status models_local(const struct setup *s, const struct case_models *m);
void models_free(struct case_models *m);

/* Marks all that constant/granularProperties says of these models as known, for programs that have no use for it. */
status models_leave(struct dict *properties);
/* Reads `grain` and the equation of state of constant/granularProperties alone. */
status models_equation(struct dict *properties, struct gas_models *out);

/* The quantities that the gas carries (carried.c): read `carried` of constant/granularProperties; fail where the
 * forces, which were read then, do not suit; list the kinds; print the choices; go through the keywords. */
status carried_read(struct dict *properties, struct case_models *m);
status carried_check(const struct case_models *m);
void carried_list(FILE *f);
void carried_print(FILE *f, const struct case_models *m);
double carried_memory(const struct gas_models *m, int dim); /* doubles of a cell; on polyhedra, of its faces, too */
void carried_keywords(struct keywords *k, const char *file);

/* Reads constant/g and constant/shaking into *out, which is zeroed before; also after an error its dictionaries must be
 * freed. Gravity may act along the axes of the mesh only. */
status forces_read(const char *case_dir, int dim, const int axis[3], struct forces *out);
void forces_free(struct forces *f);
struct plate forces_plate(const struct forces *f);
void forces_list(FILE *f);
void forces_print(FILE *f, const struct forces *forces);

/* Go through the keywords of grain { }, of constant/g and shaking, and of all that a run of the gas reads. */
void grain_keywords(struct keywords *k);
void models_leave_keywords(struct keywords *k); /* those that models_leave marks */
void forces_keywords(struct keywords *k);
void models_keywords(struct keywords *k);

void models_list(FILE *f);     /* prints every model with its line and parameters */
void boundaries_list(FILE *f); /* prints every boundary condition */
/* Prints the choices value by value; polyhedral: with the polynomials of that engine, not the lattice's
 * reconstruction. */
void models_print(FILE *f, const struct case_models *m, bool polyhedral);

/* Returns the bytes of the state and of the memory for a step, of all cells of s->grid, if all are dense. */
double models_memory(const struct setup *s, const struct gas_models *g);

#endif
