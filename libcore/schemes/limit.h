/* Invariant-domain limiting: states stay in the convex set 0 < rho < rho_max, rho e > 0 by a theorem.
 *
 * Two cells l, r, the normal n from l to r, nodal fluxes f_l, f_r along n; v the normal velocity, c the sound speed,
 * e = T/(gamma - 1), p = rho T A(rho). Low-order flux and bar state (Guermond & Popov 2016), D for a flux F_H:
 *     F_L = (f_l + f_r)/2 - s (u_r - u_l)/2,  ubar = (u_l + u_r)/2 - (f_r - f_l)/(2 s),  D = (F_H - F_L)/s.
 * Speed: s = max of |v| + c on both sides and of (rho_l v_l - rho_r v_r)/(rho_max - max(rho_l, rho_r)).
 *
 * 1. ubar is in the set. It is the mean of u_l + f_l/s and u_r - f_r/s. Of u -+ f/s the density is rho a, a = 1 -+ v/s,
 * positive as s > |v|, and the internal energy rho a [e - p^2/(2 rho^2 (s -+ v)^2)], positive as s -+ v >= c and
 * c^2 >= T [A + (gamma - 1) A^2] > (gamma - 1) T A^2/2 = p^2/(2 rho^2 e) (the misprinted sound speed included). And
 * 2 rhobar = rho_l + rho_r + (rho_l v_l - rho_r v_r)/s <= rho_l + rho_r + rho_max - max(rho_l, rho_r) < 2 rho_max.
 * 2. With F = F_L + theta D s:  u_l - (F - f_l)/s = ubar - theta D,  u_r + (F - f_r)/s = ubar + theta D. The areas of a
 * cell's faces sum to 0 as vectors, so its forward-Euler update is
 *     (1 - K) u + sum over its faces of (dt A s/V) (ubar -+ theta D),  K = dt/V sum of A s.
 * If K <= 1 and theta keeps ubar +- theta D in the set at all its faces, it is a convex combination of the set. So are
 * strong-stability-preserving stages of such updates.
 *
 * theta is the largest share, to one secant, at which ubar +- theta D keep KEPT of ubar's distance from vacuum, packing
 * and zero energy (monolithic convex limiting: Kuzmin 2020); 1 where F_H = F_L. It is a minimum over the two signs, so
 * mirror images keep their bits. A Courant number of a stage up to 1/2 means K <= 1 in one dimension, and in more where
 * the largest speeds along the axes meet in one cell and s is |v| + c; in general the step is halved until K <= 1.
 *
 * A floor `least` > 0 of the density takes the place of vacuum in theta. It is not invariant: where gas expands, ubar
 * itself falls below it, at any finite s. There theta is 0, and raise_density adds what is missing.
 *
 * At high Mach numbers rho e drowns in the round-off of E: a state counts as admissible if rho E - m^2/2 exceeds
 * ROUND m^2/2, and E is raised to that floor where it misses it by round-off: without `least` nothing else is ever
 * clamped. */
#ifndef LIBCORE_LIMIT_H
#define LIBCORE_LIMIT_H

#include "libcore/schemes/flux.h"

#define KEPT  0.1   /* of the distance from the edge of the set, at least */
#define ROUND 1e-13 /* of the kinetic energy: what an admissible internal energy exceeds */

/* f->out: F_H (NaN is allowed) -> F_L + theta (F_H - F_L), F_H itself where theta is 1 and F_L where it is 0; least,
 * limit: what rho stays above and below; theta [n]. The stencil of f is its cells 0 and 1. */
void limit_faces(const struct faces *f, double least, double limit, double *theta);

/* Moves n states towards admissible averages until they keep a share KEPT of their distance from the edge of the set
 * (Zhang & Shu 2010), by theta [n] of the way: 1 not moved, 0 (NaN, too) now the average. */
void limit_towards(int n, int dim, double least, double limit, const double (*average)[BATCH], double (*at)[BATCH],
                   double *theta);

/* Of n <= BATCH states whose variables are `size` apart: bad = 1 where one is not admissible, else 0. Is any? */
bool find_bad(int n, int dim, long size, double least, double limit, const double *restrict U, double *restrict bad);
/* The density floor: of the bad ones with 0 < rho <= least raises rho above it at their own velocity and temperature;
 * bad <- whether they still are; added [2] <- mass and energy added (else 0), kg/m^3 and J/m^3. Returns how many. */
int raise_density(int n, int dim, long size, double least, double limit, double *restrict U, double *restrict bad,
                  double (*restrict added)[BATCH]);
/* The round-off floor: raises E of the bad ones that miss it by round-off, bad <- 0, raised <- the energy added (else
 * 0), J/m^3. Returns how many. */
int raise_energy(int n, int dim, long size, double least, double limit, double *restrict U, double *restrict bad,
                 double *restrict raised);

#endif
