/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fluxes of segregation on a lattice, within, on seams and on the boundary (segregation_lattice.h has the scheme). */
#include "libcore/segregation/segregation_lattice_private.h"

/* The inner faces of an axis within one outer index: they are contiguous, and so are the cells below and above them. */
struct run {
    long cell, face, n;
};
static struct run inner_run(const struct segregation_field *s, int k, long outer) {
    const long across = s->stride[k], n = s->lattice.n[k];
    return (struct run){outer * n * across, outer * (n + 1) * across + across, (n - 1) * across};
}

KERNEL static void central_flux_lattice(long n, double per_width, const double *restrict below,
                                        const double *restrict above, const double *restrict u,
                                        const double *restrict f, const double *restrict D, double *restrict flux) {
    for (long i = 0; i < n; i++) {
        double a = below[i], b = above[i];
        flux[i] = 0.5 * (u[i] * (a + b) + f[i] * (a * (1 - a) + b * (1 - b))) - D[i] * per_width * (b - a);
    }
}

/* Returns where g = u phi + f phi (1 - phi) turns, within 0 .. 1. */
static inline double turn_of(double u, double f) {
    double half = f != 0 ? 0.5 * (u + f) / f : 0;
    double turn = f != 0 ? half : u >= 0 ? 1 : 0;
    return smaller(larger(turn, 0), 1);
}
/* Computes the Engquist-Osher flux, which takes the rising part of g from below and the falling one from above. */
KERNEL static void monotone_flux_lattice(long n, double per_width, const double *restrict below,
                                         const double *restrict above, const double *restrict u,
                                         const double *restrict f, const double *restrict D, double *restrict flux) {
    for (long i = 0; i < n; i++) {
        double a = below[i], b = above[i], bend = f[i], turn = turn_of(u[i], bend);
        double from = (bend >= 0) == (a < turn) ? a : turn, to = (bend >= 0) == (b > turn) ? b : turn;
        double g =
            from * (u[i] + bend * (1 - from)) + (to * (u[i] + bend * (1 - to)) - turn * (u[i] + bend * (1 - turn)));
        flux[i] = g - D[i] * per_width * (b - a);
    }
}

typedef void flux_function(long, double, const double *restrict, const double *restrict, const double *restrict,
                           const double *restrict, const double *restrict, double *restrict);

/* Computes the flux on the seam of a cyclic axis: the faces at both ends are one. */
static void seam_flux(const struct segregation_field *s, flux_function *function, int k, const double *phi,
                      double *flux) {
    const struct segregation_lattice *l = &s->lattice;
    const long across = s->stride[k], n = l->n[k];
    for (long outer = 0; outer < outer_count(s, k); outer++) {
        const long low = outer * (n + 1) * across, cell = outer * n * across;
        function(across, 1 / l->width[k], phi + cell + (n - 1) * across, phi + cell, l->u[k] + low, l->f[k] + low,
                 l->D[k] + low, flux + low);
        memcpy(flux + low + n * across, flux + low, (size_t)across * sizeof *flux);
    }
}
/* Computes the flux into the domain. A given phi holds on the face, half a cell away; where that is too coarse for
 * |u| + |f| <= D / (h/2), the flux is that of Engquist and Osher, which lets phi in as far as its waves run in.
 * Elsewhere phi of the cell holds on the face. Both keep 0 .. 1 and change no walls, where u, f and D are 0. */
static struct boundary_flux inward(double u, double f, double g, const double *given, double phi) {
    const double wave = u + f * (1 - 2 * phi);
    if (!given) return (struct boundary_flux){phi * (u + f * (1 - phi)), wave};
    if (fabs(u) + fabs(f) <= g) return (struct boundary_flux){*given * (u + f * (1 - *given)) - g * (phi - *given), -g};
    double flux;
    monotone_flux_lattice(1, g, given, &phi, &u, &f, &(double){1}, &flux);
    return (struct boundary_flux){flux, ((f >= 0) == (phi > turn_of(u, f)) ? wave : 0) - g};
}
struct boundary_flux segregation_edge(const struct segregation_field *s, int k, bool high, long face, double phi) {
    const struct segregation_lattice *l = &s->lattice;
    const double sign = high ? -1 : 1, g = l->D[k][face] * (2 / l->width[k]);
    const struct boundary_flux in =
        inward(sign * l->u[k][face], sign * l->f[k][face], g, fixed_on(l, k, face) ? l->value[k] + face : NULL, phi);
    return (struct boundary_flux){sign * in.flux, sign * in.slope};
}
static void boundary_flux(const struct segregation_field *s, int k, bool high, const double *phi, double *flux) {
    const long across = s->stride[k], n = s->lattice.n[k];
    for (long outer = 0; outer < outer_count(s, k); outer++)
        for (long r = 0; r < across; r++) {
            const long face = (outer * (n + 1) + (high ? n : 0)) * across + r;
            flux[face] = segregation_edge(s, k, high, face, phi[(outer * n + (high ? n - 1 : 0)) * across + r]).flux;
        }
}
/* Computes the flux on the faces between this rank and the one beyond an end of the last axis. */
static void joined_flux(const struct segregation_field *s, flux_function *function, bool high, const double *phi,
                        double *flux) {
    const struct segregation_lattice *l = &s->lattice;
    const int k = l->dim - 1;
    const long across = s->stride[k], face = high ? l->n[k] * across : 0;
    function(across, 1 / l->width[k], high ? phi + face - across : s->slab.below, high ? s->slab.above : phi,
             l->u[k] + face, l->f[k] + face, l->D[k] + face, flux + face);
}
void segregation_take_flux(struct segregation_field *s, bool monotone, const double *phi, double *const flux[MAX_DIM]) {
    const struct segregation_lattice *l = &s->lattice;
    flux_function *function = monotone ? monotone_flux_lattice : central_flux_lattice;
    slab_swap(&s->slab, phi, phi + s->cells - s->stride[l->dim - 1]);
    for (int k = 0; k < l->dim; k++) {
        for (long outer = 0; outer < outer_count(s, k); outer++) {
            struct run r = inner_run(s, k, outer);
            function(r.n, 1 / l->width[k], phi + r.cell, phi + r.cell + s->stride[k], l->u[k] + r.face,
                     l->f[k] + r.face, l->D[k] + r.face, flux[k] + r.face);
        }
        if (wraps(s, k)) {
            seam_flux(s, function, k, phi, flux[k]);
            continue;
        }
        for (int high = 0; high < 2; high++)
            if (joined(s, k, high))
                joined_flux(s, function, high, phi, flux[k]);
            else
                boundary_flux(s, k, high, phi, flux[k]);
    }
}

KERNEL static void add_difference(long n, double factor, const double *restrict ease, const double *restrict low,
                                  const double *restrict high, double *restrict out) {
    for (long i = 0; i < n; i++) out[i] -= factor * ease[i] * (high[i] - low[i]);
}
void segregation_subtract(const struct segregation_field *s, double dt, double *const flux[MAX_DIM], double *out) {
    for (int k = 0; k < s->lattice.dim; k++) {
        const long across = s->stride[k], n = s->lattice.n[k];
        for (long outer = 0; outer < outer_count(s, k); outer++) {
            const double *low = flux[k] + outer * (n + 1) * across;
            add_difference(n * across, dt / s->lattice.width[k], s->ease + outer * n * across, low, low + across,
                           out + outer * n * across);
        }
    }
}
