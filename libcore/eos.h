/* Equations of state of granular gases: a table of batch functions of (rho, eps). No other file holds a formula of one.
 *
 * All are linear in the granular temperature, p = rho T A(nu), with T = (gamma - 1) eps per unit mass and
 * nu = pi rho sigma^3 / (6 m) the packing fraction (spheres). */
#ifndef LIBCORE_EOS_H
#define LIBCORE_EOS_H

#include "libcore/param.h"

struct material {       /* parameters of the grains and of the equation of state; filled through the tables below */
    double diameter;    /* sigma, m */
    double mass;        /* of a grain, kg (1: rho is a number density) */
    double restitution; /* e, normal */
    double threshold;   /* v_c, m/s: normal impacts slower than this are elastic; 0: none are (libcore/source.h) */
    double gamma;       /* ratio of specific heats of the dilute elastic gas: 5/3 spheres, 2 disks */
    double alpha_max;   /* packing fraction at which the pressure diverges */
    bool printed_sound; /* the sound speed with Serna & Marquina's printed A' (half of dA/drho; erratum S1) */
};

struct eos {
    const char *name, *about;
    const struct param *param; /* of struct material, in the model's own dictionary */
    int nparam;
    bool bounded; /* needs nu < alpha_max */
    /* p, c2 = squared sound speed, gruneisen = p_eps / rho, for n states (rho > 0, eps > 0, nu < alpha_max) */
    void (*state)(const struct material *m, int n, const double *restrict rho, const double *restrict eps,
                  double *restrict p, double *restrict c2, double *restrict gruneisen);
    /* contact = G(nu) = nu chi(nu), the collision rate's density factor */
    void (*contact)(const struct material *m, int n, const double *restrict rho, double *restrict contact);
};

extern const struct eos eos_table[];
extern const int eos_count;
const struct eos *eos_find(const char *name); /* NULL: none */

extern const struct param grain_param[]; /* the dictionary `grain` */
extern const int grain_nparam;

double packing_per_density(const struct material *m);                  /* nu / rho, m^3/kg */
double density_limit(const struct eos *eos, const struct material *m); /* rho at alpha_max; HUGE_VAL: none */

#endif
