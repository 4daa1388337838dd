/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Brings a Crank-Nicolson step of segregation on a lattice within its bounds (Zalesak 1979; segregation_lattice.h). */
#include "libcore/segregation/segregation_lattice_private.h"

enum { ROUNDS = 1000 }; /* of limiting in balance, before each face is limited whatever the others do */

static const double ROUND = 1e-15; /* an excess of phi beyond its bounds up to this is round-off */

bool segregation_beside_coarse(const struct segregation_field *s, int k, long cell, struct cell_faces sides) {
    const struct segregation_lattice *l = &s->lattice;
    const long i = cell / s->stride[k] % l->n[k];
    const double enough = 2 / l->width[k];
    bool low = fabs(l->u[k][sides.low]) + fabs(l->f[k][sides.low]) > enough * l->D[k][sides.low];
    bool high = fabs(l->u[k][sides.high]) + fabs(l->f[k][sides.high]) > enough * l->D[k][sides.high];
    return (low && (i > 0 || l->cyclic[k] || joined(s, k, false))) ||
           (high && (i < l->n[k] - 1 || l->cyclic[k] || joined(s, k, true)));
}

/* Computes the low fluxes, the mean of as many monotone steps as dt needs, and their phi in s->low. */
static void monotone_steps(struct segregation_field *s, double dt, const double *phi) {
    long steps = (long)ceil(dt * s->advance_rate);
    if (steps < 1) steps = 1;
    memcpy(s->low, phi, (size_t)s->cells * sizeof *phi);
    for (long i = 0; i < steps; i++) {
        segregation_take_flux(s, true, s->low, s->part);
        segregation_subtract(s, dt / (double)steps, s->part, s->low);
        for (int k = 0; k < s->lattice.dim; k++)
            for (long j = 0; j < s->faces[k]; j++)
                s->low_flux[k][j] = (i ? s->low_flux[k][j] : 0) + s->part[k][j] / (double)steps;
    }
    s->counts.substeps += steps;
}

static void widen(double *least, double *most, double a, double b) {
    *least = smaller(*least, smaller(a, b));
    *most = larger(*most, larger(a, b));
}
static void widen_by_given(const struct segregation_lattice *l, int k, long face, double *least, double *most) {
    if (fixed_on(l, k, face)) widen(least, most, l->value[k][face], l->value[k][face]);
}
/* Widens the range by both times at the neighbour of a cell, number i along axis k, in one direction. */
static void widen_by_neighbour(const struct segregation_field *s, int k, bool high, long c, long i, const double *phi,
                               double *least, double *most) {
    const struct segregation_lattice *l = &s->lattice;
    const long across = s->stride[k], end = high ? l->n[k] - 1 : 0, step = high ? across : -across;
    if (i == end && joined(s, k, high)) {
        const long at = c % across;
        widen(least, most, (high ? s->slab.above : s->slab.below)[at],
              (high ? s->low_slab.above : s->low_slab.below)[at]);
        return;
    }
    /* On the boundary the cell itself stands for its neighbour. */
    const long other = i != end ? c + step : wraps(s, k) ? c - (l->n[k] - 1) * step : c;
    widen(least, most, phi[other], s->low[other]);
}
static void find_bounds(struct segregation_field *s, const double *phi) {
    const struct segregation_lattice *l = &s->lattice;
    const long end = s->cells - s->stride[l->dim - 1];
    long i[MAX_DIM] = {0};
    slab_swap(&s->slab, phi, phi + end);
    slab_swap(&s->low_slab, s->low, s->low + end);
    for (long c = 0; c < s->cells; c++) {
        double least = 1, most = 0;
        widen(&least, &most, phi[c], s->low[c]);
        for (int k = 0; k < l->dim && s->sharp[c]; k++) {
            for (int high = 0; high < 2; high++) widen_by_neighbour(s, k, high, c, i[k], phi, &least, &most);
            if (i[k] == 0) widen_by_given(l, k, sides_of(s, k, c).low, &least, &most);
            if (i[k] == l->n[k] - 1) widen_by_given(l, k, sides_of(s, k, c).high, &least, &most);
        }
        s->least[c] = s->sharp[c] ? larger(least, 0) : 0;
        s->most[c] = s->sharp[c] ? smaller(most, 1) : 1;
        for (int k = 0; k < l->dim && ++i[k] == l->n[k]; k++) i[k] = 0;
    }
}

/* Limits the shares of fluxes on a cell's faces so that it keeps its bounds, whatever shares other cells ask for. */
static void limit_cell(struct segregation_field *s, double dt, long c) {
    double gain = 0, loss = 0;
    for (int k = 0; k < s->lattice.dim; k++) {
        struct cell_faces f = sides_of(s, k, c);
        double per = dt * s->ease[c] / s->lattice.width[k], in = s->flux[k][f.low], out = s->flux[k][f.high];
        gain += per * (larger(in, 0) - smaller(out, 0));
        loss += per * (larger(out, 0) - smaller(in, 0));
    }
    const double room = larger(s->most[c] - s->low[c], 0), stock = larger(s->low[c] - s->least[c], 0);
    const double gains = gain > room ? room / gain : 1, losses = loss > stock ? stock / loss : 1;
    for (int k = 0; k < s->lattice.dim; k++) {
        struct cell_faces f = sides_of(s, k, c);
        s->part[k][f.low] = smaller(s->part[k][f.low], s->flux[k][f.low] > 0 ? gains : losses);
        s->part[k][f.high] = smaller(s->part[k][f.high], s->flux[k][f.high] > 0 ? losses : gains);
    }
}
/* Returns phi' of cell c with the fluxes as limited so far. */
static double limited(const struct segregation_field *s, double dt, long c) {
    double out = s->low[c];
    for (int k = 0; k < s->lattice.dim; k++) {
        struct cell_faces f = sides_of(s, k, c);
        out -= dt * s->ease[c] / s->lattice.width[k] *
               (s->part[k][f.high] * s->flux[k][f.high] - s->part[k][f.low] * s->flux[k][f.low]);
    }
    return out;
}

