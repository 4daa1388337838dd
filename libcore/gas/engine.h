/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An engine of the gas: the way in which one kind of mesh, a lattice or polyhedra, holds the state and does its part of
 * a time step. */
#ifndef LIBCORE_ENGINE_H
#define LIBCORE_ENGINE_H

#include <limits.h>

#include "libcore/gas/carried.h"
#include "libcore/gas/tally.h"

enum { SLACK = 32 }; /* doubles behind every block: the last line is read in whole vectors, or batches of lanes */

struct span { /* the columns low <= i < high of a row of a tile */
    int low, high;
};
static inline struct span span_join(struct span a, struct span b) {
    return (struct span){a.low < b.low ? a.low : b.low, a.high > b.high ? a.high : b.high};
}
/* The conserved variables of this rank's cells, in blocks: the tiles of a lattice, or one block for all polyhedra. A
 * tile has a background, the values that many of its cells share (libcore/lattice/tiles_activity.c), and a span for
 * each of its rows: the cells outside the span equal the background, and their memory is not kept up. */
struct state {
    double **block;       /* [blocks] of [nvar][g->size]; offset 0 of a tile is no cell but the background */
    struct span **varied; /* [ntiles] of [nspans]; NULL on polyhedra */
    int nspans;           /* of a tile: rows with ghosts */
    bool *narrow;         /* [ntiles] has the tile a background, and are its spans known to be as short as they can? */
    bool *calm;           /* [ntiles] are its spans known to be empty, so that it is its background alone? */
};

struct row { /* n <= BATCH cells that lie one behind the other in a block's lines */
    int block;
    long at; /* the first cell's place in each line; the lines of a state's variables are g->size apart */
    int n;
};
typedef void row_visitor(void *context, const struct row *row);
enum extent {
    EVERY_CELL, /* all cells of this rank, one by one; backgrounds of s, if it is not NULL, are written out first */
    NEAR_CELLS, /* these, and the ghosts that diffusion reads: a layer of a lattice, all of polyhedra; s is NULL */
    EACH_STATE, /* each state that occurs: spans are narrowed, then their cells are visited, and each background once */
    KEPT_STATES, /* the cells in the spans as these are, and each background once */
    VARIED_CELLS /* the cells in the spans as these are, without backgrounds */
};

struct block_cells { /* the cells of a block of the grid (mesh/grid/grid.h), in its order: the first axis is fastest */
    int block;       /* of the state */
    int n[3];        /* along the axes; on polyhedra all along the first one */
    long first, step[3]; /* place of the first cell in a line, and from cell to cell: 0 between images of one cell */
    const int *at;       /* [n[0]] the places on polyhedra; NULL on a lattice */
    const struct span *varied; /* the span of row (j, k) is varied[row[0] j + row[1] k]; NULL: there are none */
    int row[2];
};

struct ending {                        /* the work that follows the last stage of a step */
    const struct source_plan *sources; /* the second half of the sources; NULL: there are none */
    struct gas_speed speed;            /* out: wave speeds of the final state in this rank's cells */
};

enum diffusing { VISCOUS, HEAT };
enum rate { OF_VISCOUS = VISCOUS, OF_HEAT = HEAT, OF_FLOW };

