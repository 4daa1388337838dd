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

struct diffuser {      /* [ntiles] blocks of lines of [size]; a comment begins with their number */
    double **sum[2];   /* components of u: S of the last stage, with one layer of ghosts, and S of the stage before */
    double **start;    /* components of u: q_0, with one layer of ghosts */
    double **gradient; /* dim * dim: at k dim + c half of dS_c/dx_k, in ghosts and along the sides only */
    double **face;     /* FACE_LINES * dim: coefficients of the face below a cell */
    double **cross;    /* dim: cross/h d rho/dx on the face below a cell, then 1: cross of cells; NULL: no such term */
    double **light;    /* 1: 1/rho */
    double **keep;     /* dim: while `plain`, 0 on faces whose stress goes without tangential derivatives, else 1 */
    double **wall;     /* WALL_LINES */
    bool plain;        /* `keep` counts, until the next rates */
    int last;          /* which of the two sums is that of the last stage */
};

/* Components of u, or T alone. */
static inline int lines_of(const struct gas *g, enum diffusing what) {
    return what == VISCOUS ? g->components : 1;
}

/* Half of a central difference of the width h of cells; quarter: 1/(4 h) */
ALWAYS_INLINE double half_derivative(const double *q, long step, double quarter) {
    return (q[step] - q[-step]) * quarter;
}

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

#endif
