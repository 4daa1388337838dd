/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The equations of state, each with its parameters and its row of the table, and the parameters of the grains. All have
 * the form of docs/physics.md 2.1, p = rho T A, c^2 = T [A + nu A' + (gamma - 1) A^2]. */
#include "libcore/models/eos.h"
#include "libcore/models/kernel.h"

#define PI 3.14159265358979323846

#define PARAM_STRUCT struct material
const struct param grain_param[] = {
    NUMBER("diameter", diameter, REQUIRED_AS("diameter 1e-3;"), FROM_TO(0, 1e30), UNIT(0, 1, 0), "grain diameter"),
    NUMBER("mass", mass, 1, BETWEEN(0, 1e30), UNIT(1, 0, 0), "grain mass; 1: rho counts grains"),
    NUMBER("restitution", restitution, 1, FROM_TO(0, 1), NO_UNIT,
           "normal restitution when two grains collide; 1: elastic. A wall has its own, in 0.orig: restitution of "
           "granularWall, restitutionCoefficient of JohnsonJacksonSlip"),
    NUMBER("thresholdSpeed", threshold, 0, FROM_TO(0, 1e30), UNIT(0, 1, -1),
           "impacts with a normal speed below it are elastic: cooling fades, nothing collapses; 0: none are"),
    NUMBER("friction", friction, 0, FROM_TO(0, 10), NO_UNIT,
           "Coulomb friction mu_p of contacts: impacts lose as with restitution e - 1.5 mu_p exp(-3 mu_p), and "
           "VescoviSpheres packs less; 0: smooth grains"),
};
const int grain_nparam = sizeof grain_param / sizeof *grain_param;

double packing_per_density(const struct material *m) {
    if (m->disks) return PI / 4 * m->diameter * m->diameter / m->mass;
    return PI / 6 * m->diameter * m->diameter * m->diameter / m->mass;
}

/* Returns the sink of the contact integrals (docs/physics.md 1.3) over (1 - e^2) rho T^(3/2) G/sigma. */
double cooling_factor(const struct material *m) {
    return (m->disks ? 4 : 12) / sqrt(PI);
}

/* Returns a2 of docs/physics.md 3.4, the second Sonine coefficient. */
double second_sonine(const struct material *m) {
    const double e = m->restitution, d = m->disks ? 2 : 3;
    return 16 * (1 - e) * (1 - 2 * e * e) / (9 + 24 * d - (41 - 8 * d) * e + 30 * e * e * (1 - e));
}

double effective_restitution(const struct material *m) {
    return larger(m->restitution - 1.5 * m->friction * exponential(-3 * m->friction), 0);
}

/* Densities below the limit may give nu = alpha_max once they are rounded. G follows its formula up to this fraction of
 * alpha_max, so that no pressure or speed of sound is infinite. */
#define LAST_DIGIT (1 - 0x1p-52)

double packing_limit(const struct eos *eos, const struct material *m) {
    return eos->bounded && !m->tangent ? m->alpha_max : HUGE_VAL;
}

double density_limit(const struct eos *eos, const struct material *m) {
    double k = packing_per_density(m);
    return k > 0 ? packing_limit(eos, m) / k : HUGE_VAL;
}

/* Goldshtein & Shapiro (1995), Serna & Marquina (1)-(8); docs/physics.md 2.2:
 *   x = (nu/nu_max)^(4 nu_max/3), G = nu/(1 - x), A = 1 + 2(1+e) G, p = rho T A
 *   nu G' = G (1 + a x/(1 - x)), c^2 = T [A + rho A' + (gamma - 1) A^2], rho A' = 2(1+e) nu G'
 * The A' that Serna & Marquina print lacks the factor 2 (docs/physics.md S1); `printed_sound` puts that A' into c
 * alone. */
struct gs { /* nu = k rho; 1/nu_max; the exponent of x */
    double k, inverse_max, a;
};
ALWAYS_INLINE struct gs gs_of(const struct material *m) {
    return (struct gs){packing_per_density(m), 1 / m->alpha_max, 4. / 3 * m->alpha_max};
}
/* Computes ln x in a loop of its own: a processor keeps some hundred operations in hand that wait for others, and the
 * chain from rho to p is longer than what these overlap. */
ALWAYS_INLINE void gs_logarithms(struct gs e, int n, const double *restrict rho, double *restrict log_x) {
    for (int i = 0; i < n; i++) /* 1e-200 allows nu = 0: x is then too small to matter */
        log_x[i] = e.a * logarithm(e.k * rho[i] * e.inverse_max + 1e-200);
}
ALWAYS_INLINE double gs_x(double log_x) {
    return smaller(exponential(log_x), LAST_DIGIT);
}

KERNEL static void gs_state(const struct material *m, int n, const double *restrict rho, const double *restrict eps,
                            double *restrict p, double *restrict c2, double *restrict gruneisen) {
    const struct gs e = gs_of(m);
    const double pairs = 2 * (1 + m->restitution), slope = m->printed_sound ? 0.5 : 1, g1 = m->gamma - 1;
    ALIGNED double log_x[BATCH];
    gs_logarithms(e, n, rho, log_x);
    for (int i = 0; i < n; i++) {
        double nu = e.k * rho[i], x = gs_x(log_x[i]), inverse = 1 / (1 - x);
        double G = nu * inverse, dense = pairs * G, A = 1 + dense, T = g1 * eps[i];
        double rho_dA = slope * dense * fma(e.a * x, inverse, 1);
        p[i] = rho[i] * T * A;
        c2[i] = T * fma(g1 * A, A, A + rho_dA);
        gruneisen[i] = g1 * A;
    }
}

KERNEL static void gs_contact(const struct material *m, int n, const double *restrict rho, double *restrict contact) {
    const struct gs e = gs_of(m);
    ALIGNED double log_x[BATCH];
    gs_logarithms(e, n, rho, log_x);
    for (int i = 0; i < n; i++) contact[i] = e.k * rho[i] / (1 - gs_x(log_x[i]));
}

KERNEL static void gs_slope(const struct material *m, int n, const double *restrict rho, double *restrict steep) {
    const struct gs e = gs_of(m);
    ALIGNED double log_x[BATCH];
    gs_logarithms(e, n, rho, log_x);
    for (int i = 0; i < n; i++) {
        double x = gs_x(log_x[i]), inverse = 1 / (1 - x);
        steep[i] = e.k * rho[i] * inverse * fma(e.a * x, inverse, 1);
    }
}

/* The perfect gas, the dilute limit (docs/physics.md 2.3): p = rho T, c^2 = gamma T, G = nu. */
KERNEL static void perfect_state(const struct material *m, int n, const double *restrict rho,
                                 const double *restrict eps, double *restrict p, double *restrict c2,
                                 double *restrict gruneisen) {
    const double g1 = m->gamma - 1;
    for (int i = 0; i < n; i++) {
        double T = g1 * eps[i];
        p[i] = rho[i] * T;
        c2[i] = m->gamma * T;
        gruneisen[i] = g1;
    }
}

KERNEL static void perfect_contact(const struct material *m, int n, const double *restrict rho,
                                   double *restrict contact) {
    const double k = packing_per_density(m);
    for (int i = 0; i < n; i++) contact[i] = k * rho[i];
}

/* Torquato's contact value chi for disks (d = 2) and spheres (d = 3), G = nu chi, A = 1 + 2^(d-2) (1+e) G
 * (docs/physics.md 2.4; with G = chi, as printed, thin gas would be wrong: docs/physics.md C1):
 *   chi = (1 - a nu)/(1 - nu)^d below freezing, a = 0.436 (disks), 1/2;  chi_f (nu_c - nu_f)/(nu_c - nu) above.
 * chi' jumps at nu_f, and with it the speed of sound. On nu_f -+ smoothing a quintic of t = (nu - nu_f)/(2 smoothing) +
 * 1/2 takes over value, slope and curvature of both branches. G diverges at nu_c, below which the gas stays (limit.h).
 * With `tangent` G goes on as its tangent above EOS_PACKING nu_c: no density is forbidden then, and a gas that cools
 * under its weight is pressed beyond nu_c, as its T falls below what a G without divergence needs to carry it. */
struct contact {
    double freezing, packed, dense; /* nu_f; nu_c; chi (nu_c - nu) of the dense branch */
    double last;                    /* nu where the tangent begins: without `tangent` at the last digit of nu_c */
    double smoothing, inverse;      /* half the joint; 1/(2 smoothing) */
    double c[6];                    /* coefficients of the quintic */
};

/* Returns chi below freezing; *slope = dchi/dnu. */
ALWAYS_INLINE double fluid_value(int d, double nu, double *slope) {
    const double a = d == 2 ? 0.436 : 0.5, inverse = 1 / (1 - nu), factor = 1 - a * nu;
    double power = d == 2 ? inverse * inverse : inverse * inverse * inverse;
    *slope = (d * factor * inverse - a) * power;
    return factor * power;
}
/* Returns d^2 chi/dnu^2 below freezing. */
ALWAYS_INLINE double fluid_curvature(int d, double nu) {
    const double a = d == 2 ? 0.436 : 0.5, inverse = 1 / (1 - nu);
    double power = d == 2 ? inverse * inverse : inverse * inverse * inverse;
    return d * ((d + 1) * (1 - a * nu) * inverse - 2 * a) * inverse * power;
}

ALWAYS_INLINE struct contact contact_make(int d, const struct material *m) {
    double slope, value = fluid_value(d, m->freezing, &slope), h = 2 * m->smoothing;
    struct contact t = {.freezing = m->freezing,
                        .packed = m->alpha_max,
                        .last = (m->tangent ? EOS_PACKING : LAST_DIGIT) * m->alpha_max,
                        .dense = value * (m->alpha_max - m->freezing),
                        .smoothing = m->smoothing};
    if (h == 0) return t;
    double width = t.packed - (t.freezing + m->smoothing), high = t.dense / width;
    t.inverse = 1 / h;
    t.c[0] = fluid_value(d, m->freezing - m->smoothing, &slope);
    t.c[1] = h * slope;
    t.c[2] = 0.5 * h * h * fluid_curvature(d, m->freezing - m->smoothing);
    double D0 = high - t.c[0] - t.c[1] - t.c[2], D1 = h * (high / width) - t.c[1] - 2 * t.c[2];
    double D2 = h * h * (2 * high / (width * width)) - 2 * t.c[2];
    t.c[3] = 10 * D0 - 4 * D1 + 0.5 * D2;
    t.c[4] = -15 * D0 + 7 * D1 - D2;
    t.c[5] = 6 * D0 - 3 * D1 + 0.5 * D2;
    return t;
}

/* Returns G; *steep = nu G'. */
ALWAYS_INLINE double contact_value(int d, const struct contact *t, double nu, double *steep) {
    double at = smaller(nu, t->last), slope[3], value = fluid_value(d, at, &slope[0]);
    double inverse = 1 / (t->packed - at), high = t->dense * inverse;
    double s = (at - t->freezing) * t->inverse + 0.5;
    const double *c = t->c;
    double joint = c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))));
    slope[1] = high * inverse;
    slope[2] = (c[1] + s * (2 * c[2] + s * (3 * c[3] + s * (4 * c[4] + s * (5 * c[5]))))) * t->inverse;
    const bool dense = at >= t->freezing, between = fabs(at - t->freezing) < t->smoothing;
    double chi = dense ? high : value, dchi = dense ? slope[1] : slope[0];
    chi = between ? joint : chi;
    dchi = between ? slope[2] : dchi;
    double gradient = chi + at * dchi;
    *steep = nu * gradient;
    return at * chi + gradient * (nu - at);
}

