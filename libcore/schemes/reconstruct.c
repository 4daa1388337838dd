/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The formulas of the reconstructions; each cites its source. A row of the table is a function of the five cells of a
 * stencil; LOOP makes its loop over lines. */
#include "libcore/schemes/reconstruct.h"

/* Returns the value of one field at the right face of cell c, from five cells in a row. */
typedef double face_value(double a, double b, double c, double d, double e);

ALWAYS_INLINE double first_order(double a, double b, double c, double d, double e) {
    (void)a, (void)b, (void)d, (void)e;
    return c;
}

/* Piecewise hyperbolic method, Marquina (1994); docs/physics.md 6.8. With differences l, r of one sign, harmonic mean
 * d = 2 l r/(l + r) and z = a/2 (z = sqrt(2r/(l+r)) - 1 if |l| <= |r|, else 1 - sqrt(2l/(l+r)), so |z| <= sqrt 2 - 1)
 *   r(1/2) = q + d/2 [1/(1 - z) - (atanh(z)/z - 1)/z],   (atanh(z)/z - 1)/z = z (1/3 + z^2/5 + z^4/7 ..)
 * With s = l + r and the root in z: 1/(1 - z) = s (2 + root)/(2 (s + l)) if |l| <= |r|, else s root/(2 l).
 * The series is a Chebyshev fit on z^2 <= (sqrt 2 - 1)^2, error 6e-15: no logarithm, no cancellation at z = 0.
 * Differences so small that l r has lost digits, and 1/(s below) may be infinite, count as none. */
ALWAYS_INLINE double phm(double a, double b, double c, double d, double e) {
    (void)a, (void)e;
    double l = c - b, r = d - c, sum = l + r;
    double wide = fabs(l) <= fabs(r) ? 1 : 0, big = wide > 0 ? r : l, sign = fma(2, wide, -1);
    double below = fma(wide, sum, l);   /* s + l or l */
    double inverse = 1 / (sum * below); /* one division for 1/sum and 1/(1 - z) */
    double inverse_sum = below * inverse, root = sqrt(2 * big * inverse_sum);
    double z = sign * (root - 1), w = z * z, w2 = w * w, w4 = w2 * w2;
    double s0 = fma(0.20000000000496251, w, 0.33333333333332907);
    double s1 = fma(0.11111118149621544, w, 0.14285714190649538);
    double s2 = fma(0.076979387131951564, w, 0.090906456173762298);
    double s3 = fma(0.064531900997139819, w, 0.065940553207767167);
    double s4 = fma(0.10997920174382668, w, 0.026302098770333701);
    double series = fma(fma(s4, w4, fma(s3, w2, s2)), w4, fma(s1, w2, s0));
    double pole = 0.5 * (sum * sum) * inverse * (1 + sign + root); /* 1/(1 - z) */
    double change = l * r * inverse_sum * fma(-z, series, pole);
    return l * r > 0x1p-1022 ? c + change : c;
}

/* Returns the epsilon of the weights: 1e-6 of the squared scale of the stencil, so that weights do not depend on the
 * unit. What is added to that is too little to change a bit where values exceed 1e-25, and makes the weights of a
 * stencil of zeros the linear ones; its fourth power, of which weights are ratios, is a normal number. Values up to
 * 1e37 keep these powers finite. To multiply them by powers of two first would free all values, and takes 9 % more
 * time. */
ALWAYS_INLINE double weight_epsilon(double a, double b, double c, double d, double e) {
    return fma(2e-7, fma(a, a, b * b) + fma(c, c, d * d) + e * e, 1e-75);
}

struct parabolas { /* smoothness (Jiang & Shu) plus epsilon, and 6 (face value - c), of the three stencils */
    double b0, b1, b2, v0, v1, v2;
};
/* Computes the parabolas from differences, so that constants are kept exactly; the smoothness is 12/13 of Jiang &
 * Shu's. */
