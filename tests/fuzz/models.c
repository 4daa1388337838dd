/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rows of the model tables that constant/granularProperties, g and shaking choose, with whatever parameters the
 * reader lets pass, on states from near vacuum to near packing: what the heads of the tables promise. */
#include "solvers/gas/models.h"
#include "tests/fuzz/target.h"

#include "libcore/models/boundary.h"
#include "libcore/models/cooling.h"
#include "libcore/models/source.h"
#include "solvers/case/fields.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { N = BATCH, DENSITIES = 8 };
struct states {
    double rho[N], eps[N], T[N];
};

/* Are the numbers such that products of a few of them are numbers, too? What is beyond is refused with the state. */
static bool is_tame(double x) {
    return x == 0 || (fabs(x) > 1e-30 && fabs(x) < 1e30);
}

static bool are_tame(const struct model *row, const void *base) {
    bool tame = true;
    for (int i = 0; i < row->nparam; i++) {
        double x[3] = {0};
        const enum param_kind kind = row->param[i].kind;
        if (kind == PARAM_NUMBER || kind == PARAM_VECTOR)
            memcpy(x, (const char *)base + row->param[i].offset, kind == PARAM_NUMBER ? sizeof *x : sizeof x);
        for (int k = 0; k < 3; k++) tame = tame && is_tame(x[k]);
    }
    return tame;
}

/* Packings from 1e-9 to all but the limit, temperatures from 1e-20 to 1e20. */
static void fill(const struct gas_models *g, struct states *s) {
    static const double part[DENSITIES] = {1e-9, 1e-3, 0.1, 0.3, 0.7, 0.9, 0.99, 0.999};
    const double per = packing_per_density(&g->material);
    for (int i = 0; i < N; i++) {
        s->rho[i] = part[i % DENSITIES] * g->material.alpha_max / per;
        s->T[i] = pow(10, 40. / 7 * (i / DENSITIES) - 20);
        s->eps[i] = eps_of(&g->material, s->T[i]);
    }
}

static void promise_range(const double *v, double low, const char *text) {
    for (int i = 0; i < N; i++) PROMISE(isfinite(v[i]) && v[i] >= low, text);
}

static void try_eos(const struct gas_models *g, const struct states *s) {
    double p[N], c2[N], gruneisen[N], one[3];
    g->eos->state(&g->material, N, s->rho, s->eps, p, c2, gruneisen);
    promise_range(p, 1e-300, "a gas has pressure");
    promise_range(c2, 1e-300, "a gas has a speed of sound");
    promise_range(gruneisen, 0, "pressure rises with energy");
    for (int i = 0; i < N; i += 5) {
        g->eos->state(&g->material, 1, s->rho + i, s->eps + i, one, one + 1, one + 2);
        PROMISE(one[0] == p[i] && one[1] == c2[i] && one[2] == gruneisen[i], "a state's results are its own");
    }
    for (int i = 1; i < DENSITIES; i++) PROMISE(p[i] > p[i - 1], "at one temperature pressure rises with density");
    g->eos->contact(&g->material, N, s->rho, p);
    promise_range(p, 0, "G is a number, not negative");
    g->eos->slope(&g->material, N, s->rho, c2);
    promise_range(c2, 0, "G rises with density");
}

static void try_cooling(const struct gas_models *g, const struct states *s) {
    static const double dt[] = {0, 1e-12, 1e-3, 1, 1e6};
    const struct closure_line cells = {g->eos, &g->material, N, s->rho, NULL, s->T, NULL, false};
    const struct sources *q = &g->source;
    for (int k = 0; q->cooling && k < 5; k++) {
        double eps[N];
        memcpy(eps, s->eps, sizeof eps);
        q->cooling->step(&q->cooling_params, &cells, dt[k], eps);
        for (int i = 0; i < N; i++) PROMISE(eps[i] > 0 && eps[i] <= s->eps[i], "impacts cool, and never to zero");
        for (int i = 0; i < N; i++)
            PROMISE(dt[k] > 0 || fabs(eps[i] / s->eps[i] - 1) < 1e-15, "no time changes nothing");
    }
}

static void try_transport(const struct gas_models *g, const struct states *s) {
    const struct transport *t = g->transport;
    double bulk[N], shear[N], heat[N];
    const struct closure_line cells = {g->eos, &g->material, N, s->rho, s->T, s->T, NULL, false};
    if (!t || !are_tame(&t->model, &g->transport_params)) return;
    const struct transport_terms terms = transport_terms(t, &g->transport_params);
    t->coefficients(&g->transport_params, &cells, bulk, shear, heat);
    promise_range(bulk, 0, "bulk viscosity is not negative");
    promise_range(shear, 0, "shear viscosity is not negative");
    promise_range(heat, 0, "conductivity is not negative");
    if (terms.cross) {
        t->cross(&g->transport_params, &cells, bulk);
        promise_range(bulk, -HUGE_VAL, "the coefficient of grad rho is a number");
    }
    if (terms.dilation) {
        t->dilation(&g->transport_params, &cells, bulk);
        promise_range(bulk, -HUGE_VAL, "the coefficient of div u is a number");
    }
}

