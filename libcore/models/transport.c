/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The laws of viscosity and heat conduction, each with its parameters and its row of the table (transport.h). */
#include "libcore/models/transport.h"

#include "libcore/models/kernel.h"

#define PI 3.14159265358979323846

struct jenkins_richman { /* the law's own parameters */
    double alpha_min;    /* packing fraction below which G no longer falls in the coefficients */
    int bulk;            /* index of bulk_words; 1: bulk viscosity twice as large, as printed (docs/physics.md C2) */
};
OWN_PARAMS_FIT(struct jenkins_richman);

/* Jenkins & Richman's disks (1985; docs/physics.md 4.2) as in Carrillo, Poeschel & Saluena (2.12)-(2.14), with the bulk
 * viscosity of the contact integrals (docs/physics.md 1.3):
 *   bulk = 2/sqrt pi rho sigma sqrt T G,  shear = sqrt pi/8 rho sigma sqrt T [1/G + 2 + (1 + 8/pi) G],
 *   heat = sqrt pi/2 rho sigma sqrt T [1/G + 3 + (9/4 + 4/pi) G].
 * Where G vanishes, rho/G has a limit, but diffusivities, which are coefficients per rho, have none: below alpha_min G
 * is taken at alpha_min. Near packing, where G diverges, it is taken at most at EOS_PACKING of alpha_max, so that
 * coefficients stay finite. The factor rho itself is never clipped. */
KERNEL static void disks_of_contact(const struct closure_line *cells, double bulk_factor,
                                    const double *restrict contact, double *restrict bulk, double *restrict shear,
                                    double *restrict heat) {
    const double *restrict rho = cells->rho, *restrict T = cells->T, sigma = cells->material->diameter;
    const int n = cells->n;
    const double root_pi = sqrt(PI), b = 2 / root_pi * bulk_factor;
    for (int i = 0; i < n; i++) {
        double G = contact[i], inverse = 1 / G, factor = rho[i] * sigma * sqrt(T[i]);
        bulk[i] = b * factor * G;
        shear[i] = root_pi / 8 * factor * (inverse + 2 + (1 + 8 / PI) * G);
        heat[i] = root_pi / 2 * factor * (inverse + 3 + (9. / 4 + 4 / PI) * G);
    }
}

/* Returns the density at which the coefficients end, a fraction of that of alpha_max: above it they are those there
 * times rho/(rho there) (docs/physics.md 4.5). */
static double packed_density(const struct material *m, double fraction) {
    return m->alpha_max > 0 ? fraction * m->alpha_max / packing_per_density(m) : HUGE_VAL;
}

static void jenkins_richman(const struct own_params *params, const struct closure_line *cells, double *restrict bulk,
                            double *restrict shear, double *restrict heat) {
    const struct material *m = cells->material;
    const int n = cells->n;
    struct jenkins_richman own;
    memcpy(&own, params, sizeof own);
    const double low = own.alpha_min / packing_per_density(m), high = packed_density(m, EOS_PACKING);
    double clipped[BATCH], contact[BATCH];
    for (int i = 0; i < n; i++) clipped[i] = smaller(larger(cells->rho[i], low), high);
    cells->eos->contact(m, n, clipped, contact);
    disks_of_contact(cells, own.bulk ? 2 : 1, contact, bulk, shear, heat);
}

#define PARAM_STRUCT struct jenkins_richman
static const char *const bulk_words[] = {"corrected", "paper", NULL};
static const struct param jenkins_richman_param[] = {
    NUMBER("alphaMin", alpha_min, 1e-4, BETWEEN(0, 1), NO_UNIT,
           "packing fraction below which viscosity and conductivity fall with the density"),
    CHOICE("bulk", bulk, 0, bulk_words, "viscosity by the contact integral, or twice that, as printed"),
};

#undef PARAM_STRUCT

enum { ZETA_OFF, ZETA_GEOMETRIC, ZETA_FULL };
struct garzo_dufty {
    double alpha_min; /* as Jenkins & Richman's; 0: coefficients do not fall */
    double knudsen;   /* packing fraction at which the coefficients are halved; 0: they are not cut */
    int zeta_u;       /* index of zeta_words */
    int stress;       /* index of stress_words; 1: diagonal, derivatives across faces alone (docs/physics.md 4.6) */
    double end;       /* fraction of alpha_max above which coefficients go with the density; 0: EOS_PACKING */
};
OWN_PARAMS_FIT(struct garzo_dufty);

