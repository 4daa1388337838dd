/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Quantities of the gas: primitive ones from libcore, energy and momentum, and those made of gradients (quantities.h).
 */
#include "solvers/gas/quantities.h"

#include "mesh/grid/gradient.h"
#include "solvers/gas/scales.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const struct quantity gas_quantity[GAS_QUANTITIES] = {
    [GAS_RHO] = {"rho", 1, {1, -3, 0, 0, 0, 0, 0}, true},
    [GAS_ALPHA] = {"alpha", 1, {0, 0, 0, 0, 0, 0, 0}, false},
    [GAS_U] = {"U", 3, {0, 1, -1, 0, 0, 0, 0}, false},
    [GAS_T] = {"T", 1, {0, 2, -2, 0, 0, 0, 0}, false},
    [GAS_P] = {"p", 1, {1, -1, -2, 0, 0, 0, 0}, false},
    [GAS_C] = {"c", 1, {0, 1, -1, 0, 0, 0, 0}, false},
    [GAS_MACH] = {"Ma", 1, {0, 0, 0, 0, 0, 0, 0}, false},
    [GAS_LIMITED] = {"limited", 1, {0, 0, 0, 0, 0, 0, 0}, true},
    [GAS_VORTICITY] = {"vorticity", 3, {0, 0, -1, 0, 0, 0, 0}, false},
    [GAS_GRAD_ALPHA] = {"gradAlpha", 3, {0, -1, 0, 0, 0, 0, 0}, false},
    [GAS_KNUDSEN] = {"Kn", 1, {0, 0, 0, 0, 0, 0, 0}, false},
    [GAS_STRESS_RATIO] = {"stressRatio", 1, {0, 0, 0, 0, 0, 0, 0}, false},
    [GAS_MOMENTUM] = {"rhoU", 3, {1, -2, -1, 0, 0, 0, 0}, true},
    [GAS_ENERGY] = {"rhoE", 1, {1, -1, -2, 0, 0, 0, 0}, true},
};
const int gas_written[] = {GAS_ALPHA, GAS_U, GAS_T, GAS_P, GAS_LIMITED, GAS_RHO, GAS_MOMENTUM, GAS_ENERGY, -1};
const int gas_shown[] = {GAS_RHO, GAS_ALPHA, GAS_U, GAS_T, GAS_P, -1};

static bool is_derived(int quantity) {
    return quantity >= GAS_FIELDS && quantity < GAS_CARRIED;
}

/* Copies a list, and adds the carried quantities. */
static void extend(const int *list, int carried, int *out) {
    while (*list >= 0) *out++ = *list++;
    for (int i = 0; i < carried; i++) *out++ = GAS_CARRIED + i;
    *out = -1;
}

struct offered gas_fields_offer(struct gas_fields *f, const struct gas_models *models) {
    memcpy(f->quantity, gas_quantity, sizeof gas_quantity);
    for (int i = 0; i < models->ncarried; i++)
        f->quantity[GAS_CARRIED + i] = (struct quantity){models->carried[i].name, 1, {0}, true};
    extend(gas_written, models->ncarried, f->written);
    extend(gas_shown, models->ncarried, f->shown);
    return (struct offered){f->quantity, GAS_CARRIED + models->ncarried, f->written, f->shown};
}

/* ---- derived quantities ---- */

void gas_view_free(struct gas_view *v) {
    for (int d = 0; d < GAS_DERIVED; d++) free(v->line[d][0]);
    free(v->first);
}

void gas_view_forget(struct gas_view *v) {
    for (int d = 0; d < GAS_DERIVED; d++) v->known[d] = false;
}

const char *gas_view_lacks(const struct gas_models *models, int quantity) {
    if (quantity == GAS_STRESS_RATIO && !gas_rubs(models)) return "a gas without friction has no such stress";
    if (quantity != GAS_KNUDSEN || (models->eos->bounded && models->material.diameter > 0)) return NULL;
    return "a gas without grains has no mean free path";
}

