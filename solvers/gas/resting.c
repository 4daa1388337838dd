/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Columns of gas at rest on a mesh whose cells lie in layers. The gas is at rest by the scheme itself
 * (libcore/lattice/tiles_balance.c) if each face between two layers has the pressure that both sides have there,
 *     p_j - h_j/2 rho_j g = p_(j+1) + h_(j+1)/2 rho_(j+1) g,
 * which from the floor up is one equation for each rho_j:  p(rho_j, T_j) + h_j/2 rho_j g = P_j,  P_(j+1) = P_j - h_j
 * rho_j g. */
#include "solvers/gas/layers.h"

#include <math.h>
#include <stdlib.h>

struct resting {
    const struct gas_models *models;
    double g; /* m/s^2 */
    int layers;
    double *thick, *T; /* [layers] m, m^2/s^2, from the floor up */
};

status resting_make(const struct gas_models *models, double g, int layers, const double *thick, const double *T,
                    struct resting **out) {
    struct resting *r;
    TRY(allocate(&r, 1, sizeof *r, "a column of gas"));
    *r = (struct resting){.models = models, .g = g, .layers = layers};
    status s = allocate(&r->thick, layers, sizeof(double), "a column of gas");
    if (!s) s = allocate(&r->T, layers, sizeof(double), "a column of gas");
    for (int j = 0; j < layers && !s; j++) {
        r->thick[j] = thick[j];
        r->T[j] = T[j];
    }
    if (s)
        resting_free(r);
    else
        *out = r;
    return s;
}

void resting_free(struct resting *r) {
    if (!r) return;
    free(r->thick);
    free(r->T);
    free(r);
}

/* Finds rho of n <= BATCH columns in layer j, over whose lower faces the pressure is P: by bisection, below the rho of
 * a perfect gas. */
static void layer_density(const struct resting *r, int j, int n, const double *P, double *rho) {
    enum { HALVINGS = 200 };
    const double limit = density_limit(r->models->eos, &r->models->material), T = r->T[j],
                 half = 0.5 * r->thick[j] * r->g;
    double low[BATCH], high[BATCH], Z[BATCH];
    for (int i = 0; i < n; i++) {
        low[i] = 0;
        high[i] = fmin(limit, fmax(P[i], 0) / (T + half));
    }
    for (int k = 0, open = n; k < HALVINGS && open; k++) {
        open = 0;
        for (int i = 0; i < n; i++) rho[i] = 0.5 * (low[i] + high[i]);
        pressure_per_temperature(r->models->eos, &r->models->material, n, rho, Z);
        for (int i = 0; i < n; i++) {
            open += rho[i] > low[i] && rho[i] < high[i];
            *(T * Z[i] + half * rho[i] < P[i] ? &low[i] : &high[i]) = rho[i];
        }
    }
    for (int i = 0; i < n; i++) rho[i] = low[i];
}

/* Fills n <= BATCH columns, column i to out[i layers ..], from the pressures P on the floor; mass[n]: what they hold.
 */
static void fill_columns(const struct resting *r, int n, const double *floor, double *out, double *mass) {
    double P[BATCH], rho[BATCH];
    for (int i = 0; i < n; i++) {
        P[i] = floor[i];
        mass[i] = 0;
    }
    for (int j = 0; j < r->layers; j++) {
        layer_density(r, j, n, P, rho);
        for (int i = 0; i < n; i++) {
            out[(long)i * r->layers + j] = rho[i];
            mass[i] += r->thick[j] * rho[i];
            P[i] -= r->thick[j] * r->g * rho[i];
        }
    }
}

/* The pressure on the floor is g times the mass, and that on the lid more: the root of mass(P) = mass by secants. */
void resting_columns(const struct resting *r, int n, const double *mass, double *out) {
    enum { TRIALS = 20 };
    for (int from = 0; from < n; from += BATCH) {
        const int m = n - from < BATCH ? n - from : BATCH;
        double P[BATCH], held[BATCH], before[BATCH], held_before[BATCH];
        for (int i = 0; i < m; i++) {
            before[i] = held_before[i] = 0;
            P[i] = r->g * mass[from + i];
        }
        for (int k = 0; k < TRIALS; k++) {
            fill_columns(r, m, P, out + (long)from * r->layers, held);
            bool done = true;
            for (int i = 0; i < m; i++) {
                const double missing = mass[from + i] - held[i],
                             slope = (P[i] - before[i]) / (held[i] - held_before[i]);
                if (fabs(missing) < 1e-14 * mass[from + i] || !isfinite(slope)) continue;
                done = false;
                before[i] = P[i];
                held_before[i] = held[i];
                P[i] += missing * slope;
            }
            if (done) break;
        }
    }
}