ALWAYS_INLINE struct parabolas parabolas(double a, double b, double c, double d, double e) {
    double e1 = b - a, e2 = c - b, e3 = d - c, e4 = e - d;
    double epsilon = 12. / 13 * weight_epsilon(a, b, c, d, e);
    double t0 = e2 - e1, t1 = e3 - e2, t2 = e4 - e3;
    double s0 = fma(3, e2, -e1), s1 = e2 + e3, s2 = fma(3, e3, -e4);
    return (struct parabolas){.b0 = fma(t0, t0, fma(3. / 13 * s0, s0, epsilon)),
                              .b1 = fma(t1, t1, fma(3. / 13 * s1, s1, epsilon)),
                              .b2 = fma(t2, t2, fma(3. / 13 * s2, s2, epsilon)),
                              .v0 = fma(5, e2, -2 * e1),
                              .v1 = fma(2, e3, e2),
                              .v2 = fma(4, e3, -e4)};
}

/* Returns the face value for weights n0, n1, n2 of the parabolas. */
ALWAYS_INLINE double weighted(double c, struct parabolas p, double n0, double n1, double n2) {
    return c + fma(n0, p.v0, fma(n1, p.v1, n2 * p.v2)) / (6 * (n0 + n1 + n2));
}

/* WENO5 of Jiang & Shu (1996; docs/physics.md 6.9): linear weights 1/10, 6/10, 3/10 over the squared smoothness, on one
 * denominator. */
ALWAYS_INLINE double weno5(double a, double b, double c, double d, double e) {
    struct parabolas p = parabolas(a, b, c, d, e);
    double q0 = p.b0 * p.b0, q1 = p.b1 * p.b1, q2 = p.b2 * p.b2;
    return weighted(c, p, q1 * q2, 6 * (q0 * q2), 3 * (q0 * q1));
}

/* WENO-Z of Borges et al. (2008): the linear weights times 1 + (tau/b)^2, tau = |b0 - b2|: power 2, and epsilon 1e-6 of
 * the stencil's squared scale as in all of these. On one denominator, products of six squares would underflow. */
ALWAYS_INLINE double wenoz(double a, double b, double c, double d, double e) {
    struct parabolas p = parabolas(a, b, c, d, e);
    double b01 = p.b0 * p.b1, b02 = p.b0 * p.b2, b12 = p.b1 * p.b2, inverse = (p.b0 - p.b2) / (b01 * p.b2);
    double r0 = inverse * b12, r1 = inverse * b02, r2 = inverse * b01; /* tau/b */
    return weighted(c, p, fma(r0, r0, 1), 6 * fma(r1, r1, 1), 3 * fma(r2, r2, 1));
}

/* TENO5 of Fu, Hu & Adams (2016): a stencil counts with its linear weight, or not at all where its share of
 * (C + tau/b)^q is below C_T; C = 1, q = 6, C_T = 1e-5, tau and epsilon as in WENO-Z. */
ALWAYS_INLINE double sixth_power(double x) {
    return x * x * x * (x * x * x);
}
ALWAYS_INLINE double teno5(double a, double b, double c, double d, double e) {
    struct parabolas p = parabolas(a, b, c, d, e);
    double tau = fabs(p.b0 - p.b2), g0 = (p.b0 + tau) * (p.b1 * p.b2), g1 = (p.b1 + tau) * (p.b0 * p.b2);
    double g2 = (p.b2 + tau) * (p.b0 * p.b1), inverse = 1 / (g0 + g1 + g2); /* else the powers overflow */
    g0 = sixth_power(g0 * inverse);
    g1 = sixth_power(g1 * inverse);
    g2 = sixth_power(g2 * inverse);
    double least = 1e-5 * (g0 + g1 + g2);
    return weighted(c, p, g0 < least ? 0 : 1, g1 < least ? 0 : 6, g2 < least ? 0 : 3);
}

/* Returns twice the power_3 limiter of Serna & Marquina (2004): the sum of x and y of one sign, times
 * 1 - |(x - y)/(x + y)|^3. With m the smaller one and r = m/(x + y) that is m (6 - 12 r + 8 r^2), which keeps the
 * digits of m: 1 - |..|^3 has the round-off of the larger one, 1e-7 of m beside a jump of 1e9 m. */
