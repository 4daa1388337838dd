/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inside of diffusion on a lattice: what libcore/lattice/tiles_coefficients.c, tiles_sums.c and tiles_diffusion.c
 * share. */
#ifndef LIBCORE_TILES_DIFFUSER_H
#define LIBCORE_TILES_DIFFUSER_H

#include "libcore/gas/patch.h"
#include "libcore/lattice/tiles.h"

/* Three lines per axis: coefficients of the face below a cell, (lambda + 2 mu)/h^2, mu/h^2, heat/h^2 with the width h
 * of a cell along the axis. */
enum { NORMAL, SHEAR, CONDUCTION, FACE_LINES };
/* Lines at the ghosts beyond walls, from wall_shares: the share of drag, and the part of the heat of friction on the
 * wall that stays in the gas. (The share of heat is in the coefficients.) */
enum { DRAG, STAYS, WALL_LINES };
/* Lines of a body of revolution, with the radius r: h/(2 r) of cells; of the faces below them along the radius h/(2 r),
 * 0 on the axis; 1 there, 0 elsewhere; and the ratio of r of the cells below and above them, 1 on patches. */
enum { LEAN, RING, ON_AXIS, NEARER, TURN_LINES };

enum { EDGE = 8, LINE = EDGE + BATCH + 8 }; /* of a row in scratch: place of its first cell, and length */
/* The lines of the faces of a row: components of the stress and, in the end, its work behind them; HOOP is the stress
 * around the axis of a body of revolution. */
enum { HOOP = MAX_DIM + 1, STRESS_LINES };

struct diffuser {    /* [ntiles] blocks of lines of [size]; a comment begins with their number */
    double **sum[2]; /* components of u: S of the last stage, with one layer of ghosts, and S of the stage before */
    double **start;  /* components of u: q_0, with one layer of ghosts */
    double **sheet;  /* SHEET_LINES(dim) in sheets (mesh/lattice/forest.h): what sheet_line says */
    double **face;   /* FACE_LINES * dim: coefficients of the face below a cell */
    double **cross;  /* dim: cross/h d rho/dx on the face below a cell, then 1: cross of cells; NULL: no such term */
    double **light;  /* 1: 1/rho */
    double **keep;   /* dim: if `plain`, 0 on faces whose stress goes without tangential derivatives, else 1 */
    double **wall;   /* WALL_LINES */
    double **turn;   /* TURN_LINES; NULL: the mesh is none of a body of revolution */
    bool plain;      /* `keep` counts */
    double (*plane[2])[STRESS_LINES][LINE]; /* of the rows of a tile: faces along axis 2 below and above a plane */
};

/* Components of u, or T alone. */
static inline int lines_of(const struct gas *g, enum diffusing what) {
    return what == VISCOUS ? g->components : 1;
}

/* Of the cells along a side across `axis` and of those beyond it: half of dS_c/dx_k for each other axis k, with c = k
 * and with c = axis. Faces across `axis` take no other derivatives. */
#define SHEET_LINES(dim) (2 * ((dim)-1))
ALWAYS_INLINE int sheet_line(int axis, int k, int c) {
    return 2 * (k - (k > axis)) + (c == axis);
}

/* Half of a central difference of the width h of cells; quarter: 1/(4 h) */
ALWAYS_INLINE double half_derivative(const double *q, long step, double quarter) {
    return (q[step] - q[-step]) * quarter;
}

/* Half of d(r q)/(r dr) of a body of revolution, so that of linear q it is exact; lean: h/(2 r) of the cell. */
ALWAYS_INLINE double half_divergence(const double *q, long step, double quarter, double lean) {
    return ((1 + 2 * lean) * q[step] - (1 - 2 * lean) * q[-step]) * quarter;
}
/* The line of `turn` at cell 0 of a tile; NULL: there is none. */
static inline const double *turn_line(const struct gas *g, int tile, int line) {
    return g->tiles->diffuser->turn ? g->tiles->diffuser->turn[tile] + line * g->size : NULL;
}

/* S of the next stage, which takes the place of the sum before the last. c: factors of the last S, of the S before, of
 * the gain over rho, and of q_0. */
