/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear systems of implicit diffusion on polyhedra (hooks of libcore/gas/engine.h). The matrix, from which the
 * preconditioner is made, is that of the jumps along the lines of centres: what gradients add to the fluxes is left
 * out, and so is what couples the components. */
#include "libcore/polyhedral/cells_diffuser.h"

long cells_implicit_across(const struct gas *g, int block, long at, int k) {
    const struct polyhedra *m = g->cells->polyhedra;
    const int entry = m->face_start[at] + k;
    (void)block;
    if (entry >= m->face_start[at + 1]) return NO_FACE;
    const long other = cells_across(m, entry);
    return m->face_of_cell[entry] < m->face.ninternal ? other : ~other;
}

double *cells_implicit_sum(const struct gas *g, int block, int c) {
    (void)block;
    return g->cells->diffuser->sum[g->cells->diffuser->last][c];
}

void cells_implicit_beyond(struct gas *g, enum diffusing what) {
    const struct polyhedra *m = g->cells->polyhedra;
    const struct cells_diffuser *d = g->cells->diffuser;
    const struct mirror_sums sums = {
        what,           0, what == VISCOUS ? d->wall.drag : d->wall.heat, d->wall.lift, (const double *const *)d->start,
        d->sum[d->last]};
    cells_mirror_sums(g, &sums, 0, m->face.n - m->face.ninternal);
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

double cells_implicit_weight(const struct gas *g, enum diffusing what, double per, int block, long at, int k, int c,
                             const double jump[MAX_DIM]) {
    const struct polyhedra *m = g->cells->polyhedra;
    const int entry = m->face_of_cell[m->face_start[at] + k];
    (void)block;
    return per * passed(g, what, entry < 0 ? ~entry : entry, c, jump);
}
