/* Diffusion by implicit steps: the two linear problems of diffusion.h, solved.
 *
 * A step of dt is that of the L-stable SDIRK of two stages, gamma = 1 - 1/sqrt 2 (Alexander 1977), which is of second
 * order:
 *     rho q_1 = rho q_0 + gamma dt L q_1,  rho q_2 = rho q_0 + dt L ((1 - gamma) q_1 + gamma q_2),
 *     S = dt ((1 - gamma) q_1 + gamma q_2), which the faces take;
 * of heat rho gamma h and rho h on the right sides, h what friction less cooling makes of T in the step (diffusion.c).
 * Its R(z) = (1 - (1 - 2 gamma) z)/(1 + gamma z)^2 is above that of Crank-Nicolson by gamma^2 z^3/((2 + z)(1 + gamma
 * z)^2), so its work heats (diffusion.h). The solution enters by S alone, so its faces conserve whatever
 * the solver left; from a residual r of the second stage q ends r/rho beside q_2. R is below 0 for z > 2.4, down to
 * -0.21: a hot cell may end below its surroundings. Where one becomes inadmissible, steps of backward Euler take over,
 * after which a temperature is a mean of temperatures.
 *
 * PETSc solves the systems by conjugate gradients, that of the stress, which walls and varying viscosities keep from
 * being quite symmetric, and those on meshes whose lines of centres lean on faces, by conjugate residuals; all with the
 * part of the jumps that couples no components, factored incompletely on each rank. So runs agree to the bit only on
 * the same number of ranks, else to the solver's tolerance: 1e-6 of every cell's T, or of the speed of its energy,
 * below the errors of the splitting and of frozen coefficients by far. PETSc's part is a module of its own, which
 * whoever makes a gas finds and hands over in struct gas_models (solvers/gas/linear.h loads it when a run asks for it).
 * This header is all that both sides share.
 */
#ifndef LIBCORE_IMPLICIT_H
#define LIBCORE_IMPLICIT_H

#include "mesh/base/status.h"

/* Positive: this rank's rows of what the preconditioner is made from, which is symmetric, and the system itself as a
 * function. */
struct linear_system {
    void *comm;                                                    /* MPI_Comm * */
    bool symmetric;                                                /* the system itself, too? */
    int unknowns;                                                  /* of a cell; they follow each other */
    int rows;                                                      /* = cells * unknowns */
    int *first;                                                    /* [rows + 1] into column and value */
    int *column;                                                   /* over all ranks, ascending in a row */
    double *value;                                                 /* may change from solution to solution */
    const void *caller;                                            /* of the functions */
    void (*apply)(const void *caller, const double *x, double *y); /* y = A x */
    /* Of what x still lacks, over all ranks: 1 is good enough. */
    double (*error)(const void *caller, const double *x, const double *residual);
};

struct linear_solver;
struct linear_module { /* what the module exports as `haff_linear_module`; texts of errors are PETSc's */
    const char *(*make)(const struct linear_system *s, struct linear_solver **out);
    const char *(*prepare)(struct linear_solver *l); /* of new values */
    /* A x = b; iterations: as many as it took; < 0 on all ranks: not solved */
    const char *(*solve)(struct linear_solver *l, const double *b, double *x, int *iterations);
    void (*free)(struct linear_solver *l);
};

struct gas;
struct implicit;
status implicit_make(struct gas *g, struct implicit **out);
void implicit_free(struct implicit *p);

#endif
