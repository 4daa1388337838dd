/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of the gas on a lattice: what libcore/lattice/tiles_*.c share. The lattice is cut into tiles (struct forest);
 * a tile is the unit of cache, of skipping and of communication. */
#ifndef LIBCORE_TILES_H
#define LIBCORE_TILES_H

#include "libcore/gas/gas_private.h"
#include "mesh/lattice/forest.h"

/* What the fluxes along one axis read of the tile in hand, as lines. They hold of the block what stages need at a time:
 * a row along the first axis, a plane along the second, all of it along the last; the number of the block's offset o is
 * at o - origin. */
struct axis_lines {
    long origin;
    double *flux[MAX_VAR];  /* nodal fluxes; that of the mass is the momentum and has no line */
    double *rise, *on;      /* k and `on` of tiles_balance.c; NULL where gravity does not act along the axis */
    double *face, *base[2]; /* P, P_0 and P_1 of tiles_balance.c, likewise */
    bool *taken;            /* [rows of activity_row] is anything of these not 0 in the row? */
};
/* Fluxes of a row of faces: a line each of the variables. */
typedef double face_lines[MAX_VAR][BATCH];
struct range { /* the least and the largest of numbers >= 0 */
    double low, high;
};
#define RANGE_EMPTY ((struct range){HUGE_VAL, 0})
/* Widens it by n numbers, or by another range. */
void range_widen(struct range *of, int n, const double *q);
void range_join(struct range *of, const struct range *with);
struct work { /* scratch of the tile in hand, [size] each */
    double *velocity[MAX_DIM], *eps, *p, *c, *gruneisen;
    struct axis_lines along[MAX_DIM];
    face_lines *planes[2];       /* 3D: [rows] faces along axis 2 below and above a plane, in turn */
    double pace[MAX_DIM][BATCH]; /* dt/width along each axis, for fluxes that are paced */
    struct range *density;       /* [rows of activity_row] of the cells that the stage in hand reads */
};
#define SPAN_EMPTY ((struct span){1 << 20, -(1 << 20)})
static inline bool span_empty(struct span s) {
    return s.low >= s.high;
}
struct activity { /* spans of the tile in hand: cells that differ from its background, that a stage computes, that the
                     fluxes of those read, that their fluxes along axes 1 and 2 read */
    int reach;    /* cells on either side that the fluxes of a cell read */
    int rows;     /* most rows of a tile with its ghosts along axis 1 */
    int planes;   /* layers of ghosts along axis 2: none in one and two dimensions */
    int nspans;   /* rows times most planes of a tile with its ghosts */
    struct span *differ, *active, *needed, *crossed;
    bool whole;  /* are all cells of the tile in hand computed, and none of its faces limited? */
    bool *quiet; /* [ntiles * 6] sides whose ghost layers equal the tile's background and are not kept up either */
};
/* The span of row (j, k), which may be one of ghosts. */
static inline struct span *activity_row(const struct activity *a, struct span *spans, int j, int k) {
    return &spans[(j + GHOSTS) + a->rows * (k + a->planes)];
}

/* Fluxes through the faces between tiles of this rank (libcore/lattice/tiles_seams.c). A row of faces is a line along
 * axis 1 of one plane where they lie along axis 0, else along axis 0 of one plane (axis 1) or of one row (axis 2). */
struct seams {
    face_lines **above; /* [ntiles * MAX_DIM] rows above a tile along an axis; NULL: there is no such tile */
    bool *known;        /* [ntiles * MAX_DIM] in the stage in hand */
};
struct seam {        /* one side of the tile in hand */
    face_lines *row; /* NULL: nothing is kept or taken */
    bool known;
};

/* Memory that the engine of the lattice owns: g->tiles. */
struct tiles {
    struct work work;
    struct activity activity;
    struct seams seams;
    /* [ntiles] of 1 + dim lines: phi_f of carried quantities is phi + line 0 + slopes * way to the face; or NULL */
    double **slope;
    struct fronts *fronts;     /* libcore/lattice/tiles_fronts.c; NULL: nothing is done about fronts */
    int *edge;                 /* [ntiles * 6] number of the first face of a side that is a patch; else -1 */
    struct diffuser *diffuser; /* libcore/lattice/tiles_diffuser.h; NULL without transport */
};