/* Garzo & Dufty's disks and spheres (1999) in d dimensions, Lutsko (2005); docs/physics.md 4.3: with nu the packing
 * fraction, X = nu chi, L = nu chi'/chi, and a2 the second Sonine coefficient,
 *   shear = shear0 shear*,  bulk = shear0 bulk*,  heat = heat0 heat*,  cross = heat0 T/rho cross*,
 *   shear0 = (d + 2)/8 Gamma(d/2) pi^(-(d - 1)/2) m sqrt T/sigma^(d - 1),  heat0 = d (d + 2)/(2 (d - 1)) shear0,
 * where the starred functions of X, chi, nu and L are
 *   bulk*  = g nu X
 *   shear* = (1 - s1 X)/(chi s0) (1 + s2 X) + d/(d + 2) bulk*
 *   k      = (h1 + h2 X)/(chi h0),  heat* = k (1 + h3 X) + h4 nu X
 *   cross* = [z (1 + L) k chi + c1 + c2 X (1 + L/2)]/(chi c0) (1 + h3 X)
 * and the constants depend on e and d alone. z chi is the cooling rate in units of p0/shear0, p0 = rho T. */
struct garzo_constants {
    double shear0, heat_ratio; /* shear0/sqrt T, heat0/shear0 */
    double z, g, of_bulk;      /* of_bulk: d/(d + 2) */
    double s0, s1, s2, h0, h1, h2, h3, h4, c0, c1, c2;
};

static struct garzo_constants garzo_constants_of(const struct material *m, double a2) {
    const double e = m->restitution, d = m->disks ? 2 : 3, pairs = 1 + e;
    const double two = m->disks ? 1 : 2; /* 2^(d-2) */
    struct garzo_constants c;
    c.shear0 = m->mass * (m->disks ? 0.5 / (sqrt(PI) * m->diameter) : 5. / 16 / (sqrt(PI) * m->diameter * m->diameter));
    c.heat_ratio = d * (d + 2) / (2 * (d - 1));
    c.z = (d + 2) / (4 * d) * (1 - e * e) * (1 + 3. / 16 * a2);
    c.g = 32 * two * two / (PI * (d + 2)) * pairs * (1 - a2 / 16);
    c.of_bulk = d / (d + 2);
    c.s0 = 3 / (4 * d) * pairs * (1 - e + 2 * d / 3) * (1 - a2 / 32) - c.z / 2;
    c.s1 = two / (d + 2) * pairs * (1 - 3 * e);
    c.s2 = 2 * two / (d + 2) * pairs;
    const double heat_rate =
        pairs / d * ((d - 1) / 2 + 3. / 16 * (d + 8) * (1 - e) + (4 + 5 * d - 3 * (4 - d) * e) * a2 / 512);
    c.h0 = heat_rate - 2 * c.z;
    c.h1 = (d - 1) / d * (1 + 2 * a2);
    c.h2 = (d - 1) / d * (1.5 * two / (d + 2)) * pairs * pairs * (2 * e - 1 + pairs * a2);
    c.h3 = 3 * two / (d + 2) * pairs;
    c.h4 = 32 * two * two * (d - 1) / (PI * (d + 2) * (d + 2)) * pairs * (1 + 7 * a2 / 16);
    c.c0 = heat_rate - 1.5 * c.z;
    c.c1 = (d - 1) / d * a2;
    c.c2 = 3 * two * (d - 1) / (d * (d + 2)) * pairs * (e * (e - 1) + a2 / 6 * (10 + 2 * d - 3 * e + 3 * e * e));
    return c;
}

struct garzo_line { /* of a batch: nu, X and 1 + L at densities within the range, rho over these, and the Knudsen cut */
    double nu[BATCH], X[BATCH], steep[BATCH], share[BATCH], cut[BATCH];
};

/* Finds the state of a batch at which the coefficients are taken: below alpha_min and above EOS_PACKING of alpha_max
 * that at the end of the range, and `share` = rho/(rho there) multiplies them. The Knudsen cut nu/(nu + knudsen)
 * multiplies them, too: grains that cross a thin gas without a collision carry less momentum and heat than the law
 * says. Below alpha_min `share` also multiplies cross, which else would be constant there: heat rises against grad rho
 * because denser gas cools faster, and gas without impacts would get T ~ rho^-0.4 over all decades of rho. */
