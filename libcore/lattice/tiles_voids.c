/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds thin cells beside dense ones (VOID in libcore/gas/gas_private.h), whose faces have the flux of first order.
 * Most tiles have none, and most rows of the others: the extremes of the density in each row tell so. */
#include "libcore/lattice/tiles.h"

/* Numbers >= 0 are in the order of their bits, whose extremes compilers find in vectors. */
KERNEL static void widen_row(int n, const double *restrict q, struct range *restrict of) {
    uint64_t low = bits_of(of->low), high = bits_of(of->high);
    for (int i = 0; i < n; i++) {
        const uint64_t bits = bits_of(q[i]);
        low = bits < low ? bits : low;
        high = bits > high ? bits : high;
    }
    of->low = double_of(low);
    of->high = double_of(high);
}

void range_widen(struct range *of, int n, const double *q) {
    widen_row(n, q, of);
}

void range_join(struct range *of, const struct range *with) {
    of->low = smaller(of->low, with->low);
    of->high = larger(of->high, with->high);
}

void voids_row(const struct gas *g, const double *U, int j, int k) {
    const struct activity *a = &g->tiles->activity;
    const struct span *s = activity_row(a, a->needed, j, k);
    struct range *row = &g->tiles->work.density[s - a->needed];
    *row = RANGE_EMPTY;
    if (!span_empty(*s))
        range_widen(row, s->high - s->low,
                    U + g->forest->first + s->low + j * g->forest->stride[1] + k * g->forest->stride[2]);
}

/* May a strip have a cell VOID times thinner than another one of its faces' stencils? */
static bool may_hold_voids(const struct gas *g, const struct strip *s) {
    const struct activity *a = &g->tiles->activity;
    const int reach = g->models.reconstruct->reach, step = s->axis == 1 ? 1 : a->rows;
    const struct range *row = g->tiles->work.density + s->row;
    struct range all = *row;
    for (int k = -reach; k <= reach + 1 && s->axis > 0; k++) range_join(&all, &row[k * step]);
    return all.high > VOID * all.low;
}

/* Chooses the faces of cells that are VOID times thinner than a cell of the face's stencil on one side, where p falls,
 * too. Where the density rises on both sides, the polynomials of a smooth minimum are right, and across a contact p is
 * even. Returns bits that are all 0 if there are none. rho, p: of the left cells; reach: cells of the stencil on either
 * side. */
ALWAYS_INLINE uint64_t find_within(const int reach, int n, long stride, const double *restrict rho,
                                   const double *restrict p, double *restrict chosen) {
    uint64_t any = 0;
    for (int i = 0; i < n; i++) {
        const double l = rho[i], r = rho[i + stride], p_l = p[i], p_r = p[i + stride], thin = smaller(l, r);
        double left = l, right = r, high = larger(p_l, p_r);
        for (int k = 1; k < reach; k++) {
            left = larger(left, rho[i - k * stride]);
            right = larger(right, rho[i + (k + 1) * stride]);
            high = larger(high, larger(p[i - k * stride], p[i + (k + 1) * stride]));
        }
        const double far = larger(left, right), near = smaller(left, right);
        const bool alone = (far > VOID * thin) & (near < VOID_BESIDE * thin);
        chosen[i] = (alone & (high > VOID_BESIDE * smaller(p_l, p_r))) ? 1 : 0;
        any |= bits_of(chosen[i]);
    }
    return any;
}
KERNEL static uint64_t find_two(int n, long stride, const double *rho, const double *p, double *restrict chosen) {
    return find_within(2, n, stride, rho, p, chosen);
}
KERNEL static uint64_t find_three(int n, long stride, const double *rho, const double *p, double *restrict chosen) {
    return find_within(3, n, stride, rho, p, chosen);
}

bool voids_find(const struct gas *g, const double *U, const struct strip *s, double *flat) {
    if (g->models.reconstruct->reach == 0 || !may_hold_voids(g, s)) return false;
    const double *rho = U + s->offset, *p = g->tiles->work.p + s->offset;
    const long stride = g->forest->stride[s->axis];
    const bool narrow = g->models.reconstruct->reach == 1;
    if (!(narrow ? find_two : find_three)(s->n, stride, rho, p, flat)) return false;
    for (int i = s->n; i < whole_vectors(s->n); i++) flat[i] = 0;
    return true;
}
