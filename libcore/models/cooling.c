/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The cooling laws: their sub-steps at frozen density, and their table. cooling.h has the equations. */
#include "libcore/models/cooling.h"

#include "libcore/models/kernel.h"

#define PI 3.14159265358979323846

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

/* Returns 1 - e^2 of the restitution that friction leaves. */
static double losses_of(const struct material *m) {
    const double e = effective_restitution(m);
    return 1 - e * e;
}

/* Advances eps by Haff's law with `factor` times its rate. */
static void cool_by(double factor, const struct closure_line *cells, double dt, double *restrict eps) {
    const struct material *m = cells->material;
    const double g1 = m->gamma - 1, loss = factor * (cooling_factor(m) * losses_of(m) / m->diameter);
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

/* ---- laws with a length of correlations (docs/physics.md 3.7) ----
 *
 * dT/dt = -B T^(3/2)/(L/sigma) with L frozen. In the second half of a step it is that of its end: L/sigma = a/sqrt T
 * there, where it is above 1, makes T a root of a quadratic. In steady shear of thin gas sqrt T is a; heating and loss
 * in turn move T about it, and with L of each moment the loss would lack a part of first order in dt. */
KERNEL static void cool_correlated(int n, double g1, double per_contact, double dt, const double *restrict contact,
                                   const double *restrict bound, double *restrict eps) {
    for (int i = 0; i < n; i++) {
        const double root = sqrt(g1 * eps[i]), length = larger(1, bound[i] / root);
        const double slow = 1 + 0.5 * dt * (per_contact * (contact[i] / length)) * root;
        eps[i] = eps[i] / (slow * slow);
    }
}

KERNEL static void cool_correlated_late(int n, double g1, double per_contact, double dt, const double *restrict contact,
                                        const double *restrict bound, double *restrict eps) {
    for (int i = 0; i < n; i++) {
        const double root = sqrt(g1 * eps[i]), a = larger(bound[i], 1e-100), path = dt * (per_contact * contact[i]);
        const double slow = 1 + 0.5 * dt * (per_contact * contact[i]) * root;
        const double part = 2 / (1 + sqrt(1 + 2 * path * (root / a) * root));
        eps[i] = root < a * slow ? eps[i] * (part * part) : eps[i] / (slow * slow);
    }
}

/* Divides G by L/sigma of the T that eps is. */
KERNEL static void divide_by_length(int n, double g1, const double *restrict bound, const double *restrict eps,
                                    const double *restrict contact, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = contact[i] / larger(1, bound[i] / sqrt(g1 * eps[i]));
}

/* The law with a threshold, by a midpoint rule: L is that of T after half the step. */
static void cool_length_above(const struct closure_line *cells, double per_contact, const double *contact,
                              const double *bound, double dt, double *restrict eps) {
    const double g1 = cells->material->gamma - 1, threshold = cells->material->threshold;
    const int n = cells->n;
    double slowed[BATCH] = {0}, half[BATCH];
    memcpy(half, eps, (size_t)n * sizeof *half);
    divide_by_length(n, g1, bound, half, contact, slowed);
    cool_above(n, g1, per_contact, threshold, 0.5 * dt, slowed, half);
    divide_by_length(n, g1, bound, half, contact, slowed);
    cool_above(n, g1, per_contact, threshold, dt, slowed, eps);
}

/* Advances eps by Haff's law with B T^(3/2) sigma/L; bound: a, in m/s. */
static void cool_with_length(const struct closure_line *cells, const double *contact, const double *bound, double dt,
                             double *restrict eps) {
    const struct material *m = cells->material;
    const double g1 = m->gamma - 1, per_contact = g1 * (cooling_factor(m) * losses_of(m) / m->diameter);
    if (m->threshold > 0)
        cool_length_above(cells, per_contact, contact, bound, dt, eps);
    else if (cells->late)
        cool_correlated_late(cells->n, g1, per_contact, dt, contact, bound, eps);
    else
        cool_correlated(cells->n, g1, per_contact, dt, contact, bound, eps);
}

/* Finds a of f0, where contacts with friction carry a share of the stress less. */
static void bound_of(const struct closure_line *cells, const double *f0, double *bound) {
    const double *share = cells->by_impacts;
    for (int i = 0; i < cells->n; i++)
        bound[i] = f0[i] * (cells->shear_rate[i] * cells->material->diameter) * (share ? share[i] : 1);
}

/* Jenkins (2007), Jenkins & Berzi (2010): f0 = (c/2) G^(1/3). */
struct jenkins {
    double c;
};
OWN_PARAMS_FIT(struct jenkins);
#define PARAM_STRUCT struct jenkins
static const struct param jenkins_param[] = {
    NUMBER("c", c, 0.5, FROM_TO(0, 10), NO_UNIT, "L/diameter = (c/2) G^(1/3) diameter shear rate/sqrt T, at least 1"),
};
#undef PARAM_STRUCT

KERNEL static void jenkins_length(int n, double c, const double *restrict contact, double *restrict f0) {
    for (int i = 0; i < n; i++) f0[i] = 0.5 * c * power(larger(contact[i], 1e-200), 1. / 3);
}

static void jenkins(const struct own_params *params, const struct closure_line *cells, double dt,
                    double *restrict eps) {
    struct jenkins own;
    double contact[BATCH], f0[BATCH], bound[BATCH];
    memcpy(&own, params, sizeof own);
    cells->eos->contact(cells->material, cells->n, cells->rho, contact);
    jenkins_length(cells->n, own.c, contact, f0);
    bound_of(cells, f0, bound);
    cool_with_length(cells, contact, bound, dt, eps);
}

/* Berzi & Vescovi (2015): f0^2 = 2 J/(15 (1 - e'^2)) S^3, with S the L/sigma of homogeneous shear,
 *   S = 1 + (26/15) (1 - e') max(0, (nu - nu_1)/(nu_2 - nu)),
 * e' the effective restitution, and J of the shear viscosity (8/(5 sqrt pi)) rho_p sigma sqrt T nu G J,
 *   J = (1 + e)/2 + (pi/32) [5/G + 2 (1 + e)(3 e - 1)] [5/G + 4 (1 + e)]/[24 - 6 (1 - e)^2 - 5 (1 - e^2)].
 * nu is taken at most at EOS_PACKING nu_2, so that L is finite. */
struct berzi_vescovi {
    double from, to; /* nu_1, nu_2 */
};
OWN_PARAMS_FIT(struct berzi_vescovi);
#define PARAM_STRUCT struct berzi_vescovi
static const struct param berzi_vescovi_param[] = {
    NUMBER("alphaFreezing", from, 0.49, FROM_TO(0, 0.6), NO_UNIT,
           "packing fraction above which L of steady shear grows"),
    NUMBER("alphaRandom", to, 0.64, FROM_TO(0.61, 1), NO_UNIT,
           "packing fraction at which L diverges, whatever the friction"),
};
#undef PARAM_STRUCT

KERNEL static void berzi_vescovi_length(const struct material *m, struct berzi_vescovi own, int n,
                                        const double *restrict rho, const double *restrict contact,
                                        double *restrict f0) {
    const double e = m->restitution, lost = 1 - effective_restitution(m), per = packing_per_density(m);
    const double unlike = PI / 32 / (24 - 6 * (1 - e) * (1 - e) - 5 * (1 - e * e)), factor = 2 / (15 * losses_of(m));
    for (int i = 0; i < n; i++) {
        const double thin = 5 / larger(contact[i], 1e-100), nu = smaller(per * rho[i], EOS_PACKING * own.to);
        const double J = 0.5 * (1 + e) + unlike * (thin + 2 * (1 + e) * (3 * e - 1)) * (thin + 4 * (1 + e));
        const double S = 1 + 26. / 15 * lost * larger((nu - own.from) / (own.to - nu), 0);
        f0[i] = smaller(sqrt(factor * J * S) * S, 1e100);
    }
}

static void berzi_vescovi(const struct own_params *params, const struct closure_line *cells, double dt,
                          double *restrict eps) {
    struct berzi_vescovi own;
    double contact[BATCH], f0[BATCH], bound[BATCH];
    memcpy(&own, params, sizeof own);
    cells->eos->contact(cells->material, cells->n, cells->rho, contact);
    berzi_vescovi_length(cells->material, own, cells->n, cells->rho, contact, f0);
    bound_of(cells, f0, bound);
    cool_with_length(cells, contact, bound, dt, eps);
}

const struct cooling cooling_table[] = {
    {MODEL("Haff", "inelastic collisions, integrated exactly; grain.thresholdSpeed spares the slow ones"),
     .valid = GRAINS_BOTH, .step = haff},
    {MODEL("GarzoDufty", "Haff's with the second Sonine coefficient of the velocities (Garzo & Dufty 1999)"),
     .valid = GRAINS_BOTH, .step = garzo_dufty},
    {MODEL_WITH("Jenkins", "Haff's over the length of correlations that shear makes (Jenkins 2007)", jenkins_param),
     .valid = GRAINS_BOTH, .needs = NEEDS_SHEAR_RATE, .step = jenkins},
    {MODEL_WITH("BerziVescovi", "Haff's over the length of correlations of Berzi & Vescovi (2015)",
                berzi_vescovi_param),
     .valid = GRAINS_SPHERES, .needs = NEEDS_SHEAR_RATE, .step = berzi_vescovi},
};
const int cooling_count = sizeof cooling_table / sizeof *cooling_table;

const struct cooling *cooling_find(const char *name) {
    return model_find(cooling_table, sizeof *cooling_table, cooling_count, name);
}