static void garzo_state(const struct garzo_dufty *own, const struct closure_line *cells, struct garzo_line *l) {
    const struct material *m = cells->material;
    const double *rho = cells->rho;
    const int n = cells->n;
    const double per = packing_per_density(m), low = larger(own->alpha_min / per, 1e-200);
    const double high = packed_density(m, own->end > 0 ? own->end : EOS_PACKING);
    double clipped[BATCH];
    for (int i = 0; i < n; i++) {
        clipped[i] = smaller(larger(rho[i], low), high);
        l->nu[i] = per * clipped[i];
        l->share[i] = rho[i] / clipped[i];
        l->cut[i] = per * rho[i] / (per * rho[i] + own->knudsen + 1e-300);
    }
    cells->eos->contact(m, n, clipped, l->X);
    cells->eos->slope(m, n, clipped, l->steep);
    for (int i = 0; i < n; i++) l->steep[i] /= l->X[i];
}

KERNEL static void garzo_viscosities(int n, const struct garzo_constants *c, const struct garzo_line *l,
                                     const double *restrict T, double *restrict bulk, double *restrict shear,
                                     double *restrict heat) {
    const struct garzo_constants k = *c;
    for (int i = 0; i < n; i++) {
        const double X = l->X[i], nu = l->nu[i], inverse = nu / X,
                     unit = l->share[i] * l->cut[i] * k.shear0 * sqrt(T[i]);
        const double g = k.g * nu * X, kinetic = (1 - k.s1 * X) * inverse / k.s0;
        bulk[i] = unit * g;
        shear[i] = unit * (kinetic * (1 + k.s2 * X) + k.of_bulk * g);
        const double of_heat = (k.h1 + k.h2 * X) * inverse / k.h0 * (1 + k.h3 * X) + k.h4 * nu * X;
        heat[i] = unit * k.heat_ratio * larger(of_heat, 0); /* it is below 0 for disks of e = 0 near packing */
    }
}

KERNEL static void garzo_crossing(int n, const struct garzo_constants *c, const struct garzo_line *l, double per,
                                  const double *restrict T, double *restrict cross) {
    const struct garzo_constants k = *c;
    for (int i = 0; i < n; i++) {
        const double X = l->X[i], inverse = l->nu[i] / X, steep = l->steep[i];
        const double kinetic = k.z * steep * (k.h1 + k.h2 * X) / k.h0 + k.c1 + k.c2 * X * (0.5 + 0.5 * steep);
        const double thin = smaller(l->share[i], 1);
        const double unit = thin * l->cut[i] * k.shear0 * k.heat_ratio * sqrt(T[i]) * T[i] * (per / l->nu[i]);
        cross[i] = unit * (kinetic * inverse / k.c0 * (1 + k.h3 * X));
    }
}

/* Computes the coefficients with a second Sonine coefficient a2. */
static void coefficients_of_sonine(double a2, const struct own_params *params, const struct closure_line *cells,
                                   double *restrict bulk, double *restrict shear, double *restrict heat) {
    const struct garzo_constants c = garzo_constants_of(cells->material, a2);
    struct garzo_dufty own;
    struct garzo_line l;
    memcpy(&own, params, sizeof own);
    garzo_state(&own, cells, &l);
    garzo_viscosities(cells->n, &c, &l, cells->T, bulk, shear, heat);
}

static void garzo_coefficients(const struct own_params *params, const struct closure_line *cells, double *restrict bulk,
                               double *restrict shear, double *restrict heat) {
    coefficients_of_sonine(second_sonine(cells->material), params, cells, bulk, shear, heat);
}

/* The transport of extended kinetic theory (Jenkins & Berzi 2010; docs/physics.md 4.9): Garzo & Dufty's with a2 = 0,
 * and no heat along grad rho. */
static void jenkins_berzi(const struct own_params *params, const struct closure_line *cells, double *restrict bulk,
                          double *restrict shear, double *restrict heat) {
    coefficients_of_sonine(0, params, cells, bulk, shear, heat);
}

static void garzo_cross(const struct own_params *params, const struct closure_line *cells, double *restrict cross) {
    const struct garzo_constants c = garzo_constants_of(cells->material, second_sonine(cells->material));
    struct garzo_dufty own;
    struct garzo_line l;
    memcpy(&own, params, sizeof own);
    garzo_state(&own, cells, &l);
    garzo_crossing(cells->n, &c, &l, packing_per_density(cells->material), cells->T, cross);
}

/* The cooling rate of a gas that is compressed depends on the divergence of the velocity (docs/physics.md 4.4): its
 * term zeta_U div u takes the heat rho T/(gamma - 1) zeta_U div u per volume and time. Most of zeta_U is geometry, the
 * rest the change of the fourth moment of the velocities (taken for a2 = 0). */
