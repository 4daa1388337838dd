/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The granular gas on a lattice or on polyhedra: its state, its time step, and all that the outside may ask of it. The
 * equations of the gas stand in docs/physics.md 1.2, the order of a step in docs/physics.md 7.2.
 *
 * Variables are rho, rho u, E = rho (eps + |u|^2/2). u has a component along each of the dim computational axes of the
 * mesh (struct forest) and, behind these, along further axes that the mesh does not resolve, if the case has them:
 * nothing varies along such an axis, but gas moves along it. Its momentum is carried with the gas; of the stress it has
 * the shear on the faces of the other axes, with its work and the drag of walls, and of gravity its part. There are no
 * fluxes, ghosts or gradients along that axis, and no part of div u. A step is half the sources (exact) | Runge-Kutta
 * stages of the fluxes | half the sources; with transport, half the diffusion stands on both sides of the stages, in a
 * step with a bed all of it before them.
 * Nothing is allocated after gas_make but room for beds that grow. */
#ifndef LIBCORE_GAS_H
#define LIBCORE_GAS_H

#include "libcore/acoustics/acoustics.h"
#include "libcore/gas/diffusion.h"
#include "libcore/models/boundary.h"
#include "libcore/models/carried.h"
#include "libcore/models/eos.h"
#include "libcore/models/friction.h"
#include "libcore/models/source.h"
#include "libcore/models/transport.h"
#include "libcore/schemes/flux.h"
#include "libcore/schemes/polynomial.h"
#include "libcore/schemes/reconstruct.h"
#include "libcore/schemes/stepper.h"
#include "mesh/base/clock.h"
#include "mesh/grid/grid.h"

struct gas_models { /* models and schemes, as the dictionaries choose them */
    struct material material;
    const struct eos *eos;
    const struct flux *flux;
    struct own_params flux_params; /* of the row; all 0: `common` without its rules of single faces */
    const struct reconstruct *reconstruct;
    const struct stepper *stepper;
    struct sources source;
    const struct polynomial *polynomial; /* takes the place of reconstruct on polyhedra; may be NULL on a lattice */
    const struct transport *transport;   /* NULL: the gas is inviscid, and transport costs nothing */
    struct own_params transport_params;  /* parameters of the transport law */
    const struct friction *friction;     /* of packed gas; NULL or the row `none`: there is none */
    struct friction_params friction_params;
    const struct diffusion *diffusion;    /* time scheme of viscous stress and heat conduction; with transport */
    const struct linear_module *linear;   /* solver of the systems of implicit diffusion (libcore/gas/implicit.h) */
    double linear_error;                  /* allowed in their solutions; 0: 1e-6 (implicit.h) */
    const struct acoustics *acoustics;    /* NULL: explicit */
    struct own_params acoustics_params;   /* parameters of the row */
    const struct carried_choice *carried; /* [ncarried] quantities that the gas carries (libcore/gas/carried.h) */
    int ncarried;
    int components;     /* of u, if more than the mesh has axes; 0: as many */
    int swirl;          /* component around the axis of a body of revolution; 0: there is none */
    double alpha_floor; /* least alpha: mass is added where fluxes would fall below it; 0: off */
    /* without transport or a law that sees the shear rate: are cells in exactly uniform surroundings left out
     * (libcore/lattice/tiles_activity.c, libcore/polyhedral/cells_still.c)? The bits stay the same */
    bool skip_uniform;
};

enum {
    GAS_LEVELS = 6
}; /* of local time steps, at most: on the meshes looked at more than five halvings gain nothing */
/* Counts of the measures that kept the state admissible (libcore/schemes/limit.h), and of diffusion and beds: on all
 * ranks since gas_make, added to the counts that gas_resume was given. */
struct gas_counts {
    long cells;              /* cells whose faces were limited, counted once a stage */
    long faces;              /* faces whose flux was moved towards the low-order flux, counted once a stage */
    long levels[GAS_LEVELS]; /* cells of each level in the last step of timeScheme local; level 0 has the longest steps
                              */
    long staged;             /* steps of timeScheme local that would be inadmissible, and were done again by stages */
    long rejected;           /* steps that were rejected and done again with half of dt or less */
    long floored;            /* cells raised to the round-off floor */
    double energy;           /* J: energy that this floor added */
    long filled;             /* cells raised to the density floor, counted once a stage */
    double fill[2];          /* kg, J: mass and energy that it added to the results of steps, to round-off */
    double place[3];         /* m: centre of a cell that was limited last; 0: there was none */
    long halves;             /* half steps of diffusion that stand; a whole one counts twice */
    long stages[2];          /* stages of viscous stress and of heat conduction, over all attempts */
    long repeated;           /* attempts at diffusion that were done again because cells were not admissible */
    long plain;              /* cells on whose faces the stress went without tangential derivatives then */
    long beds;               /* steps with implicit acoustics, and those of their cells in the last one */
    long bed_cells;
    long newton, linear; /* iterations of Newton's method in these steps, and of the linear solver in those */
    long lifted;         /* cells that took eps of bed.h's (*), as the conservative one was much less */
    double lift;         /* J: energy that this added */
    /* steps with implicit acoustics that damp sound: on demand they stand, automatic ones give way to explicit steps;
     * the greatest part of the bed's energy of motion that one takes, and the centre (m) of the cell that loses most */
    long damped;
    double damping, damped_at[3];
    double pause[2]; /* s: for so long steps stay explicit because of that; for so long they do in all */
};