/* Makes the shares on both copies of faces equal, of a seam's and of those between ranks: the smaller one holds. */
static void join_parts(struct segregation_field *s) {
    const int last = s->lattice.dim - 1;
    double *first_part = s->part[last], *last_part = first_part + s->faces[last] - s->stride[last];
    slab_swap(&s->slab, first_part, last_part);
    for (long i = 0; i < s->stride[last] && joined(s, last, false); i++)
        first_part[i] = smaller(first_part[i], s->slab.below[i]);
    for (long i = 0; i < s->stride[last] && joined(s, last, true); i++)
        last_part[i] = smaller(last_part[i], s->slab.above[i]);
    for (int k = 0; k < s->lattice.dim; k++) {
        const long across = s->stride[k], n = s->lattice.n[k] * across;
        for (long outer = 0; wraps(s, k) && outer < outer_count(s, k); outer++)
            for (long i = 0; i < across; i++) {
                double *low = s->part[k] + outer * (n + across) + i, *high = low + n;
                *low = *high = smaller(*low, *high);
            }
    }
}

/* Computes phi' with the fluxes as limited so far; returns whether some cell leaves its bounds that does not limit its
 * faces yet, and has it do so. */
static bool watch(struct segregation_field *s, double dt, double slack) {
    double again = 0;
    for (long c = 0; c < s->cells; c++) {
        s->next[c] = limited(s, dt, c);
        if (s->watched[c] || (s->next[c] >= s->least[c] - slack && s->next[c] <= s->most[c] + slack)) continue;
        s->watched[c] = true;
        again = 1;
    }
    slab_max(&s->slab, &again, 1);
    return again > 0;
}

/* Computes the shares of fluxes with which a cell keeps its bounds, from the shares that its faces have now. */
static void relieve_cell(struct segregation_field *s, double dt, long c, double *const share[MAX_DIM]) {
    double gain = 0, loss = 0;
    for (int k = 0; k < s->lattice.dim; k++) {
        const struct cell_faces f = sides_of(s, k, c);
        const double per = dt * s->ease[c] / s->lattice.width[k];
        const double in = s->part[k][f.low] * s->flux[k][f.low], out = s->part[k][f.high] * s->flux[k][f.high];
        gain += per * (larger(in, 0) - smaller(out, 0));
        loss += per * (larger(out, 0) - smaller(in, 0));
    }
    const double over = larger(s->next[c] - s->most[c], 0), under = larger(s->least[c] - s->next[c], 0);
    const double gains = over < gain ? 1 - over / gain : 0, losses = under < loss ? 1 - under / loss : 0;
    for (int k = 0; k < s->lattice.dim; k++) {
        const struct cell_faces f = sides_of(s, k, c);
        const double low = s->flux[k][f.low] > 0 ? gains : losses, high = s->flux[k][f.high] > 0 ? losses : gains;
        share[k][f.low] = smaller(share[k][f.low], s->part[k][f.low] * low);
        share[k][f.high] = smaller(share[k][f.high], s->part[k][f.high] * high);
    }
}
/* Limits the faces of the cells that leave their bounds, round by round. Large fluxes that cancel each other, as those
 * of long steps beside a face whose phi is given, stay balanced so; limited each for itself, they would carry the cell
 * from one bound to the other. Where central fluxes are monotone few steps need it; elsewhere all do, and their fluxes
 * are as small as the flow's. Returns whether all cells are within their bounds. */
static bool relieve(struct segregation_field *s, double dt) {
    for (int round = 0; round < ROUNDS; round++) {
        memset(s->watched, 0, (size_t)s->cells * sizeof *s->watched);
        if (!watch(s, dt, ROUND)) return true;
        double *const *share = s->low_flux;
        for (int k = 0; k < s->lattice.dim; k++) memcpy(share[k], s->part[k], (size_t)s->faces[k] * sizeof *share[k]);
        for (long c = 0; c < s->cells; c++)
            if (s->watched[c]) relieve_cell(s, dt, c, share);
        for (int k = 0; k < s->lattice.dim; k++) memcpy(s->part[k], share[k], (size_t)s->faces[k] * sizeof *share[k]);
        join_parts(s);
    }
    return false;
}

void segregation_bound_lattice(struct segregation_field *s, double dt, const double *phi) {
    s->counts.bounded++;
    monotone_steps(s, dt, phi);
    find_bounds(s, phi);
    for (int k = 0; k < s->lattice.dim; k++)
        for (long j = 0; j < s->faces[k]; j++) {
            s->flux[k][j] -= s->low_flux[k][j];
            s->part[k][j] = 1;
        }
    if (s->coarse || !relieve(s, dt)) {
        memset(s->watched, 0, (size_t)s->cells * sizeof *s->watched);
        while (watch(s, dt, 0)) {
            for (long c = 0; c < s->cells; c++)
                if (s->watched[c]) limit_cell(s, dt, c);
            join_parts(s);
        }
    }
    for (int k = 0; k < s->lattice.dim; k++) /* faces between two ranks count on the lower one */
        for (long j = joined(s, k, false) && comm_rank(s->slab.comm) > 0 ? s->stride[k] : 0; j < s->faces[k]; j++)
            s->counts.corrected += s->part[k][j] < 1;
}
