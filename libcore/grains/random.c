/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Draws random numbers by xoshiro256++, and normal ones by Marsaglia's polar method with our own logarithm: those of
 * libraries differ in their last bits. */
#include "libcore/grains/random.h"

#include "libcore/models/kernel.h"

static uint64_t rotate(uint64_t x, int k) {
    return (x << k) | (x >> (64 - k));
}

/* Applies the bijection of splitmix64 (Steele, Lea & Flood 2014); 0 stays 0. */
static uint64_t mix(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
}

/* Stream 0 is the usual seeding; the others start where a hash of their number says. */
struct random random_make(uint64_t seed, uint64_t stream) {
    struct random r = {.spare = NAN};
    uint64_t x = seed ^ mix(stream);
    for (int k = 0; k < 4; k++) r.s[k] = mix(x += 0x9e3779b97f4a7c15);
    return r;
}

static uint64_t next(struct random *r) {
    uint64_t *s = r->s, out = rotate(s[0] + s[3], 23) + s[0], t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rotate(s[3], 45);
    return out;
}

double random_uniform(struct random *r) {
    return (double)(next(r) >> 11) * 0x1p-53;
}

double random_normal(struct random *r) {
    if (!isnan(r->spare)) {
        double out = r->spare;
        r->spare = NAN;
        return out;
    }
    double a, b, s;
    do {
        a = 2 * random_uniform(r) - 1;
        b = 2 * random_uniform(r) - 1;
        s = a * a + b * b;
    } while (s >= 1 || s == 0);
    double scale = sqrt(-2 * logarithm(s) / s);
    r->spare = b * scale;
    return a * scale;
}

double random_waiting(struct random *r) {
    return -logarithm(1 - random_uniform(r));
}

/* The most frequent of those speeds; its two forms lose no digits. */
static double most_frequent(double u, double sigma) {
    const double root = sqrt(u * u + 4 * sigma * sigma);
    return u > 0 ? 0.5 * (u + root) : 2 * sigma * sigma / (root - u);
}

double random_inflow_rate(double u, double sigma) {
    if (!(sigma > 0)) return fmax(u, 0);
    const double w = most_frequent(u, sigma), y = (w - u) / sigma;
    return y < 35 ? w * exponential(-0.5 * y * y) : 0;
}

bool random_inflow(struct random *r, double u, double sigma, double *v) {
    *v = u;
    if (!(sigma > 0)) return u > 0;
    const double w = most_frequent(u, sigma), s = 1 + sigma / w * random_normal(r), chance = random_uniform(r);
    *v = s * w;
    return s > 0 && s < 600 && chance < s * exponential(1 - s);
}
