/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Segregation of a bidisperse granular mixture on a line: phi_t + (f phi (1 - phi))_y = (D phi_y)_y (Dolgunin &
 * Ukolov), by the strongly implicit Crank-Nicolson scheme of Christov (2018), without flux through the walls at both
 * ends (docs/physics.md 11.1).
 *
 * A line is n cells between n + 1 faces, uniform or graded; a value stands at the node of its cell. With a node at the
 * middle of each cell this is the finite-volume scheme on the cells of a mesh. The paper's M nodes, of which the first
 * and the last lie on the walls, are a line of M cells whose end cells are half as wide and have their node on the
 * wall: then `conservative` is the half-cell closure of the paper's scheme (3), and its interior rows are (3).
 *
 * phi' = phi - dt/width (F_{i+1} - F_i), F = mean of f P (1 - P) at both nodes - D dP/dy, P = (phi + phi')/2: iterated
 * by a tridiagonal system. F is central, which makes the scheme monotone in space where |f| dy <= 2 D. Beyond that, and
 * wherever phi' would leave 0 .. 1, F is pulled towards the flux of a scheme that is monotone for every step (implicit
 * Euler with the Engquist-Osher flux), face by face, as little as the bounds ask for: flux-corrected transport (Zalesak
 * 1979), which conserves. Where phi' keeps its bounds F stays as it is. */
#ifndef LIBCORE_SEGREGATION_H
#define LIBCORE_SEGREGATION_H

#include "libcore/models/kernel.h"
#include "mesh/base/status.h"

struct segregation_line {      /* borrowed, with its arrays */
    int n;                     /* cells, at least 3 */
    const double *face;        /* [n + 1] m, ascending; the walls first and last */
    const double *node;        /* [n] m, ascending; within its cell, or on a wall */
    const double *speed;       /* [n] f at the nodes, m/s: percolation velocity, either sign */
    const double *diffusivity; /* [n + 1] D at the faces, m^2/s, at least 0 */
    /* Computes D(y, phi) at the faces from phi at the faces. NULL: `diffusivity` above holds, which then may not be
     * NULL. */
    void (*law)(const void *context, int nfaces, const double *phi, double *diffusivity);
    const void *context; /* the first argument of law */
};

enum segregation_closure {
    SEGREGATION_CONSERVATIVE, /* no flux through the outer faces: conserves to round-off */
    SEGREGATION_PAPER,        /* (5): f phi (1 - phi) = D phi_y at the walls, one-sided, at the new time; wants D > 0 */
    SEGREGATION_NEUMANN       /* (7): phi_y = 0, one-sided; (5) and (7) want nodes on the walls, and keep no bounds */
};
struct segregation_scheme {
    enum segregation_closure closure;
    bool newton;      /* Newton's iteration instead of the paper's Picard iteration (4) */
    bool unbounded;   /* phi stays as Crank-Nicolson gives it, without bounds */
    double tolerance; /* the iteration ends when its largest change < tolerance * largest phi; the paper: 1e-8 */
    int most;         /* iterations allowed */
};

struct segregation_counts { /* since segregation_make */
    long steps, iterations;
    long bounded;   /* steps in which phi had to be brought within its bounds */
    long unsolved;  /* steps among these whose Crank-Nicolson iteration had not settled: its last flux was used */
    long corrected; /* faces whose flux was pulled back */
    long rejected;  /* steps that segregation_advance repeated with a smaller one */
};

struct segregation; /* opaque: the line's geometry and scratch memory; nothing is allocated after segregation_make */
status segregation_make(const struct segregation_line *line, const struct segregation_scheme *scheme,
                        struct segregation **out);
void segregation_free(struct segregation *s);

/* Advances phi[n] by dt (s). Fails with ERR_STATE if the iteration does not settle; phi is then as it was.
 * `damped` steps are two implicit Euler steps of dt/2. A start that does not meet the conditions at the walls leaves
 * Crank-Nicolson an oscillation there that it hardly damps; a few damped steps at the start end it, and the order stays
 * two (Rannacher 1984). */
status segregation_step(struct segregation *s, double dt, bool damped, double *phi);
/* Advances phi once by *dt and once by two halves and takes the mean of both, which conserves, keeps the bounds, is of
 * second order and, unlike Crank-Nicolson alone, damps fast modes. *dt is halved or more until the error of that mean
 * is at most `allowed` (average of |error| over the line); *next is the step to try after it. The result depends on phi
 * and *dt only, so that a restart repeats it. */
status segregation_advance(struct segregation *s, double allowed, double *dt, double *next, double *phi);

struct segregation_counts segregation_counts(const struct segregation *s);
double segregation_mass(const struct segregation *s, const double *phi); /* integral of phi, m */

#endif
