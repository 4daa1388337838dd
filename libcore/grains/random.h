/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random numbers that are the same on every machine: xoshiro256++ (Blackman & Vigna 2019), seeded through
 * splitmix64. */
#ifndef LIBCORE_RANDOM_H
#define LIBCORE_RANDOM_H

#include <stdbool.h>
#include <stdint.h>

struct random {
    uint64_t s[4];
    double spare; /* second normal number of a pair; NAN: none */
};
struct random random_make(uint64_t seed, uint64_t stream); /* streams of a seed are independent */
double random_uniform(struct random *r);                   /* [0, 1), 53 bits */
double random_normal(struct random *r);                    /* mean 0, variance 1 */
double random_waiting(struct random *r);                   /* exponential, mean 1 */

/* The speeds v > 0 at which the grains of a Maxwellian gas of mean u and deviation sigma (m/s) along a line pass a
 * point of it: n v exp(-(v - u)^2/(2 sigma^2))/(sqrt(2 pi) sigma) dv of them per time and area. With w = (u + sqrt(u^2
 * + 4 sigma^2))/2, where that is greatest, n random_inflow_rate times a normal density about w is nowhere less, for the
 * logarithm bends down by at least 1/sigma^2: candidates come at that rate, and random_inflow accepts each or not.
 * docs/physics.md 10.6; Garcia & Wagner, J. Comput. Phys. 217 (2006) 693 have other envelopes for inlets. */
double random_inflow_rate(double u, double sigma);                       /* m/s */
bool random_inflow(struct random *r, double u, double sigma, double *v); /* is the candidate accepted? its speed */

#endif
