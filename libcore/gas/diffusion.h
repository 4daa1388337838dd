/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscous stress and heat conduction over part of a time step: a table of schemes that take their many small steps.
 *
 * rho and the coefficients are frozen (docs/physics.md 8.1); then velocity and temperature obey linear equations of
 * their own,
 *     rho du/dt = div tau(u),  rho/(gamma - 1) dT/dt = div (heat grad T),
 * in short rho dq/dt = L q. A scheme of s stages takes q_0 over dt to q_s by sums S_j of earlier stages:
 *     S_j = a S_(j-1) + b S_(j-2) + dt (c q_(j-1) + d q_0),  S_0 = 0,  q_j = q_0 + L S_j / rho,
 * so that S_s is dt times a mean velocity u* (or temperature) and the faces pass on tau(S_s): the scheme conserves,
 * and where q is uniform nothing changes. The work of the stress is that on u*: E changes by div (tau(S_s) . u*). This
 * heats the gas by S_s : tau(S_s)/dt, which is no less than 0, and by (u* - (u_0 + u_s)/2) . L S_s, which is no less
 * than 0 for every mode of a scheme that damps no faster than Crank-Nicolson, as the schemes of the table. That heat is
 * a constant source in the equation of T; q_j gets it in proportion to the sum of its weights. `rate` is the largest
 * sum over a cell's faces of (face coefficient)/(rho h^2): an Euler step with dt rate <= 1 is stable, and T after it is
 * a mean of temperatures. */
#ifndef LIBCORE_DIFFUSION_H
#define LIBCORE_DIFFUSION_H

#include "libcore/models/param.h"

/* The implicit schemes (libcore/gas/implicit.h). */
enum implicit_scheme { BY_SDIRK, BY_MIDPOINT, BY_GAUSS };

struct diffusion {
    struct model model;
    /* Returns into how many equal super steps to cut a time, ratio = time * rate, and sets the stages of one. NULL:
     * steps are implicit (libcore/gas/implicit.h). */
    long (*plan)(double ratio, int *stages);
    void (*stage)(int stages, int j, double out[4]); /* sets a, b, c, d of stage j; only c counts for j = 1 */
    enum implicit_scheme implicit;                   /* where plan is NULL */
};
extern const struct diffusion diffusion_table[];
extern const int diffusion_count;
const struct diffusion *diffusion_find(const char *name); /* NULL: there is no such scheme */

#endif
