/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Faces whose cells vary smoothly: the linear scheme of fifth order takes the place of the nonlinear reconstruction
 * (docs/physics.md 6.12). With the fluxes F and states U of the six cells of a face,
 *     F_face = C(F) - sum_k |lambda_k| (l_k . D(U)) r_k,   C: central of sixth order,   D: fifth difference / 60,
 * is what the linear weights make of the split fields, |lambda_k| the larger speed of both cells: one projection of one
 * vector, where the nonlinear weights project six cells of U and of F. A face's choice depends on its six cells alone,
 * so bits do not depend on batches, tiles or ranks. Differences are formed first: what is uniform stays so to the bit,
 * and mirror images keep their bits. */
#include "libcore/schemes/flux_private.h"

#define BUMP  0.1   /* most that the fourth and fifth differences may be of the total variation */
#define NOISE 1e-3  /* share of a sum over both cells (of c for a velocity) below which they do not count */
#define STILL 1e-6  /* the same of a tangential velocity that two neighbours share, as beside a wall */
#define EQUAL 1e-12 /* share of the sum of c by which such neighbours differ at most: far above round-off */
#define SLOPE 0.2   /* most that the total variation may be of the sum of both cells: far below shocks and voids */

struct course {                 /* of a quantity over the six cells of a face */
    double left, middle, right; /* its variation on both sides and across the face */
    double bump;                /* its |fourth| and |fifth difference| */
    double least;               /* of its five |differences| */
};
ALWAYS_INLINE struct course course_of(const double *restrict q, long s) {
    const double e1 = q[-s] - q[-2 * s], e2 = q[0] - q[-s], e3 = q[s] - q[0], e4 = q[2 * s] - q[s];
    const double e5 = q[3 * s] - q[2 * s], fifth = fma(6, e3, fma(-4, e2 + e4, e1 + e5));
    const double fourth = fma(-2, e4 - e2, e5 - e1);
    return (struct course){.left = fabs(e1) + fabs(e2),
                           .middle = fabs(e3),
                           .right = fabs(e4) + fabs(e5),
                           .bump = fabs(fourth) + fabs(fifth),
                           .least =
                               smaller(smaller(smaller(fabs(e1), fabs(e5)), smaller(fabs(e2), fabs(e4))), fabs(e3))};
}
/* Does a quantity vary smoothly, on a scale (its own sum over both cells; that of the speeds of sound for a velocity)?
 * A step has differences of 6 to 10 of its variation, a kink of 1, a sine of eight cells a wave 0.1. */
ALWAYS_INLINE uint64_t varies_smoothly(const struct course x, double scale, double noise) {
    const double variation = (x.left + x.right) + x.middle;
    return is(x.bump <= fma(BUMP, variation, noise * scale)) & is(variation <= SLOPE * scale);
}
/* Is the face none at the border of what is uniform: do rho or p differ on both sides, or nowhere? */
ALWAYS_INLINE uint64_t is_border_free(const struct course r, const struct course p) {
    const double left = r.left + p.left, right = r.right + p.right;
    return (is(left > 0) & is(right > 0)) | is((left + right) + (r.middle + p.middle) == 0);
}
/* Does the Grueneisen coefficient keep the face from being a contact of dense gas (flux_rules.h)? */
ALWAYS_INLINE uint64_t is_even(const double *restrict g, long s) {
    const double high = larger(larger(g[-s], g[2 * s]), larger(g[0], g[s]));
    const double low = smaller(smaller(g[-s], g[2 * s]), smaller(g[0], g[s]));
    return is(high <= DENSER * low);
}
/* Does a tangential velocity vary smoothly? Shears need have no jump of rho and p. A kink at a wall would heat the
 * cells beside it (the kinetic energy has the square of the velocity), and walls are mirrors: two cells are equal. */
ALWAYS_INLINE uint64_t slips_smoothly(const double *restrict u, long s, double scale) {
    const struct course x = course_of(u, s);
    return varies_smoothly(x, scale, select_masked(is(x.least <= EQUAL * scale), STILL, NOISE));
}

