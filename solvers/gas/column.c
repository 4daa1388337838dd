/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The isothermal hydrostatic column. With w the mass per area above h, p = g w, so that rho(w) solves P(rho) = p/T =
 * g w/T, and dh = -dw/rho(w): one curve h(w) holds for columns of every mass, which differ by the place of their floor
 * on it. Nodes are equidistant in ln w, in which the thin gas is a straight line. */
#include "solvers/gas/layers.h"

#include "libcore/gas/gas.h"

#include <math.h>
#include <stdlib.h>

enum { NODES = 8001 };
static const double FALL = 80; /* e-folds of w from the first node to the last */

struct column {
    double g, T, lid, top; /* m/s^2; m^2/s^2; m: height of the lid; ln w at node 0 */
    double h[NODES];       /* m: heights of the nodes above node 0 */
    double slope[NODES];   /* d ln w/dh = -rho/w */
};

/* Finds rho at which P(rho) = target, for n targets, by bisection. */
static void density_of(const struct gas_models *m, int n, const double *target, double *rho) {
    enum { HALVINGS = 100, MOST_DOUBLINGS = 200 };
    const double limit = density_limit(m->eos, &m->material);
    double low[BATCH], high[BATCH], P[BATCH];
    for (int i = 0; i < n; i++) {
        low[i] = 0;
        high[i] = isfinite(limit) ? limit : fmin(target[i], 1 / packing_per_density(&m->material)); /* P >= rho */
    }
    for (int k = 0; isinf(limit) && k < MOST_DOUBLINGS; k++) {
        pressure_per_temperature(m->eos, &m->material, n, high, P);
        for (int i = 0; i < n; i++) high[i] *= P[i] < target[i] ? 2 : 1;
    }
    for (int k = 0; k < HALVINGS; k++) {
        for (int i = 0; i < n; i++) rho[i] = 0.5 * (low[i] + high[i]);
        pressure_per_temperature(m->eos, &m->material, n, rho, P);
        for (int i = 0; i < n; i++) *(P[i] < target[i] ? &low[i] : &high[i]) = rho[i];
    }
}

/* Computes w/rho at ln w = top - s, for n values of s. */
static void height_per_fold(const struct gas_models *m, const struct column *c, int n, const double *s, double *out) {
    double target[BATCH], rho[BATCH];
    for (int i = 0; i < n; i++) target[i] = c->g / c->T * exp(c->top - s[i]);
    density_of(m, n, target, rho);
    for (int i = 0; i < n; i++) out[i] = exp(c->top - s[i]) / rho[i];
}

status column_make(const struct gas_models *models, double g, double T, double most, double lid, struct column **out) {
    struct column *c = NULL;
    double P, mean = most / lid;
    TRY(allocate(&c, 1, sizeof *c, "a column of gas"));
    pressure_per_temperature(models->eos, &models->material, 1, &mean, &P);
    c->g = g;
    c->T = T;
    c->lid = lid;
    /* under the lid rho is below its mean, so that at most P T/g lies above the lid */
    c->top = log(most + P * T / g);
    const double step = FALL / (NODES - 1);
    double s[BATCH], fold[2 * NODES - 1]; /* at the nodes and half way between them */
    for (int i = 0; i < 2 * NODES - 1; i += BATCH) {
        int n = 2 * NODES - 1 - i < BATCH ? 2 * NODES - 1 - i : BATCH;
        for (int k = 0; k < n; k++) s[k] = 0.5 * step * (i + k);
        height_per_fold(models, c, n, s, fold + i);
    }
    for (int i = 0; i < NODES; i++) {
        c->slope[i] = -1 / fold[2 * i];
        c->h[i] = i ? c->h[i - 1] + step / 6 * (fold[2 * i - 2] + 4 * fold[2 * i - 1] + fold[2 * i]) : 0;
    }
    *out = c;
    return OK;
}

void column_free(struct column *c) {
    free(c);
}

/* Returns the value at t of 0 .. 1 of the cubic with these ends and slopes (per unit of t). */
static double hermite(double t, double a, double b, double da, double db) {
    double r = 1 - t;
    return a * r * r * (1 + 2 * t) + b * t * t * (3 - 2 * t) + t * r * (da * r - db * t);
}

double column_above(const struct column *c, double bottom, double h) {
    const double step = FALL / (NODES - 1), place = (c->top - log(bottom)) / step;
    int low = (int)fmin(fmax(place, 0), NODES - 2), high = NODES - 1;
    double start = hermite(place - low, c->h[low], c->h[low + 1], -step / c->slope[low], -step / c->slope[low + 1]);
    const double at = start + h;
    if (at >= c->h[high]) return exp(c->top - FALL + c->slope[high] * (at - c->h[high]));
    if (at <= c->h[0]) low = 0;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        *(c->h[middle] <= at ? &low : &high) = middle;
    }
    double width = c->h[low + 1] - c->h[low], from = c->top - low * step;
    return exp(hermite((at - c->h[low]) / width, from, from - step, width * c->slope[low], width * c->slope[low + 1]));
}

double column_bottom(const struct column *c, double mass) {
    enum { HALVINGS = 100 };
    double low = log(mass), high = c->top;
    if (mass + column_above(c, mass, c->lid) == mass) return mass; /* nothing reaches the lid */
    for (int k = 0; k < HALVINGS && high > low; k++) {
        double middle = 0.5 * (low + high), bottom = exp(middle);
        *(bottom - column_above(c, bottom, c->lid) < mass ? &low : &high) = middle;
    }
    return exp(0.5 * (low + high));
}