ALWAYS_INLINE double next_sum(const double *c, double last, double before, double gain, double light, double start) {
    return (c[0] * last + c[1] * before) + (c[2] * (gain * light) + c[3] * start);
}

struct stage_row { /* what next_sum takes in a row of cells, and `next`, which it sets */
    const double *restrict c, *restrict light, *restrict start, *restrict last;
    double *restrict next;
};

struct stress_row { /* the faces below n cells along an axis; lines stand at the first cell */
    int n, axis;
    double h;  /* width of a cell along the axis */
    long step; /* leads across the face */
    const double *restrict face, *restrict S;
    const double *restrict keep;                /* NULL: all 1 */
    const double *restrict low, *restrict high; /* the gradients on both sides */
    double (*restrict out)[LINE];
};

/* Bodies of revolution (libcore/lattice/tiles_turn.c); `turn`: at the first cell. */
status tiles_turn_make(struct gas *g);
/* Stress and work as viscous_faces, at faces across the radius. */
void turn_faces(const struct gas *g, bool ends, const double *turn, const struct stress_row *r);
struct turn_row { /* what n cells gain in a line, by the faces below and above across the radius and along the axis */
    int n, line;  /* line: as in `out` of stress_row; < 0: heat */
    const double *low, *high, *hoop_low, *hoop_high;
    const double *along[2]; /* NULL: the mesh has no cells along the axis */
    const double *turn;
    double *out;         /* NULL: the gains go to the next sums */
    struct stage_row to; /* of those */
};
void turn_gain(const struct gas *g, const struct turn_row *r);
/* The heat that conduction brings to n cells whose last sum is to->last: goes to `out`; NULL: with that of friction to
 * the next sum. */
void turn_heat(const struct gas *g, int n, const double *turn, const double *face, const double *friction,
               const struct stage_row *to, double *out);
/* That of the gradient of rho; cross: the line of the faces below them along axis 0. */
void turn_cross(const struct gas *g, int n, const double *turn, const double *cross, double *out);
/* The ratio of radii of a side and its cells, 1 where the mesh or the side has none: of the area of a cell's face to
 * its volume over h, and by which swirl grows from there to the wall if gas rotates as a rigid body: that is edge_turn,
 * 1 where the edge has no such swirl, and 0 on the axis. */
double edge_widens(const struct gas *g, int tile, const struct edge *e);
double edge_turn(const struct gas *g, int tile, const struct edge *e);
/* The ratio of radii of the side and its ghosts. */
double edge_turn_back(const struct gas *g, int tile, const struct edge *e);
/* The rates of a row over 1/rho, as tiles_diffusion_rates_row; face: the lines of all axes. */
void tiles_turn_rates(const struct gas *g, int n, const double *turn, const double *face, double (*rate)[BATCH]);

typedef void edge_visitor(struct gas *g, int tile, const struct edge *e, const void *context);
/* Visits the first layer of ghosts of all sides of a tile that are patches. */
void edges_visit(struct gas *g, int tile, edge_visitor *visit, const void *context);

/* Fluxes through patches (libcore/lattice/tiles_tally.c): the stress at the faces of n cells that lie one behind the
 * other, `inner` the first, at a side of a tile: lines as viscous_faces makes them, `length` apart, of which the work
 * counts `per` times; energy that friction on a wall gives to a cell of an edge (J/m^3); the heat of the last S; that
 * of the gradient of rho. */
void tiles_tally_stress(struct gas *g, int tile, int side, long inner, int n, double per, const double *lines,
                        int length);
void tiles_tally_friction(struct gas *g, int tile, const struct edge *e, int i, double gain);
void tiles_tally_heat(struct gas *g);
void tiles_tally_cross(struct gas *g, double dt);

/* Ghosts of S: from the neighbours, and by the rules of patches; of the stress the derivatives along the tile's sides,
 * too. weight: struct diffusion_hooks. */
void tiles_fill_sums(struct gas *g, enum diffusing what, double weight);
/* Makes the ghost of the last S beyond the face of a cell on a patch. */
void tiles_sums_beyond(struct gas *g, enum diffusing what, double weight, int tile, int side, long at);
/* If fluxes are to be plain (g->diffusion.plain), finds on which faces. */
void tiles_plain_faces(struct gas *g);

#endif
