/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tools that every kernel shares: the batch, the clones for instruction sets, and powers, exponentials and
 * logarithms with the same bits everywhere.
 *
 * A kernel works on lines of at most BATCH numbers: variables outside, faces (or cells) inside. It cannot fail, calls
 * no library function in a loop but sqrt, fabs and fma (all exact to the last bit), and selects where others branch.
 * Terms that a swap of axes or a mirror exchanges are added without fma, which would tell them apart. */
#ifndef LIBCORE_KERNEL_H
#define LIBCORE_KERNEL_H

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

enum {
    BATCH = 64,  /* faces or cells in a line */
    MAX_DIM = 3, /* components of a vector */
    MAX_VAR = 5  /* rho, the components of rho u, E */
};

/* KERNEL makes one clone of a function per instruction set, chosen when the program starts; sums stay in program order,
 * so the bits agree. clang gives target_clones resolvers external linkage even for static functions: KERNEL names must
 * be unique in the whole program (a test checks). */
#if defined(__x86_64__) && !defined(HAFF_NO_CLONES)
#define KERNEL __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define KERNEL __attribute__((noinline)) /* as clones are */
#endif
#define ALWAYS_INLINE static inline __attribute__((always_inline))
#define ALIGNED       _Alignas(64) /* of lines: a vector then lies in one line of the cache */

/* Stands before a loop over lines that do not overlap. Compilers else compare the addresses of all lines that a loop
 * reads and writes before they enter it, and of more than some ten they make no vectors at all. clang still compares,
 * but any number of lines: told that nothing overlaps, it may let all turns share an array that the loop declares.
 * EACH_SURE tells it so, before loops that else get no vectors: what these declare has no array whose index is a
 * variable, even of an unrolled loop. UNROLL stands before a loop of few turns inside of such a loop: gcc makes vectors
 * of no loop that holds another. */
#ifdef __clang__
#define EACH_ALONE _Pragma("clang loop vectorize(enable)")
#define EACH_SURE  _Pragma("clang loop vectorize(assume_safety)")
#define UNROLL     _Pragma("clang loop unroll(full)")
#else
#define EACH_ALONE _Pragma("GCC ivdep")
#define EACH_SURE  EACH_ALONE
#define UNROLL     _Pragma("GCC unroll 8")
#endif

static inline double select_double(bool condition, double yes, double no) {
    return condition ? yes : no;
}
static inline double larger(double a, double b) {
    return a > b ? a : b;
}
static inline double smaller(double a, double b) {
    return a < b ? a : b;
}

static inline uint64_t bits_of(double x) {
    uint64_t b;
    memcpy(&b, &x, sizeof b);
    return b;
}
static inline double double_of(uint64_t b) {
    double x;
    memcpy(&x, &b, sizeof x);
    return x;
}
/* All bits are set where the condition holds: as wide as the numbers, such conditions are joined without being turned.
 */
static inline uint64_t is(bool condition) {
    return -(uint64_t)condition;
}
/* Selects by a mask whose bits are all set or all clear: compilers make no vectors of loops with many conditions. */
static inline double select_masked(uint64_t mask, double yes, double no) {
    return double_of((bits_of(yes) & mask) | (bits_of(no) & ~mask));
}

/* ln x of a normal x > 0, error below 4e-16 (1 + |ln x|): 2 atanh((m-1)/(m+1)) on sqrt(1/2) <= m < sqrt 2 by a
 * Chebyshev fit of (atanh(s)/s - 1)/s^2 (error 1.6e-16, which counts s^2 < 0.03 times). Plain IEEE operations, here and
 * below, so the bits are the same on every machine, and they vectorise (libm's log, exp and pow do neither). */
static inline double logarithm(double x) {
    const uint64_t root_half = 0x3fe6a09e667f3bcdu, one_exponent = (uint64_t)1 << 52;
    uint64_t shifted = bits_of(x) - root_half + 1024 * one_exponent;
    double k = double_of((shifted >> 52) | 0x4330000000000000u) - (4503599627370496.0 + 1024);
    double m = double_of(bits_of(x) - (shifted & 0xfff0000000000000u) + 1024 * one_exponent);
    double s = (m - 1) / (m + 1), w = s * s;
    double w2 = w * w; /* Estrin's scheme: its chains of dependent operations are short */
    double l0 = fma(0.19999999999949752245, w, 0.33333333333333348431);
    double l1 = fma(0.11111105567397539928, w, 0.14285714312987742461);
    double l2 = fma(0.076658608002780206343, w, 0.090914445626308610401);
    double series = fma(fma(fma(0.073082248425217029302, w2, l2), w2, l1), w2, l0);
    return fma(k, 0.69314718055994530942, 2 * fma(s * w, series, s));
}

/* e^y = 2^n (1 + fraction), |fraction| < 0.42, |y| < 690: fraction = e^r - 1 on |r| <= ln 2 / 2 by a Chebyshev fit of
 * (e^r - 1 - r)/r^2 (error 1.1e-16, r^2 < 0.13 times). *exponent = n << 52, to be added to the bits of a double. */
static inline double exponential_fraction(double y, uint64_t *exponent) {
    const double round_bits = 6755399441055744.0; /* 1.5 * 2^52: adding it rounds to an integer */
    double shifted_n = fma(y, 1.4426950408889634074, round_bits), n = shifted_n - round_bits;
    /* subtracts n ln 2 in two parts */
    double r = fma(-n, 1.90821492927058770002e-10, fma(-n, 0.693147180369123816490, y));
    double r2 = r * r, r4 = r2 * r2;
    double e0 = fma(0.16666666666666667452, r, 0.50000000000000010211);
    double e1 = fma(0.0083333333333300644495, r, 0.041666666666624161903);
    double e2 = fma(0.00019841269863040545271, r, 0.0013888888917196719077);
    double e3 = fma(2.7557268480310025526e-6, r, 0.000024801521322368693266);
    double e4 = fma(2.5100375832561233664e-8, r, 2.7620075879983366586e-7);
    double high = fma(e4, r4, fma(e3, r2, e2));
    *exponent = bits_of(shifted_n) << 52;
    return fma(r2, fma(high, r4, fma(e1, r2, e0)), r);
}
static inline double exponential(double y) {
    uint64_t exponent;
    double e = 1 + exponential_fraction(y, &exponent);
    return double_of(bits_of(e) + exponent);
}

/* x^a for a normal x > 0 and |a ln x| < 690, relative error below 4e-16 (2 + |a ln x|). */
static inline double power(double x, double a) {
    return exponential(a * logarithm(x));
}

/* e^y - 1 for |y| < 690 and ln(1 + y) for 0 <= y < 1e300, with relative errors of 4e-16 (2 + |y|) and 1e-15 however
 * small y is. */
static inline double exponential_minus_one(double y) {
    uint64_t exponent;
    double fraction = exponential_fraction(y, &exponent), scale = double_of(bits_of(1.0) + exponent);
    return fma(scale, fraction, scale - 1);
}
static inline double logarithm_plus_one(double y) {
    double u = 1 + y;
    return logarithm(u) + (y - (u - 1)) / u;
}

#endif
