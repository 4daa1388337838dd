/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bed with friction, for tests. */
#ifndef TESTS_FRICTION_BED_H
#define TESTS_FRICTION_BED_H

#include "tests/libcore/acoustics/box_bed.h"

static struct comm *comm;
static const double PACKED = 0.61, THIN = 1e-4, PRESSURE = 5;

static inline struct friction_use law(const char *name, double mu) {
    return (struct friction_use){friction_find(name),
                                 {.mu_static = mu,
                                  .mu_dynamic = 1.5 * mu,
                                  .I0 = 0.279,
                                  .alpha_friction = 0.50,
                                  .alpha_solid = 0.576,
                                  .modulus = 300},
                                 .grain = sqrt(6 / acos(-1))};
}

/* A bed with friction whose gas has no stress yet, and whose walls are smooth and at rest. */
static inline void make(struct box *x, const struct box_form *form) {
    box_make_of(x, comm, "TorquatoSpheres", 1, form);
    struct bed_set *b = &x->bed.set;
    memset(b->pressure, 0, (size_t)b->cells * sizeof(double));
    memset(b->wall_friction, 0, (size_t)b->faces * sizeof(double));
    for (int i = 0; i < bed_tensors(x->bed.components); i++) memset(b->stress[i], 0, (size_t)b->faces * sizeof(double));
    for (int k = 0; k < x->bed.components; k++) memset(b->wall_speed[k], 0, (size_t)b->faces * sizeof(double));
}

/* Friction alone: whether the rest of the step succeeds does not matter. */
static inline void rub(struct box *x, double dt) {
    const double weightless[MAX_DIM] = {0};
    bool done;
    ok(bed_step(&x->bed, dt, weightless, &done));
}

/* Returns the modulus G that bed_rub takes where gas is packed. */
static inline double modulus_of(const struct box *x) {
    return x->bed.friction.params.modulus * PRESSURE;
}

static inline double distance(const struct box *x, int i, const double about[3]) {
    double square = 0;
    for (int k = 0; k < x->bed.dim; k++) square += (x->centre[i][k] - about[k]) * (x->centre[i][k] - about[k]);
    return sqrt(square);
}

static inline int start(void **state) {
    int argc = 0;
    char **argv = NULL;
    (void)state;
    ok(comm_start(&argc, &argv, &comm));
    return 0;
}
static inline int finish(void **state) {
    (void)state;
    comm_finish(comm);
    return 0;
}

#endif
