/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Smooth fields in the unit box, periodic along every axis, and what the Navier-Stokes equations of a granular gas make
 * of them, by their definition. Every term is there: pressure and convection; bulk, shear, heat and, if the law asks
 * for them, cross and dilation (libcore/models/transport.h), with coefficients that vary in space, derivatives across,
 * the work of the stress; cooling, gravity. Derivatives by differences of the fourth order (1e-9 of the largest):
 * nothing here knows a mesh or a scheme, so both engines are held to the same.
 *
 * A mesh's own operator is tested by its rates in a cell against manufactured_rates at the cell's centre: the
 * difference must fall at second order. */
#ifndef TESTS_MANUFACTURED_H
#define TESTS_MANUFACTURED_H

#include "libcore/gas/gas.h"

#define TWO_PI 6.283185307179586

/* rho between 0.9 and 2.1: with grains of diameter 0.5 disks are packed to 0.18 .. 0.41. Sines of sums come from those
 * of the three angles: they are most of what these tests cost. */
static inline void manufactured_fields(const double x[3], double *rho, double u[3], double *T) {
    const double a = TWO_PI * x[0], b = TWO_PI * x[1], c = TWO_PI * x[2];
    const double sa = sin(a), ca = cos(a), sb = sin(b), cb = cos(b), sc = sin(c), cc = cos(c);
    *rho = 1.5 + 0.4 * (sa * cos(0.3) + ca * sin(0.3)) * cb + 0.2 * (sc * cb + cc * sb);
    *T = 3 + sa * (cb * cos(0.7) - sb * sin(0.7)) + 0.5 * sc;
    u[0] = (sa * cos(0.2) + ca * sin(0.2)) * cb + 0.6 * (cc * ca - sc * sa);
    u[1] = 0.8 * ca * (sb * cos(0.5) + cb * sin(0.5)) + 0.3 * sc;
    u[2] = 0.5 * ((sa * cb + ca * sb) * cc + (ca * cb - sa * sb) * sc);
}

/* A law for any grains, in which each coefficient depends on rho and T in a way of its own. */
static inline void manufactured_law(const struct own_params *params, const struct closure_line *cells,
                                    double *restrict bulk, double *restrict shear, double *restrict heat) {
    const double *rho = cells->rho, *T = cells->T;
    (void)params;
    for (int i = 0; i < cells->n; i++) {
        bulk[i] = 0.4 * rho[i] * T[i];
        shear[i] = 0.3 * rho[i] * rho[i] * sqrt(T[i]);
        heat[i] = 1.1 * T[i] / rho[i];
    }
}

/* The other terms: of the size that they have in inelastic spheres, beside the law above. */
static inline void manufactured_cross(const struct own_params *params, const struct closure_line *cells,
                                      double *restrict cross) {
    const double *rho = cells->rho, *T = cells->T;
    (void)params;
    for (int i = 0; i < cells->n; i++) cross[i] = 0.7 * T[i] * sqrt(T[i]) / rho[i];
}

static inline void manufactured_dilation(const struct own_params *params, const struct closure_line *cells,
                                         double *restrict dilation) {
    const double *rho = cells->rho, *T = cells->T;
    (void)params;
    for (int i = 0; i < cells->n; i++) dilation[i] = -0.6 * rho[i] * rho[i] * T[i];
}

static inline struct transport_terms manufactured_terms(const struct own_params *params) {
    (void)params;
    return (struct transport_terms){.cross = true, .dilation = true};
}

static inline struct transport_terms manufactured_diagonal(const struct own_params *params) {
    (void)params;
    return (struct transport_terms){.diagonal = true};
}

enum manufactured_part { OF_CONVECTION = 1, OF_DIFFUSION = 2, OF_SOURCES = 4, OF_ALL = 7 };

/* d/dx_axis of f at x, n values; h: of the difference */
typedef void manufactured_function(const void *context, const double x[3], double *out);
static inline void manufactured_derivative(manufactured_function *f, const void *context, int n, int axis,
                                           const double x[3], double *out) {
    const double h = 1e-3, weight[4] = {1, -8, 8, -1};
    for (int v = 0; v < n; v++) out[v] = 0;
    for (int j = 0; j < 4; j++) {
        double at[3] = {x[0], x[1], x[2]}, value[MAX_VAR];
        at[axis] += (const double[]){-2, -1, 1, 2}[j] * h;
        f(context, at, value);
        for (int v = 0; v < n; v++) out[v] += weight[j] * value[v] / (12 * h);
    }
}

/* Components of u: more than axes if the models ask for them. */
static inline int manufactured_components(const struct gas_models *models, int dim) {
    return models->components > dim ? models->components : dim;
}

struct manufactured { /* what a flux needs */
    const struct gas_models *models;
    int dim, components, axis;
    enum manufactured_part parts;
};

static inline void manufactured_velocity_and_temperature(const void *context, const double x[3], double *out) {
    double rho;
    (void)context;
    manufactured_fields(x, &rho, out, out + 3);
}

static inline void manufactured_density(const void *context, const double x[3], double *out) {
    double u[3], T;
    (void)context;
    manufactured_fields(x, out, u, &T);
}