struct state_hooks {
    /* make allocates the states and the work memory of g, whose other members are set; free also undoes a make that
     * failed. */
    status (*make)(struct gas *g);
    void (*free)(struct gas *g);
    /* Finds where the cells of a block of the grid are, and the spans of s (NULL: none). */
    void (*cells)(const struct gas *g, int block, const struct state *s, struct block_cells *out);
    /* As gas_rest, under gravity. NULL: the engine balances pressure and weight by itself. */
    status (*rest)(struct gas *g, const bool *rests);
    /* Calls visit(context, row) for the rows of s, in the same order on every call. */
    void (*rows)(const struct gas *g, enum extent extent, const struct state *s, row_visitor *visit, void *context);
    /* Writes the background of a block out, so that all of its cells are varied ones. NULL: there are none. */
    void (*unfold)(const struct gas *g, int block, const struct state *s);
    /* Fills the ghosts of n lines of blocks, not those beyond patches. */
    void (*fill)(const struct gas *g, int n, double *const *block);
    /* Computes the centre (m) of the cell at place `at` of a block. */
    void (*place)(const struct gas *g, int block, long at, double place[3]);
    /* speed finds the wave speeds of this rank's cells; rates computes what they are found from, or the last rates of
     * diffusion, which were those of s, in the cells of a row of s (1/s). */
    void (*speed)(struct gas *g, struct gas_speed *speed);
    void (*rates)(struct gas *g, enum rate what, const struct state *s, const struct row *row, double *rate);
    /* Sets g->diffusion.shear_rate.now to the shear rate (shear_rate_row) of s, in ghosts to that of the cell beside or
     * across; where g->diffusion.shear_rate.now is not NULL. Collective. */
    void (*shear_rate)(struct gas *g, const struct state *s);
};

struct stage_hooks {
    /* Finds the fronts of shocks in U, for the rule of single faces beside them (docs/physics.md 6.12) in all stages of
     * a step, before each attempt at it. speed: of U. Collective. */
    void (*fronts)(struct gas *g, const struct gas_speed *speed);
    /* Computes to = W + a (U0 - W), W = from + dt L(from), in all cells of this rank, L = -div F/V. Raises the flags of
     * the cells to be limited (row_limited), and returns their number. `from` may hold inadmissible cells or NaN: the
     * result is thrown away then. ending: of the last stage of a step, done block by block while a block is in the
     * cache; NULL: there is none. */
    long (*stage)(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                  double dt, struct ending *ending);
    bool ends; /* does `stage` do endings? Else the parts of the step do them */
    /* Does the stage again where flags are near, with limited fluxes through the faces of flagged cells
     * (libcore/schemes/limit.h), and counts these faces in g->limits.faces. Flags the cells to be limited then. */
    void (*redo)(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                 double dt);
};

/* The parts of one super step of diffusion: S_0 = 0, q_0 = u or T of Y0, q_j = q_0 + L S_j/rho
 * (libcore/gas/diffusion.h); the fluxes of the last S move the state. */
struct diffusion_hooks {
    /* [dim] most stages of one super step, where the operator is not quite symmetric; 0: any number */
    int most_stages[MAX_DIM + 1];
    /* is friction T(to) - (T(from) + cooled)? Else (T(to) - T(from)) - cooled, which differs in the last bit */
    bool cooled_first;
    /* Freezes the coefficients at Y0 and fills its ghosts; most[VISCOUS] and most[HEAT] are the largest rates of this
     * rank's cells, 1/s. */
    void (*rates)(struct gas *g, const struct state *Y0, double most[2]);
    /* Fills the ghosts of a state that are NEAR_CELLS, beyond patches, too. */
    void (*ghosts)(struct gas *g, const struct state *s);
    /* Adds to the energy of `to` dt div (cross grad rho), with rho and the coefficients of the last rates. */
    void (*cross)(struct gas *g, const struct state *to, double dt);
    /* Computes div u in the cells of a row, with the mean u of both states, whose ghosts are filled. */
    void (*spread)(const struct gas *g, const struct state *from, const struct state *to, const struct row *row,
                   double *spread);
    /* Sets q_0 = u (VISCOUS), or T - pending friction - (g->diffusion.late ? cooled : 0) (HEAT), of Y0, and S_1 =
     * factor q_0. */
    void (*begin)(struct gas *g, enum diffusing what, const struct state *Y0, double factor, double pending);
    /* Computes S_j = c[0] S_(j-1) + c[1] S_(j-2) + c[2] q_(j-1) + c[3] q_0 + c[4] friction; c[2], c[3] and c[4] hold
     * dt. weight: the value of S_(j-1) if q were 1 throughout, for S beyond patches that hold a value. */
    void (*stage)(struct gas *g, enum diffusing what, const struct state *Y0, const double c[5], double weight);
    /* Computes to = Y0 + div of the flux of the last S, with the work of the stress; `to` may be Y0. weight: the value
     * of that S if q were 1 throughout. Marks the cells that are not admissible, and returns their number. */
    long (*end)(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to, double dt,
                double weight);
    /* From here on the stress on the faces of flagged cells has no tangential derivatives (on polyhedra all their
     * fluxes have the jumps across the faces alone), and cross is 0 there. */
    void (*plain)(struct gas *g);
};