long tiles_stage(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                 double dt, struct ending *ending);
void tiles_redo(struct gas *g, const struct state *U0, const struct state *from, const struct state *to, double a,
                double dt);

void tiles_shear_rate(struct gas *g, const struct state *s); /* libcore/lattice/tiles_shear_rate.c */

status tiles_diffuser_make(struct gas *g);
void tiles_diffuser_free(struct gas *g);
void tiles_diffusion_rates(struct gas *g, const struct state *Y0, double most[2], const struct state *each);
void tiles_near_ghosts(struct gas *g, const struct state *s);
void tiles_diffusion_begin(struct gas *g, enum diffusing what, const struct state *Y0, double factor, double pending);
void tiles_diffusion_stage(struct gas *g, enum diffusing what, const struct state *Y0, const double c[5],
                           double weight);
long tiles_diffusion_end(struct gas *g, enum diffusing what, const struct state *Y0, const struct state *to, double dt,
                         double weight);
void tiles_diffusion_cross(struct gas *g, const struct state *to, double dt);
void tiles_diffusion_spread(const struct gas *g, const struct state *from, const struct state *to,
                            const struct row *row, double *spread);
double tiles_implicit_weight(struct gas *g, enum diffusing what, double per, int tile, long at, int k, int c);

status blocks_make(const struct forest *f, int nvar, double ***out);
void blocks_free(const struct forest *f, double **blocks);

/* Calls visit(context, offset, n), n <= BATCH, for the runs of cells of a tile along axis 0. margin: ghost cells to
 * include on each active axis, but no corners. */
typedef void run_visitor(void *context, long offset, int n);
void runs_visit(const struct forest *f, const struct tile *tile, int margin, run_visitor *visit, void *context);

/* Makes all cells varied: none is background. */
void activity_reset(const struct gas *g, const struct state *s);
/* Narrows the spans of a tile to the cells that differ from its background, or finds a background if there was none.
 * Returns whether there is a background. */
bool activity_find(const struct gas *g, int tile, const struct state *s);
/* Has the tile a background, by its spans as they are? */
bool activity_has_background(const struct gas *g, int tile, const struct state *s);
/* Do the backgrounds of two blocks have the same bits? */
bool same_background(const struct gas *g, const double *a, const double *b);
/* Is the tile its background, at the start of the step and now, and all around it, too? Of `from` after the ghost
 * fill. */
bool activity_calm(const struct gas *g, int tile, const struct state *U0, const struct state *from);
/* Empties the spans of a tile. */
void activity_empty(const struct gas *g, int tile, const struct state *s);
/* Before a ghost fill: finds the quiet sides of all tiles, and writes out the layers of cells that others will read. */
void activity_prepare(struct gas *g, const struct state *s);
/* After the ghost fill of `from`: finds a tile's active cells, whose stencil holds a cell that differs or which U0
 * keeps, and the cells that their fluxes need. Returns false if there are none. */
bool activity_spread(struct gas *g, int tile, const struct state *U0, const struct state *from);
/* Makes the background cells of a tile varied cells, so that they may change one by one. */
void activity_unfold(const struct gas *g, int tile, const struct state *s);
/* Writes the background out to cells that are to be read: to given spans of rows (margin: of ghosts, too), or to the
 * whole tile. */
void activity_store(const struct gas *g, int tile, const struct state *s, struct span *spans, int margin);
void activity_store_all(const struct gas *g, int tile, const struct state *s);
/* As runs_visit, for the span of one row of a tile, or for the spans of all its rows. */
void span_visit(const struct gas *g, struct span *spans, int j, int k, run_visitor *visit, void *context);
void spans_visit(const struct gas *g, int tile, struct span *spans, int margin, run_visitor *visit, void *context);
/* As runs_visit, for the cells of a tile that differ from its background. */
static inline void varied_visit(const struct gas *g, int tile, const struct state *s, run_visitor *visit,
                                void *context) {
    if (!s->calm[tile]) spans_visit(g, tile, s->varied[tile], 0, visit, context);
}

