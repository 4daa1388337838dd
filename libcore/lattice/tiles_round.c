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

/* Adds the radial part of a conserved variable. Gas without radial velocity between equal fluxes keeps it to the bit,
 * as skipped cells do: the flux is round-off there, or has an extremum. */
ALWAYS_INLINE void conserve(int n, double inverse, const double *restrict half, const double *restrict momentum,
                            const double *restrict low, const double *restrict high, const bool first,
                            double *restrict sum) {
    for (int i = 0; i < n; i++) {
        const double part = low[i] * (inverse - half[i]) - high[i] * (inverse + half[i]);
        const double gain = ((momentum[i] == 0) & (low[i] == high[i])) ? 0 : part;
        sum[i] = first ? gain : sum[i] + gain;
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
            conserve(l->n, ir, l->half, l->momentum, low, high, !axial, sum);
            continue;
        }
        for (int i = 0; i < l->n; i++) {
            const double turn = l->swirl ? l->around[0][i] * l->around[1][i] : 0;
            const double gain = (low[i] - high[i]) * ir - 2 * l->half[i] * (l->momentum[i] * l->velocity[i] - turn);
            sum[i] = axial ? sum[i] + gain : gain;
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
    (void)row_radius(g, tile, offset, n, half);
    for (int i = 0; i < n; i++) half[i] = 0.5 / half[i];
    round_row(&l, &f[radial], g->dim > 1 ? &f[1 - radial] : NULL, residual);
}
