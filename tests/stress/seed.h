/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random numbers with the same bits on every machine: splitmix64 (Steele, Lea & Flood 2014), and no libm. */
#ifndef STRESS_SEED_H
#define STRESS_SEED_H

#include "libcore/models/kernel.h"

struct seed {
    uint64_t state;
};

static inline uint64_t seed_next(struct seed *s) {
    uint64_t x = s->state += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}
/* A stream of its own for the problem `number` of a family. */
static inline struct seed seed_start(int family, uint64_t number) {
    struct seed s = {.state = 0x5deece66d + 1000003 * (uint64_t)(family + 1)};
    s.state = seed_next(&s) ^ (number * 0xd1342543de82ef95u);
    (void)seed_next(&s);
    return s;
}
static inline double seed_uniform(struct seed *s, double low, double high) {
    return low + (high - low) * ((double)(seed_next(s) >> 11) * 0x1p-53);
}
static inline int seed_below(struct seed *s, int n) { /* 0 .. n - 1 */
    return (int)(seed_next(s) >> 33) % n;
}
static inline bool seed_chance(struct seed *s, double share) {
    return seed_uniform(s, 0, 1) < share;
}
static inline double seed_power(struct seed *s, double low, double high) { /* 10^low .. 10^high, even in the exponent */
    return power(10, seed_uniform(s, low, high));
}
static inline double seed_sign(struct seed *s) {
    return seed_below(s, 2) ? 1 : -1;
}

#endif