/* What stress and heat flux bring into the positive direction of m->axis; d: derivatives of u and T along each axis. */
static inline void manufactured_diffusion(const struct manufactured *m, const double x[3], double d[3][4],
                                          double *out) {
    const struct gas_models *models = m->models;
    const struct transport_terms terms = transport_terms(models->transport, &models->transport_params);
    const struct material *grains = &models->material;
    const int k = m->axis, energy = m->components + 1;
    double rho, u[3], T, bulk, shear, heat, cross, steep, spread = 0;
    manufactured_fields(x, &rho, u, &T);
    models->transport->coefficients(&models->transport_params,
                                    &(struct closure_line){models->eos, grains, 1, &rho, &T, NULL, NULL, false}, &bulk,
                                    &shear, &heat);
    for (int a = 0; a < m->dim; a++) spread += a == k || !terms.diagonal ? d[a][a] : 0;
    for (int c = 0; c < m->components; c++) {
        const double lambda = bulk - (grains->disks ? 1 : 2. / 3) * shear;
        const double stress = shear * (d[k][c] + (c < m->dim && (c == k || !terms.diagonal) ? d[c][k] : 0)) +
                              (c == k ? lambda * spread : 0);
        out[1 + c] -= stress;
        out[energy] -= stress * u[c];
    }
    out[energy] -= heat * d[k][3];
    if (!terms.cross) return;
    models->transport->cross(&models->transport_params,
                             &(struct closure_line){models->eos, grains, 1, &rho, &T, NULL, NULL, false}, &cross);
    manufactured_derivative(manufactured_density, NULL, 1, k, x, &steep);
    out[energy] -= cross * steep;
}

/* Into the positive direction of m->axis: mass, momentum, energy. */
static inline void manufactured_flux(const void *context, const double x[3], double *out) {
    const struct manufactured *m = context;
    const struct material *grains = &m->models->material;
    const int dim = m->dim, k = m->axis, energy = m->components + 1;
    double rho, u[3] = {0}, T, d[3][4], square = 0, p, c2, gruneisen;
    manufactured_fields(x, &rho, u, &T);
    for (int v = 0; v <= energy; v++) out[v] = 0;
    for (int a = 0; a < m->components; a++) square += u[a] * u[a];
    if (m->parts & OF_CONVECTION) {
        const double eps = T / (grains->gamma - 1), E = rho * (eps + 0.5 * square);
        m->models->eos->state(grains, 1, &rho, &eps, &p, &c2, &gruneisen);
        out[0] = rho * u[k];
        for (int c = 0; c < m->components; c++) out[1 + c] = rho * u[k] * u[c] + (c == k ? p : 0);
        out[energy] = (E + p) * u[k];
    }
    if (!(m->parts & OF_DIFFUSION)) return;
    for (int a = 0; a < dim; a++) manufactured_derivative(manufactured_velocity_and_temperature, NULL, 4, a, x, d[a]);
    manufactured_diffusion(m, x, d, out);
}

/* The heat that the law's term of dilation takes at x, per volume and time. */
static inline double manufactured_dilated(const struct gas_models *models, int dim, const double x[3]) {
    double rho, u[3], T, dilation, spread = 0;
    if (!transport_terms(models->transport, &models->transport_params).dilation) return 0;
    manufactured_fields(x, &rho, u, &T);
    for (int a = 0; a < dim; a++) {
        double d[4];
        manufactured_derivative(manufactured_velocity_and_temperature, NULL, 4, a, x, d);
        spread += d[a];
    }
    models->transport->dilation(&models->transport_params,
                                &(struct closure_line){models->eos, &models->material, 1, &rho, &T, NULL, NULL, false},
                                &dilation);
    return dilation * spread;
}

/* d/dt of mass, momentum and energy at x, all per volume. */
static inline void manufactured_rates(const struct gas_models *models, int dim, enum manufactured_part parts,
                                      const double x[3], double out[MAX_VAR]) {
    const struct sources *s = &models->source;
    const int components = manufactured_components(models, dim), energy = components + 1;
    for (int v = 0; v <= energy; v++) out[v] = 0;
    for (int axis = 0; axis < dim; axis++) {
        double change[MAX_VAR];
        const struct manufactured m = {models, dim, components, axis, parts};
        manufactured_derivative(manufactured_flux, &m, energy + 1, axis, x, change);
        for (int v = 0; v <= energy; v++) out[v] -= change[v];
    }
    if (parts & OF_DIFFUSION) out[energy] -= manufactured_dilated(models, dim, x);
    if (!(parts & OF_SOURCES)) return;
    const struct material *m = &models->material;
    double rho, u[3], T, contact;
    manufactured_fields(x, &rho, u, &T);
    models->eos->contact(m, 1, &rho, &contact);
    for (int k = 0; k < components; k++) {
        out[1 + k] += rho * s->gravity[k];
        out[energy] += rho * s->gravity[k] * u[k];
    }
    if (s->cooling)
        out[energy] -=
            cooling_factor(m) * (1 - m->restitution * m->restitution) * rho * T * sqrt(T) * contact / m->diameter;
}

#endif
