/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cooling laws: their sub-steps at frozen density, and their table. cooling.h has the equations. */
#include "libcore/models/cooling.h"

#include "libcore/models/kernel.h"

/* Computes T/(1 + B sqrt(T) dt/2)^2, the solution of Haff's law dT/dt = -B T^(3/2) (docs/physics.md 3.2); B =
 * per_contact G. */
KERNEL static void cool(int n, double g1, double per_contact, double dt, const double *restrict contact,
                        double *restrict eps) {
    for (int i = 0; i < n; i++) {
        double root = sqrt(g1 * eps[i]);
        double slow = 1 + 0.5 * dt * (per_contact * contact[i]) * root;
        eps[i] = eps[i] / (slow * slow);
    }
}

/* The functions below solve the law with a threshold speed (docs/physics.md 3.3), dT/dt = -B T^(3/2) (1 + x) e^-x, x =
 * v_c^2/(4 T). With s = sqrt x and tau = B v_c dt this is
 *   ds/dtau = (1 + x) e^-x / 4:  Haff's straight line at first, then a logarithm.
 * w = sqrt(2 (e^2x - 1)) follows both, dw/dtau = r/2 with r = 2 s (1 + x)/sqrt(2 (1 - e^-2x)), which is 1 at x = 0 and
 * grows no faster than s^3. One midpoint step in w is of second order, keeps T positive and falling, stops T where e^-x
 * is next to nothing, and is sensible for a step of any length. The kernel works with w e^-x0, which cannot overflow,
 * and gains x1 - x0 = ln(1 + e^-2x0 (w1^2 - w0^2)/2)/2 without a difference of close numbers. */
ALWAYS_INLINE double scaled_w(double x) {
    return sqrt(-2 * exponential_minus_one(-2 * smaller(x, 300))); /* e^-600 is nothing beside 1 */
}
ALWAYS_INLINE double speed_of_w(double x) {
    return 2 * sqrt(x) * (1 + x) / scaled_w(x);
}
ALWAYS_INLINE double gain_of_x(double w, double step) {
    return 0.5 * logarithm_plus_one(0.5 * step * (2 * w + step));
}

KERNEL static void cool_above(int n, double g1, double per_contact, double threshold, double dt,
                              const double *restrict contact, double *restrict eps) {
    for (int i = 0; i < n; i++) {
        double T = g1 * eps[i], x = 0.25 * threshold * threshold / T;
        x = smaller(larger(x, 1e-200), 1e100); /* avoids 0/0 and overflow, and changes no other result */
        double w = scaled_w(x);
        double path = dt * (per_contact * contact[i]) * sqrt(T * x) * exponential(-smaller(x, 300)); /* tau e^-x / 2 */
        double middle = x + gain_of_x(w, 0.5 * path * speed_of_w(x));
        eps[i] *= x / (x + gain_of_x(w, path * speed_of_w(middle)));
    }
}

/* Advances eps by Haff's law with `factor` times its rate. */
static void cool_by(double factor, const struct closure_line *cells, double dt, double *restrict eps) {
    const struct material *m = cells->material;
    const double g1 = m->gamma - 1, losses = 1 - m->restitution * m->restitution;
    const double loss = factor * (cooling_factor(m) * losses / m->diameter);
    double contact[BATCH];
    cells->eos->contact(m, cells->n, cells->rho, contact);
    if (m->threshold > 0)
        cool_above(cells->n, g1, g1 * loss, m->threshold, dt, contact, eps);
    else
        cool(cells->n, g1, g1 * loss, dt, contact, eps);
}

static void haff(const struct own_params *params, const struct closure_line *cells, double dt, double *restrict eps) {
    (void)params;
    cool_by(1, cells, dt, eps);
}

/* Cooling with the second Sonine coefficient a2 (docs/physics.md 3.4; Garzo & Dufty 1999, van Noije & Ernst 1998): the
 * velocities of inelastic grains are not quite Maxwellian, and the rate is 1 + 3 a2/16 of Haff's: 0.997 at e = 0.9 and
 * 1.028 at e = 0.2 for spheres. */
static void garzo_dufty(const struct own_params *params, const struct closure_line *cells, double dt,
                        double *restrict eps) {
    (void)params;
    cool_by(1 + 3. / 16 * second_sonine(cells->material), cells, dt, eps);
}

const struct cooling cooling_table[] = {
    {MODEL("Haff", "inelastic collisions, integrated exactly; grain.thresholdSpeed spares the slow ones"),
     .step = haff},
    {MODEL("GarzoDufty", "Haff's with the second Sonine coefficient of the velocities (Garzo & Dufty 1999)"),
     .step = garzo_dufty},
};
const int cooling_count = sizeof cooling_table / sizeof *cooling_table;

const struct cooling *cooling_find(const char *name) {
    return model_find(cooling_table, sizeof *cooling_table, cooling_count, name);
}
