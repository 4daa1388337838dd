/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An engine of the gas: the way in which one kind of mesh, a lattice or polyhedra, holds the state and does its part of
 * a time step. */
#ifndef LIBCORE_ENGINE_H
#define LIBCORE_ENGINE_H

#include <limits.h>

#include "libcore/gas/carried.h"
#include "libcore/gas/tally.h"

typedef void edge_face_visitor(void *context, int edge, double scale, struct gas_face *face);

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

struct row_speeds { /* of a row of cells: eps, p; 1/s: sum_k |u_k|/width_k, and with |u_k| + c for |u_k| */
    double eps[BATCH], p[BATCH], flow[BATCH], thin[BATCH];
    double rate[BATCH]; /* 1/s: what the largest rate of struct gas_speed is that of; `thin` but for its last bits */
};

struct patch_face { /* a face of a patch; patch -1: none */
    int patch, face;
};
struct sides {         /* a face of each of n <= BATCH cells of a block, as the cell sees it */
    bool line;         /* do the places across lie one behind the other? */
    int across[BATCH]; /* place of the cell or ghost across */
    int face[BATCH];   /* place of the face in lines over faces of the block, ~place if the cell is its right one */
    int edge[BATCH];   /* number of the face among this rank's faces of patches; -1: it is none */
    struct patch_face patch[BATCH]; /* where edge >= 0 */
};
#define NO_SIDE INT_MIN /* `face` of a cell that has fewer faces than others; its `across` is the cell itself */

struct state_hooks {
    /* make allocates the states and the work memory of g, whose other members are set; with g->dense it makes the bed
     * (bed_make), its shapes and what it needs in g->dense->pool, and sets own and sides of g->dense. free also undoes
     * a make that failed. */
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
    /* Fills the ghosts of n lines of blocks, not those beyond patches; on a lattice the first `layers` of them. */
    void (*fill)(const struct gas *g, int layers, int n, double *const *block);
    /* Computes the centre (m) of the cell at place `at` of a block. */
    void (*place)(const struct gas *g, int block, long at, double place[3]);
    /* Finds the k-th faces of a row of cells, k from 0 on. Returns false if no cell of the row has one. */
    bool (*sides)(const struct gas *g, const struct row *row, int k, struct sides *out);
    /* Visits the faces that a block of the grid has on patches: their numbers (edge of struct sides), the factor from
     * numbers in lines over faces to the whole face, and their geometry. */
    void (*edges)(const struct gas *g, int block, edge_face_visitor *visit, void *context);
    /* Fills the ghosts of a state that are NEAR_CELLS, beyond patches, too. Collective. */
    void (*ghosts)(struct gas *g, const struct state *s);
    /* speed finds the wave speeds of this rank's cells; speeds finds those of a row of s. */
    void (*speed)(struct gas *g, struct gas_speed *speed);
    void (*speeds)(struct gas *g, const struct state *s, const struct row *row, struct row_speeds *out);
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
    /* Computes `to` = `from` after a step of dt in which each cell takes steps of its own, by the limits of
     * g->step.courant, from the time g->step.t on. Raises flags and returns as `stage` does; V is scratch. NULL: the
     * engine has no such steps. Collective. */
    long (*local)(struct gas *g, const struct state *from, const struct state *to, double dt);
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
     * rank's cells, 1/s. each: its first two variables get the rates of each cell; NULL: they are not wanted. */
    void (*rates)(struct gas *g, const struct state *Y0, double most[2], const struct state *each);
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
    /* For the systems of implicit diffusion (libcore/gas/implicit.c): returns per times component c of the flux out of
     * a cell through its k-th face if S is 1 in this component of the cell and 0 in all other cells, and beyond a patch
     * what follows from that, without what couples components within the gas. The last S is lost. */
    double (*weight)(struct gas *g, enum diffusing what, double per, int block, long at, int k, int c);
};

/* What a cell is to the bed of a step with implicit acoustics (libcore/gas/dense.c): dense cells, hard ones among them,
 * the neighbours of hard ones, and two rings around these. The Runge-Kutta stages leave the inner parts, frozen and up,
 * as they are, so that they see no fast sound; they do advance the two rings, for the sake of the fluxes between the
 * bed and the other cells alone. */
enum bed_part { BED_OUTER = 1, BED_LIVE, BED_FROZEN, BED_DENSE, BED_HARD };
/* number: of the block over all ranks; place: where in g->floors.raised its sums go. */
typedef void bed_block_visitor(void *context, int number, int place, const struct row *row);
/* The implicit acoustics of dense cells. A bed is libcore/acoustics/bed.h's, g->dense has it. */
struct bed_hooks {
    /* Visits the rows of all cells of the blocks that ranks are dealt, block by block, where g->dense->holds is set. */
    void (*blocks)(const struct gas *g, bed_block_visitor *visit, void *context);
    /* Takes the numbers that balance a state at rest, `from` filled. NULL: there are none. */
    void (*balance)(struct gas *g, const struct state *from);
};

struct engine {
    struct state_hooks state;
    struct stage_hooks stage;
    struct diffusion_hooks diffusion;
    struct bed_hooks bed;
    struct tally_hooks tally;     /* libcore/gas/tally.h */
    struct carried_hooks carried; /* libcore/gas/carried.h */
};
extern const struct engine engine_lattice, engine_polyhedral;

#endif