struct gas_speed {  /* of the whole domain */
    double rate;    /* 1/s: max over cells of sum_k (|u_k| + c)/width_k; dt = maxCo / rate */
    double loose;   /* 1/s: the same without cells above 0.99 alpha_max, as the rate would be without a collapse */
    double axis[3]; /* m/s: max |u_k| + c */
    /* Pa: least and largest pressure; HUGE_VAL and 0 where no fronts are looked for (docs/physics.md 6.12) */
    double low, high;
    /* The step lasts 2^levels of the shortest local steps, and `rate` and `loose` are those of the shortest over that
     */
    int levels;
};

struct gas; /* opaque: state and work memory of this rank's cells */

/* Makes a gas on a lattice. rules[npatches] belong to the polyMesh's patches; the forest, the rules and the tables of
 * the models are borrowed. */
status gas_make(struct forest *f, const struct gas_models *models, int npatches, const struct patch_rules *rules,
                struct gas **out);
/* Makes a gas on the grid's polyhedra, whose stencils have at least the rings of models->polynomial. */
status gas_make_polyhedral(const struct grid *grid, const struct gas_models *models, int npatches,
                           const struct patch_rules *rules, struct gas **out);
/* What the models have that time scheme `local` is not there for (docs/physics.md 7.1), and what to say in the case
 * instead (*cure; NULL: nothing). NULL: no such thing, or another scheme. Both makers above fail with it. */
const char *gas_local_lacks(const struct gas_models *m, bool polyhedral, bool round, const char **cure);
void gas_free(struct gas *g);
int gas_variables(const struct gas *g); /* 2 + components of u */

/* The state from or to arrays in polyMesh order [ncells_all]. set: every rank holds the arrays; get: the root's arrays
 * are filled. Conserved variables restart a run bit by bit. Velocities and momenta: one array per component. */
status gas_set(struct gas *g, const double *rho, const double *const u[3], const double *T);
void gas_set_conserved(struct gas *g, const double *const U[MAX_VAR]);
status gas_get_conserved(const struct gas *g, double *const U[MAX_VAR]);
/* As that, of n variables from the first one on: out[n]. */
status gas_get_variables(const struct gas *g, int first, int n, double *const *out);
/* As gas_set and gas_set_conserved, from arrays of the cells of this rank alone, `cells` of them: one block after the
 * other, each in the order of gas_block_field. */
status gas_set_own(struct gas *g, long cells, const double *rho, const double *const u[3], const double *T);
void gas_set_own_conserved(struct gas *g, const double *const U[MAX_VAR]);
/* Writes n conserved variables, from the first one on, of the cells of one of this rank's blocks: out[n][cells]. */
void gas_block_variables(const struct gas *g, int block, int first, int n, double *const *out);

/* Carried quantity q of gas_models.carried: sets it from the cells of this rank, as gas_set_own has them (own), or from
 * an array in polyMesh order; gives it in the cells of a block, as gas_block_variables does; or gathers it as
 * gas_get_variables does. */
void gas_set_carried(struct gas *g, int q, bool own, const double *values);
void gas_block_carried(const struct gas *g, int block, int q, double *out);
status gas_get_carried(const struct gas *g, int q, double *out);

/* Makes it known that the state now set, with its velocity taken as 0, is at rest under gravity in the cells with
 * rests[ncells_all]: on polyhedra it, and states near it, are then balanced to round-off
 * (libcore/polyhedral/cells_rest.c). The state itself is lost: it must be set again. Collective. */
status gas_rest(struct gas *g, const bool *rests);

/* What friction keeps from step to step (docs/physics.md 9.3), for restarts. A cell has one line of pressure and, for
 * each of its sides, lines of the stress: rows of the upper half of a tensor of `components`. The sides of a lattice
 * are the low and the high one along each axis in turn; those of polyhedra have the order of the polyMesh's faces. */
