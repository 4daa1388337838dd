/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Faces whose cells vary smoothly: the linear scheme of fifth order takes the place of the nonlinear reconstruction
 * (docs/physics.md 6.12). With the fluxes F and states U of the six cells of a face,
 *     F_face = C(F) - sum_k |lambda_k| (l_k . D(U)) r_k,   C: central of sixth order,   D: fifth difference / 60,
 * is what the linear weights make of the split fields, |lambda_k| the larger speed of both cells: one projection of one
 * vector, where the nonlinear weights project six cells of U and of F. A face's choice depends on its six cells alone,
 * so bits do not depend on batches, tiles or ranks. Differences are formed first: what is uniform stays so to the bit,
 * and mirror images keep their bits. */
#include "libcore/schemes/flux_private.h"

#define BUMP  0.1  /* most that the fourth and fifth differences may be of the total variation */
#define NOISE 1e-3 /* share of a value below which they do not count: jumps that WENO's epsilon takes for smooth */
#define STILL 1e-6 /* the same of tangential velocities, whose kinks at walls count */
#define SLOPE 0.2  /* most that the total variation may be of the sum of both cells: far below shocks and voids */

/* Is the face none at the border of what is uniform: do rho or p differ on both sides, or are all cells equal? */
ALWAYS_INLINE uint64_t is_border_free(const double *restrict q, const double *restrict p, long s) {
    const uint64_t left = is(q[-2 * s] != q[-s]) | is(q[-s] != q[0]) | is(p[-2 * s] != p[-s]) | is(p[-s] != p[0]);
    const uint64_t right =
        is(q[s] != q[2 * s]) | is(q[2 * s] != q[3 * s]) | is(p[s] != p[2 * s]) | is(p[2 * s] != p[3 * s]);
    return (left & right) | ~(left | is(q[0] != q[s]) | is(p[0] != p[s]) | right);
}
/* Does a quantity vary smoothly over the six cells, on a scale (its own sum over both cells; twice the speed of sound
 * for a velocity)? A step has differences of 6 to 10 of its variation, a kink of 1, a sine of eight cells a wave 0.1.
 */
ALWAYS_INLINE uint64_t varies_smoothly(const double *restrict q, long s, double scale, double noise) {
    const double a = q[-2 * s], b = q[-s], c = q[0], d = q[s], e = q[2 * s], f = q[3 * s];
    const double o1 = d - c, o3 = e - b, o5 = f - a, s1 = c + d, s3 = b + e, s5 = a + f;
    const double fifth = fabs(fma(10, o1, fma(-5, o3, o5))), fourth = fabs(fma(2, s1, fma(-3, s3, s5)));
    const double variation = (fabs(b - a) + fabs(f - e)) + (fabs(c - b) + fabs(e - d)) + fabs(o1);
    return is(fifth + fourth <= fma(BUMP, variation, noise * scale)) & is(variation <= SLOPE * scale);
}
/* Does the Grueneisen coefficient keep the face from being a contact of dense gas (flux_rules.h)? */
ALWAYS_INLINE uint64_t is_even(const double *restrict g, long s) {
    const double high = larger(larger(g[-s], g[2 * s]), larger(g[0], g[s]));
    const double low = smaller(smaller(g[-s], g[2 * s]), smaller(g[0], g[s]));
    return is(high <= DENSER * low);
}

/* Marks the rough faces. The linear scheme reads cells downwind: gas that is uniform ahead of a wave would get
 * round-off of it, and would not be skipped (skipUniform). So faces at the border of what is uniform are rough. */
KERNEL static void find_rough(const struct faces *f, double *restrict rough) {
    const double *rho = f->state[0], *p = f->p, *g = f->gruneisen;
    const long s = f->stride;
    EACH_ALONE
    for (int i = 0; i < f->n; i++) {
        const double *r = rho + i, *q = p + i;
        const uint64_t smooth = varies_smoothly(r, s, r[0] + r[s], NOISE) & varies_smoothly(q, s, q[0] + q[s], NOISE);
        rough[i] = select_masked(smooth & is_border_free(r, q, s) & is_even(g + i, s), 0, 1);
    }
}
/* Marks those across which a tangential velocity does not vary smoothly: shears need have no jump of rho and p. */
KERNEL static void find_sheared(const struct faces *f, const double *restrict u, double *restrict rough) {
    const double *c = f->c;
    const long s = f->stride;
    EACH_ALONE
    for (int i = 0; i < f->n; i++)
        rough[i] = select_masked(varies_smoothly(u + i, s, c[i] + c[i + s], STILL), rough[i], 1);
}

