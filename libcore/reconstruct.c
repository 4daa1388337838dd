#include "libcore/reconstruct.h"
#include "libcore/kernel.h"

static void first_order(int n, const double *const q[5], double *restrict out) {
    memcpy(out, q[2], (size_t)n * sizeof *out);
}

/* Piecewise hyperbolic method, Marquina (1994); physics 1.2. With differences l, r of one sign, harmonic mean
 * d = 2 l r/(l + r) and z = a/2 (z = sqrt(2r/(l+r)) - 1 if |l| <= |r|, else 1 - sqrt(2l/(l+r)), so |z| <= sqrt 2 - 1)
 *   r(1/2) = q + d/2 [1/(1 - z) - (atanh(z)/z - 1)/z],   (atanh(z)/z - 1)/z = z (1/3 + z^2/5 + z^4/7 ..)
 * With s = l + r and the root in z: 1/(1 - z) = s (2 + root)/(2 (s + l)) if |l| <= |r|, else s root/(2 l).
 * The series is a Chebyshev fit on z^2 <= (sqrt 2 - 1)^2, error 6e-15: no logarithm, no cancellation at z = 0. */
KERNEL static void phm(int n, const double *const q[5], double *restrict out) {
    const double *restrict a = q[1], *restrict b = q[2], *restrict c = q[3];
    double big[BATCH], below[BATCH], sign[BATCH]; /* chosen in a loop of their own: else both choices are carried on */
    for (int i = 0; i < n; i++) {
        double l = b[i] - a[i], r = c[i] - b[i];
        bool right_larger = fabs(l) <= fabs(r);
        big[i] = right_larger ? r : l;
        below[i] = right_larger ? l + r + l : l;
        sign[i] = right_larger ? 1 : -1;
    }
    for (int i = 0; i < n; i++) {
        double l = b[i] - a[i], r = c[i] - b[i], sum = l + r;
        double inverse = 1 / (sum * below[i]); /* one division for 1/sum and 1/(1 - z) */
        double root = sqrt(2 * big[i] * (below[i] * inverse));
        double z = sign[i] * (root - 1), w = z * z, w2 = w * w, w4 = w2 * w2;
        double series =
            ((0.33333333333332907 + 0.20000000000496251 * w) + (0.14285714190649538 + 0.11111118149621544 * w) * w2) +
            (((0.090906456173762298 + 0.076979387131951564 * w) +
              (0.065940553207767167 + 0.064531900997139819 * w) * w2) +
             (0.026302098770333701 + 0.10997920174382668 * w) * w4) *
                w4;
        double pole = 0.5 * (sum * sum) * inverse * (1 + sign[i] + root); /* 1/(1 - z) */
        double change = l * r * (below[i] * inverse) * (pole - z * series);
        out[i] = l * r > 0 ? b[i] + change : b[i];
    }
}

/* Squared scale of a stencil times 1e-6: the epsilon of the weights, so that they do not depend on the unit. */
static inline double weight_epsilon(double a, double b, double c, double d, double e) {
    return 2e-7 * (a * a + b * b + c * c + d * d + e * e) + 1e-40;
}

/* WENO5 of Jiang & Shu (1996), linear weights 1/10, 6/10, 3/10, written in differences (constants are kept exactly)
 * with the three weights on one denominator. */
KERNEL static void weno5(int n, const double *const q[5], double *restrict out) {
    const double *restrict qa = q[0], *restrict qb = q[1], *restrict qc = q[2], *restrict qd = q[3],
                           *restrict qe = q[4];
    for (int i = 0; i < n; i++) {
        double a = qa[i], b = qb[i], c = qc[i], d = qd[i], e = qe[i];
        double e1 = b - a, e2 = c - b, e3 = d - c, e4 = e - d, epsilon = weight_epsilon(a, b, c, d, e);
        double t0 = e2 - e1, t1 = e3 - e2, t2 = e4 - e3;
        double s0 = 3 * e2 - e1, s1 = e2 + e3, s2 = 3 * e3 - e4;
        double b0 = epsilon + 13. / 12 * (t0 * t0) + 0.25 * (s0 * s0);
        double b1 = epsilon + 13. / 12 * (t1 * t1) + 0.25 * (s1 * s1);
        double b2 = epsilon + 13. / 12 * (t2 * t2) + 0.25 * (s2 * s2);
        b0 *= b0;
        b1 *= b1;
        b2 *= b2;
        double n0 = b1 * b2, n1 = 6 * (b0 * b2), n2 = 3 * (b0 * b1);
        double sum = n0 * (5 * e2 - 2 * e1) + n1 * (e2 + 2 * e3) + n2 * (4 * e3 - e4);
        out[i] = c + sum / (6 * (n0 + n1 + n2));
    }
}

/* power_3 limiter of Serna & Marquina (2004): the mean of x and y of one sign, reduced by 1 - |(x - y)/(x + y)|^3. */
static inline double power3(double x, double y) {
    double sum = x + y, t = fabs((x - y) / sum);
    return select_double((x > 0 && y > 0) || (x < 0 && y < 0), 0.5 * sum * (1 - t * t * t), 0);
}

/* Weighted PowerENO5, Serna & Marquina (2004); physics 1.2: linear weights 1/5, 1/5, 3/5 of the left, central and right
 * parabola, whose second differences are limited by power_3. */
KERNEL static void wpeno5(int n, const double *const q[5], double *restrict out) {
    const double *restrict qa = q[0], *restrict qb = q[1], *restrict qc = q[2], *restrict qd = q[3],
                           *restrict qe = q[4];
    for (int i = 0; i < n; i++) {
        double a = qa[i], b = qb[i], c = qc[i], d = qd[i], e = qe[i];
        double e1 = b - a, e2 = c - b, e3 = d - c, e4 = e - d, epsilon = weight_epsilon(a, b, c, d, e);
        double D = e3 - e2, PL = power3(e2 - e1, D), PR = power3(D, e4 - e3);
        double sl = e2 + 0.5 * PL, sc = 0.5 * (e2 + e3), sr = e3 - 0.5 * PR;
        double bl = epsilon + 13. / 12 * (PL * PL) + sl * sl;
        double bc = epsilon + 13. / 12 * (D * D) + sc * sc;
        double br = epsilon + 13. / 12 * (PR * PR) + sr * sr;
        bl *= bl;
        bc *= bc;
        br *= br;
        double nl = bc * br, nc = bl * br, nr = 3 * (bl * bc);
        double sum = nl * (3 * e2 + 2 * PL) + nc * (e2 + 2 * e3) + nr * (3 * e3 - PR);
        out[i] = c + sum / (6 * (nl + nc + nr));
    }
}

const struct reconstruct reconstruct_table[] = {
    {"PHM", "piecewise hyperbolic, third order on monotone data, for shocks (Marquina 1994)", 1, phm},
    {"WPENO5", "Weighted PowerENO5 (Serna & Marquina 2004)", 2, wpeno5},
    {"WENO5", "WENO5 with the weights of Jiang & Shu (1996)", 2, weno5},
    {"firstOrder", "the cell's value", 0, first_order},
};
const int reconstruct_count = sizeof reconstruct_table / sizeof *reconstruct_table;

const struct reconstruct *reconstruct_find(const char *name) {
    for (int i = 0; i < reconstruct_count; i++)
        if (!strcmp(name, reconstruct_table[i].name)) return &reconstruct_table[i];
    return NULL;
}
