/* Source terms: Haff's cooling and gravity, constant or shaken (physics 1.1, 1.3), integrated exactly.
 *
 * Grains whose collisions are elastic below a normal impact speed v_c (material.threshold) lose less. Pairs of
 * Maxwellian grains meet at the normal speed w with density ~ w e^(-w^2/4T) (T per unit mass: w has variance 2T) and
 * lose (1 - e^2) w^2/4, so that the sink is multiplied by
 *   phi(x) = int_vc^inf w^3 e^(-w^2/4T) dw / int_0^inf .. = (1 + x) e^-x,  x = v_c^2/(4T):
 * 1 in warm gas, 0.0005 at T = v_c^2/40. So T stays above zero for all time, and a cluster is held up by its pressure.
 * That keeps its factor 1 + e, and with it p = rho T A(nu): elastic impacts would raise the collisional part of p by
 * up to (1 - e)/(1 + e) where T < v_c^2/10 (1.5 % at e = 0.97, two thirds at e = 0.2), and not at all where T >> v_c^2.
 */
#ifndef LIBCORE_SOURCE_H
#define LIBCORE_SOURCE_H

#include "libcore/models/eos.h"
#include "libcore/models/kernel.h"

struct sources {                        /* zeroed: no source, which costs nothing */
    bool cooling;                       /* Haff (1983), Serna & Marquina (2); no effect at e = 1 */
    double gravity[MAX_DIM];            /* m/s^2, computational axes */
    double amplitude, frequency, phase; /* g(t) = gravity (1 + amplitude cos(2 pi frequency t + phase)); -, Hz, rad */
    int knots;                          /* > 0: amplitude is linear between them, and constant before and beyond */
    const double *ramp;                 /* [knots][2] time in rising order (s), amplitude; not owned */
};
bool source_active(const struct sources *s, const struct material *m);
bool source_cools(const struct sources *s, const struct material *m); /* whether collisions take energy */
bool source_shaken(const struct sources *s);

/* Velocity gained from t to t + dt: the exact integral of g(t), m/s. */
void source_kick(const struct sources *s, double t, double dt, double kick[MAX_DIM]);

/* n cells: U[v] = rho, rho u .., E are moved by dt; temperature first, T = T0 / (1 + B sqrt(T0) dt/2)^2 with
 * B = (gamma - 1)(12/sqrt pi)(1 - e^2) G/sigma (disks: 4 in place of 12), then the velocity by `kick`. With a threshold
 * the temperature step is of second order in dt; for any dt T stays positive, does not rise, and is within 27 % of the
 * exact value. */
void source_apply(const struct sources *s, const struct eos *eos, const struct material *m, int n, int dim, double dt,
                  const double kick[MAX_DIM], double *const U[MAX_VAR]);

#endif
