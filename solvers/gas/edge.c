/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities of the gas on the faces of patches (quantities.h; docs/physics.md 5.8): rho, u, T by the rules of the
 * patch, all others from these. */
#include "solvers/gas/quantities.h"

#include <math.h>
#include <string.h>

const int gas_edge_state[] = {GAS_RHO, GAS_U, GAS_T, -1};

struct edge_line { /* of n <= BATCH faces */
    int n;
    double q[MAX_VAR][BATCH]; /* rho, u along computational axes, T */
};

static void take_states(const struct setup *s, int n, const struct edge_face *face, struct edge_line *out) {
    out->n = n;
    for (int i = 0; i < n; i++) {
        out->q[0][i] = face[i].state[0];
        for (int k = 0; k < s->components; k++) out->q[k + 1][i] = face[i].state[1 + s->axis[k]];
        out->q[s->components + 1][i] = face[i].state[4];
    }
}

/* Returns whether the patch is a wall. */
static bool find_states(const struct gas_view *v, int patch, const struct edge_face *face, struct edge_line *l) {
    const struct setup *s = v->setup;
    double normal[3][BATCH] = {{0}}, gap[BATCH], *q[MAX_VAR];
    int number[BATCH];
    for (int i = 0; i < l->n; i++) {
        number[i] = face[i].face;
        gap[i] = face[i].gap;
        for (int k = 0; k < s->dim; k++) normal[k][i] = face[i].normal[s->axis[k]];
    }
    for (int k = 0; k < MAX_VAR; k++) q[k] = l->q[k];
    return gas_on_patch(v->gas, patch, l->n, number, (double *const[]){normal[0], normal[1], normal[2]}, gap, q);
}

/* Computes a scalar of the states. */
static void find_scalar(const struct gas_view *v, int quantity, struct edge_line *l, double *out) {
    const int last = v->setup->components + 1;
    const struct material *m = &v->models->material;
    double eps[BATCH] = {0}, p[BATCH], c2[BATCH], gruneisen[BATCH];
    for (int i = 0; i < l->n; i++) eps[i] = eps_of(m, l->q[last][i]);
    v->models->eos->state(m, l->n, l->q[0], eps, p, c2, gruneisen);
    for (int i = 0; i < l->n; i++) {
        double square = 0;
        for (int k = 1; k < last; k++) square += l->q[k][i] * l->q[k][i];
        out[i] = quantity == GAS_RHO     ? l->q[0][i]
                 : quantity == GAS_ALPHA ? packing_per_density(m) * l->q[0][i]
                 : quantity == GAS_T     ? l->q[last][i]
                 : quantity == GAS_P     ? p[i]
                 : quantity == GAS_C     ? sqrt(c2[i])
                 : quantity == GAS_MACH  ? sqrt(square / c2[i])
                                         : l->q[0][i] * (eps[i] + 0.5 * square);
    }
}

/* Is the face in the cell's state, as far as the quantity asks? Then the value stays, to the bit. */
static bool stays(int quantity, int last, bool wall, const struct edge_line *cell, const struct edge_line *face,
                  int i) {
    bool same[3] = {true, true, true}; /* rho, u, T */
    for (int k = 0; k <= last; k++) same[k == 0 ? 0 : k < last ? 1 : 2] &= cell->q[k][i] == face->q[k][i];
    return quantity == GAS_RHO || quantity == GAS_ALPHA ? same[0]
           : quantity == GAS_U                          ? same[1]
           : quantity == GAS_T                          ? same[2]
           : quantity == GAS_P && wall                  ? true
           : quantity == GAS_P || quantity == GAS_C     ? same[0] && same[2]
                                                        : same[0] && same[1] && same[2];
}

static void edge_batch(const struct gas_view *v, int quantity, int patch, int n, const struct edge_face *face,
                       double *values) {
    const struct setup *s = v->setup;
    const bool vector = gas_quantity[quantity].components == 3;
    struct edge_line cell, on;
    double out[BATCH];
    take_states(s, n, face, &cell);
    on = cell;
    const bool wall = find_states(v, patch, face, &on);
    if (!vector) find_scalar(v, quantity, &on, out);
    for (int i = 0; i < n; i++) {
        const double was = values[(vector ? 3L : 1L) * i];
        if (!isnan(was) && stays(quantity, s->components + 1, wall, &cell, &on, i)) continue;
        if (!vector) values[i] = out[i];
        for (int k = 0; k < s->components && vector; k++)
            values[3L * i + s->axis[k]] = (quantity == GAS_MOMENTUM ? on.q[0][i] : 1) * on.q[k + 1][i];
    }
}

/* The same of a carried quantity, by its rule. */
static void carried_edge(const struct rule *rule, const struct setup *s, int n, const struct edge_face *face,
                         double *values) {
    for (int i = 0; i < n; i++) {
        const double inner = values[i], *U = face[i].state + 1;
        double outflow = 0;
        for (int k = 0; k < s->dim; k++) outflow += U[s->axis[k]] * face[i].normal[s->axis[k]];
        const struct ghost_line l = {.n = 1,
                                     .components = 1,
                                     .face = &face[i].face,
                                     .inner = {&inner},
                                     .outflow = &outflow,
                                     .normal = -1,
                                     .ghost = {&values[i]}};
        rule->type->ghost(rule, &l);
    }
}

void gas_view_edge(const struct gas_view *v, const struct patch_rules *r, int quantity, int patch, int n,
                   const struct edge_face *face, double *values) {
    if (gas_carried(quantity) >= 0) {
        carried_edge(&r->carried[gas_carried(quantity)], v->setup, n, face, values);
        return;
    }
    const int components = gas_quantity[quantity].components;
    if (quantity == GAS_LIMITED || (quantity >= GAS_FIELDS && quantity < GAS_CARRIED)) return; /* of cells alone */
    for (int at = 0; at < n; at += BATCH)
        edge_batch(v, quantity, patch, n - at < BATCH ? n - at : BATCH, face + at, values + (long)at * components);
}

bool gas_rules_give(const struct patch_rules *r, const struct gas_models *models, int quantity) {
    if (gas_carried(quantity) >= 0) return rule_fixes(&r->carried[gas_carried(quantity)]);
    if (!r->velocity.type) return false;
    if (patch_is_wall(r) && quantity == GAS_T)
        return models->transport && wall_conducts(r) && r->temperature.type->temperature;
    if (patch_is_wall(r)) return quantity == GAS_U && wall_drags(r);
    const bool rho = rule_fixes(&r->density), u = rule_fixes(&r->velocity) || (patch_feeds(r) && rho);
    const bool heat = rule_fixes(&r->temperature), T = heat && (rho || !r->pressure), p = heat && (rho || r->pressure);
    return quantity == GAS_RHO || quantity == GAS_ALPHA ? rho
           : quantity == GAS_U                          ? u
           : quantity == GAS_T                          ? T
           : quantity == GAS_P                          ? p
           : quantity == GAS_C                          ? rho && T
           : quantity == GAS_MACH                       ? rho && u && T
                                                        : false;
}
