/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The inside of the gas, which the files of libcore/gas and both engines (libcore/gas/engine.h) share. */
#ifndef LIBCORE_GAS_PRIVATE_H
#define LIBCORE_GAS_PRIVATE_H

#include "libcore/acoustics/bed.h"
#include "libcore/gas/books.h"
#include "libcore/gas/engine.h"
#include "libcore/gas/implicit.h"
#include "libcore/gas/tally.h"
#include "libcore/schemes/limit.h"
#include "mesh/base/pool.h"

#define PACKED 0.99 /* fraction of the density limit; cells above it are packed */
/* A face has the flux of first order if a cell of its stencil is VOID times as dense as the thinner of its two, and
 * none on the other side VOID_BESIDE times, where p changes by more than VOID_BESIDE, too. */
#define VOID        100.
#define VOID_BESIDE 4.
/* T and the shear rate at the end of a step are extrapolated from the first half by at most this factor: at a front
 * that passes the extrapolation says nothing of what follows. */
#define MOST_RISE 4.
/* Most of the largest rate of diffusion times half a step: beyond it sums of stages have no digit of q_0 left. */
#define MOST_RATIO 1e16
/* Most stages of stress, or of heat, that a half step may take before it is cut into parts. */
enum { MOST_STAGES = 100000 };

enum { GUARDED = 16 }; /* steps that are guarded after one that found an inadmissible cell */

struct dense_border {        /* a face of the bed that is not BED_INNER */
    int face, block;         /* in the bed's list; the block of its places */
    long inside, beyond;     /* places of the bed's cell and of what is across the face, in the lines of the block */
    int through, edge;       /* place in lines over the faces of the block; number among faces of patches, or -1 */
    struct patch_face patch; /* which it is a part of */
};
struct dense { /* implicit acoustics of dense cells (libcore/gas/dense.c) */
    struct bed bed;
    long own;                    /* cells of this rank */
    struct row *row;             /* [rows] the bed's cells in the bed's order */
    struct dense_border *border; /* [borders] */
    int rows, borders;
    int blocks;           /* tiles of a lattice; 1 on polyhedra */
    bool *holds;          /* [blocks] has the block a cell of the bed? */
    int **number;         /* [blocks][size] numbers of the bed's cells over all ranks from 1 on, else 0; ghosts too */
    struct arrays arrays; /* the memory of row, border */
    struct pool pool;     /* that of the engine, and of `flux` on a lattice */
    double **flux;        /* [blocks] of [nvar][g->blocks.faces]: of the last stage; NULL where no bed has been */
    int *place;           /* [blocks of the bed] where in g->floors.raised its sums go */
    double thin;          /* kg/m^3: below it cells are near vacuum */
    double above, hard;   /* kg/m^3: denser cells are dense, or hard */
    double **part;        /* [blocks][size] enum bed_part, 0: none; ghosts too */
    bool alone;           /* is every cell one of the bed? */
    /* [blocks] of [1 + sides * tensors][size]: what friction keeps from step to step, the pressure of each cell and the
     * stress on each of its sides (struct bed_set); NULL without friction */
    double **kept;
    int sides;                  /* most of a cell */
    struct sides *seen;         /* [sides] scratch */
    bool rubs;                  /* is there packed gas, on which friction acts? */
    bool relisted;              /* does `kept` hold cells that are no longer in the bed? */
    double inertia;             /* of the dense cells in the last plan */
    double cooling;             /* 1/s: this rank's largest rate of cooling in dense cells so far; 0: not known yet */
    bool begun;                 /* are the stages at work, whose results in cells of the bed are given up? */
    double kick[MAX_DIM];       /* m/s^2: mean acceleration by gravity in the last step of the bed */
    double longest;             /* s: the step that was planned; 0: the next step is explicit */
    double beside;              /* 1/s: the Courant number of gas outside the bed, in that step, is this times dt */
    struct gas_bed_bound bound; /* why it is explicit; its cause is BED_CAUSES if it is not, or no gas is dense */
    double plain, usual; /* s: the explicit step in the last plan, and that which implicit ones are compared with */
    bool refused;        /* was the last step of the bed refused: it would damp sound, or gas leans on an outlet? */
    bool leans;          /* did packed gas lean on an open patch without pressure in it? */
    double pause;        /* s: steps stay explicit for so long after that */
    double paused;       /* s: so long the pause was at first; a restart goes on with both */
    status failed;       /* why an attempt could not be made, other than that dt was too long */
};

