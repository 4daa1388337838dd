/* Equations of state of granular gases: a table of batch functions of (rho, eps). No other file holds a formula of one.
 *
 * All are linear in the granular temperature, p = rho T A(nu), with T = (gamma - 1) eps per unit mass and the packing
 * fraction nu = pi rho sigma^3 / (6 m) of spheres, nu = pi rho sigma^2 / (4 m) of disks (rho is then per area). */
#ifndef LIBCORE_EOS_H
#define LIBCORE_EOS_H

#include "libcore/models/param.h"

#define EOS_PACKING 0.9999 /* of alpha_max: where Torquato's G goes on as its tangent */

struct material {       /* parameters of the grains and of the equation of state; filled through the tables below */
    double diameter;    /* sigma, m */
    double mass;        /* of a grain, kg (1: rho is a number density) */
    double restitution; /* e, normal */
    double threshold; /* v_c, m/s: normal impacts slower than this are elastic; 0: none are (libcore/models/source.h) */
    double gamma;     /* ratio of specific heats of the dilute elastic gas: 5/3 spheres, 2 disks */
    double alpha_max; /* packing fraction at which the pressure diverges, or would */
    bool printed_sound; /* the sound speed with Serna & Marquina's printed A' (half of dA/drho; erratum S1) */
    bool disks;         /* of the equation of state: grains are disks, not spheres */
    double freezing;    /* nu_f at which Torquato's two branches meet */
    double smoothing;   /* they are joined smoothly from nu_f - smoothing to nu_f + smoothing */
};

struct eos {
    struct model model; /* its parameters: members of struct material */
    bool bounded;       /* needs nu < alpha_max */
    bool disks;         /* what material.disks must be */
    /* p, c2 = squared sound speed, gruneisen = p_eps / rho, for n states (rho > 0, eps > 0, nu < alpha_max) */
    void (*state)(const struct material *m, int n, const double *restrict rho, const double *restrict eps,
                  double *restrict p, double *restrict c2, double *restrict gruneisen);
    /* contact = G(nu) = nu chi(nu), the collision rate's density factor */
    void (*contact)(const struct material *m, int n, const double *restrict rho, double *restrict contact);
};

/* Granular temperature of an internal energy per unit mass, T = (gamma - 1) eps, and the energy of a temperature. As
 * both are linear they also take what changes T or eps. */
static inline double temperature_of(const struct material *m, double eps) {
    return (m->gamma - 1) * eps;
}
static inline double eps_of(const struct material *m, double T) {
    return T / (m->gamma - 1);
}

extern const struct eos eos_table[];
extern const int eos_count;
const struct eos *eos_find(const char *name); /* NULL: none */

extern const struct param grain_param[]; /* the dictionary `grain` */
extern const int grain_nparam;

/* What is wrong with the row's parameters together, which the ranges of their table cannot tell; NULL: nothing. */
const char *eos_objection(const struct eos *eos, const struct material *m);

double packing_per_density(const struct material *m); /* nu / rho, m^3/kg; m^2/kg for disks */
/* K of the cooling rate K (1 - e^2) rho T^(3/2) G / sigma per volume, of disks per area: 12/sqrt pi, of disks 4/sqrt pi
 */
double cooling_factor(const struct material *m);
double density_limit(const struct eos *eos, const struct material *m); /* rho at alpha_max; HUGE_VAL: none */

/* p / T of a gas of density rho[n]: the equations of state are linear in T. */
void pressure_per_temperature(const struct eos *eos, const struct material *m, int n, const double *rho, double *out);

#endif
