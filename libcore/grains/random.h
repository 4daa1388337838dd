/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random numbers that are the same on every machine: xoshiro256++ (Blackman & Vigna 2019), seeded through
 * splitmix64. */
#ifndef LIBCORE_RANDOM_H
#define LIBCORE_RANDOM_H

#include <stdint.h>

struct random {
    uint64_t s[4];
    double spare; /* second normal number of a pair; NAN: none */
};
struct random random_make(uint64_t seed, uint64_t stream); /* streams of a seed are independent */
double random_uniform(struct random *r);                   /* [0, 1), 53 bits */
double random_normal(struct random *r);                    /* mean 0, variance 1 */

#endif
