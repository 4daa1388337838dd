/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear systems of implicit diffusion on a lattice (hook `weight` of libcore/gas/engine.h). */
#include "libcore/lattice/tiles_diffuser.h"

/* The jump of component c that such an S makes across the k-th face of a cell. */
static double jump_of(struct gas *g, enum diffusing what, int tile, long at, int k, int c) {
    const struct forest *f = g->forest;
    const long step = f->stride[k / 2];
    const int place = forest_place_along(f, tile, at, k / 2) - f->tile[tile].low[k / 2];
    double *S = g->diffusion.sum[g->diffusion.last][tile];
    if (f->tile[tile].side[k].patch < 0 || place != (k % 2 ? f->tile[tile].n[k / 2] - 1 : 0)) return 1;
    for (int i = 0; i < lines_of(g, what); i++) S[i * f->size + at] = i == c;
    tiles_sums_beyond(g, what, 0, tile, k, at);
    return 1 - S[c * f->size + (k % 2 ? at + step : at - step)];
}

double tiles_implicit_weight(struct gas *g, enum diffusing what, double per, int tile, long at, int k, int c) {
    const struct forest *f = g->forest;
    const int axis = k / 2, line = what == HEAT ? CONDUCTION : axis == c ? NORMAL : SHEAR;
    const long face = at + (k % 2 ? f->stride[axis] : 0); /* faces stand at the cell above them */
    const double weight = per * g->tiles->diffuser->face[tile][(FACE_LINES * axis + line) * f->size + face] *
                          jump_of(g, what, tile, at, k, c);
    const double place = f->radial < 0 ? 0 : forest_place_along(f, tile, at, f->radial) + 0.5;
    if (f->radial < 0) return weight;
    return weight * forest_radius(f, axis == f->radial ? place + (k % 2 ? 0.5 : -0.5) : place);
}
