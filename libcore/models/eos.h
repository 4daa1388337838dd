/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Equations of state of granular gases: a table of batch functions of (rho, eps). Their formulas stand in eos.c alone.
 *
 * All are linear in the granular temperature, p = rho T A(nu), with T = (gamma - 1) eps per unit mass and the packing
 * fraction nu = pi rho sigma^3 / (6 m) for spheres, nu = pi rho sigma^2 / (4 m) for disks (rho is then per area).
 * Symbols: docs/physics.md 1.1; what all equations of state share: docs/physics.md 2.1. */
#ifndef LIBCORE_EOS_H
#define LIBCORE_EOS_H

#include "libcore/models/param.h"

/* m^2/s^2: the least T that coefficients and walls see. Round-off may leave a cell without T, and a wall may take all
 * of it; nothing is then divided by 0. */
#define COLDEST     1e-200
#define EOS_PACKING 0.9999 /* fraction of alpha_max at which the coefficients of transport are taken at most */

struct material {       /* parameters of the grains and of the equation of state; filled through the tables below */
    double diameter;    /* sigma, m */
    double mass;        /* m, kg: mass of a grain (1: rho is a number density) */
    double restitution; /* e: coefficient of normal restitution */
    /* v_c, m/s: normal impacts slower than this are elastic; 0: none are (libcore/models/cooling.h) */
    double threshold;
    double friction;    /* mu_p: Coulomb friction of contacts; 0: smooth grains */
    double gamma;       /* ratio of specific heats of the dilute elastic gas: 5/3 spheres, 2 disks */
    double alpha_max;   /* packing fraction at which the pressure diverges, or would without the tangent */
    bool tangent;       /* does Torquato's G go on as its tangent from EOS_PACKING of alpha_max on, without a bound? */
    bool printed_sound; /* is c that of the A' that Serna & Marquina print, half of dA/drho (docs/physics.md S1)? */
    bool disks;         /* are the grains disks, not spheres? Given by the equation of state */
    double freezing;    /* nu_f: packing fraction at which Torquato's two branches meet */
    double smoothing;   /* the branches are joined smoothly from nu_f - smoothing to nu_f + smoothing */
};

struct eos {
    struct model model; /* its parameters fill members of struct material */
    bool bounded;       /* must nu stay below alpha_max? (Unless material.tangent says otherwise) */
    bool disks;         /* are its grains disks, not spheres? Copied to material.disks */
    /* Computes p, c2 = squared sound speed and gruneisen = p_eps / rho of n <= BATCH states (rho > 0, eps > 0, nu below
     * alpha_max). */
    void (*state)(const struct material *m, int n, const double *restrict rho, const double *restrict eps,
                  double *restrict p, double *restrict c2, double *restrict gruneisen);
    /* Computes contact = G(nu) = nu chi(nu), the factor of the collision rate that depends on density. */
    void (*contact)(const struct material *m, int n, const double *restrict rho, double *restrict contact);
    /* Computes steep = nu G'(nu). */
    void (*slope)(const struct material *m, int n, const double *restrict rho, double *restrict steep);
    /* Returns alpha_max of grains with a friction, for cases that leave it at 0. NULL: they give it, or the row. */
    double (*packing)(double friction);
};

/* Granular temperature of an internal energy per unit mass, T = (gamma - 1) eps, and the energy of a temperature. As
 * both are linear they also take changes of eps or T. */
static inline double temperature_of(const struct material *m, double eps) {
    return (m->gamma - 1) * eps;
}
static inline double eps_of(const struct material *m, double T) {
    return T / (m->gamma - 1);
}

extern const struct eos eos_table[];
extern const int eos_count;
const struct eos *eos_find(const char *name); /* NULL: there is no such row */

extern const struct param grain_param[]; /* the dictionary `grain` */
extern const int grain_nparam;

/* Returns what is wrong with the row's parameters together, which the ranges of their table cannot tell; NULL:
 * nothing. */
const char *eos_objection(const struct eos *eos, const struct material *m);

double packing_per_density(const struct material *m); /* nu / rho in m^3/kg, for disks m^2/kg */
/* Returns K of the cooling rate K (1 - e^2) rho T^(3/2) G / sigma per volume, for disks per area: 12/sqrt pi, for disks
 * 4/sqrt pi (the contact integrals of docs/physics.md 1.3). */
double cooling_factor(const struct material *m);
/* Returns the second Sonine coefficient of the velocities of cooling grains in d dimensions (docs/physics.md 3.4; van
 * Noije & Ernst 1998),
 *   a2 = 16 (1 - e)(1 - 2 e^2)/[9 + 24 d - (41 - 8 d) e + 30 e^2 (1 - e)]: 0 if they are elastic. */
double second_sonine(const struct material *m);
/* Returns the normal restitution whose smooth grains lose as much in an impact as these grains, which rub, too
 * (docs/physics.md 3.7; Chialvo & Sundaresan 2013): e - (3/2) mu_p exp(-3 mu_p), at least 0. */
double effective_restitution(const struct material *m);
/* Return the packing fraction, and the density, below which a gas must stay: alpha_max and rho there, or HUGE_VAL if
 * the equation of state has no limit. */
double packing_limit(const struct eos *eos, const struct material *m);
double density_limit(const struct eos *eos, const struct material *m);

/* ---- p is linear in T ----
 *
 * The functions below, and follow_pressure in boundary.c with p_T = p/T, are what relies on p = rho T A(nu): an
 * equation of state whose p is another function of T has these places to change. */

/* Computes p / T, which depends on rho alone, for rho[n] with any n. */
void pressure_per_temperature(const struct eos *eos, const struct material *m, int n, const double *rho, double *out);
/* Computes the state of n <= BATCH densities at eps = 1: p and c2 are proportional to eps, gruneisen has no eps. */
void eos_unit_state(const struct eos *eos, const struct material *m, int n, const double *rho, double *p, double *c2,
                    double *gruneisen);
/* Returns the eps at which the pressure is p, if it is `plain` at eps and the same rho. */
static inline double eps_at_pressure(double p, double plain, double eps) {
    return eps * (p / plain);
}
/* The same with the Grueneisen coefficient of rho. */
static inline double eps_of_pressure(double p, double rho, double gruneisen) {
    return p / (rho * gruneisen);
}
/* Returns eps + p/rho. */
static inline double enthalpy_of(double eps, double gruneisen) {
    return fma(gruneisen, eps, eps);
}
/* Returns rho dGamma/drho of the Grueneisen coefficient Gamma, from c2 at eps = 1. */
static inline double gruneisen_slope(double unit_c2, double gruneisen) {
    return unit_c2 - gruneisen - gruneisen * gruneisen;
}

#endif
