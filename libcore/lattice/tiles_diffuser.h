/* Inside of diffusion on a lattice: what libcore/lattice/tiles_coefficients.c, tiles_sums.c and tiles_diffusion.c
 * share. */
#ifndef LIBCORE_TILES_DIFFUSER_H
#define LIBCORE_TILES_DIFFUSER_H

#include "libcore/gas/patch.h"
#include "libcore/lattice/tiles.h"

/* Lines of the coefficients of the face below a cell along an axis, h the width of a cell there:
 * (lambda + 2 mu)/h^2, mu/h^2, heat/h^2. */
enum { NORMAL, SHEAR, CONDUCTION, FACE_LINES };
/* Lines at the ghosts beyond walls, from wall_shares: the share of drag, and the part of the heat of friction on the
 * wall that stays in the gas. (The share of heat is in the coefficients.) */
enum { DRAG, STAYS, WALL_LINES };

struct diffuser {      /* of diffusion: [ntiles] of so many lines of [size] */
    double **sum[2];   /* dim: S of the last stage, with one layer of ghosts, and of the one before */
    double **start;    /* dim: q_0, the same */
    double **gradient; /* dim * dim: at k dim + c half of dS_c/dx_k, in ghosts and along the sides only */
    double **face;     /* of each axis FACE_LINES: coefficients of the face below a cell */
    double **light;    /* 1/rho */
    double **keep;     /* of each axis, if `plain`: 0 where the tangential derivatives do not count, else 1 */
    double **wall;     /* WALL_LINES */
    double **mark;     /* 1: cells that were not admissible */
    double **warm;     /* T of the coefficients, or what it rose by; with one layer of ghosts */
    bool marked;       /* any? */
    bool plain;        /* until the next rates */
    int last;          /* sum of the last stage */
};

/* Components of u, or T alone. */
static inline int lines_of(const struct gas *g, enum diffusing what) {
    return what == VISCOUS ? g->dim : 1;
}

/* Half of a central difference; quarter: 1/(4 h) */
ALWAYS_INLINE double half_derivative(const double *q, long step, double quarter) {
    return (q[step] - q[-step]) * quarter;
}

struct edge { /* n cells along a side: offsets of the first one and of its ghost, from cell to cell `step` */
    const struct patch_rules *rules;
    const int *face; /* [n] within the patch */
    int normal, n;
    long from, to, step;
};

typedef void edge_visitor(struct gas *g, int tile, const struct edge *e, const void *context);
/* Visits the first layer of ghosts of all sides of a tile that are patches. */
void edges_visit(struct gas *g, int tile, edge_visitor *visit, const void *context);

/* Ghosts of S: from the neighbours, and by the rules of patches; of the stress the derivatives along the tile's sides,
 * too. weight: struct diffusion_hooks. */
void tiles_fill_sums(struct gas *g, enum diffusing what, double weight);

#endif