/* Velocity and eps of n cells at `offset` of a block U go to the workspace; with primitives_of_row p, c and gruneisen,
 * too. */
void velocities_of_row(const struct gas *g, const double *U, long offset, int n);
void primitives_of_row(const struct gas *g, const double *U, long offset, int n);

struct speeds { /* wave speeds that speed_visit gathers on this rank */
    struct gas *g;
    double *U;          /* the tile's block */
    const double *last; /* the block whose background was looked at last; NULL: there is none */
    struct gas_speed most;
    struct range p, background; /* Pa: of the tile in hand, and of the background that was looked at last */
};
void speed_visit(void *speeds, long offset, int n);
/* As speed_visit for the tile's background, which often is that of the tile before. */
void speed_of_background(struct speeds *s);

/* Fronts of shocks (libcore/lattice/tiles_fronts.c). */
status fronts_make(struct gas *g);
void fronts_free(struct gas *g);
void tiles_fronts(struct gas *g, const struct gas_speed *speed);
/* Notes the extremes of a tile of s, whose primitives are there; then sets those of this rank in the wave speeds. */
void fronts_note(struct gas *g, int tile, const struct state *s, const struct range *of);
void fronts_speed(const struct gas *g, struct gas_speed *speed);

/* Centre of the cell at `offset` of a tile, m */
void tiles_place(const struct gas *g, int tile, long offset, double place[3]);

/* Fills the first `layers` of the ghosts of a tile's sides that are patches, by the patches' rules, but not of the
 * sides where `leave` is set (NULL: nowhere). */
void ghosts_of_patches(const struct gas *g, int tile, double *U, int layers, const bool *leave);

/* A line is computed in whole vectors of 8: the faces behind its end read the rows' padding, and are thrown away. */
static inline int whole_vectors(int n) {
    return (n + 7) / 8 * 8;
}

/* A line of faces along an axis, whose left cells start at `offset`. */
struct strip {
    int tile, axis, n;
    long offset;
    int from;   /* place of the first left cell along the axis: -1 below the tile */
    int row;    /* of activity_row: that of the left cells */
    int column; /* along axis 0, of the first left cell */
};

/* Returns the floors of a strip of faces beside fronts, which hold until the next call; NULL: they have none. */
const double *fronts_floor(const struct gas *g, const struct strip *s);

/* Thin cells beside dense ones (libcore/lattice/tiles_voids.c). Reads the densities of row (j, k) of the tile in hand;
 * marks the faces of a strip that have such a cell by 1, others by 0, in whole vectors, after the rows of its stencils
 * were read. Returns whether there is one; else flat is not set. */
void voids_row(const struct gas *g, const double *U, int j, int k);
bool voids_find(const struct gas *g, const double *U, const struct strip *s, double *flat);

/* The lines of the faces below and above the cells of a row along an axis: variable v at low[v], high[v]. */
struct faces_of_row {
    const double (*low)[BATCH], (*high)[BATCH];
    double inverse; /* 1/width */
};

/* Bodies of revolution (libcore/lattice/tiles_round.c). */
struct round_line { /* n cells of a row; radial: computational axis; half: 1/(2 r), 1/m; momentum and velocity along r
                     */
    int n, nvar, radial, swirl;
    const double *half, *momentum, *velocity;
    const double *around[2]; /* momentum and velocity around the axis, if there is swirl */
};
/* Computes the residuals of such cells of a block U from the fluxes through their faces, f[dim]. */
void round_residual(const struct gas *g, int tile, const double *U, long offset, int n, const struct faces_of_row *f,
                    double (*residual)[BATCH]);

struct edge { /* n <= BATCH cells along a side: offsets of the first cell and of its ghost; `step` from cell to cell */
    const struct patch_rules *rules;
    const int *face; /* [n] within the patch */
    int normal, n;
    long from, to, step;
};
/* Finds the faces of a strip on a patch below it or above it, whose first one is face *first of the strip. Returns
 * false if there are none. */