ALWAYS_INLINE void torquato_state(int d, const struct material *m, int n, const double *restrict rho,
                                  const double *restrict eps, double *restrict p, double *restrict c2,
                                  double *restrict gruneisen) {
    const struct contact t = contact_make(d, m);
    const double k = packing_per_density(m), pairs = (d - 1) * (1 + m->restitution), g1 = m->gamma - 1;
    for (int i = 0; i < n; i++) {
        double steep, G = contact_value(d, &t, k * rho[i], &steep), A = 1 + pairs * G, T = g1 * eps[i];
        p[i] = rho[i] * T * A;
        c2[i] = T * fma(g1 * A, A, A + pairs * steep);
        gruneisen[i] = g1 * A;
    }
}

ALWAYS_INLINE void torquato_contact(int d, const struct material *m, int n, const double *restrict rho,
                                    double *restrict contact) {
    const struct contact t = contact_make(d, m);
    const double k = packing_per_density(m);
    for (int i = 0; i < n; i++) {
        double steep;
        contact[i] = contact_value(d, &t, k * rho[i], &steep);
    }
}

ALWAYS_INLINE void torquato_slope(int d, const struct material *m, int n, const double *restrict rho,
                                  double *restrict steep) {
    const struct contact t = contact_make(d, m);
    const double k = packing_per_density(m);
    for (int i = 0; i < n; i++) (void)contact_value(d, &t, k * rho[i], &steep[i]);
}

