/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implicit steps of diffusion (docs/physics.md 8.3): they solve the two linear problems of diffusion.h.
 *
 * A step of dt uses the L-stable SDIRK scheme of two stages, gamma = 1 - 1/sqrt 2 (Alexander 1977), which is of second
 * order:
 *     rho q_1 = rho q_0 + gamma dt L q_1,  rho q_2 = rho q_0 + dt L ((1 - gamma) q_1 + gamma q_2),
 *     S = dt ((1 - gamma) q_1 + gamma q_2), which the faces take;
 * for heat the right sides have rho gamma h and rho h, too, where h is the change of T by friction less cooling in the
 * step (diffusion.c). R(z) = (1 - (1 - 2 gamma) z)/(1 + gamma z)^2 exceeds that of Crank-Nicolson by
 *     gamma^2 z^3/((2 + z)(1 + gamma z)^2),
 * so that the work of the stress heats (diffusion.h). The state gets the solution by S alone, so that the fluxes
 * conserve whatever error the solver left; a residual r of the second stage makes q end r/rho beside q_2. R is negative
 * for z > 2.4, down to -0.21: a hot cell may end below its surroundings. If a cell becomes inadmissible, steps of
 * backward Euler take over, after which each temperature is a mean of temperatures.
 *
 * Two schemes of Shakeri et al. are A-stable only, so that stiff modes stay
 * (tests/libcore/lattice/test_mpi_rational.c): the implicit midpoint rule, one stage with gamma = 1/2 and S = dt q_1, R
 * = (1 - z/2)/(1 + z/2), and the method of Gauss & Legendre of two stages and fourth order, R = (1 - z/2 + z^2/12)/(1 +
 * z/2 + z^2/12), which exceeds that of Crank-Nicolson, too. Let m = (q_1 + q_2)/2 and e = (q_2 - q_1)/2 be of its
 * stages, s = sqrt 3/6, and Z = dt L/rho, to which the values at the edges belong: then e = s (Z m + h),  m = q_0 +
 * sqrt 3 e - s Z e,  S = dt m, so that m solves (1 - Z/2 + Z^2/12) m = .., a system near (1 - s Z)^2 m = .., with the
 * matrix of the other schemes at gamma = s: as z runs over all modes the first is 1 to (2 + sqrt 3)/4 of the second. So
 *     (1 - s Z) y = q_0 - m + sqrt 3 e - s Z e,  (1 - s Z) d = y,  m += w d,  w = 8/(6 + sqrt 3),
 * leaves 0.035 of the error each time. y - e solves (1 - s Z)(y - e) = q_0 - m + (sqrt 3 - 1) e, with nothing large on
 * the right.
 *
 * PETSc solves the systems: that of heat by conjugate gradients; that of the stress, which walls and varying
 * viscosities keep from being quite symmetric, and that of heat on meshes where lines of centres are oblique to faces,
 * by conjugate residuals. The preconditioner is the part of the jumps that couples no components, factored incompletely
 * on each rank. So runs agree to the bit only on the same number of ranks, else to the solver's tolerance: 1e-6 of
 * every cell's T, or of the speed that its energy amounts to, far below the errors of the splitting and of frozen
 * coefficients. PETSc's part is a module of its own, which the caller of gas_make finds and hands over in struct
 * gas_models (solvers/gas/linear.h loads it when a run asks for it). This header is all that both sides share. */
#ifndef LIBCORE_IMPLICIT_H
#define LIBCORE_IMPLICIT_H

#include "mesh/base/status.h"

/* A positive definite system: this rank's rows of the symmetric matrix that the preconditioner is made from, and the
 * system itself as a function. */
struct linear_system {
    void *comm;         /* MPI_Comm * */
    bool symmetric;     /* is the system itself symmetric, too? */
    int unknowns;       /* unknowns of a cell, one behind the other */
    int rows;           /* rows of this rank: cells * unknowns */
    int *first;         /* [rows + 1] where a row begins in column and value */
    int *column;        /* numbers over all ranks, ascending in a row */
    double *value;      /* the entries, which may change from solution to solution */
    const void *caller; /* first argument of the functions */
    void (*apply)(const void *caller, const double *x, double *y); /* computes y = A x */
    /* Returns the error of x over all ranks, from its residual; 1 is good enough. */
    double (*error)(const void *caller, const double *x, const double *residual);
};

struct linear_solver;
/* The functions of the module, which exports them as `haff_linear_module`. They return NULL or PETSc's text of an
 * error. */
struct linear_module {
    const char *(*make)(const struct linear_system *s, struct linear_solver **out);
    const char *(*prepare)(struct linear_solver *l); /* takes note of new values */
    /* Solves A x = b; iterations: their number, < 0 on all ranks if it was not solved. */
    const char *(*solve)(struct linear_solver *l, const double *b, double *x, int *iterations);
    void (*free)(struct linear_solver *l);
};

struct gas;
struct implicit;
/* Makes the systems of stress and of heat, and their solvers, for a gas whose models and engine are set. */
status implicit_make(struct gas *g, struct implicit **out);
void implicit_free(struct implicit *p);

#endif
