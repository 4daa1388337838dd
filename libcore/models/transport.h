/* Viscosities and heat conductivity of granular gases: a table of batch functions.
 *
 * Stress tau = (bulk - 2/d shear) tr(E) I + 2 shear E with E the symmetric gradient of u, d = 2 for disks and 3 for
 * spheres; heat flux q = -heat grad T, T per unit mass. */
#ifndef LIBCORE_TRANSPORT_H
#define LIBCORE_TRANSPORT_H

#include "libcore/models/eos.h"

struct transport_numbers {
    double alpha_min;   /* packing fraction below which G no longer falls in the coefficients */
    double bulk_factor; /* of the bulk viscosity: 1, or 2 as printed (erratum C2) */
};

struct transport {
    const char *name, *about;
    const struct param *param; /* of struct transport_numbers */
    int nparam;
    bool disks; /* what material.disks must be */
    /* kg/(m s), of disks kg/s, for n <= BATCH states (rho > 0, T > 0) */
    void (*coefficients)(const struct transport_numbers *t, const struct eos *eos, const struct material *m, int n,
                         const double *restrict rho, const double *restrict T, double *restrict bulk,
                         double *restrict shear, double *restrict heat);
};

/* 2/d, the share of the shear viscosity in the trace of the stress */
static inline double trace_share(const struct material *m) {
    return m->disks ? 1 : 2. / 3;
}

extern const struct transport transport_table[];
extern const int transport_count;
const struct transport *transport_find(const char *name); /* NULL: none, an inviscid gas, too */

#endif