KERNEL static void disks_state(const struct material *m, int n, const double *restrict rho, const double *restrict eps,
                               double *restrict p, double *restrict c2, double *restrict gruneisen) {
    torquato_state(2, m, n, rho, eps, p, c2, gruneisen);
}
KERNEL static void disks_contact(const struct material *m, int n, const double *restrict rho,
                                 double *restrict contact) {
    torquato_contact(2, m, n, rho, contact);
}
KERNEL static void disks_slope(const struct material *m, int n, const double *restrict rho, double *restrict steep) {
    torquato_slope(2, m, n, rho, steep);
}
KERNEL static void spheres_state(const struct material *m, int n, const double *restrict rho,
                                 const double *restrict eps, double *restrict p, double *restrict c2,
                                 double *restrict gruneisen) {
    torquato_state(3, m, n, rho, eps, p, c2, gruneisen);
}
KERNEL static void spheres_contact(const struct material *m, int n, const double *restrict rho,
                                   double *restrict contact) {
    torquato_contact(3, m, n, rho, contact);
}

KERNEL static void spheres_slope(const struct material *m, int n, const double *restrict rho, double *restrict steep) {
    torquato_slope(3, m, n, rho, steep);
}

/* Vescovi, Berzi, Richard & Brodu (2014), fitted to sheared grains (docs/physics.md 2.6):
 *   chi = (1 - g) (1 - nu/2)/(1 - nu)^3 + g 2/(nu_s - nu),  g = ((nu - 0.4)/(nu_s - 0.4))^2 above nu 0.4, else 0.
 * chi' is continuous. nu_s = alpha_max is the packing at which sheared grains jam, and depends on their friction. */