/* Gravity is a part of div F in the stages, where the fluxes know the pressure that carries gas at rest. Only in cold
 * cells, which fall freely, half of it acts before the stages and half behind them, and leaves their T alone: in a
 * stage it would take the square of the velocity gained from an energy that is smaller. */
struct falling {
    double **cells;          /* [blocks][size] 1 in cold cells, else 0; NULL without gravity */
    bool *blocks;            /* [blocks] has the block a cold cell? */
    double gravity[MAX_DIM]; /* m/s^2: mean over the step in hand */
    double *dropped;         /* [places] J/m^3 that drop_row added in the redo of a stage */
    /* [places] kg s/m^3, with a budget: dt times the rise of rho in the stage, in the cells that drop_row drops */
    double *denser;
};

struct floors {      /* what floors and gravity added in this attempt at a step (libcore/gas/floors.c) */
    int places;      /* where amounts are summed: one per tile, or one per cell of polyhedra */
    int step;        /* of a row's cell i the place is block + step (at + i): 0 per tile, 1 per cell */
    double share;    /* fraction of an amount added to the present stage that survives in the result of the step */
    long floored;    /* cells raised to the round-off floor, on this rank */
    double *raised;  /* [places] J/m^3 that the round-off floor added */
    long filled;     /* cells raised to the density floor, on this rank */
    double *fill[2]; /* [places] mass and energy per m^3 that the density floor added; NULL without it */
    double *given[MAX_DIM]; /* [places] momentum per m^3 of that mass; NULL without a budget */
};

struct limit_flags {  /* of cells whose faces are to be limited (libcore/gas/flags.c) */
    double **cells;   /* [blocks][size] > 0 where they are (numbers travel like variables) */
    bool *blocks;     /* [blocks] does the block, or its ghosts that are NEAR_CELLS, hold a flag? */
    double **limited; /* [blocks][size] how often the faces of a cell were limited */
    double **kept;    /* as limited, before the step in hand */
    double **mark;    /* [blocks][size] > 0 in cells that diffusion left inadmissible */
    bool marked;      /* is any mark up? */
};

struct limits { /* of admissible states, and the limiting of fluxes that keeps to them (libcore/schemes/limit.h) */
    double least, most; /* least < rho < most; least is 0, or the density floor less round-off */
    bool crowds;        /* are crowded cells limited (find_crowded)? no, if the gas may collapse: it packs by itself */
    const struct reconstruct *first_order; /* of the fluxes that limiting moves towards */
    long faces;                            /* faces limited in the last redo, on this rank */
    struct limit_flags flags;
};

struct patch_side {     /* a face of this rank on a patch */
    int block, face;    /* its place in lines over the faces of the block */
    int inside, beyond; /* places of its cell and of the ghost */
    double out;         /* 1: fluxes lead out of the gas, -1: into it */
    struct patch_face patch;
};
struct patches {
    int n;
    int sides;                                /* of this rank */
    struct patch_side *side;                  /* [sides] by their number (edge of struct sides) */
    const struct patch_rules *rules;          /* [n] */
    bool fed;                                 /* is there a patch that gives the mass that flows in? */
    status (*renew)(void *renewer, double t); /* of gas_vary; NULL: the values of patches do not change */
    void *renewer;
    status failed; /* why they could not be renewed in this step */
};

