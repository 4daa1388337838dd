/* Source terms, integrated exactly: Haff's cooling and gravity, constant or shaken (physics 1.1, 1.3). */
#ifndef LIBCORE_SOURCE_H
#define LIBCORE_SOURCE_H

#include "libcore/eos.h"
#include "libcore/kernel.h"

struct sources {                        /* zeroed: no source, which costs nothing */
    bool cooling;                       /* Haff (1983), Serna & Marquina (2); no effect at e = 1 */
    double gravity[MAX_DIM];            /* m/s^2, computational axes */
    double amplitude, frequency, phase; /* g(t) = gravity (1 + amplitude cos(2 pi frequency t + phase)); -, Hz, rad */
};
bool source_active(const struct sources *s, const struct material *m);

/* Velocity gained from t to t + dt: the exact integral of g(t), m/s. */
void source_kick(const struct sources *s, double t, double dt, double kick[MAX_DIM]);

/* n cells: U[v] = rho, rho u .., E are moved by dt; temperature first, T = T0 / (1 + B sqrt(T0) dt/2)^2 with
 * B = (gamma - 1)(12/sqrt pi)(1 - e^2) G/sigma, then the velocity by `kick`. */
void source_apply(const struct sources *s, const struct eos *eos, const struct material *m, int n, int dim, double dt,
                  const double kick[MAX_DIM], double *const U[MAX_VAR]);

#endif
