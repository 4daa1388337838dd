/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscosities and heat conductivity of granular gases: a table of batch functions.
 *
 * Stress tau = (bulk - 2/d shear) tr(E) I + 2 shear E with E the symmetric gradient of u, d = 2 for disks and 3 for
 * spheres; heat flux q = -heat grad T - cross grad rho, T per unit mass; and of inelastic grains the heat per volume
 * and time dilation div u, which the gas loses besides the work p div u of its pressure (docs/physics.md 4.1). */
#ifndef LIBCORE_TRANSPORT_H
#define LIBCORE_TRANSPORT_H

#include "libcore/models/closure.h"

struct transport_terms {  /* terms of a law besides stress and q = -heat grad T */
    bool cross, dilation; /* has the law these coefficients? */
    bool diagonal;        /* is the stress on a face made by derivatives across it alone? On lattices only */
    double thin;          /* packing fraction below which the coefficients fall with the density; 0: they do not */
};

struct transport {
    struct model model;      /* its parameters fill a struct of the law's own */
    enum grains_shape valid; /* the grains that the law is for */
    unsigned needs;          /* bits NEEDS_.. of closure.h */
    /* Computes the coefficients (kg/(m s), for disks kg/s) of a line of cells. params: values of the row's
     * parameters. */
    void (*coefficients)(const struct own_params *params, const struct closure_line *cells, double *restrict bulk,
                         double *restrict shear, double *restrict heat);
    /* Returns the terms that the law has with these parameters, besides stress and q = -heat grad T; NULL: none. */
    struct transport_terms (*terms)(const struct own_params *params);
    /* Compute cross (m^4/s^3, for disks m^3/s^3) and dilation (Pa, for disks N/m), as coefficients. NULL: terms never
     * asks for them. */
    void (*cross)(const struct own_params *params, const struct closure_line *cells, double *restrict cross);
    void (*dilation)(const struct own_params *params, const struct closure_line *cells, double *restrict dilation);
};

/* Returns the terms of a law; without a law there are none. */
static inline struct transport_terms transport_terms(const struct transport *t, const struct own_params *params) {
    return t && t->terms ? t->terms(params) : (struct transport_terms){false, false, false, 0};
}

/* Returns 2/d, the share of the shear viscosity in the trace of the stress. */
static inline double trace_share(const struct material *m) {
    return m->disks ? 1 : 2. / 3;
}

extern const struct transport transport_table[];
extern const int transport_count;
const struct transport *transport_find(const char *name); /* NULL: there is no such law */

#endif