struct counting {
    struct gas_counts now;       /* of this run; sums of amounts and `place` go on from an earlier one */
    struct gas_counts before;    /* numbers of an earlier run */
    long computed, all;          /* cell updates on this rank: computed ones, and with those that were left out */
    double seconds[PARTS_TIMED]; /* s, clock of this rank: by each part of steps (libcore/step/step_parts.c) */
    long images;                 /* cells of the mesh that each cell stands for: more than 1 along uniform axes */
};

struct stiff { /* the diffusion that an attempt at a step refused; the same on all ranks */
    bool found, second;
    enum diffusing what;
    double rate, dt; /* 1/s: the largest rate of its cells; s: the half step */
    double stages;   /* that it would take, at least; 0 if diffusion is implicit */
    double place[3]; /* m: of a cell that has that rate */
};
/* What laws ask for (libcore/gas/shear_rate.c); NULL if none does. */
struct shear_rate {
    double **now;  /* [blocks][size] 1/s, of the state that was seen last */
    double **rise; /* [blocks][size] the factor by which it rose over the first half of diffusion */
};

enum lapse_of { FIRST_HALF, SECOND_HALF, WHOLE_STEP };

struct half_diffusion {           /* the half step of diffusion in hand, or the whole one; with transport */
    struct transport_terms terms; /* what the transport law asks for */
    double pull[MAX_DIM];         /* m/s^2: mean acceleration by the sources */
    bool late;                    /* is it the second half of a step, whose cooling is to come, or a whole step? */
    bool whole;                   /* is it a whole step? Its sink is what cooling takes in both halves */
    bool oblique;                 /* is a line of centres oblique to its face, so that heat is not symmetric? */
    bool ahead;                   /* are the coefficients those at the end of the half step (diffusion.c)? */
    /* From flags_of_marks on until the next rates: the stress on the faces of flagged cells has no tangential
     * derivatives (on polyhedra all their fluxes have the jumps across the faces alone), and cross is 0 there. */
    bool plain;
    /* Lines of the engine: S of the last stage is sum[last], that of the stage before sum[1 - last]; [blocks], from
     * component to component `wide` numbers. */
    double **sum[2];
    long wide;
    int last;
    /* [blocks][size] T of the coefficients of the first half, then T at its end over that; with ghosts (NEAR_CELLS) */
    double **warm;
    double **dilation;         /* [blocks][size] coefficient of div u; NULL: the law has no such term */
    double **friction;         /* [blocks][size] rise of T by the stress, less cooled; 0 in ghosts */
    double **cooled;           /* [blocks][size] fall of T by the sources in the first half; 0 in ghosts */
    struct implicit *implicit; /* NULL: diffusion is explicit */
    int unasked;               /* stages since the ranks last asked each other whether to leave the step */
    struct stiff stiff;
    struct shear_rate shear_rate; /* for laws of transport and cooling */
};

struct stepping {           /* the step in hand and those before it (libcore/step/step.c) */
    double dt;              /* s: its Runge-Kutta stages, for fluxes that depend on it */
    double t, courant;      /* s: its start; maxCo: for local steps */
    struct gas_speed speed; /* wave speeds of U, if speed_known */
    bool speed_known;
    double fastest[MAX_DIM]; /* m/s: max |u_k| + c, from the last gas_speed */
    int guarded;             /* number of steps still to be guarded, stage by stage */
    int slow;                /* number of consecutive tiny steps; -1 in a state that was set: unknown */
    double slow_dt[2];       /* s: dt of an earlier tiny step (at most 50 before), and of the last step */
    bool hybrid;             /* has it a bed? */
    bool (*asked)(void);     /* of gas_heed; NULL: never */
    bool left;               /* is it left as asked? The same on all ranks */
    bool held;               /* is a copy of the field `limited` kept, from before it? */
};

