/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear systems of implicit diffusion on a lattice (hooks of libcore/gas/engine.h). The faces of a cell are
 * numbered as the sides of a tile. */
#include "libcore/lattice/tiles_diffuser.h"

long tiles_implicit_across(const struct gas *g, int tile, long at, int k) {
    const struct forest *f = g->forest;
    const struct tile *t = &f->tile[tile];
    const int axis = k / 2;
    if (axis >= f->dim) return NO_FACE;
    const long inside = at - f->first,
               i = (axis + 1 < f->dim ? inside % f->stride[axis + 1] : inside) / f->stride[axis];
    const long other = at + (k % 2 ? f->stride[axis] : -f->stride[axis]);
    return t->side[k].patch >= 0 && i == (k % 2 ? t->n[axis] - 1 : 0) ? ~other : other;
}

double *tiles_implicit_sum(const struct gas *g, int tile, int c) {
    return g->tiles->diffuser->sum[g->tiles->diffuser->last][tile] + c * g->size;
}

double tiles_implicit_weight(const struct gas *g, enum diffusing what, double per, int tile, long at, int k, int c,
                             const double jump[MAX_DIM]) {
    const struct forest *f = g->forest;
    const int axis = k / 2, line = what == HEAT ? CONDUCTION : axis == c ? NORMAL : SHEAR;
    const long face = at + (k % 2 ? f->stride[axis] : 0); /* faces stand at the cell above them */
    const double weight = per * g->tiles->diffuser->face[tile][(FACE_LINES * axis + line) * f->size + face] * jump[c];
    const double place = f->radial < 0 ? 0 : forest_place_along(f, tile, at, f->radial) + 0.5;
    if (f->radial < 0) return weight;
    return weight * forest_radius(f, axis == f->radial ? place + (k % 2 ? 0.5 : -0.5) : place);
}
