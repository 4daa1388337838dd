/* What every kernel shares: the batch, the instruction sets, and a power function with the same bits everywhere.
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
    MAX_VAR = 5  /* rho, rho u (dim of them), E */
};

/* One clone per instruction set, chosen when the program starts; sums stay in program order, so the bits agree. */
#if defined(__x86_64__) && !defined(HAFF_NO_CLONES)
#define KERNEL __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#else
#define KERNEL
#endif
#define ALWAYS_INLINE static inline __attribute__((always_inline))

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

/* x^a for a normal x > 0 and |a ln x| < 690, relative error below 4e-16 (2 + |a ln x|): log by 2 atanh((m-1)/(m+1))
 * on sqrt(1/2) <= m < sqrt 2, exp by its series on |r| <= ln 2 / 2. Plain IEEE operations, so the bits are the same on
 * every machine, and it vectorises (libm's pow does neither). */
static inline double power(double x, double a) {
    const uint64_t root_half = 0x3fe6a09e667f3bcdu, one_exponent = (uint64_t)1 << 52;
    uint64_t shifted = bits_of(x) - root_half + 1024 * one_exponent;
    double k = double_of((shifted >> 52) | 0x4330000000000000u) - (4503599627370496.0 + 1024);
    double m = double_of(bits_of(x) - (shifted & 0xfff0000000000000u) + 1024 * one_exponent);
    double s = (m - 1) / (m + 1), w = s * s;
    double w2 = w * w, w4 = w2 * w2; /* short chains: Estrin's scheme */
    double series = ((1. / 3 + 1. / 5 * w) + (1. / 7 + 1. / 9 * w) * w2) +
                    (((1. / 11 + 1. / 13 * w) + (1. / 15 + 1. / 17 * w) * w2) + (1. / 19 + 1. / 21 * w) * w4) * w4;
    double y = a * (k * 0.69314718055994530942 + 2 * (s + s * w * series));
    const double round_bits = 6755399441055744.0; /* 1.5 * 2^52: adding it rounds to an integer */
    double shifted_n = y * 1.4426950408889634074 + round_bits, n = shifted_n - round_bits;
    double r = (y - n * 0.693147180369123816490) - n * 1.90821492927058770002e-10; /* ln 2 in two parts */
    double r2 = r * r, r4 = r2 * r2;
    double low = (1. / 2 + 1. / 6 * r) + (1. / 24 + 1. / 120 * r) * r2;
    double high = ((1. / 720 + 1. / 5040 * r) + (1. / 40320 + 1. / 362880 * r) * r2) +
                  ((1. / 3628800 + 1. / 39916800 * r) + (1. / 479001600 + 1. / 6227020800 * r) * r2) * r4;
    double e = 1 + (r + r2 * (low + high * r4));
    return double_of(bits_of(e) + (bits_of(shifted_n) << 52));
}

#endif