struct blocks {              /* of the state, and sums over them (libcore/gas/blocks.c) */
    int n;                   /* tiles, or 1 */
    const struct grid *grid; /* the mesh of polyhedra, borrowed; NULL on a lattice */
    const double *volume;    /* [size] of the cells of polyhedra, m^dim; NULL on a lattice */
    double unit;             /* m^3 of a cell of a lattice, m^(3-dim) of polyhedra: sums are multiplied by that */
    const double *area;      /* of the faces of polyhedra, m^(dim-1); NULL on a lattice: fluxes are per area */
    long faces;              /* numbers in a line over the faces of a block */
    double *sums;            /* [nvar][blocks of the grid] scratch */
};

struct books {           /* what a step is booked in (libcore/step/books.c) */
    struct audit *audit; /* the budget; NULL: none is kept */
    struct tally *tally; /* fluxes through patches; NULL: they are not kept */
};

struct gas {
    const struct engine *engine;
    const struct comm *comm;
    struct forest *forest; /* the mesh, borrowed: a lattice cut into tiles; NULL on polyhedra */
    struct tiles *tiles;   /* memory of the engine of the lattice (libcore/lattice/tiles.h), or NULL */
    struct cells *cells;   /* memory of the engine of polyhedra (libcore/polyhedral/cells.h), or NULL */
    struct gas_models models;
    int dim;
    int components; /* of u: those along the dim axes of the mesh, then those it does not resolve */
    int nvar;       /* components + 2: rho, rho u, E */
    long size;      /* numbers in a line of a block: the distance from one variable to the next */

    struct state U;    /* the state between steps */
    struct state U0;   /* after the first half of the sources: the start of the Runge-Kutta step */
    struct state V, W; /* results of stages, and scratch */

    struct blocks blocks;
    struct patches patches;
    struct stepping step;
    struct limits limits;
    struct floors floors;
    struct falling falling;
    struct half_diffusion diffusion;

    struct dense *dense;     /* implicit acoustics; NULL: there are none */
    struct carried *carried; /* libcore/gas/carried.h; NULL: the gas carries nothing */
    struct counting counts;
    struct books books;
};

/* The place of E among the variables: behind rho and the components of rho u. */
static inline int energy_at(const struct gas *g) {
    return g->components + 1;
}

/* Sets g->step.speed to the maxima over the ranks, unless a rank says that its speeds are void: then returns false.
 * Collective. */
bool speed_agree(struct gas *g, const struct gas_speed *mine, bool is_void);

/* Gives the patches their values at time t (gas_vary). */
void renew_patches(struct gas *g, double t);

/* Moves `from` by viscous stress and heat conduction over dt from t on, a half of a step or all of it. bad:
 * number of cells of `from` on this rank that are not admissible. Returns false, on all ranks, if a rank has such cells
 * or would have them in `to`. */
bool diffuse(struct gas *g, const struct state *from, const struct state *to, double t, double dt, enum lapse_of part,
             long bad);

/* Sets g->diffusion.cooled to the fall of T from one state to the other by sources. It is negative where T rose, if a
 * source heats. */
void note_cooled(struct gas *g, const struct state *from, const struct state *to);

struct lapse {    /* one step of stress or conduction */
    double t, dt; /* its start and its length, s */
    /* fraction of the half step's frictional heating that Y0's T contains although it is not yet conducted */
    double pending;
    double part; /* fraction of that heating that this step adds */
};

/* Advances `what` (velocity or temperature) from Y0 to `to` by one implicit step, of backward Euler if `monotone`.
 * Returns this rank's number of cells that are not admissible: all, if the system was not solved. */
long implicit_step(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to,
                   const struct lapse *l, bool monotone);

/* ---- implicit acoustics of dense cells (libcore/gas/dense.c) ---- */

/* dense_make comes before the engine is made, dense_kept behind it. */
status dense_make(struct gas *g);
status dense_kept(const struct gas *g);
/* Lets friction act on the packed gas of `to` over dt, behind an explicit step. Returns whether the result is of use.
 */