static int lines_of(const struct gas_view *v, int quantity) {
    return setup_lines(v->setup, quantity);
}

static status find_ratio(struct gas_view *v) {
    double *out = v->line[GAS_STRESS_RATIO - GAS_FIELDS][0];
    return comm_agree(v->setup->comm, friction_ratio(v->setup, v->gas, v->models, out));
}

static status make_lines(struct gas_view *v, int quantity) {
    const struct grid *grid = v->setup->grid;
    double **line = v->line[quantity - GAS_FIELDS];
    if (line[0]) return OK;
    if (!v->first) {
        TRY(allocate(&v->first, grid->nblocks + 1L, sizeof *v->first, "a field"));
        for (int b = 0; b < grid->nblocks; b++) {
            v->first[b] = v->ncells;
            v->ncells += grid->block[b].ncells;
        }
    }
    const int n = lines_of(v, quantity);
    TRY(allocate(&line[0], n * v->ncells + 1, sizeof(double), gas_quantity[quantity].name));
    for (int k = 1; k < n; k++) line[k] = line[0] + k * v->ncells;
    return OK;
}

/* Copies a field of the gas to lines over the cells of this rank. */
static void take_lines(const struct gas_view *v, enum gas_field field, int lines, double *const *to) {
    for (int b = 0; b < v->setup->grid->nblocks; b++) {
        double *at[3] = {NULL, NULL, NULL};
        for (int k = 0; k < lines; k++) at[k] = to[k] + v->first[b];
        gas_block_field(v->gas, b, field, at);
    }
}

/* Sets gradient[k lines + c] to the derivatives of a field with that number of lines, whose memory is taken from `room`
 * [(dim + 1) lines ncells]. Collective. */
static status differentiate(const struct gas_view *v, enum gas_field field, int lines, double *room,
                            double *gradient[9]) {
    double *values[3];
    for (int c = 0; c < lines; c++) values[c] = room + c * v->ncells;
    for (int k = 0; k < v->setup->dim * lines; k++) gradient[k] = room + (lines + k) * v->ncells;
    take_lines(v, field, lines, values);
    return grid_gradients(v->setup->grid, lines, (const double *const *)values, gradient);
}

static status allocate_room(const struct gas_view *v, int lines, double **room) {
    const status s = allocate(room, (v->setup->dim + 1L) * lines * v->ncells + 1, sizeof **room, "gradients");
    return comm_agree(v->setup->comm, s);
}

/* The derivative of u_c along x_k is a part of the component of curl u along the third axis, with the sign of (k, c,
 * third) as physical axes. */
static status find_vorticity(struct gas_view *v) {
    const struct setup *s = v->setup;
    const int lines = s->components;
    double *room, *gradient[9], *const *curl = v->line[GAS_VORTICITY - GAS_FIELDS];
    TRY(allocate_room(v, lines, &room));
    const status e = differentiate(v, GAS_U, lines, room, gradient);
    memset(curl[0], 0, (size_t)(3 * v->ncells) * sizeof(double));
    for (int k = 0; !e && k < s->dim; k++)
        for (int c = 0; c < lines; c++) {
            if (c == k) continue;
            const int third = 3 - k - c;
            const double sign = (s->axis[k] + 1) % 3 == s->axis[c] ? 1 : -1;
            for (long i = 0; i < v->ncells; i++) curl[third][i] += sign * gradient[k * lines + c][i];
        }
    free(room);
    return e;
}

static status find_grad_alpha(struct gas_view *v) {
    const struct setup *s = v->setup;
    double *room, *gradient[9], *const *out = v->line[GAS_GRAD_ALPHA - GAS_FIELDS];
    TRY(allocate_room(v, 1, &room));
    const status e = differentiate(v, GAS_ALPHA, 1, room, gradient);
    for (int k = 0; !e && k < s->components; k++)
        if (k < s->dim)
            memcpy(out[k], gradient[k], (size_t)v->ncells * sizeof(double));
        else
            memset(out[k], 0, (size_t)v->ncells * sizeof(double));
    free(room);
    return e;
}