/* The systems of implicit diffusion (libcore/gas/implicit.c). */
struct implicit_hooks {
    /* Returns the place in a block of the cell or ghost across the k-th face of a cell, ~place beyond a patch; NO_FACE:
     * the cell has no more faces. */
    long (*across)(const struct gas *g, int block, long at, int k);
    /* Returns line c of the last S of a block. */
    double *(*sum)(const struct gas *g, int block, int c);
    /* Fills the last S beyond patches as if these gave values of 0. */
    void (*beyond)(struct gas *g, enum diffusing what);
    /* Returns per times component c of the flux that a jump of S between its cells makes through the k-th face of a
     * cell, without what couples components within the gas. */
    double (*weight)(const struct gas *g, enum diffusing what, double per, int block, long at, int k, int c,
                     const double jump[MAX_DIM]);
};
#define NO_FACE LONG_MIN

/* What a cell is to the bed of a step with implicit acoustics (libcore/gas/dense.c): dense cells, hard ones among them,
 * the neighbours of hard ones, and two rings around these. The Runge-Kutta stages leave the inner parts, frozen and up,
 * as they are, so that they see no fast sound; they do advance the two rings, for the sake of the fluxes between the
 * bed and the other cells alone. */
enum bed_part { BED_OUTER = 1, BED_LIVE, BED_FROZEN, BED_DENSE, BED_HARD };
struct bed_speeds { /* of a row of cells: eps, p; 1/s: sum_k |u_k|/width_k, sum_k (|u_k| + c)/width_k */
    double eps[BATCH], p[BATCH], flow[BATCH], thin[BATCH];
};
/* The implicit acoustics of dense cells; all NULL: the engine has none. A bed is libcore/acoustics/bed.h's, g->dense
 * has it. */
struct bed_hooks {
    /* make makes the bed (bed_make), its shapes and what the engine needs, and sets g->dense->own. */
    status (*make)(struct gas *g);
    void (*free)(struct gas *g);
    /* Marks the rings around the dense cells, where no cell is in a ring yet, and sets g->dense->holds. Writes all
     * backgrounds of U out: no cell is left out as uniform in a step with a bed. Collective. */
    void (*rings)(struct gas *g);
    /* Finds the speeds of a row of U. */
    void (*speeds)(struct gas *g, const struct row *row, struct bed_speeds *out);
    /* Fills the ghosts of `from` across the faces of the bed, beyond patches, too. Collective. */
    void (*fill)(struct gas *g, const struct state *from);
    /* Lists the bed's cells and faces: g->dense->bed.home, row, border and number. Collective. */
    status (*list)(struct gas *g);
    /* Takes the numbers that balance a state at rest, `from` filled. NULL: there are none. */
    void (*balance)(struct gas *g, const struct state *from);
    /* Adds `weight` times the fluxes of the last stage to those that are kept. */
    void (*keep)(struct gas *g, double weight);
    /* Sums numbers per block of the bed (J/m^3) to one per cell block of g->floors.raised. */
    void (*spread)(struct gas *g, const double *per_block, double *raised);
};

struct engine {
    struct state_hooks state;
    struct stage_hooks stage;
    struct diffusion_hooks diffusion;
    struct implicit_hooks implicit;
    struct bed_hooks bed;
    struct tally_hooks tally;     /* libcore/gas/tally.h */
    struct carried_hooks carried; /* libcore/gas/carried.h */
};
extern const struct engine engine_lattice, engine_polyhedral;

#endif
