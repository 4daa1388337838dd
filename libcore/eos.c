#include "libcore/eos.h"
#include "libcore/kernel.h"

#define PI 3.14159265358979323846

const struct param grain_param[] = {
    {"diameter", PARAM_NUMBER, offsetof(struct material, diameter), NAN, 0, 1e30, false, {0, 1, 0}, "grain diameter"},
    {"mass",
     PARAM_NUMBER,
     offsetof(struct material, mass),
     1,
     0,
     1e30,
     true,
     {1, 0, 0},
     "grain mass; 1: rho counts grains"},
    {"restitution",
     PARAM_NUMBER,
     offsetof(struct material, restitution),
     1,
     0,
     1,
     false,
     {0, 0, 0},
     "normal restitution of a collision; 1: elastic"},
    {"thresholdSpeed",
     PARAM_NUMBER,
     offsetof(struct material, threshold),
     0,
     0,
     1e30,
     false,
     {0, 1, -1},
     "impacts with a normal speed below it are elastic: cooling fades, nothing collapses; 0: none are"},
};
const int grain_nparam = sizeof grain_param / sizeof *grain_param;

double packing_per_density(const struct material *m) {
    return PI / 6 * m->diameter * m->diameter * m->diameter / m->mass;
}

double density_limit(const struct eos *eos, const struct material *m) {
    double k = packing_per_density(m);
    return eos->bounded && k > 0 ? m->alpha_max / k : HUGE_VAL;
}

/* Goldshtein & Shapiro (1995), Serna & Marquina (1)-(8):
 *   x = (nu/nu_max)^(4 nu_max/3), G = nu/(1 - x), A = 1 + 2(1+e) G, p = rho T A
 *   nu G' = G (1 + a x/(1 - x)), c^2 = T [A + rho A' + (gamma - 1) A^2], rho A' = 2(1+e) nu G'
 * Their printed A' lacks the factor 2 (physics S1); `printed_sound` reproduces it in c alone. */
static inline double gs_x(double nu, double inverse_max, double a) {
    return power(nu * inverse_max + 1e-200, a); /* nu = 0 is allowed: x is then too small to matter */
}

KERNEL static void gs_state(const struct material *m, int n, const double *restrict rho, const double *restrict eps,
                            double *restrict p, double *restrict c2, double *restrict gruneisen) {
    const double k = packing_per_density(m), inverse_max = 1 / m->alpha_max, a = 4. / 3 * m->alpha_max;
    const double pairs = 2 * (1 + m->restitution), slope = m->printed_sound ? 0.5 : 1, g1 = m->gamma - 1;
    for (int i = 0; i < n; i++) {
        double nu = k * rho[i], x = gs_x(nu, inverse_max, a), inverse = 1 / (1 - x);
        double G = nu * inverse, dense = pairs * G, A = 1 + dense, T = g1 * eps[i];
        double rho_dA = slope * dense * fma(a * x, inverse, 1);
        p[i] = rho[i] * T * A;
        c2[i] = T * fma(g1 * A, A, A + rho_dA);
        gruneisen[i] = g1 * A;
    }
}

KERNEL static void gs_contact(const struct material *m, int n, const double *restrict rho, double *restrict contact) {
    const double k = packing_per_density(m), inverse_max = 1 / m->alpha_max, a = 4. / 3 * m->alpha_max;
    for (int i = 0; i < n; i++) {
        double nu = k * rho[i];
        contact[i] = nu / (1 - gs_x(nu, inverse_max, a));
    }
}

/* The dilute limit: p = rho T, c^2 = gamma T, G = nu. */
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

static const struct param gs_param[] = {
    {"gamma",
     PARAM_NUMBER,
     offsetof(struct material, gamma),
     5. / 3,
     1,
     3,
     true,
     {0, 0, 0},
     "ratio of specific heats of the dilute elastic gas"},
    {"alphaMax",
     PARAM_NUMBER,
     offsetof(struct material, alpha_max),
     0.65,
     0,
     1,
     true,
     {0, 0, 0},
     "packing fraction at which the pressure diverges"},
    {"printedSoundSpeed",
     PARAM_SWITCH,
     offsetof(struct material, printed_sound),
     0,
     0,
     1,
     false,
     {0, 0, 0},
     "sound speed with the misprinted A' of Serna & Marquina"},
};
static const struct param perfect_param[] = {
    {"gamma", PARAM_NUMBER, offsetof(struct material, gamma), 5. / 3, 1, 3, true, {0, 0, 0}, "ratio of specific heats"},
};

#define ROWS(table) table, sizeof table / sizeof *table
const struct eos eos_table[] = {
    {"GoldshteinShapiro", "dense spheres up to close packing (Goldshtein & Shapiro 1995)", ROWS(gs_param), true,
     gs_state, gs_contact},
    {"perfectGas", "the dilute limit, p = rho T", ROWS(perfect_param), false, perfect_state, perfect_contact},
};
const int eos_count = sizeof eos_table / sizeof *eos_table;

const struct eos *eos_find(const char *name) {
    for (int i = 0; i < eos_count; i++)
        if (!strcmp(name, eos_table[i].name)) return &eos_table[i];
    return NULL;
}