#define VESCOVI_FROM 0.4

/* Returns G; *steep = nu G'. */
ALWAYS_INLINE double vescovi_value(double packed, double nu, double *steep) {
    const double per = 1 / (packed - VESCOVI_FROM), at = smaller(nu, packed * LAST_DIGIT);
    double slope, thin = fluid_value(3, at, &slope), inverse = 1 / (packed - at);
    double w = larger(at - VESCOVI_FROM, 0) * per, more = 2 * inverse - thin;
    double gradient = thin + w * w * more + at * (slope + 2 * w * per * more + w * w * (2 * inverse * inverse - slope));
    *steep = nu * gradient;
    return at * (thin + w * w * more) + gradient * (nu - at);
}

KERNEL static void vescovi_state(const struct material *m, int n, const double *restrict rho,
                                 const double *restrict eps, double *restrict p, double *restrict c2,
                                 double *restrict gruneisen) {
    const double k = packing_per_density(m), packed = m->alpha_max, pairs = 2 * (1 + m->restitution), g1 = m->gamma - 1;
    for (int i = 0; i < n; i++) {
        double steep, A = 1 + pairs * vescovi_value(packed, k * rho[i], &steep), T = g1 * eps[i];
        p[i] = rho[i] * T * A;
        c2[i] = T * fma(g1 * A, A, A + pairs * steep);
        gruneisen[i] = g1 * A;
    }
}