int gas_friction_sides(const struct gas *g); /* most sides of a cell, of all ranks; 0: there is no friction */
/* The lines of cells of this rank, as gas_set_own has them, from line `first` on: sets n of them, or gives those of one
 * block. */
void gas_set_friction(struct gas *g, int first, int n, const double *const *values);
void gas_block_friction(const struct gas *g, int block, int first, int n, double *const *out);

enum gas_field { GAS_RHO, GAS_ALPHA, GAS_U, GAS_T, GAS_P, GAS_C, GAS_MACH, GAS_LIMITED, GAS_FIELDS };
/* gas_block_field writes the values of one field in the cells of one of this rank's blocks (struct grid; on a
 * lattice axis 0 is fastest), out[component][cells], with all components for GAS_U, else 1. gas_field gathers a whole
 * field to the root in polyMesh order. */
void gas_block_field(const struct gas *g, int block, enum gas_field field, double *const out[3]);
/* Is a field known to have the same bits in all cells of a block? Then value[component] gets them. */
bool gas_block_uniform(const struct gas *g, int block, enum gas_field field, double value[3]);
status gas_field(const struct gas *g, enum gas_field field, double *const out[3]);

/* Checks that every cell has rho > 0 (and the density floor), T > 0 and alpha < alphaMax. The error names field, value,
 * cell and place. */
status gas_check(const struct gas *g);

/* Finds the wave speeds of the present state. Collective. */
void gas_speed(struct gas *g, struct gas_speed *speed);
/* Finds the centre (m; physical x, y, z; the same on all ranks) of a cell that reaches the rate of gas_speed. */
void gas_fastest_place(struct gas *g, const struct gas_speed *speed, double place[3]);
/* Finds how long a step with implicit acoustics of dense cells may be (s), and what limits it: the thin gas, the flow,
 * the cooling of the bed, or the fall. Returns 0 if the next step should be explicit. speed: of the present state; fall
 * (s): the longest step that gravity allows the explicit scheme. Collective. */
double gas_bed_step(struct gas *g, double maxCo, const struct gas_speed *speed, double fall, const char **limit);
/* Can a gas of these models ever take such steps? */
bool gas_may_be_dense(const struct gas_models *m);
static inline bool gas_rubs(const struct gas_models *m) { /* is there friction? */
    return friction_acts(m->friction);
}
/* Returns the largest inertial number (docs/physics.md 4.8) |u| sigma/(h sqrt(p/rho of a grain)) of dense cells in the
 * last gas_bed_step, an upper estimate as u may change over more than a cell; HUGE_VAL if there was no bed. */
double gas_inertia(const struct gas *g);
struct gas_cell {
    double place[3], alpha, T, c; /* centre, m; state, m^2/s^2, m/s */
};
/* Why gas_bed_step planned an explicit step although gas is dense: the longest step with a bed, as the cause has it, is
 * `steps` explicit ones, and `gain` are the least. */
enum bed_cause { BY_THIN, BY_FLOW, BY_COOLING, BY_FALL, BY_OUTLET, BED_CAUSES };
struct gas_bed_bound {
    enum bed_cause cause;
    const char *name, *cure;      /* the cause in words, and what a case may do about it */
    double steps, gain, rate, dt; /* rate: 1/s, of the cell; 0: no cell is the cause. dt: s, the explicit step */
    struct gas_cell cell;
};
/* Was the last planned step explicit although gas is dense? Then gas_bed_bound says why; the state must still be that
 * of the plan. Collective. */
bool gas_bed_refused(const struct gas *g);
void gas_bed_bound(struct gas *g, struct gas_bed_bound *out);
/* Finds such a cell with its state, the same on all ranks. */
void gas_fastest_cell(struct gas *g, const struct gas_speed *speed, struct gas_cell *out);

/* Lets the values of patches change in time: before they are used for another time t (s) in a step, renew(context, t)
 * gives the rules their values of that time. These are the times of the Runge-Kutta stages; of each half step of
 * diffusion its coefficients' time, its middle, and the times at which walls act in its stages; and the end of a step
 * for a bed of implicit acoustics. All ranks call it alike, and must get the same result; an error ends gas_step.
 * Patches that give mass (patch_feeds) do not go with implicit acoustics; automatic ones are explicit then. */
void gas_vary(struct gas *g, status (*renew)(void *context, double t), void *context);
/* Lets gas_step ask, between parts of a step that takes long, whether to leave it. It is left if any rank says yes;
 * each rank sets `asked`, or none. */
void gas_heed(struct gas *g, bool (*asked)(void));
/* Advances the state from t by *dt, or by a halved *dt where the state would leave the admissible set. `speed` comes
 * from gas_speed for the present state. Fails (ERR_STATE, "inelastic collapse at t = .., (x y z)") if dt must fall
 * below `least` (s); in a gas that cools also if it falls below `fraction` of maxCo / loose: immediately if the state
 * that was set is already that stiff, otherwise after 100 consecutive tiny steps whose dt halved over the last 50, or
 * after 500. The state is then the last good one. A step that is left (gas_heed) has *dt = 0 and changes nothing. */