static status find_knudsen(struct gas_view *v) {
    double *room, *out = v->line[GAS_KNUDSEN - GAS_FIELDS][0], *const *slope = v->line[GAS_GRAD_ALPHA - GAS_FIELDS];
    TRY(gas_view_derive(v, GAS_GRAD_ALPHA));
    TRY(comm_agree(v->setup->comm, allocate(&room, 2 * v->ncells + 1, sizeof *room, "Kn")));
    double *rho = room, *alpha = room + v->ncells;
    take_lines(v, GAS_RHO, 1, &rho);
    take_lines(v, GAS_ALPHA, 1, &alpha);
    for (long i = 0; i < v->ncells; i++) {
        double square = 0;
        for (int k = 0; k < v->setup->dim; k++) square += slope[k][i] * slope[k][i];
        out[i] = free_path(v->models, rho[i]) * sqrt(square) / alpha[i];
    }
    free(room);
    return OK;
}

status gas_view_derive(struct gas_view *v, int quantity) {
    if (!is_derived(quantity) || v->known[quantity - GAS_FIELDS]) return OK;
    TRY(comm_agree(v->setup->comm, make_lines(v, quantity)));
    TRY(quantity == GAS_VORTICITY      ? find_vorticity(v)
        : quantity == GAS_GRAD_ALPHA   ? find_grad_alpha(v)
        : quantity == GAS_STRESS_RATIO ? find_ratio(v)
                                       : find_knudsen(v));
    v->known[quantity - GAS_FIELDS] = true;
    return OK;
}

/* ---- blocks ---- */

/* The energy of a block's cells, rho (eps + u^2/2), put together in the lines of `out`. */
static void block_energy(const struct gas_view *v, int block, double *const out[3]) {
    const int n = v->setup->grid->block[block].ncells;
    gas_block_field(v->gas, block, GAS_U, out);
    for (int i = 0; i < n; i++) {
        double square = 0;
        for (int k = 0; k < v->setup->components; k++) square += out[k][i] * out[k][i];
        out[0][i] = 0.5 * square;
    }
    gas_block_field(v->gas, block, GAS_T, (double *[]){out[1], NULL, NULL});
    gas_block_field(v->gas, block, GAS_RHO, (double *[]){out[2], NULL, NULL});
    for (int i = 0; i < n; i++) out[0][i] = out[2][i] * (eps_of(&v->models->material, out[1][i]) + out[0][i]);
}

void gas_view_block(const struct gas_view *v, int block, int quantity, double *const out[3]) {
    if (gas_carried(quantity) >= 0) {
        gas_block_carried(v->gas, block, gas_carried(quantity), out[0]);
    } else if (quantity == GAS_ENERGY) {
        block_energy(v, block, out);
    } else if (is_derived(quantity)) {
        const size_t bytes = (size_t)v->setup->grid->block[block].ncells * sizeof(double);
        for (int k = 0; k < lines_of(v, quantity); k++)
            memcpy(out[k], v->line[quantity - GAS_FIELDS][k] + v->first[block], bytes);
    } else {
        gas_block_field(v->gas, block, (enum gas_field)quantity, out);
    }
}

bool gas_view_uniform(const struct gas_view *v, int block, int quantity, double value[3]) {
    return quantity < GAS_FIELDS && gas_block_uniform(v->gas, block, (enum gas_field)quantity, value);
}

void gas_view_exact(const struct gas_view *v, int block, int quantity, double *const out[3]) {
    const int last = gas_variables(v->gas) - 1;
    if (quantity == GAS_ENERGY)
        gas_block_variables(v->gas, block, last, 1, out);
    else if (quantity == GAS_MOMENTUM)
        gas_block_variables(v->gas, block, 1, last - 1, out);
    else
        gas_view_block(v, block, quantity, out);
}
