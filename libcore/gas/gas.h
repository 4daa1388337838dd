/* The granular gas on a lattice or on polyhedra: state, one time step, and what the outside may ask of it.
 *
 * Variables are rho, rho u (dim components, computational axes of struct forest), E = rho (eps + |u|^2/2). A step is
 * half the sources (exact) | Runge-Kutta stages of the fluxes | half the sources; with transport, half the diffusion
 * stands on both sides of the stages. Nothing is allocated after gas_make.
 */
#ifndef LIBCORE_GAS_H
#define LIBCORE_GAS_H

#include "libcore/gas/diffusion.h"
#include "libcore/models/boundary.h"
#include "libcore/models/eos.h"
#include "libcore/models/source.h"
#include "libcore/models/transport.h"
#include "libcore/schemes/flux.h"
#include "libcore/schemes/polynomial.h"
#include "libcore/schemes/reconstruct.h"
#include "libcore/schemes/stepper.h"
#include "mesh/grid/grid.h"

struct gas_models { /* what the dictionaries chose */
    struct material material;
    const struct eos *eos;
    const struct flux *flux;
    const struct reconstruct *reconstruct;
    const struct stepper *stepper;
    struct sources source;
    const struct polynomial *polynomial; /* on polyhedra, in place of reconstruct; may be NULL on a forest */
    const struct transport *transport;   /* NULL: inviscid, which costs nothing */
    struct own_params transport_params;  /* parameters of the transport law */
    const struct diffusion *diffusion;   /* with transport */
    const struct linear_module *linear;  /* with implicit diffusion: who solves its systems (libcore/gas/implicit.h) */
    double alpha_floor;                  /* alpha stays above it: mass is added where the fluxes cannot help; 0: off */
    bool skip_uniform; /* with transport off; leave out what is exactly zero (libcore/lattice/tiles_activity.c): the
                          same bits, less work */
};

struct gas_counts { /* of what kept the state admissible (libcore/schemes/limit.h), since gas_make; the same on all
                       ranks */
    long cells;     /* whose faces were limited, once a stage */
    long faces;     /* whose flux was moved towards the low-order one, once a stage */
    long rejected;  /* steps rejected and halved */
    long floored;   /* cells raised to the round-off floor, and the energy that added, J */
    double energy;
    long filled;     /* cells raised to the density floor, once a stage, */
    double fill[2];  /* and what that added to the results of steps: mass and energy, kg and J, to round-off */
    double place[3]; /* centre of a cell limited last, m; 0 before */
    long halves;     /* diffusive half steps that stand, */
    long stages[2];  /* the stages they took, of viscous stress and of heat conduction, and those of */
    long repeated;   /* attempts that were repeated for cells that were not admissible, and */
    long plain;      /* how many: the stress on their faces was left without tangential derivatives */
};

struct gas_speed {  /* of the whole domain */
    double rate;    /* max over cells of sum_k (|u_k| + c)/width_k, 1/s: dt = maxCo / rate */
    double calm;    /* the same without cells above 0.99 alpha_max: what it would be without a collapse */
    double axis[3]; /* max |u_k| + c, m/s */
};

struct gas; /* opaque: the state and scratch memory of this rank's tiles */

/* rules[npatches]: of the polyMesh's patches; the forest, rules and models' tables are borrowed. */
status gas_make(struct forest *f, const struct gas_models *models, int npatches, const struct patch_rules *rules,
                struct gas **out);
/* On the grid's polyhedra, made with at least the rings of models->polynomial. */
status gas_make_polyhedral(const struct grid *grid, const struct gas_models *models, int npatches,
                           const struct patch_rules *rules, struct gas **out);
void gas_free(struct gas *g);
int gas_variables(const struct gas *g); /* 2 + dim */

/* State from or to arrays in polyMesh order [ncells_all]; set: every rank holds the arrays; get: root's arrays are
 * filled. Conserved variables restart a run bit by bit. Velocities and momenta: one array per computational axis. */
status gas_set(struct gas *g, const double *rho, const double *const u[3], const double *T);
void gas_set_conserved(struct gas *g, const double *const U[MAX_VAR]);
status gas_get_conserved(const struct gas *g, double *const U[MAX_VAR]);

enum gas_field { GAS_RHO, GAS_ALPHA, GAS_U, GAS_T, GAS_P, GAS_C, GAS_MACH, GAS_LIMITED, GAS_FIELDS };
/* Components: dim for GAS_U, else 1. The values of one field in the cells of one of this rank's blocks (tiles: axis 0
 * fastest): out[component][cells]. gas_field gathers a whole field to root in polyMesh order. */
void gas_block_field(const struct gas *g, int block, enum gas_field field, double *const out[3]);
status gas_field(const struct gas *g, enum gas_field field, double *const out[3]);

/* Checks every cell: rho > 0 (and the density floor), T > 0, alpha < alphaMax; the error names field, value, cell and
 * place. */
status gas_check(const struct gas *g);

void gas_speed(struct gas *g, struct gas_speed *speed);
/* Centre of a cell that reaches the rate of gas_speed for the present state (physical x, y, z; the same on all ranks).
 */
void gas_fastest_place(struct gas *g, const struct gas_speed *speed, double place[3]);

/* One step from t by *dt, or by a halved *dt where the state would leave the admissible set. It fails (ERR_STATE) below
 * `least` (s), and in a gas that cools below `fraction` of maxCo / calm: at once in a state that was set, else after
 * 100 steps in a row of which the later ones fell by half, or 500: "inelastic collapse at t = .., (x y z)"; the state
 * is then the last good one. speed: from gas_speed for the present state. */
status gas_step(struct gas *g, double t, double *dt, double maxCo, double least, double fraction,
                const struct gas_speed *speed);
struct gas_counts gas_counts(const struct gas *g);
/* Share of the cells times stages since gas_make that were computed and not left out as uniform; collective. */
double gas_computed_share(const struct gas *g);

/* Sums over the domain of volume * (rho, rho u .., E): mass, momentum, energy; rank-independent bits. Volume per
 * thickness of the empty axes is struct forest's `volume`. */
status gas_totals(const struct gas *g, double totals[MAX_VAR]);

/* The budget of mass and energy by cause (libcore/gas/audit.h). gas_audit: from now on it is kept; the same bits, a few
 * sums over all cells a step. gas_budget: since then; collective, both. */
enum gas_cause { GAS_HEAT, GAS_FRICTION, GAS_FLOW, GAS_FLOORS, GAS_CAUSES }; /* besides the rows of source_table */
struct gas_budget {              /* sums over the domain, as of gas_totals */
    double mass, energy;         /* now, kg and J */
    double sourced[SOURCE_MOST]; /* J, from each source */
    double gained[GAS_CAUSES];   /* J, from the heat and the work of walls, open patches, floors */
    double flowed, filled;       /* kg, through open patches and by the density floor */
    double lost[2];              /* kg and J that nothing accounts for: round-off */
};
status gas_audit(struct gas *g);
status gas_budget(const struct gas *g, struct gas_budget *out);

#endif