KERNEL static void vescovi_contact(const struct material *m, int n, const double *restrict rho,
                                   double *restrict contact) {
    const double k = packing_per_density(m), packed = m->alpha_max;
    for (int i = 0; i < n; i++) {
        double steep;
        contact[i] = vescovi_value(packed, k * rho[i], &steep);
    }
}

KERNEL static void vescovi_slope(const struct material *m, int n, const double *restrict rho, double *restrict steep) {
    const double k = packing_per_density(m), packed = m->alpha_max;
    for (int i = 0; i < n; i++) (void)vescovi_value(packed, k * rho[i], &steep[i]);
}

/* Returns nu_s of frictional grains, linear between the values of Chialvo, Sun & Sundaresan (2012). */
static double vescovi_packing(double friction) {
    static const double table[][2] = {{0, 0.636}, {0.1, 0.613}, {0.3, 0.587}, {0.5, 0.581}, {1, 0.573}};
    enum { LAST = sizeof table / sizeof *table - 1 };
    int i = 0;
    while (i < LAST - 1 && friction > table[i + 1][0]) i++;
    const double share = (friction - table[i][0]) / (table[i + 1][0] - table[i][0]);
    return table[i][1] + smaller(share, 1) * (table[i + 1][1] - table[i][1]);
}

static const struct param gs_param[] = {
    NUMBER("gamma", gamma, 5. / 3, BETWEEN(1, 3), NO_UNIT, "ratio of specific heats of the dilute elastic gas"),
    NUMBER("alphaMax", alpha_max, 0.65, BETWEEN(0, 1), NO_UNIT, "packing fraction at which the pressure diverges"),
    SWITCH("printedSoundSpeed", printed_sound, false, "sound speed with the misprinted A' of Serna & Marquina"),
};
#define JAMMED FROM_TO(0, 0.7), .example = "alphaMax 0.636;"
static const struct param vescovi_param[] = {
    NUMBER("gamma", gamma, 5. / 3, BETWEEN(1, 3), NO_UNIT, "ratio of specific heats of the dilute elastic gas"),
    NUMBER(
        "alphaMax", alpha_max, USUALLY(0, "by grain.friction"), JAMMED, NO_UNIT,
        "packing at which sheared grains jam and the pressure diverges, 0.5 to 0.7; 0: that of grain.friction, 0.636, "
        "0.613, 0.587, 0.581, 0.573 at 0, 0.1, 0.3, 0.5, 1"),
};
static const struct param perfect_param[] = {
    NUMBER("gamma", gamma, 5. / 3, BETWEEN(1, 3), NO_UNIT, "ratio of specific heats"),
};

#define TORQUATO_PARAM(least_heats, packed, freezes)                                                                   \
    NUMBER("gamma", gamma, least_heats, BETWEEN(1, 3), NO_UNIT, "ratio of specific heats of the dilute elastic gas"),  \
        NUMBER("alphaMax", alpha_max, packed, BETWEEN(0, 1), NO_UNIT,                                                  \
               "packing fraction at which the pressure diverges"),                                                     \
        NUMBER("alphaFreezing", freezing, freezes, BETWEEN(0, 1), NO_UNIT,                                             \
               "packing fraction where the two branches of the contact value meet"),                                   \
        NUMBER("smoothing", smoothing, 0.01, FROM_TO(0, 0.5), NO_UNIT,                                                 \
               "the branches are joined smoothly within so much of alphaFreezing; 0: a kink"),                         \
        SWITCH("tangent", tangent, false,                                                                              \
               "G goes on linearly above 0.9999 alphaMax: fewer steps in cold beds, but nothing keeps alpha below "    \
               "alphaMax")
