/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The state that a run starts from, and the boundary rules, from the field files of one time folder. */
#ifndef SOLVERS_INITIAL_H
#define SOLVERS_INITIAL_H

#include "libcore/gas/gas.h"
#include "mesh/base/pool.h"
#include "solvers/case/fields.h"
#include "solvers/case/times.h"
#include "solvers/case/warnings.h"

/* The end of the message about a density that a gas cannot start from. */
#define BELOW_PACKING " (alphaMax, where the pressure diverges): lower it; of a settledLayer, laidAt"

struct carried_start { /* the fields of the quantities that the gas carries */
    int n;
    struct field_kind kind[CARRIED_MOST];
    struct field *field[CARRIED_MOST];
    double *phi[CARRIED_MOST]; /* [ncells] of struct initial */
    struct rule *rule;         /* [npatches][n] */
};
struct initial {      /* the same on every rank, but for the values of cells */
    struct pool pool; /* has all lists but those of cells, which initial_drop_cells frees */
    /* On lattices without a layer (layers.h) each rank has the cells of its slice, else all. `ncells` is how many it
     * has. */
    bool sliced;
    struct share share;
    long ncells;
    struct field *field[FIELD_COUNT]; /* NULL: there is no such file */
    enum field_id (*from)[3];         /* [npatches] the fields that give a patch's rules: rho or alpha, U, T or p */
    int components, axis[3];    /* of the velocity: the axes of the mesh, then those it lacks but gas moves along */
    double *rho, *T, *u[3];     /* [ncells] kg/m^3, m^2/s^2, m/s along axis[] */
    double *conserved[MAX_VAR]; /* [ncells] rho, rho u .., E: of an exact restart, or averages; else NULL */
    struct carried_start carried;
    bool *rests; /* [ncells] of initial_rest: is the cell at rest? else NULL */
    int npatches;
    struct patch_rules *rules;   /* [npatches] */
    double **values;             /* [3 npatches] nonuniform values that the rules borrow; NULL: uniform */
    const struct polymesh *mesh; /* borrowed */
    double packing_per_density;
    bool *outside; /* [npatches] is the gas outside given, with a velocity that leads along the patch? */
    bool mapped;   /* has the folder all fields of a written time, though no run wrote it? */
    bool varies;   /* does a rule of a patch change in time? */
    double t;      /* s: the time that the rules' values are those of */
};
/* The rule of values that gives rule i (density, velocity, temperature) of a patch; NULL: it has none. */
const struct varying *initial_varying(const struct initial *s, int patch, int i);
/* The first time after t at which a table has a knot; HUGE_VAL: there is none. */
double initial_knot(const struct initial *s, double t);
/* Gives the rules the values of time t: a renewal of gas_vary, whose context is a struct initial. The error is of
 * ERR_STATE. */
status initial_renew(void *initial, double t);
/* Reads the state and the rules. If the folder has conserved fields they are the state, and U and T must agree with
 * them to at->digits. dim, axis: of the mesh; along other axes u has a component if U is not 0 along them, in a cell or
 * on a patch, or if they are `moved` (physical axes: models_move). Collective if place->share is given, the slices that
 * are then read. */
status initial_read(const char *case_dir, const struct instant *at, const struct field_place *place, int dim,
                    const int axis[3], const bool moved[3], const struct gas_models *models, struct initial **out);
/* Reads the state of a folder that no run has written as it would be at rest: its hydrostatic settledLayer without
 * waves, averaged as initial_average does, without patches. Cells of the layer's background are not at rest: they
 * fall.
 * *out is NULL if there is no such layer. */
status initial_rest(const char *case_dir, const struct instant *at, const struct field_place *place, int dim,
                    int components, const int axis[3], const struct gas_models *models, struct initial **out);
/* Warns of patches that may be meant as walls and are open (`outside`). */
status initial_warn(const struct initial *s, bool transport, struct warnings *w);
void initial_free(struct initial *s);
/* For engines whose cells hold averages: if fields are given by expressions, sets s->conserved to the averages of the
 * conserved variables over the cells (mesh/grid/quadrature.h). Uniform values and lists stay as they are, and so does a
 * state that has conserved fields. */
status initial_average(struct initial *s, const struct field_place *place, int dim, const struct gas_models *models);
/* Gives the gas the state: on each rank its own cells, the values of which come from the ranks' slices and are freed.
 * Collective. */
status initial_set(struct initial *s, const struct grid *grid, struct gas *g);
/* Frees the cells' values of the fields, which rho, T, u and conserved were taken from. */
void initial_drop_fields(struct initial *s);
/* Frees what a run no longer needs once the gas holds the state; the boundary rules stay. */
void initial_drop_cells(struct initial *s);

/* What a case says to be at rest: a hydrostatic settledLayer, without its perturbation, of the folder that the case
 * started from. Tells a gas on polyhedra under gravity (gas_rest) what that is; the state of the gas is lost. The start
 * is the newest time folder, up to the one that this run starts from, which no run has written: so a restart has the
 * same balance. *missing: is there no such folder, so that nothing is known? Collective. */
struct setup;
status rest_lay(const struct setup *s, const struct gas_models *models, struct gas *g, bool *missing);

/* The quantities that the gas carries (carried.c). Reads their fields in a folder (path). Collective if place->share is
 * given. */
status carried_start_read(const char *folder, const struct field_place *place, const struct gas_models *models,
                          struct carried_start *s);
/* Makes the rules of the patches. */
status carried_start_rules(struct carried_start *s, struct pool *pool, int npatches, struct patch_rules *rules);
bool carried_start_varies(const struct carried_start *s, int npatches); /* does a rule change in time? */
/* Gives the rules of a patch the values of time t; the first time after t at which a table has a knot. */
status carried_start_renew(struct carried_start *s, int patch, double t);
double carried_start_knot(const struct carried_start *s, int patch, double t);
void carried_start_drop(struct carried_start *s); /* frees the values of cells */
void carried_start_free(struct carried_start *s);

#endif