ALWAYS_INLINE double twice_power3(double x, double y) {
    double m = fabs(x) <= fabs(y) ? x : y, r = m / (x + y);
    double value = m * fma(r, fma(8, r, -12), 6);
    return x * y > 0 ? value : 0;
}

/* Weighted PowerENO5, Serna & Marquina (2004); docs/physics.md 6.10: linear weights 1/5, 1/5, 3/5 of the left, central
 * and right parabola, whose second differences are limited by power_3. */
ALWAYS_INLINE double wpeno5(double a, double b, double c, double d, double e) {
    double e1 = b - a, e2 = c - b, e3 = d - c, e4 = e - d, epsilon = weight_epsilon(a, b, c, d, e);
    double D = e3 - e2, PL = twice_power3(e2 - e1, D), PR = twice_power3(D, e4 - e3);
    double sl = fma(0.25, PL, e2), sc = 0.5 * (e2 + e3), sr = fma(-0.25, PR, e3);
    double bl = fma(13. / 48 * PL, PL, fma(sl, sl, epsilon));
    double bc = fma(13. / 12 * D, D, fma(sc, sc, epsilon));
    double br = fma(13. / 48 * PR, PR, fma(sr, sr, epsilon));
    bl *= bl;
    bc *= bc;
    br *= br;
    double nl = bc * br, nc = bl * br, nr = 3 * (bl * bc);
    double sum = fma(nl, fma(3, e2, PL), fma(nc, fma(2, e3, e2), nr * fma(3, e3, -0.5 * PR)));
    return c + sum / (6 * (nl + nc + nr));
}

/* wide: does the formula read five cells? Where the three upwind ones are equal to the bit, the value is theirs:
 * weights would carry some of a shock (1e-8 of it) into the uniform gas ahead, which could then not be skipped. */
ALWAYS_INLINE void line(face_value *value, const bool wide, int n, const double *const q[5], double *restrict out) {
    const double *a = q[0], *b = q[1], *c = q[2], *d = q[3], *e = q[4];
    for (int i = 0; i < n; i++) {
        const double face = value(a[i], b[i], c[i], d[i], e[i]);
        const uint64_t even = -(uint64_t)(fabs(b[i] - a[i]) + fabs(c[i] - b[i]) == 0);
        out[i] = wide ? select_masked(even, c[i], face) : face;
    }
}

#define LOOP(value, wide)                                                                                              \
    KERNEL static void value##_line(int n, const double *const q[5], double *restrict out) {                           \
        line(value, wide, n, q, out);                                                                                  \
    }
LOOP(phm, false)
LOOP(wpeno5, true)
LOOP(weno5, true)
LOOP(wenoz, true)
LOOP(teno5, true)
LOOP(first_order, false)
#define ROW(name, about, reach, value)                                                                                 \
    { MODEL(name, about), reach, value##_line }

const struct reconstruct reconstruct_table[] = {
    ROW("PHM", "piecewise hyperbolic, third order on monotone data, for shocks (Marquina 1994)", 1, phm),
    ROW("WPENO5", "Weighted PowerENO5 (Serna & Marquina 2004)", 2, wpeno5),
    ROW("WENO5", "WENO5 with the weights of Jiang & Shu (1996)", 2, weno5),
    ROW("WENOZ", "WENO-Z, less dissipative than WENO5 (Borges et al. 2008)", 2, wenoz),
    ROW("TENO5", "targeted ENO: full order or none of a stencil (Fu, Hu & Adams 2016)", 2, teno5),
    ROW("firstOrder", "the cell's value", 0, first_order),
};
const int reconstruct_count = sizeof reconstruct_table / sizeof *reconstruct_table;

const struct reconstruct *reconstruct_find(const char *name) {
    return model_find(reconstruct_table, sizeof *reconstruct_table, reconstruct_count, name);
}