bool edge_of_strip(const struct gas *g, const struct strip *s, bool high, struct edge *e, int *first);
/* The face of the cell at `offset` among those at a side of a tile. */
int face_at_side(const struct forest *f, int tile, int side, long offset);

/* Does a side of a tile lie on a patch that gives the mass that flows in? */
bool tiles_fed(const struct gas *g, int tile, int side);
/* Gives the fluxes `out`, in program order, through such faces of a strip that mass (libcore/gas/patch.h). */
void tiles_feed(const struct gas *g, const double *U, const struct strip *s, double (*out)[BATCH], int column);

/* Does gravity act along an axis? */
bool balance_acts(const struct gas *g, int axis);
/* Where along the axes the faces on walls of a tile are, by the place of the cell below; far below or above the tile
 * where there is none. */
struct walls {
    int low[MAX_DIM], high[MAX_DIM];
};
void balance_walls(const struct gas *g, int tile, struct walls *walls);
/* Computes work.rise, on, face and base of n cells from place j along the axis on; along axis 0 they lie one behind the
 * other there. Up to 7 numbers behind them are lost. Returns false if nothing is taken at these faces. */
bool balance_row(const struct gas *g, const struct walls *walls, const double *U, int axis, int j, long offset, int n);
/* Computes the fluxes f->out through the faces f of a strip, for which gas at rest is in balance. */
void balance_through(const struct gas *g, const struct strip *s, const struct faces *f, const struct reconstruct *r);

status seams_make(struct gas *g);
void seams_free(struct gas *g);
/* Forgets all fluxes, at the start of a stage. */
void seams_begin(struct gas *g);
/* Finds what the tile in hand takes and keeps at its sides; all of it is known when its stage ends. */
void seams_of_tile(const struct gas *g, int tile, struct seam seam[6]);
void seams_end(struct gas *g, int tile);

/* The bed of implicit acoustics (libcore/lattice/tiles_bed.c). */
status tiles_bed_make(struct gas *g);
void tiles_bed_blocks(const struct gas *g, bed_block_visitor *visit, void *context);
/* Has the step in hand a bed with cells in the tile? */
bool tiles_hold_bed(const struct gas *g, int tile);
/* The span of a row of such a tile, `row` being the offset of its first cell, outside of which its n cells are
 * frozen. */
struct span tiles_moving_span(const struct gas *g, int tile, long row, int n);
/* Notes the fluxes through a strip of such a tile. */
void tiles_note_fluxes(struct gas *g, const struct strip *s, double (*out)[BATCH], int column);

/* The sides of cells, and the faces of patches (libcore/lattice/tiles_edges.c): hooks of libcore/gas/engine.h. */
status tiles_edges_make(struct gas *g);
bool tiles_sides(const struct gas *g, const struct row *row, int k, struct sides *out);
void tiles_edges(const struct gas *g, int block, edge_face_visitor *visit, void *context);

/* Fluxes through patches (libcore/lattice/tiles_tally.c). */
/* Gives all faces of a tile the flux of its background, before a stage of it; then notes the fluxes of a strip. */
void tiles_tally_begin(struct gas *g, int tile, const double *U);
void tiles_tally(struct gas *g, const struct strip *s, double (*out)[BATCH], int column);

/* Carried quantities (libcore/lattice/tiles_carried.c): the hooks of libcore/gas/carried.h. */
void tiles_carried_rise(struct gas *g);
void tiles_carried_terms(struct gas *g, double dt);
double tiles_carried_most_out(const struct gas *g);
void tiles_carried_move(struct gas *g, const struct carried_quantity *q, struct carried_part part);
/* Give all faces of a tile the flux of mass of its background, before a stage of it; then note those below and above n
 * cells of a row. */
void tiles_carry_begin(struct gas *g, int tile, const double *U);
void tiles_carry(struct gas *g, int tile, int axis, long offset, int n, const double *low, const double *high);

/* One stage of one tile: to = W + a (U0 - W), W = from + dt L(from); returns the number of cells that are not
 * admissible and raises their flags. */
int stage_of_tile(struct gas *g, int tile, const struct state *U0, const struct state *from, const struct state *to,
                  double a, double dt);

#endif
