/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Bodies of revolution on a lattice of (axial, radial) or of radial cells (struct revolution of mesh/format/polymesh.h;
 * docs/physics.md 1.4). Fluxes are those of plane flow; what differs is how a cell adds them up:
 *   rho, E, axial momentum    -d(r F)/(r dr)             conserved: areas r -+ h/2 and volume r h are exact
 *   radial momentum           -dF/dr - rho u_r^2/r       F holds p, whose part in d(r p)/(r dr) - p/r is dp/dr
 *   with swirl, further       + rho u_s^2/r
 *   momentum around the axis  -d(r^2 F)/(r^2 dr)         conserved: moments of areas, and of the volume r^2 h + h^3/4,
 *                                                        the integral of r^3 over r, exact in rigid rotation
 * with r of the cell's centre. So the pressure of uniform gas without radial flow cancels to the bit, as in the plane.
 */
#include "libcore/lattice/tiles.h"

/* Adds the radial part of a conserved variable. Between equal cells without radial velocity its fluxes are 0. */
ALWAYS_INLINE void conserve(int n, double inverse, const double *restrict half, const double *restrict low,
                            const double *restrict high, const bool first, double *restrict sum) {
    for (int i = 0; i < n; i++) {
        const double part = low[i] * (inverse - half[i]) - high[i] * (inverse + half[i]);
        sum[i] = first ? part : sum[i] + part;
    }
}

/* Adds the radial part of the momentum around the axis. */
ALWAYS_INLINE void conserve_moment(int n, double inverse, const double *restrict half, const double *restrict low,
                                   const double *restrict high, const bool first, double *restrict sum) {
    for (int i = 0; i < n; i++) {
        const double d = half[i] / inverse, below = 1 - d, above = 1 + d;
        const double part = (low[i] * (below * below) - high[i] * (above * above)) * (inverse / (1 + d * d));
        sum[i] = first ? part : sum[i] + part;
    }
}

KERNEL static void round_row(const struct round_line *l, const struct faces_of_row *radial,
                             const struct faces_of_row *axial, double (*restrict residual)[BATCH]) {
    const double ir = radial->inverse, ia = axial ? axial->inverse : 0;
    for (int v = 0; v < l->nvar; v++) {
        double *restrict sum = residual[v];
        const double *restrict low = radial->low[v], *restrict high = radial->high[v];
        if (axial)
            for (int i = 0; i < l->n; i++) sum[i] = (axial->low[v][i] - axial->high[v][i]) * ia;
        if (v == l->swirl + 1 && l->swirl) {
            conserve_moment(l->n, ir, l->half, low, high, !axial, sum);
            continue;
        }
        if (v != l->radial + 1) {
            conserve(l->n, ir, l->half, low, high, !axial, sum);
            continue;
        }
        for (int i = 0; i < l->n; i++) {
            const double turn = l->swirl ? l->around[0][i] * l->around[1][i] : 0;
            const double gain = (low[i] - high[i]) * ir - 2 * l->half[i] * (l->momentum[i] * l->velocity[i] - turn);
            sum[i] = axial ? sum[i] + gain : gain;
        }
    }
}

/* Cells whose faces are limited: both momenta have the weights of mass and energy, and what a cell's own p and u_s do
 * on its sides, so that the theorem of schemes/limit.h holds. Angular momentum is not conserved there. */
static void limit_cells(const struct round_line *l, const struct faces_of_row *radial, const struct faces_of_row *axial,
                        const double *flag, const double *p, double (*residual)[BATCH]) {
    const int lines[2] = {l->radial + 1, l->swirl + 1};
    for (int i = 0; i < l->n; i++) {
        if (flag[i] == 0) continue;
        const double around = l->swirl ? l->around[0][i] : 0, speed = l->swirl ? l->around[1][i] : 0;
        const double side[2] = {p[i] + around * speed, -around * l->velocity[i]};
        for (int k = 0; k < (l->swirl ? 2 : 1); k++) {
            const int v = lines[k];
            const double along = axial ? (axial->low[v][i] - axial->high[v][i]) * axial->inverse : 0;
            const double across = radial->low[v][i] * (radial->inverse - l->half[i]) -
                                  radial->high[v][i] * (radial->inverse + l->half[i]);
            residual[v][i] = along + across + 2 * l->half[i] * side[k];
        }
    }
}

void round_residual(const struct gas *g, int tile, const double *U, long offset, int n, const struct faces_of_row *f,
                    double (*residual)[BATCH]) {
    ALIGNED double half[BATCH];
    const int radial = g->forest->radial, swirl = g->models.swirl;
    const struct round_line l = {
        .n = n,
        .swirl = swirl,
        .around = {U + (swirl + 1) * g->forest->size + offset, g->tiles->work.velocity[swirl] + offset},
        .nvar = g->nvar,
        .radial = radial,
        .half = half,
        .momentum = U + (radial + 1) * g->forest->size + offset,
        .velocity = g->tiles->work.velocity[radial] + offset};
    const struct faces_of_row *axial = g->dim > 1 ? &f[1 - radial] : NULL;
    (void)row_radius(g, tile, offset, n, half);
    for (int i = 0; i < n; i++) half[i] = 0.5 / half[i];
    round_row(&l, &f[radial], axial, residual);
    if (g->limits.flags.blocks[tile])
        limit_cells(&l, &f[radial], axial, g->limits.flags.cells[tile] + offset, g->tiles->work.p + offset, residual);
}
