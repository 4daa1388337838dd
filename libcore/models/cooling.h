/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cooling laws: the rate at which impacts take granular temperature. A law is one function and one row of
 * cooling_table. docs/physics.md 3.2 and 3.3 have Haff's law and the threshold speed of impacts.
 *
 * Haff (1983), Serna & Marquina (2): T = (gamma - 1) eps falls by
 *     dT/dt = -B T^(3/2),  B = (gamma - 1) (12/sqrt pi) (1 - e^2) G/sigma;  for disks 4 stands in place of 12.
 * Grains whose collisions are elastic below a normal impact speed v_c (material.threshold) lose less. Pairs of
 * Maxwellian grains meet at the normal speed w with density ~ w e^(-w^2/4T) (T per unit mass: w has variance 2T) and
 * lose (1 - e^2) w^2/4, so that the sink is multiplied by
 *   phi(x) = int_vc^inf w^3 e^(-w^2/4T) dw / int_0^inf .. = (1 + x) e^-x,  x = v_c^2/(4T):
 * 1 in warm gas, 0.0005 at T = v_c^2/40. So T stays above zero for all time, and a cluster is held up by its pressure.
 * The pressure p = rho T A(nu) keeps its factor 1 + e all the same: elastic impacts would raise its collisional part
 * by up to (1 - e)/(1 + e) where T < v_c^2/10 (1.5 % at e = 0.97, two thirds at e = 0.2), and not at all where
 * T >> v_c^2.
 *
 * Grains of dense sheared gas collide with the same partners again and again, so that an impact takes less energy
 * (docs/physics.md 3.7; Jenkins 2007): the rate is B T^(3/2) sigma/L, with a length L of correlations,
 *     L/sigma = max(1, a/sqrt T),  a = f0 shear_rate sigma,
 * and f0 of the row. L is sigma in gas without shear, where the step has the bits of Haff's law. */
#ifndef LIBCORE_COOLING_H
#define LIBCORE_COOLING_H

#include "libcore/models/closure.h"

struct cooling {
    struct model model;      /* its parameters fill a struct of the law's own */
    enum grains_shape valid; /* the grains that the law is for */
    unsigned needs;          /* bits NEEDS_.. of closure.h */
    /* Advances eps (J/kg, > 0) of a line of cells by dt (s). For any dt eps stays positive and does not rise. params:
     * values of the row's parameters. */
    void (*step)(const struct own_params *params, const struct closure_line *cells, double dt, double *restrict eps);
};

/* Haff without a threshold is exact; with a threshold it is of second order in dt, and within 27 % of the exact value
 * however long dt is. Laws with L are of second order over two half steps, of which the second one is `late`. */
extern const struct cooling cooling_table[];
extern const int cooling_count;
const struct cooling *cooling_find(const char *name); /* NULL: there is no such law */

#endif