/* All sources together, forwards and backwards. */
static void try_sources(const struct gas_models *g, const struct states *s, int dim) {
    double U[MAX_VAR][N];
    double *const line[MAX_VAR] = {U[0], U[1], U[2], U[3], U[4]};
    struct source_plan plan;
    for (int i = 0; i < source_count; i++)
        if (g->source.on[i] && !are_tame(&source_table[i].model, &g->source.params[i])) return;
    for (int k = 0; k < dim; k++)
        if (!is_tame(g->source.gravity[k])) return;
    if (!is_tame(g->source.amplitude) || !is_tame(g->source.frequency) || g->source.knots) return;
    for (int back = 0; back < 2; back++) {
        source_plan(&g->source, g->eos, &g->material, dim, 0.25, 1e-3, back, &plan);
        for (int i = 0; i < N; i++) {
            U[0][i] = s->rho[i];
            for (int k = 0; k < dim; k++) U[k + 1][i] = s->rho[i] * sqrt(s->T[i]);
            U[dim + 1][i] = s->rho[i] * (s->eps[i] + 0.5 * dim * s->T[i]);
        }
        source_apply(&plan, N, line, NULL, s->T, NULL);
        for (int v = 1; v < dim + 2; v++) promise_range(U[v], -HUGE_VAL, "what sources leave is a number");
        PROMISE(!memcmp(U[0], s->rho, sizeof U[0]), "sources leave density alone");
    }
}

/* Walls of every row, with parameters at the ends and in the middle of their ranges. */
static void try_wall(const struct gas_models *g, const struct states *s, const struct boundary_type *type, int where) {
    static double ones[N], slip[N], push[N];
    static int face[N];
    double drag[N], heat[N];
    struct patch_rules r = {.density.type = boundary_find("zeroGradient")};
    const struct boundary_type *thermal = type->scalar ? type : boundary_find("zeroGradient");
    for (int i = 0; i < type->model.nparam; i++) {
        const struct param *p = &type->model.param[i];
        const double low = isfinite(p->low) ? p->low : -1, high = isfinite(p->high) ? p->high : 1;
        if (p->kind != PARAM_NUMBER) return;
        r.velocity.params.room[p->offset / sizeof(double)] = low + (high - low) * where / 2;
    }
    r.velocity.type = type;
    r.temperature = (struct rule){.type = thermal, .params = r.velocity.params, .uniform = {1, 1, 1}};
    if (type->objection && type->objection(&r)) return;
    for (int i = 0; i < N; i++) ones[i] = 1, slip[i] = i % 3;
    struct wall_line line = {.n = N,
                             .face = face,
                             .eos = g->eos,
                             .material = &g->material,
                             .rho = s->rho,
                             .T = s->T,
                             .push = push,
                             .d = ones,
                             .shear = ones,
                             .heat = ones,
                             .slip = slip};
    wall_shares(&r, &line, drag, heat);
    promise_range(drag, 0, "a wall does not push the gas along");
    promise_range(line.surface, 0, "T of the gas on a wall is a number, not negative");
}

static void try_models(const struct case_models *m, int dim) {
    const struct gas_models *g = &m->gas;
    const struct material *grain = &g->material;
    struct states s;
    const double grains[] = {grain->diameter, grain->mass, grain->threshold, grain->gamma - 1,
                             packing_per_density(grain)};
    for (int i = 0; i < 5; i++)
        if (!is_tame(grains[i])) return;
    if (!(grain->diameter > 0) || !are_tame(&g->eos->model, grain) || grain->gamma > 100 || grain->alpha_max < 1e-6)
        return;
    fill(g, &s);
    try_eos(g, &s);
    try_cooling(g, &s);
    try_transport(g, &s);
    try_sources(g, &s, dim);
    for (int i = 0; g->transport && i < boundary_count; i++)
        for (int where = 0; where < 3; where++)
            if (boundary_table[i].wall) try_wall(g, &s, &boundary_table[i], where);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const names[] = {"system/fvSchemes", "system/fvSolution"};
    static const int axis[2][3] = {{0, 1, 2}, {0, 2, 1}};
    char path[256];
    struct case_models *m;
    scratch_unpack("case", "constant/granularProperties", data, size);
    for (int i = 0; i < 2; i++) { /* both may be left out of an input */
        snprintf(path, sizeof path, "%s/case/%s", scratch(), names[i]);
        if (!field_exists(path)) scratch_write(path + strlen(scratch()) + 1, "", 0);
    }
    snprintf(path, sizeof path, "%s/case", scratch());
    for (int dim = 2; dim <= 3; dim++)
        if (accepted(models_read(path, dim, axis[dim == 2], &m))) {
            try_models(m, dim);
            models_free(m);
        }
    scratch_clear();
    for (int i = 0; i < 2; i++) {
        snprintf(path, sizeof path, "%s/case/%s", scratch(), names[i]);
        remove(path);
    }
    return 0;
}
