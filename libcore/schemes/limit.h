/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Invariant-domain limiting: admissible states, the convex set 0 < rho < rho_max, rho e > 0, stay so by a theorem
 * (docs/physics.md 7.3).
 *
 * Let n be the normal from cell l to cell r, f_l, f_r the nodal fluxes along n, v the normal velocity, c the sound
 * speed, e = T/(gamma - 1), p = rho T A(rho). Low-order flux and bar state (Guermond & Popov 2016), and D of a flux
 * F_H, are
 *     F_L = (f_l + f_r)/2 - s (u_r - u_l)/2,  ubar = (u_l + u_r)/2 - (f_r - f_l)/(2 s),  D = (F_H - F_L)/s.
 * The speed s is the maximum of |v| + c on both sides and of (rho_l v_l - rho_r v_r)/(rho_max - max(rho_l, rho_r)).
 *
 * 1. ubar is in the set. It is the mean of u_l + f_l/s and u_r - f_r/s. The density of u -+ f/s is rho a, where
 * a = 1 -+ v/s is positive as s > |v|. Its internal energy is rho a [e - p^2/(2 rho^2 (s -+ v)^2)], positive as
 * s -+ v >= c and c^2 >= T [A + (gamma - 1) A^2] > (gamma - 1) T A^2/2 = p^2/(2 rho^2 e) (the misprinted sound speed
 * included). The density of ubar stays below rho_max as
 * 2 rhobar = rho_l + rho_r + (rho_l v_l - rho_r v_r)/s <= rho_l + rho_r + rho_max - max(rho_l, rho_r) < 2 rho_max.
 * 2. With F = F_L + theta D s:  u_l - (F - f_l)/s = ubar - theta D,  u_r + (F - f_r)/s = ubar + theta D. The areas of a
 * cell's faces sum to 0 as vectors, so its forward-Euler update is
 *     (1 - K) u + sum over its faces of (dt A s/V) (ubar -+ theta D),  K = dt/V sum of A s.
 * If K <= 1 and theta keeps ubar +- theta D in the set at all its faces, it is a convex combination of the set. So are
 * strong-stability-preserving stages of such updates. Beyond a patch u_r is what the patch's rules make of the cell
 * (libcore/gas/patch.c), which is in the set, too: a density is the cell's or a given one below rho_max. So no patch
 * lets in more than the cell can hold.
 *
 * theta is the largest share, to one secant, at which ubar +- theta D keep KEPT of ubar's distance from vacuum, packing
 * and zero energy (monolithic convex limiting: Kuzmin 2020); 1 where F_H = F_L. It is a minimum over the two signs, so
 * mirror images keep their bits. A Courant number of a stage up to 1/2 means K <= 1 in one dimension, and in more where
 * the largest speeds along the axes meet in one cell and s is |v| + c; in general the step is halved until K <= 1.
 *
 * 3. A limited cell parts from packing. By 1. ubar keeps rho_max - rhobar >= (rho_max - min(rho_l, rho_r))/2, and theta
 * keeps the share KEPT of that. So the distance d of a cell from packing becomes at least (1 - K) d + K (KEPT/2) d_m,
 * d_m the mean over its faces, weighed by A s, of the larger distance on both sides: it rises if d_m > 20 d. Other
 * fluxes know no such bound: where large, or fast and cold, cells close in on a small one, a flux that has the
 * conduction of its c may pack it to 0.6 d in each step, while dt falls with d; sum of dt is finite, and time stands
 * still. So a cell whose density rises in a stage to within CROWDED of rho_max is limited, too, although it is
 * admissible; but not in a gas that may collapse, which packs without end by itself, and whose run says so.
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

#define KEPT    0.1   /* share of an average's distance from the edge of the set that a limited state keeps at least */
#define CROWDED 1e-8  /* share of rho_max within which of it a cell whose density rises is limited */
#define ROUND   1e-13 /* share of the kinetic energy that an admissible internal energy exceeds */

/* Below dim is the number of components of velocity. limit_faces limits fluxes: f->out is F_H (NaN is allowed) and
 * becomes F_L + theta (F_H - F_L), exactly F_H where theta is 1 and F_L where it is 0. rho stays above `least` and
 * below `limit`, kg/m^3. theta[n] is an output. Only cells 0 and 1 of the stencil of f are read. */
void limit_faces(const struct faces *f, double least, double limit, double *theta);

/* Moves n states at[dim + 2] towards admissible averages until they keep a share KEPT of their distance from the edge
 * of the set (Zhang & Shu 2010). theta[n] is what remains of a state's distance from its average: 1: the state did not
 * move, 0 (also for NaN): it is the average. */
void limit_towards(int n, int dim, double least, double limit, const double (*average)[BATCH], double (*at)[BATCH],
                   double *theta);

/* Sets bad[i] to 1 where one of n <= BATCH states (variables `size` apart) is not admissible, else to 0; returns
 * whether any is bad. */
bool find_bad(int n, int dim, long size, double least, double limit, const double *restrict U, double *restrict bad);
/* Adds 1 to bad[i] where one of n <= BATCH densities rose from `from` to `to`, which is within CROWDED of `limit`;
 * returns whether any did. */
bool find_crowded(int n, double limit, const double *restrict from, const double *restrict to, double *restrict bad);
/* Applies the density floor: raises rho above `least` at the same velocity and temperature in bad states with 0 < rho
 * <= least. bad[i] becomes whether the state is still bad, added[2] the mass and energy added (else 0), kg/m^3 and
 * J/m^3. Returns how many states were raised. */
int raise_density(int n, int dim, long size, double least, double limit, double *restrict U, double *restrict bad,
                  double (*restrict added)[BATCH]);
/* Applies the round-off floor: raises E in bad states that miss admissibility by round-off, and sets bad to 0 there.
 * raised is the energy added (else 0), J/m^3. Returns how many states were raised. */
int raise_energy(int n, int dim, long size, double least, double limit, double *restrict U, double *restrict bad,
                 double *restrict raised);

#endif