bool dense_rub(struct gas *g, double t, double dt, const struct state *to);
status dense_listed(struct gas *g);      /* lists the bed, unless it is that of the last list */
void dense_take_friction(struct gas *g); /* takes what friction kept, and what the walls do */
void dense_keep_friction(struct gas *g); /* keeps what friction needs in the next step */
void dense_free(struct gas *g);
struct bed_rates {  /* 1/s, largest in this rank's cells; each dt is a share of 1/rate */
    double thin;    /* sum_k (|u_k| + c)/width_k outside of the frozen parts */
    double solid;   /* the same without near vacuum, cells less dense than g->dense->thin */
    double flow;    /* sum_k |u_k|/width_k */
    double cooling; /* of T in dense cells */
    double inertia; /* the inertial number of dense cells (gas_inertia), no rate */
};
/* Marks the dense cells. Returns whether any rank has some. Collective. */
bool dense_find(struct gas *g);
/* Makes cells of near vacuum whose rate of thin gas is above `rate` dense, too. Returns whether any rank has some: then
 * dense_rates must follow. Collective. */
bool dense_include(struct gas *g, double rate);
/* Marks the parts of the bed around the dense cells and finds the rates over all ranks, those of cooling over `plain`.
 * The second time only near vacuum has become dense, and the other cells' rate of cooling is known. Collective. */
struct bed_rates dense_rates(struct gas *g, double plain);
/* Finds the first cell that has the rate which forbids an implicit step, d->bound.rate. Collective. */
void dense_seek(struct gas *g, double place[3]);
/* Copy the states of the bed's cells from a state, or to it; dense_put returns the number of those not admissible. */
void dense_take(struct gas *g, const struct state *from);
long dense_put(struct gas *g, const struct state *to);
/* Lists and takes the bed from the state in which a step starts. Collective. */
status dense_begin(struct gas *g, const struct state *from);
/* Keeps the fluxes of a stage towards the bed, and behind the first stage writes the bed's lists, if there are new
 * ones: a rank with more of the bed has less to do in each of the stages. */
void dense_keep(struct gas *g, double weight);
/* Advances the bed and puts it into `to`, behind the stages of the other cells; in a guarded step the floors mend its
 * cells. Returns false, on all ranks, if the step must be done again. */
bool dense_advance(struct gas *g, double t, double dt, bool guarded, const struct state *to);
/* Was the step of *dt just refused by the bed? Then sets *dt to an explicit one, and begins
 * the pause. */
bool dense_refused(struct gas *g, double *dt);
/* A step of dt stands: the pause is shorter by that. */
void dense_pass(struct gas *g, double dt);
/* Sums numbers per block of the bed (J/m^3) to one per place of g->floors.raised. */
void dense_spread(const struct gas *g, const double *per_block, double *raised);
/* Counts a bed whose step stands. */
status dense_count(struct gas *g);

/* ---- why a gas cannot go on (libcore/step/stop.c); all are collective ---- */

/* Does the gas cool, however slow its impacts are, so that it may reach close packing in finite time? With a threshold
 * speed the steps of a bed at rest are short, but they fall no further. */
bool gas_can_collapse(const struct gas *g);
/* Finds the state of the cell at its place. Collective. */
void look_at(struct gas *g, struct gas_cell *cell);
/* Returns the error of a dt that falls below its least value. */
status stop_of_collapse(struct gas *g, double t, double dt, const struct gas_speed *speed);
/* Returns the error of a rate of wave speeds that is infinite or no number. */
status stop_of_speed(struct gas *g, double t, const struct gas_speed *speed);
/* Returns the error of diffusion that is too stiff; g->diffusion.stiff says where and by how much. */
status stop_of_diffusion(struct gas *g, double t);
/* Have the ranks been asked to leave the step? Sets g->step.left. */
bool asked_to_leave(struct gas *g);
/* Returns the error of a dt so short that t + dt is t, or all but t. */
status stop_of_time(struct gas *g, double t, double dt, const struct gas_speed *speed);

/* Lists the faces of patches, g->patches.side (libcore/gas/sides.c). */
status sides_make(struct gas *g);