/* Marks the rough faces and counts them. The linear scheme reads cells downwind: gas that is uniform ahead of a wave
 * would get round-off of it, and would not be skipped (skipUniform). So faces at the border of what is uniform are
 * rough. */
ALWAYS_INLINE long find_dim(const int dim, const struct faces *f, double *restrict rough) {
    const double *rho = f->state[0], *p = f->p, *g = f->gruneisen, *c = f->c;
    const double *u1 = dim > 1 ? f->velocity[1] : p, *u2 = dim > 2 ? f->velocity[2] : p;
    const long s = f->stride;
    uint64_t smooth_ones = 0;
    EACH_ALONE
    for (int i = 0; i < f->n; i++) {
        const struct course r = course_of(rho + i, s), q = course_of(p + i, s);
        const double sum_r = rho[i] + rho[i + s], sum_p = p[i] + p[i + s], sound = c[i] + c[i + s];
        uint64_t smooth = varies_smoothly(r, sum_r, NOISE) & varies_smoothly(q, sum_p, NOISE);
        smooth &= is_border_free(r, q) & is_even(g + i, s);
        if (dim > 1) smooth &= slips_smoothly(u1 + i, s, sound);
        if (dim > 2) smooth &= slips_smoothly(u2 + i, s, sound);
        rough[i] = select_masked(smooth, 0, 1);
        smooth_ones -= smooth;
    }
    return f->n - (long)smooth_ones;
}
KERNEL static long find_rough(const struct faces *f, double *restrict rough) {
    if (f->dim == 1) return find_dim(1, f, rough);
    if (f->dim == 2) return find_dim(2, f, rough);
    return find_dim(3, f, rough);
}
/* Adds faces that are marked; returns how many there are in all. */
static long add_marked(int n, const double *restrict mark, double *restrict rough) {
    long count = 0;
    for (int i = 0; i < n; i++) {
        rough[i] = mark[i] > 0 ? 1 : rough[i];
        count += rough[i] > 0;
    }
    return count;
}

int smooth_find(const struct faces *f, double *rough) {
    const int n = f->n - f->padding;
    long count = find_rough(f, rough);
    for (int i = n; i < f->n; i++) {
        count -= rough[i] > 0;
        rough[i] = 0;
    }
    if (f->floor) count = add_marked(n, f->floor, rough);
    if (f->flat) count = add_marked(n, f->flat, rough);
    return count < n ? (int)count : f->n;
}