static const struct param disks_param[] = {TORQUATO_PARAM(2, 0.82, 0.69)},
                          spheres_param[] = {TORQUATO_PARAM(5. / 3, 0.64, 0.49)};

/* Does G rise with density in the joint? Its quintic overshoots where it ends so close to alpha_max that G is steep
 * there: then the square of the speed of sound would be negative. */
static bool joint_rises(const struct eos *eos, const struct material *m) {
    enum { PLACES = 256 };
    struct material one = *m; /* its grains are of size and mass 1, as G depends on nu alone */
    one.diameter = one.mass = 1;
    const double per = packing_per_density(&one), low = m->freezing - m->smoothing;
    for (int i = 0; i <= PLACES; i++) {
        double rho = (low + 2 * m->smoothing * i / PLACES) / per, steep;
        eos->slope(&one, 1, &rho, &steep);
        if (!(steep > 0)) return false;
    }
    return true;
}

const char *eos_objection(const struct eos *eos, const struct material *m) {
    if (eos->packing && m->alpha_max < 0.5)
        return "alphaMax of sheared spheres lies from 0.5 to 0.7; 0: by grain.friction";
    if (eos->model.param != disks_param && eos->model.param != spheres_param) return NULL;
    if (m->freezing - m->smoothing <= 0 || m->freezing + m->smoothing >= EOS_PACKING * m->alpha_max)
        return "0 < alphaFreezing - smoothing and alphaFreezing + smoothing < 0.9999 alphaMax are needed";
    if (!joint_rises(eos, m)) return "the contact value falls on the way up to alphaMax: a smaller smoothing is needed";
    return NULL;
}

const struct eos eos_table[] = {
    {MODEL_WITH("GoldshteinShapiro", "dense spheres up to close packing (Goldshtein & Shapiro 1995)", gs_param),
     .bounded = true, .state = gs_state, .contact = gs_contact, .slope = gs_slope},
    {MODEL_WITH("perfectGas", "the dilute limit, p = rho T", perfect_param), .state = perfect_state,
     .contact = perfect_contact, .slope = perfect_contact},
    {MODEL_WITH("TorquatoDisks", "dense disks, Torquato's contact value (Carrillo, Poeschel & Saluena 2008)",
                disks_param),
     .bounded = true, .disks = true, .state = disks_state, .contact = disks_contact, .slope = disks_slope},
    {MODEL_WITH("TorquatoSpheres", "dense spheres, Torquato's contact value (1995)", spheres_param), .bounded = true,
     .state = spheres_state, .contact = spheres_contact, .slope = spheres_slope},
    {MODEL_WITH("VescoviSpheres", "dense sheared spheres, also with friction (Vescovi, Berzi, Richard & Brodu 2014)",
                vescovi_param),
     .bounded = true, .state = vescovi_state, .contact = vescovi_contact, .slope = vescovi_slope,
     .packing = vescovi_packing},
};
const int eos_count = sizeof eos_table / sizeof *eos_table;

const struct eos *eos_find(const char *name) {
    return model_find(eos_table, sizeof *eos_table, eos_count, name);
}

void pressure_per_temperature(const struct eos *eos, const struct material *m, int n, const double *rho, double *out) {
    double eps[BATCH], c2[BATCH], gruneisen[BATCH];
    for (int i = 0; i < BATCH; i++) eps[i] = eps_of(m, 1);
    for (int i = 0; i < n; i += BATCH)
        eos->state(m, n - i < BATCH ? n - i : BATCH, rho + i, eps, out + i, c2, gruneisen);
}

void eos_unit_state(const struct eos *eos, const struct material *m, int n, const double *rho, double *p, double *c2,
                    double *gruneisen) {
    double one[BATCH];
    for (int i = 0; i < n; i++) one[i] = 1;
    eos->state(m, n, rho, one, p, c2, gruneisen);
}
