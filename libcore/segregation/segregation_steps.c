/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of segregation made of basic steps, for lines and lattices alike: damped ones (Rannacher 1984), and ones as
 * long as the error allows (step doubling). */
#include "libcore/segregation/segregation_private.h"

status segregation_damped(const struct segregation_steps *s, double dt, double *phi) {
    memcpy(s->before, phi, (size_t)s->n * sizeof *phi);
    status e = s->step(s->of, 0.5 * dt, 1, phi);
    if (!e) e = s->step(s->of, 0.5 * dt, 1, phi);
    if (e) memcpy(phi, s->before, (size_t)s->n * sizeof *phi);
    return e;
}

/* Returns the weighted mean over all cells of |whole - halves|. */
static double difference(const struct segregation_steps *s) {
    double sum[2] = {0, 0}; /* of |whole - halves| and of 1, with weights */
    if (s->slab) slab_take_turn(s->slab, sum, 2);
    for (long i = 0; i < s->n; i++) {
        const double weight = s->weight ? s->weight[i] : 1;
        sum[0] += weight * fabs(s->whole[i] - s->halves[i]);
        sum[1] += weight;
    }
    if (s->slab) slab_end_turn(s->slab, sum, 2);
    return sum[0] / sum[1];
}

/* Is the mean of both accurate enough, and by which factor may the step grow? Whole steps err by e, halves by e/4,
 * their mean by 5/6 of their difference. */
static bool good(double differ, double allowed, double *factor) {
    const double error = smaller(5. / 6 * differ, 1); /* `differ` is infinite if a step failed */
    *factor = smaller(4, larger(0.25, 0.9 * power(larger(allowed, 1e-290) / larger(error, 1e-290), 1. / 3)));
    return error <= allowed;
}

/* The mean of both damps modes that decay within dt: they change their sign in Crank-Nicolson's whole step and keep it
 * in two halves. */
status segregation_adapt(const struct segregation_steps *s, double allowed, double *dt, double *next, long *rejected,
                         double *phi) {
    const size_t size = (size_t)s->n * sizeof *phi;
    for (int tries = 0; tries < 60; tries++) {
        memcpy(s->whole, phi, size);
        memcpy(s->halves, phi, size);
        status e = s->step(s->of, *dt, 0.5, s->whole);
        if (!e) e = s->step(s->of, 0.5 * *dt, 0.5, s->halves);
        if (!e) e = s->step(s->of, 0.5 * *dt, 0.5, s->halves);
        if (e && status_kind(e) != ERR_STATE) return e;
        double factor, differ = e ? HUGE_VAL : difference(s);
        status_free(e);
        if (good(differ, allowed, &factor)) {
            for (long i = 0; i < s->n; i++) phi[i] = 0.5 * (s->whole[i] + s->halves[i]);
            *next = *dt * factor;
            return OK;
        }
        ++*rejected;
        *dt *= smaller(factor, 0.5);
    }
    return fail(ERR_STATE, "no time step down to %g s has an error below %g", *dt, allowed);
}
