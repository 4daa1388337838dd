/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Brings a Crank-Nicolson step of segregation on a line within its bounds by flux-corrected transport (Zalesak 1979;
 * docs/physics.md 11.1): an implicit Euler step with the Engquist-Osher flux, and as much of Crank-Nicolson's flux as
 * the bounds allow. */
#include "libcore/segregation/segregation_private.h"

/* Computes the Engquist-Osher flux of f phi (1 - phi) at phi', and diffusion. It is monotone: upward >= 0 >=
 * downward. */
KERNEL static void monotone_flux(int n, const struct segregation *s, const double *restrict f,
                                 const double *restrict phi) {
    const double *restrict share = s->share, *restrict nearness = s->nearness, *restrict D = s->diffusivity;
    double *restrict flux = s->flux, *restrict upward = s->upward, *restrict downward = s->downward;
    for (int i = 1; i < n; i++) {
        double speed = (1 - share[i]) * f[i - 1] + share[i] * f[i], g = D[i] * nearness[i];
        double a = phi[i - 1], b = phi[i]; /* beyond 1/2 the characteristics turn */
        double below = select_double((speed >= 0) == (a < 0.5), a, 0.5);
        double above = select_double((speed >= 0) == (b > 0.5), b, 0.5);
        flux[i] = speed * ((below * (1 - below) + above * (1 - above)) - 0.25) - g * (b - a);
        upward[i] = speed * (1 - 2 * below) + g;
        downward[i] = speed * (1 - 2 * above) - g;
    }
}

/* Computes out = phi - dt/width (F_{i+1} - F_i), so that phi changes by the fluxes to the last bit. */
static void balance(const struct segregation *s, double dt, const double *phi, const double *flux, double *out) {
    for (int j = 0; j < s->line.n; j++) out[j] = phi[j] - dt / s->width[j] * (flux[j + 1] - flux[j]);
}

/* Makes the implicit Euler step: s->low, s->low_flux. The matrix is an M-matrix with column sums 1 for every step, so
 * Newton's method needs no damping; the solution is within 0 .. 1, and the iterates are kept there. */
static status monotone_step(struct segregation *s, double dt, const double *phi) {
    const int n = s->line.n;
    memcpy(s->low, phi, (size_t)n * sizeof *phi);
    for (int k = 0; k < 200; k++) {
        monotone_flux(n, s, s->line.speed, s->low);
        segregation_rows(s, dt, phi, s->low);
        if (!segregation_solve(s)) break;
        double change = 0;
        for (int i = 0; i < n; i++) {
            double now = smaller(larger(s->low[i] + s->matrix.right[i], 0), 1);
            change = larger(change, fabs(now - s->low[i]));
            s->low[i] = now;
        }
        if (!(change < 1e-9)) continue; /* the next change would be the square of this one */
        monotone_flux(n, s, s->line.speed, s->low);
        memcpy(s->low_flux, s->flux, (size_t)(n + 1) * sizeof(double));
        balance(s, dt, phi, s->low_flux, s->low);
        return OK;
    }
    return fail(ERR_STATE, "the monotone step has not settled; a smaller deltaT helps");
}

/* Sets the bounds of phi: 0 .. 1, and beside coarse faces the range of both times at the cell and its neighbours, so
 * that no new extremes appear. */
static void find_bounds(struct segregation *s, const double *phi) {
    const int n = s->line.n;
    for (int j = 0; j < n; j++) {
        s->least[j] = 0;
        s->most[j] = 1;
        if (!(j > 0 && segregation_coarse(s, j)) && !(j < n - 1 && segregation_coarse(s, j + 1))) continue;
        double least = 1, most = 0;
        for (int i = j > 0 ? j - 1 : 0; i <= j + 1 && i < n; i++) {
            least = smaller(least, smaller(phi[i], s->low[i]));
            most = larger(most, larger(phi[i], s->low[i]));
        }
        s->least[j] = larger(least, 0);
        s->most[j] = smaller(most, 1);
    }
}

/* Limits the faces of cell j to what keeps it within its bounds whatever the other faces do (Zalesak 1979). */
static void limit_cell(struct segregation *s, double dt, int j) {
    const double k = dt / s->width[j], in = s->excess[j], out = s->excess[j + 1];
    const double gain = k * (larger(in, 0) - smaller(out, 0)), loss = k * (larger(out, 0) - smaller(in, 0));
    const double room = larger(s->most[j] - s->low[j], 0), stock = larger(s->low[j] - s->least[j], 0);
    const double gains = gain > room ? room / gain : 1, losses = loss > stock ? stock / loss : 1;
    s->part[j] = smaller(s->part[j], in > 0 ? gains : losses);
    s->part[j + 1] = smaller(s->part[j + 1], out > 0 ? losses : gains);
}

/* Limits the faces of cells that leave their bounds, then the faces of cells that leave their bounds because of that,
 * until every cell keeps them. */
static void limit(struct segregation *s, double dt, double *found) {
    const int n = s->line.n;
    for (int i = 0; i <= n; i++) s->part[i] = 1;
    memset(s->watched, 0, (size_t)n * sizeof *s->watched);
    for (bool again = true; again;) {
        again = false;
        for (int j = 0; j < n; j++) {
            double k = dt / s->width[j];
            found[j] = s->low[j] - k * (s->part[j + 1] * s->excess[j + 1] - s->part[j] * s->excess[j]);
            if (s->watched[j] || (found[j] >= s->least[j] && found[j] <= s->most[j])) continue;
            s->watched[j] = again = true;
        }
        for (int j = 0; j < n; j++)
            if (s->watched[j]) limit_cell(s, dt, j);
    }
    for (int i = 1; i < n; i++) s->counts.corrected += s->part[i] < 1;
}

status segregation_bound(struct segregation *s, double dt, const double *phi, double *found) {
    const int n = s->line.n;
    for (int i = 1; i < n; i++) s->excess[i] = s->flux[i];
    s->counts.bounded++;
    TRY(monotone_step(s, dt, phi));
    for (int i = 1; i < n; i++) {
        double more = s->excess[i] - s->low_flux[i];
        s->excess[i] = isfinite(more) ? more : 0;
    }
    find_bounds(s, phi);
    limit(s, dt, found);
    return OK;
}
