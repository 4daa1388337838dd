/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fluxes that damp jumps, on a lattice under gravity (docs/physics.md 7.4). A column at rest has jumps from cell to
 * cell that are no waves: what LaxFriedrichs, Rusanov, FORCE and MUSTA damp of them is flow. So where gas is at rest a
 * face has the flux `common`, which damps nothing there: F = w F_common + (1 - w) F,   w = 2 - 2 m/(weight of half of
 * either cell) from 0 to 1, m = rho c |u_n| + |dp|, dp the difference of pressures that no weight explains: from the
 * pressure m = weight of motion on F is that of the flux. F is single, so that all is conserved. */
#include "libcore/schemes/flux_private.h"

struct at_rest { /* are some faces of a batch, or all, at rest: w > 0, w = 1? */
    bool some, all;
};
/* Computes w. */
KERNEL static struct at_rest rest_part(const struct faces *f, double *restrict part) {
    const double *rho = f->state[0], *p = f->p, *c = f->c, *u = f->velocity[0];
    const double *low = f->base[0], *high = f->base[1], *P = f->rest;
    const long d = f->stride;
    uint64_t some = 0, open = 0;
    for (int i = 0; i < f->n; i++) {
        const double weight = fabs(P[i] - low[i]) + fabs(P[i] - high[i]);
        const double sound = 0.25 * (rho[i] + rho[i + d]) * (c[i] + c[i + d]) * larger(fabs(u[i]), fabs(u[i + d]));
        const double motion = sound + fabs((p[i + d] - high[i]) - (p[i] - low[i]));
        part[i] = motion < weight ? smaller(2 - 2 * motion / weight, 1) : 0;
        some |= is(part[i] > 0);
        open |= is(part[i] < 1);
    }
    return (struct at_rest){some != 0, open == 0};
}

KERNEL static void mix(int n, const double *restrict part, const double *restrict common, double *restrict out) {
    for (int i = 0; i < n; i++) out[i] = part[i] > 0 ? part[i] * common[i] + (1 - part[i]) * out[i] : out[i];
}

void flux_undamped(const struct flux *flux, const struct faces *f, const struct eos *eos, const struct material *m,
                   const struct reconstruct *r) {
    double part[BATCH], out[MAX_VAR][BATCH];
    const struct at_rest rests = flux->damps ? rest_part(f, part) : (struct at_rest){false, false};
    struct faces common = *f;
    if (!rests.all) flux->through(f, eos, m, r);
    if (!rests.some) return;
    common.p = NULL; /* no rules of single faces */
    common.rule = NULL;
    common.params = NULL;
    for (int v = 0; v < f->dim + 2 && !rests.all; v++) common.out[v] = out[v];
    flux_find("common")->through(&common, eos, m, r);
    for (int v = 0; v < f->dim + 2 && !rests.all; v++) mix(f->n, part, out[v], f->out[v]);
}