/* Allocates a line of all blocks. */
status line_make(const struct gas *g, double ***out);
void line_free(const struct gas *g, double **line);

/* ---- spans (libcore/gas/spans.c); all do nothing on polyhedra ---- */

/* Writes the backgrounds of s out to the cells outside of the spans. */
void spans_write_out(const struct gas *g, const struct state *s);
/* Gives `to` the spans of `from`, whose rows were written to it. */
void spans_keep_as(const struct gas *g, const struct state *from, const struct state *to);
/* Gives both states the joined spans of both. */
void spans_join(const struct gas *g, const struct state *a, const struct state *b);
/* Makes the cells of backgrounds varied cells: of the blocks that are marked (NULL: of all), or of inadmissible
 * backgrounds, so that each cell is mended and counted by itself. */
void spans_unfold(struct gas *g, const struct state *s, const bool *blocks);
void spans_unfold_bad(struct gas *g, const struct state *s);

/* ---- flags of cells (libcore/gas/flags.c) ---- */

/* Sends the flags to the neighbours; returns the number of flagged cells of all ranks. */
long flags_send(struct gas *g);
/* Counts the flags in the field `limited`, and sets `place` to the first flagged cell. */
void flags_note(struct gas *g, double place[3]);
/* Keeps a copy of the field `limited`; back: gives the field the values of the copy. */
void flags_hold(struct gas *g, bool back);
void flags_clear(struct gas *g);
/* Turns the marks of diffusion into flags, for plain fluxes (keep), or drops them. Returns the number of flagged cells
 * of all ranks. */
long flags_of_marks(struct gas *g, bool keep);

/* ---- the blocks of the grid (libcore/gas/blocks.c) ---- */

int grid_blocks(const struct gas *g); /* of this rank */
/* Sums one number per block over all ranks, with the same bits for any number of ranks. Collective. */
status sum_blocks(const struct gas *g, const double *per_block, double *sum);
/* Sums volume * variable v of a state over the domain: totals[v]. Collective. */
status state_totals(const struct gas *g, const struct state *s, double totals[MAX_VAR]);
/* Sums volume * raised, which is [nraised], over the domain. Collective. */
status sum_raised(const struct gas *g, double *raised, double *sum);
/* Set U, or `limited`, from arrays of this rank's cells, block by block (own), or in polyMesh order. */
void state_set(struct gas *g, bool own, const double *const U[MAX_VAR]);
void limited_set(struct gas *g, const double *values);

/* ---- rows of cells (libcore/gas/rows.c) ---- */

/* Computes velocity and eps = E/rho - |u|^2/2 of n <= BATCH states whose variables are `size` apart. */
void velocity_row(int n, int dim, long size, const double *restrict U, double *const *velocity, double *restrict eps);
/* Computes c = sqrt(c). */
void root_row(int n, double *restrict c);
/* to = W + a (U0 - W), W = from + dt L, of states whose variables are g->size apart, and `each` in the residual. */
struct advance {
    const double *restrict U0, *restrict from, *restrict residual;
    long each;
    double *restrict to, a, dt;
    const double *weight; /* [n] of the cells in the sums of drop_row; NULL: 1 */
};
/* The radii (m) of n cells of a block of a round lattice, in room[BATCH]: sums per tile are weighted by them. NULL: the
 * mesh is not round. */
const double *row_radius(const struct gas *g, int block, long at, int n, double *room);
/* That of a face of a block, by its place in lines over faces; 1 where the mesh is not round. */
double face_radius(const struct gas *g, int block, long face);
/* Advances n <= BATCH states by L = residual. */
void update_rows(const struct gas *g, int n, const struct advance *s);
/* Adds rho g and rho u.g, the effect of gravity, to the residuals of rho u and E of n <= BATCH cells, but not where
 * falls is 1 (NULL: it is 0 everywhere) or flag is above 0. */