int smooth_find(const struct faces *f, double *rough) {
    const int n = f->n - f->padding;
    int count = 0;
    find_rough(f, rough);
    for (int k = 1; k < f->dim; k++) find_sheared(f, f->velocity[k], rough);
    for (int i = 0; i < n && f->floor; i++) rough[i] = f->floor[i] > 0 ? 1 : rough[i];
    for (int i = 0; i < n && f->flat; i++) rough[i] = f->flat[i] > 0 ? 1 : rough[i];
    for (int i = 0; i < n; i++) count += rough[i] > 0;
    for (int i = n; i < f->n; i++) rough[i] = 0;
    return count < n ? count : f->n;
}

static bool holds_rough(int n, const double *rough, int from) {
    double sum = 0;
    for (int i = from; i < n && i < from + GROUP; i++) sum += rough[i];
    return sum > 0;
}

bool smooth_ends(int n, const double *rough, struct face_span *s) {
    int from = s->to;
    while (from < n && !holds_rough(n, rough, from)) from += GROUP;
    *s = (struct face_span){from, from};
    while (s->to < n && holds_rough(n, rough, s->to)) s->to += GROUP;
    s->to = s->to < n ? s->to : n;
    return from < n;
}

/* C and D of a line. */
ALWAYS_INLINE double central(const double *restrict q, long s) {
    const double s1 = q[0] + q[s];
    return fma(0.5, s1, fma(-8, (q[-s] + q[2 * s]) - s1, (q[-2 * s] + q[3 * s]) - s1) * (1. / 60));
}
ALWAYS_INLINE double fifth(const double *restrict q, long s) {
    return fma(10, q[s] - q[0], fma(-5, q[2 * s] - q[-s], q[3 * s] - q[-2 * s])) * (1. / 60);
}

ALWAYS_INLINE void smooth_dim(const int dim, const struct faces *f, const struct bases *restrict b) {
    const double *u = f->velocity[0], *c = f->c;
    const double *F0 = f->flux[0], *F1 = f->flux[1], *FE = f->flux[dim + 1];
    const double *F2 = dim > 1 ? f->flux[2] : F0, *F3 = dim > 2 ? f->flux[3] : F0;
    const double *U0 = f->state[0], *U1 = f->state[1], *UE = f->state[dim + 1];
    const double *U2 = dim > 1 ? f->state[2] : U0, *U3 = dim > 2 ? f->state[3] : U0;
    double *restrict o0 = f->out[0], *restrict o1 = f->out[1], *restrict oe = f->out[dim + 1];
    double *restrict o2 = dim > 1 ? f->out[2] : o0, *restrict o3 = dim > 2 ? f->out[3] : o0;
    const long s = f->stride;
    EACH_ALONE
    for (int i = 0; i < f->n; i++) {
        const double ul = u[i], ur = u[i + s], cl = c[i], cr = c[i + s];
        double d[MAX_VAR] = {fifth(U0 + i, s), fifth(U1 + i, s)};
        if (dim > 1) d[2] = fifth(U2 + i, s);
        if (dim > 2) d[3] = fifth(U3 + i, s);
        d[dim + 1] = fifth(UE + i, s);
        const double *const q[MAX_VAR] = {&d[0], &d[1], &d[2], &d[3], &d[4]};
        const struct fields w = project(dim, rows_at(dim, b, i), q, 0, d[1]);
        const double flow = larger(fabs(ul), fabs(ur));
        const double minus = larger(fabs(ul - cl), fabs(ur - cr)) * w.minus, entropy = flow * w.entropy;
        const double plus = larger(fabs(ul + cl), fabs(ur + cr)) * w.plus;
        const double v2 = dim > 1 ? b->u[1][i] : 0, v3 = dim > 2 ? b->u[2][i] : 0;
        const double a2 = dim > 1 ? flow * w.shear[0] : 0, a3 = dim > 2 ? flow * w.shear[1] : 0;
        const double t = dim > 2 ? v2 * a2 + v3 * a3 : v2 * a2;
        const double sum = minus + plus + entropy, swing = b->c[i] * (plus - minus);
        o0[i] = central(F0 + i, s) - sum;
        o1[i] = central(F1 + i, s) - fma(b->u[0][i], sum, swing);
        if (dim > 1) o2[i] = central(F2 + i, s) - fma(v2, sum, a2);
        if (dim > 2) o3[i] = central(F3 + i, s) - fma(v3, sum, a3);
        oe[i] = central(FE + i, s) - (fma(b->h[i], sum, -(b->inverse_b1[i] * entropy)) + fma(b->u[0][i], swing, t));
    }
}

KERNEL static void smooth_faces(const struct faces *f, const struct bases *restrict b) {
    if (f->dim == 1) smooth_dim(1, f, b);
    if (f->dim == 2) smooth_dim(2, f, b);
    if (f->dim == 3) smooth_dim(3, f, b);
}

void smooth_through(const struct faces *f, const struct bases *b) {
    smooth_faces(f, b);
}