bool smooth_ends(int n, const double *rough, struct face_span *s) {
    int from = s->to, last;
    while (from < n && !(rough[from] > 0)) from++;
    last = from;
    for (int i = from; i < n && i <= last + GROUP; i++) last = rough[i] > 0 ? i : last;
    const int half = GROUP / 2, length = (last - from + half) / half * half, low = n > length ? n - length : 0;
    *s = (struct face_span){from < low ? from : low, from < low ? from + length : n};
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

/* The common basis (flux.c) of both cells, without its root: any c makes L the inverse of R, and c^2 = g h keeps
 * contacts of the perfect gas. */
struct face_basis {
    struct eigenrows l;
    double c, h, inverse_b1;
};
ALWAYS_INLINE struct face_basis basis_of(const int dim, const struct faces *f, int i) {
    const long s = f->stride;
    const double cl = f->c[i], cr = f->c[i + s], gl = f->gruneisen[i], gr = f->gruneisen[i + s];
    const double c = 0.5 * (cl + cr), c2 = 0.5 * (cl * cl + cr * cr), g = 0.5 * (gl + gr), inverse = 1 / (c2 * (g * c));
    const double b1 = g * (g * c) * inverse;
    struct face_basis b = {.c = c, .inverse_b1 = c2 * (c2 * c) * inverse};
    b.l.u[0] = 0.5 * (f->velocity[0][i] + f->velocity[0][i + s]);
    if (dim > 1) b.l.u[1] = 0.5 * (f->velocity[1][i] + f->velocity[1][i + s]);
    if (dim > 2) b.l.u[2] = 0.5 * (f->velocity[2][i] + f->velocity[2][i + s]);
    const double square = b.l.u[0] * b.l.u[0] + b.l.u[1] * b.l.u[1] + b.l.u[2] * b.l.u[2];
    b.h = 0.5 * (square + (enthalpy_of(f->eps[i], gl) + enthalpy_of(f->eps[i + s], gr)));
    b.l.half_b1 = 0.5 * b1;
    b.l.half_b2 = 0.5 * fma(b1, square - b.h, 1);
    b.l.half_inverse_c = 0.5 * (g * c2 * inverse);
    return b;
}

/* Faces that are marked as rough keep their flux. */
ALWAYS_INLINE void smooth_dim(const int dim, const struct faces *f, const double *restrict rough) {
    const struct faces x = *f; /* a copy, which no store can change */
    const double *F0 = f->flux[0], *F1 = f->flux[1], *FE = f->flux[dim + 1];
    const double *F2 = dim > 1 ? f->flux[2] : F0, *F3 = dim > 2 ? f->flux[3] : F0;
    const double *U0 = f->state[0], *U1 = f->state[1], *UE = f->state[dim + 1];
    const double *U2 = dim > 1 ? f->state[2] : U0, *U3 = dim > 2 ? f->state[3] : U0;
    double *restrict o0 = f->out[0], *restrict o1 = f->out[1], *restrict oe = f->out[dim + 1];
    double *restrict o2 = dim > 1 ? f->out[2] : o0, *restrict o3 = dim > 2 ? f->out[3] : o0;
    const long s = f->stride;
    EACH_SURE
    for (int i = 0; i < x.n; i++) {
        const double ul = x.velocity[0][i], ur = x.velocity[0][i + s], cl = x.c[i], cr = x.c[i + s];
        const struct face_basis b = basis_of(dim, &x, i);
        const uint64_t keep = is(rough[i] > 0);
        double d[MAX_VAR] = {fifth(U0 + i, s), fifth(U1 + i, s)};
        if (dim > 1) d[2] = fifth(U2 + i, s);
        if (dim > 2) d[3] = fifth(U3 + i, s);
        d[dim + 1] = fifth(UE + i, s);
        const double *const q[MAX_VAR] = {&d[0], &d[1], &d[2], &d[3], &d[4]};
        const struct fields w = project(dim, b.l, q, 0, d[1]);
        const double flow = larger(fabs(ul), fabs(ur));
        const double minus = larger(fabs(ul - cl), fabs(ur - cr)) * w.minus, entropy = flow * w.entropy;
        const double plus = larger(fabs(ul + cl), fabs(ur + cr)) * w.plus;
        const double v2 = dim > 1 ? b.l.u[1] : 0, v3 = dim > 2 ? b.l.u[2] : 0;
        const double a2 = dim > 1 ? flow * w.shear[0] : 0, a3 = dim > 2 ? flow * w.shear[1] : 0;
        const double t = dim > 2 ? v2 * a2 + v3 * a3 : v2 * a2;
        const double sum = minus + plus + entropy, swing = b.c * (plus - minus), un = b.l.u[0];
        o0[i] = select_masked(keep, o0[i], central(F0 + i, s) - sum);
        o1[i] = select_masked(keep, o1[i], central(F1 + i, s) - fma(un, sum, swing));
        if (dim > 1) o2[i] = select_masked(keep, o2[i], central(F2 + i, s) - fma(v2, sum, a2));
        if (dim > 2) o3[i] = select_masked(keep, o3[i], central(F3 + i, s) - fma(v3, sum, a3));
        const double work = fma(b.h, sum, -(b.inverse_b1 * entropy)) + fma(un, swing, t);
        oe[i] = select_masked(keep, oe[i], central(FE + i, s) - work);
    }
}

KERNEL static void smooth_faces(const struct faces *f, const double *restrict rough) {
    if (f->dim == 1) smooth_dim(1, f, rough);
    if (f->dim == 2) smooth_dim(2, f, rough);
    if (f->dim == 3) smooth_dim(3, f, rough);
}

void smooth_through(const struct faces *f, const double *rough) {
    smooth_faces(f, rough);
}