void weigh_row(const struct gas *g, int n, const double *const U[MAX_VAR], const double *falls, const double *flag,
               double *const residual[MAX_VAR]);
/* Advances n <= BATCH states by L = residual, to which gravity adds rho g and rho u.g of rho u and E, but not where
 * falls is 1 (NULL: it is 0 everywhere) or flag is above 0. */
void advance_row(const struct gas *g, int n, const struct advance *s, const double *falls, const double *flag);
/* Lets flagged states fall, for which advance_row left gravity out: W gains the velocity g dt at its own T, so that it
 * stays admissible. dropped[i step]: the energy (J/m^3) that W gains by that; it is not noted for cells of a bed (part,
 * enum bed_part, or NULL), which are given back their start. */
void drop_row(const struct gas *g, int n, const struct advance *s, const double *falls, const double *flag,
              const double *part, double *dropped);
/* Forgets what drop_row noted, before a stage is done again. */
void drop_begin(const struct gas *g);
/* Gives the frozen cells of a bed the state U0. */
void freeze_row(const struct gas *g, int n, const struct advance *s, const double *part);
/* Computes T of n <= BATCH states of a block; U points to the first state's density. */
void temperature_row(const struct gas *g, int n, const double *U, double *T);
/* Computes the share 1 - s of the stress that impacts carry (struct closure_line); returns `out`, or NULL if grains do
 * not rub. */
const double *impacts_row(const struct gas *g, int n, const double *rho, double *out);
/* Computes the coefficients of the law of transport for a line of cells. Where packed grains rub, friction is the share
 * s of the shear stress (docs/physics.md 4.10), and the viscosities keep 1 - s. Conduction stays whole. */
void transport_row(const struct gas *g, const struct closure_line *cells, double *restrict bulk, double *restrict shear,
                   double *restrict heat);
/* Computes q_0 of a row (diffusion_hooks.begin), of which components of u, or T alone, go to lines q. */
void start_row(const struct gas *g, enum diffusing what, const struct state *Y0, const struct row *row, double pending,
               double *const *q);
struct moved { /* what the flux of the last S of diffusion brings to n <= BATCH cells of a block */
    enum diffusing what;
    struct row row;
    const double *from, *E; /* the block of Y0; the line of energy that the work is added to */
    double *to, dt;
    double (*M)[BATCH]; /* gains: momentum, then dt times the work; or heat */
};
/* Moves these cells; marks those that are not admissible then, and returns their number. */
int move_row(struct gas *g, const struct moved *m);
/* Takes from the energy E of n <= BATCH states of a block what the law's term of dilation takes over dt where div u is
 * spread[n], less than the internal energy of U, which points to the first state's density; dilation: [n]
 * coefficients. */
void dilate_row(const struct gas *g, int n, double dt, const double *dilation, const double *spread, const double *U,
                double *E);
/* Computes a field of n <= BATCH states whose variables are `size` apart: out[component][n]; any field but
 * GAS_LIMITED. */
void field_row(const struct gas *g, enum gas_field field, int n, long size, const double *U, double *const out[3]);

struct half_step { /* context of source_row, the visitor of rows that applies sources */
    const struct gas *g;
    const struct state *from, *to;
    const struct source_plan *plan;
    double **shear_rate; /* [blocks][size]; NULL: no source asks for it */
    long bad;            /* out: number of cells that are not admissible in `to` */
    /* the background that was advanced last, which many tiles have in common, before and after; known: is there one? */
    bool known;
    double before[MAX_VAR], after[MAX_VAR];
};
void source_row(void *half_step, const struct row *row);
/* Writes to `to` the sources of the plan applied to `from`; returns this rank's number of inadmissible cells. */
long sources_apply(struct gas *g, const struct source_plan *plan, const struct state *from, const struct state *to);

/* Finds the cells of a step with a bed that fall freely, those with eps below `warm` outside of its frozen parts; warm
 * < 0: no cell of the bed does any more. */
void find_falling(struct gas *g, double warm, const struct state *s);

