/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grains in a box, for tests of the engine. */
#ifndef TESTS_LIBCORE_GRAINS_SCENE_H
#define TESTS_LIBCORE_GRAINS_SCENE_H

#include "libcore/grains/grains.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/checks.h" /* after what it would hide */

#define PI 3.14159265358979323846

static inline void close_to(double found, double expected, double tolerance, const char *what) {
    if (!(fabs(found - expected) <= tolerance))
        fail_msg("%s: %.17g, expected %.17g within %g", what, found, expected, tolerance);
}

static inline double uniform(uint64_t *seed) {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    return (double)(*seed >> 11) * 0x1p-53;
}

enum { MOST = 5000 };
struct scene {
    struct grain_box box;
    struct grain_law law;
    int n;
    double x[MOST][3], u[MOST][3];
};

static inline struct grains *make(const struct scene *s) {
    struct grains *g;
    ok(grains_make(&s->box, &s->law, s->n, (const double(*)[3])s->x, (const double(*)[3])s->u, 0, &g));
    return g;
}

/* A lattice of n[0] x n[1] (x n[2]) simple cells with diameter 1, velocities uniform with T = 1 and mean 0 */
static inline struct scene *lattice(int dim, const int *n, double spacing, uint64_t seed) {
    struct scene *s = calloc(1, sizeof *s);
    assert_non_null(s);
    s->box = (struct grain_box){.dim = dim, .periodic = {true, true, true}};
    s->law = (struct grain_law){.diameter = 1, .mass = 2, .restitution = 1};
    double mean[3] = {0};
    for (int k = 0; k < dim; k++) s->box.high[k] = n[k] * spacing;
    for (int c = 0; c < n[0] * n[1] * (dim > 2 ? n[2] : 1); c++, s->n++) {
        int at[3] = {c % n[0], c / n[0] % n[1], c / n[0] / n[1]};
        for (int k = 0; k < dim; k++) {
            s->x[c][k] = (at[k] + 0.5) * spacing;
            s->u[c][k] = sqrt(12) * (uniform(&seed) - 0.5);
            mean[k] += s->u[c][k];
        }
    }
    for (int c = 0; c < s->n; c++)
        for (int k = 0; k < dim; k++) s->u[c][k] -= mean[k] / s->n;
    return s;
}

/* What a listener may keep */
struct recorder {
    struct grain_observer observer;
    int n;
    struct grain_impact impact[2000];
    double virial; /* sum of impulse * distance of centres of pairs */
};
static inline void record(struct grain_observer *self, const struct grain_impact *i) {
    struct recorder *r = (struct recorder *)self;
    if (r->n < 2000) r->impact[r->n++] = *i;
    if (i->b < 0) return;
    for (int k = 0; k < 3; k++) r->virial += i->impulse * i->normal[k] * (i->x[1][k] - i->x[0][k]);
}
static inline struct recorder *recorder(void) {
    struct recorder *r = calloc(1, sizeof *r);
    assert_non_null(r);
    r->observer.impact = record;
    return r;
}

/* Kinetic and potential energy; momentum p */
static inline double total(const struct grains *g, double p[3]) {
    double kinetic, potential;
    grains_energy(g, &kinetic, &potential, p);
    return kinetic + potential;
}

#endif
