/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear systems of implicit diffusion on polyhedra (hook `weight` of libcore/gas/engine.h). The matrix, from which
 * the preconditioner is made, is that of the jumps along the lines of centres: what gradients add to the fluxes is left
 * out, and so is what couples the components. */
#include "libcore/polyhedral/cells_diffuser.h"

/* The jump of an S that is 1 in component c of the cell at a face, on a patch if `edge` >= 0. */
static void jump_of(struct gas *g, enum diffusing what, int cell, int edge, int c, double jump[MAX_DIM]) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct cells_diffuser *d = g->cells->diffuser;
    double *const *S = d->sum[g->diffusion.last];
    const int lines = what == VISCOUS ? g->components : 1;
    const struct mirror_sums sums = {
        what, 0, what == VISCOUS ? d->wall.drag : d->wall.heat, d->wall.lift, (const double *const *)d->start, S};
    for (int i = 0; i < lines; i++) jump[i] = i == c;
    if (edge < 0) return;
    for (int i = 0; i < lines; i++) S[i][cell] = i == c;
    cells_mirror_sums(g, &sums, edge, edge + 1);
    for (int i = 0; i < lines; i++) jump[i] -= S[i][m->ncells + edge];
}

/* Component c of the flux that a jump between its two cells makes through face i. */
static double passed(const struct gas *g, enum diffusing what, int i, int c, const double jump[MAX_DIM]) {
    const struct cells_diffuser *d = g->cells->diffuser;
    double *const *normal = g->cells->polyhedra->face.normal, along = 0;
    if (what == HEAT) return d->face[2][i] * d->inverse[i] * jump[0];
    for (int k = 0; k < g->dim; k++) along += normal[k][i] * jump[k];
    if (c >= g->dim) return d->face[1][i] * jump[c] * d->inverse[i]; /* of a swirl but for some h/r */
    return (d->face[1][i] * jump[c] + (d->face[0][i] + d->face[1][i]) * normal[c][i] * along) * d->inverse[i];
}

double cells_implicit_weight(struct gas *g, enum diffusing what, double per, int block, long at, int k, int c) {
    const struct polyhedra *m = g->cells->polyhedra;
    const int entry = m->face_of_cell[m->face_start[at] + k];
    double jump[MAX_DIM] = {0};
    (void)block;
    jump_of(g, what, (int)at, entry < m->face.ninternal ? -1 : entry - m->face.ninternal, c, jump);
    return per * passed(g, what, entry < 0 ? ~entry : entry, c, jump);
}
