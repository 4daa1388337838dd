/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shear rate that laws of transport and of cooling may ask for (libcore/models/closure.h). The engine finds it in
 * the cells of a state, from gradients of the second order, exact for linear velocities. It is frozen over a half step
 * of diffusion, or of the sources, as the coefficients are: at the start of the first half, at the end of the second.
 * Cooling does not change u, so that it has the state itself at either end; diffusion takes that of the end from the
 * state before it, times the factor by which the first half changed it, as T (libcore/gas/diffusion.c). */
#include "libcore/gas/gas_private.h"

static const double NO_SHEAR = 1e-200; /* 1/s: added to both sides of the factor's fraction, for gas without shear */

bool needs_shear_rate(const struct gas_models *m) {
    const unsigned needs = (m->transport ? m->transport->needs : 0) | source_needs(&m->source, &m->material);
    return needs & NEEDS_SHEAR_RATE;
}

static bool transport_asks(const struct gas *g) {
    return g->models.transport && (g->models.transport->needs & NEEDS_SHEAR_RATE);
}

bool sources_ask(const struct gas *g) {
    return source_needs(&g->models.source, &g->models.material) & NEEDS_SHEAR_RATE;
}

void diffusion_sees(struct gas *g, const struct state *s) {
    if (!transport_asks(g)) return;
    g->engine->state.shear_rate(g, s);
    for (int b = 0; b < g->blocks.n && g->diffusion.ahead; b++)
        for (long i = 0; i < g->size; i++) g->diffusion.shear_rate.now[b][i] *= g->diffusion.shear_rate.rise[b][i];
}

void diffusion_looks_ahead(struct gas *g, const struct state *to) {
    if (!transport_asks(g)) return;
    double **before = g->diffusion.shear_rate.now;
    g->diffusion.shear_rate.now = g->diffusion.shear_rate.rise;
    g->diffusion.shear_rate.rise = before;
    g->engine->state.shear_rate(g, to);
    for (int b = 0; b < g->blocks.n; b++)
        for (long i = 0; i < g->size; i++) {
            const double rise = (g->diffusion.shear_rate.now[b][i] + NO_SHEAR) / (before[b][i] + NO_SHEAR);
            before[b][i] = smaller(larger(rise, 1 / MOST_RISE), MOST_RISE);
        }
}

/* Adds 2 D'_kl D'_kl of the axes k and l, and of l and k where they differ. Terms are added from the last axis on, as
 * in velocities. */
KERNEL static void add_shears(int n, int dim, int components, double d, const double *const *gradient,
                              const double *restrict around, double *restrict sum) {
    double mean[BATCH] = {0}, none[BATCH] = {0};
    const double lacks = d - dim - (around ? 1 : 0); /* axes that the mesh lacks */
    for (int k = dim - 1; k >= 0; k--)
        for (int i = 0; i < n; i++) mean[i] += gradient[k * components + k][i];
    for (int i = 0; i < n && around; i++) mean[i] += around[i];
    for (int i = 0; i < n; i++) {
        mean[i] /= d;
        sum[i] = lacks > 0 ? 2 * lacks * (mean[i] * mean[i]) : 0;
    }
    for (int i = 0; i < n && around; i++) sum[i] += 2 * ((around[i] - mean[i]) * (around[i] - mean[i]));
    for (int k = dim - 1; k >= 0; k--) {
        const double *restrict stretch = gradient[k * components + k];
        for (int i = 0; i < n; i++) sum[i] += 2 * ((stretch[i] - mean[i]) * (stretch[i] - mean[i]));
    }
    for (int l = components - 1; l >= 1; l--)
        for (int k = (l < dim ? l : dim) - 1; k >= 0; k--) {
            const double *restrict a = gradient[k * components + l], *b = l < dim ? gradient[l * components + k] : none;
            for (int i = 0; i < n; i++) sum[i] += (a[i] + b[i]) * (a[i] + b[i]);
        }
}

void shear_rate_row(const struct gas *g, int n, const double *const *gradient, const double *around, double *out) {
    double sum[BATCH];
    add_shears(n, g->dim, g->components, g->models.material.disks ? 2 : 3, gradient, around, sum);
    for (int i = 0; i < n; i++) out[i] = sqrt(sum[i]);
}