/* Returns the number of inadmissible cells among the n <= BATCH at `offset` of a block U, and raises marks[offset + i]
 * by 1 at each of them, unless marks is NULL. */
int row_inadmissible(const struct gas *g, const double *U, long offset, int n, double *marks);
/* Returns the number of states that a stage took from `from` to `to`, n <= BATCH of a block, whose fluxes are to be
 * limited: inadmissible ones, and where g->limits.crowds those whose density rose next to its limit. Raises flags[i] by
 * 1 or more there. */
int row_limited(const struct gas *g, int n, const double *from, const double *to, double *flags);

/* ---- what laws ask for (libcore/gas/shear_rate.c) ---- */

bool needs_shear_rate(const struct gas_models *m); /* does any law? */
/* Does a source? Then the hook `shear_rate` must have seen the state that they act on, with the values that patches
 * have at its time. */
bool sources_ask(const struct gas *g);
/* Find what the transport law asks for at the start of a half step of diffusion, and behind the first one. Collective.
 */
void diffusion_sees(struct gas *g, const struct state *s);
void diffusion_looks_ahead(struct gas *g, const struct state *to);
/* The line of the cells from `at` on; NULL if a law of these needs does not ask for it. */
static inline const double *shear_rate_at(const struct gas *g, unsigned needs, int block, long at) {
    return needs & NEEDS_SHEAR_RATE ? g->diffusion.shear_rate.now[block] + at : NULL;
}
/* Computes the shear rate of n <= BATCH cells; gradient: lines du_c/dx_k, at k components + c; that of the swirl along
 * the radius less u_s/r. around: u_r/r in bodies of revolution; NULL: the mesh is none. */
void shear_rate_row(const struct gas *g, int n, const double *const *gradient, const double *around, double *out);

/* ---- the heat flux of grad rho ---- */

/* Returns the heat flux cross grad rho between two cells, times their distance, for the jump of rho and the mean of
 * their coefficients. Beside gas thinner than `thin` it is at most twice the mean of cross rho, which is what the
 * thinner cell conducts at a jump of T by some T; the jump of rho is that of the denser one, which carries a hundred
 * times as much, and would heat the thin cell a hundredfold. */
static inline double cross_jump(double thin, double mean, double jump, double low, double most) {
    const double q = mean * jump, cut = larger(smaller(q, most), -most);
    return low < thin ? cut : q;
}

/* ---- floors (libcore/gas/floors.c) ---- */

/* Allocates g->floors.places places for what the floors add. */
status floors_make(struct gas *g);
void floors_free(struct gas *g);
/* Forgets what the floors added, at the beginning of an attempt at a step. */
void floors_begin(struct gas *g);
/* Raises the density of cells to its floor, which g->floors.filled counts and g->floors.fill sums, times
 * g->floors.share; and their energy to the round-off floor, which g->floors.floored counts and g->floors.raised sums.
 * Returns the number of cells of this rank that are not admissible all the same. */
long floors_apply(struct gas *g, const struct state *s);
/* Adds to g->counts.now what the floors did in a step that stands. Collective. */
status floors_count(struct gas *g);

/* ---- places ---- */

struct first_place { /* the first in space of the places that ranks found; the order in space decides, not the rank */
    double order;    /* HUGE_VAL: none was found */
    double place[3];
};
static inline void first_place_offer(struct first_place *p, const double here[3]) {
    double order = here[0] + 1e-7 * here[1] + 1e-14 * here[2];
    if (!(order < p->order)) return;
    p->order = order;
    memcpy(p->place, here, sizeof p->place);
}
/* Sets `place` to the first over all ranks, HUGE_VAL if no rank found one. Collective. */
void first_place_agree(const struct gas *g, const struct first_place *p, double place[3]);
/* Finds the first cell that has `wanted` in variable v of a state. Collective. */
void place_of_value(struct gas *g, const struct state *s, int v, double wanted, double place[3]);

#endif