status gas_step(struct gas *g, double t, double *dt, double maxCo, double least, double fraction,
                const struct gas_speed *speed);
struct gas_counts gas_counts(const struct gas *g);
/* Sets out[] to the seconds of the clock that each part of steps took on this rank since gas_make, attempts that failed
 * among them; returns their number. */
int gas_seconds(const struct gas *g, struct part_seconds out[PARTS_TIMED]);
/* Goes on with the counts of an earlier run (all but those of diffusion and beds), its pause, and with its field
 * GAS_LIMITED in the cells of this rank, as gas_set_own has them (NULL: there is none). */
void gas_resume(struct gas *g, const struct gas_counts *counts, const double *limited);
/* Returns the share of the cell updates since gas_make that were computed, not left out as uniform. Collective. */
double gas_computed_share(const struct gas *g);

/* Sums volume * (rho, rho u .., E) over the domain: mass, momentum, energy, with the same bits on any number of ranks.
 * Volumes are per thickness of the empty axes, as struct forest's `volume`. */
status gas_totals(const struct gas *g, double totals[MAX_VAR]);

/* Gives n faces of a patch its values (docs/physics.md 5.8): q, which holds rho, u along computational axes and T in
 * the cells beside them, [components + 2][n], gets those on the faces. face[n]: faces within the patch; normal: unit,
 * out of the gas, [components][n], 0 along axes beyond dim; gap[n] m: from the cells to their mirror images. Returns
 * whether the patch is a wall: there the pressure is that of the cells, whatever T is. */
bool gas_on_patch(const struct gas *g, int patch, int n, const int *face, double *const normal[3], const double *gap,
                  double *const q[MAX_VAR]);

/* What left the gas through the faces of patches in the last step: the state itself has changed by it, to round-off
 * (libcore/gas/tally.h). gas_tally begins to keep it, which changes no bit of the gas and costs little; collective. */
struct gas_face {       /* of a patch; vectors along computational axes; rates are means over the last step */
    int patch;          /* of the polyMesh */
    double area;        /* m^2, with the thickness of empty axes */
    double centre[3];   /* [dim] m */
    double normal[3];   /* [dim] unit, out of the gas */
    double mass;        /* kg/s that left */
    double pressure[3]; /* [components] N: momentum that left by pressure and flow */
    double viscous[3];  /* [components] N: momentum that left by viscous stress */
    double energy;      /* W that left by pressure and flow, by the work of the stress, by conduction */
    double work, heat;
};
typedef void gas_face_visitor(void *context, const struct gas_face *face);
status gas_tally(struct gas *g);
double gas_tally_step(const struct gas *g); /* s: length of the last step; 0: there was none since gas_tally */
/* Visits the faces of patches that one of this rank's blocks has (struct grid), in an order that does not depend on the
 * ranks. */
void gas_tally_faces(const struct gas *g, int block, gas_face_visitor *visit, void *context);

/* The budget of mass, momentum and energy by cause (libcore/step/audit.h). gas_audit begins to keep it, which changes
 * no bit of the gas and costs a few sums over all cells a step; gas_budget says what has changed since then. Both are
 * collective. */

/* Causes of changes, besides the rows of source_table. */
enum gas_cause { GAS_HEAT, GAS_FRICTION, GAS_FLOW, GAS_FLOORS, GAS_DILATION, GAS_CONTACTS, GAS_CAUSES };
enum gas_edge { GAS_WALLS, GAS_OPEN, GAS_EDGES };
struct gas_budget {              /* sums over the domain, as by gas_totals */
    double mass, energy;         /* kg, J: of the present state */
    double sourced[SOURCE_MOST]; /* J: from each source */
    double gained[GAS_CAUSES];   /* J: by gas_cause: heat of walls, work of walls, open patches, floors, zeta_U,
                                  * friction of grains in contact */
    double flowed, filled;       /* kg: through open patches, and by the density floor */
    double lost[2];              /* kg, J: changes that no cause accounts for: round-off */
    /* N s along computational axes, [components]: of the present state; from each source; through walls and open
     * patches, by pressure, flow and stress; by the density floor; round-off */
    double momentum[MAX_DIM], pushed[SOURCE_MOST][MAX_DIM], through[GAS_EDGES][MAX_DIM], given[MAX_DIM],
        strayed[MAX_DIM];
};
status gas_audit(struct gas *g);
status gas_budget(const struct gas *g, struct gas_budget *out);

#endif