static void garzo_dilation(const struct own_params *params, const struct closure_line *cells,
                           double *restrict dilation) {
    const struct material *m = cells->material;
    const int n = cells->n;
    const double e = m->restitution, d = m->disks ? 2 : 3, two = m->disks ? 1 : 2, losses = 1 - e * e;
    const double z = (d + 2) / (4 * d) * losses;
    const double moment = (1 + e) * (56 * d + 73 - (105 + 24 * d) * e + 30 * e * e * (1 - e)) / (64 * d);
    const double fourth =
        z * 3 / 16 * (1.5 * two / (d + 2)) * (1 + e) * losses * (5 * e - 1) / (d * (moment - 1.5 * z));
    struct garzo_dufty own;
    memcpy(&own, params, sizeof own);
    const double per_contact = -3 * two / d * losses + (own.zeta_u == ZETA_FULL ? fourth : 0);
    const double high = packed_density(m, EOS_PACKING);
    double clipped[BATCH], X[BATCH];
    for (int i = 0; i < n; i++) clipped[i] = smaller(cells->rho[i], high);
    cells->eos->contact(m, n, clipped, X);
    for (int i = 0; i < n; i++) dilation[i] = per_contact * X[i] * cells->rho[i] * eps_of(m, cells->T[i]);
}

static struct transport_terms garzo_terms(const struct own_params *params) {
    struct garzo_dufty own;
    memcpy(&own, params, sizeof own);
    return (struct transport_terms){
        .cross = true, .dilation = own.zeta_u != ZETA_OFF, .diagonal = own.stress == 1, .thin = own.alpha_min};
}

static struct transport_terms jenkins_berzi_terms(const struct own_params *params) {
    struct garzo_dufty own;
    memcpy(&own, params, sizeof own);
    return (struct transport_terms){.diagonal = own.stress == 1, .thin = own.alpha_min};
}

#define PARAM_STRUCT struct garzo_dufty
static const char *const zeta_words[] = {"off", "geometric", "full", NULL};
static const char *const stress_words[] = {"full", "diagonal", NULL};
#define GARZO_RANGE                                                                                                    \
    NUMBER("alphaMin", alpha_min, 1e-4, FROM_TO(0, 0.1), NO_UNIT,                                                      \
           "packing fraction below which viscosity and conductivity fall with the density; 0: they do not"),           \
        NUMBER("knudsenCut", knudsen, 0, FROM_TO(0, 1), NO_UNIT,                                                       \
               "coefficients are multiplied by alpha/(alpha + knudsenCut); 0: they are not")
#define GARZO_STRESS                                                                                                   \
    CHOICE("stress", stress, 0, stress_words, "of all derivatives of u, or of those across faces alone (lattices)")
static const struct param garzo_param[] = {
    GARZO_RANGE,
    CHOICE("zetaU", zeta_u, ZETA_OFF, zeta_words, "change of the cooling rate with div u: geometric part, or all"),
    GARZO_STRESS,
};
static const struct param jenkins_berzi_param[] = {
    GARZO_RANGE,
    GARZO_STRESS,
    NUMBER("packingEnd", end, EOS_PACKING, BETWEEN(0.9, 1), NO_UNIT,
           "fraction of alphaMax above which coefficients go with the density; the closer to 1, the less flow at rest "
           "creeps, and the more it costs"),
};

const struct transport transport_table[] = {
    {MODEL_WITH("JenkinsRichman", "viscosities and heat conductivity of dense disks (Jenkins & Richman 1985)",
                jenkins_richman_param),
     .valid = GRAINS_DISKS, .coefficients = jenkins_richman},
    {MODEL_WITH("GarzoDufty", "viscosities and heat flux of dense inelastic disks or spheres (Garzo & Dufty 1999)",
                garzo_param),
     .valid = GRAINS_BOTH, .coefficients = garzo_coefficients, .terms = garzo_terms, .cross = garzo_cross,
     .dilation = garzo_dilation},
    {MODEL_WITH("JenkinsBerzi",
                "those of Garzo & Dufty without Sonine coefficient and heat along grad rho (Jenkins & Berzi 2010)",
                jenkins_berzi_param),
     .valid = GRAINS_BOTH, .coefficients = jenkins_berzi, .terms = jenkins_berzi_terms},
};
const int transport_count = sizeof transport_table / sizeof *transport_table;

const struct transport *transport_find(const char *name) {
    return model_find(transport_table, sizeof *transport_table, transport_count, name);
}
