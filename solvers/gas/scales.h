/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Are the sizes and speeds of a start those of a granular gas? A number in other units passes every other check. How
 * long may a step last that gravity acts in? */
#ifndef SOLVERS_SCALES_H
#define SOLVERS_SCALES_H

#include "solvers/case/case.h"
#include "solvers/gas/initial.h"
#include "solvers/gas/models.h"

/* Warns (warnings.h) of
 *   largeGrains: a grain is wider than the domain, or than the cells that hold more than a tenth of the mass;
 *   fewGrains:   more than a tenth of the mass sits in cells that are wider, with less than one grain in a cube of the
 *                cell's width;
 *   rarefied:    more than a tenth of it sits where the mean free path exceeds a tenth of the domain, whose periodic
 *                axes count only where all are;
 *   temperature: the mean T is far from every other speed squared: of the mean flow, the walls, free fall and the
 *                shaking;
 *   elasticGrains: restitution is below 1, and no impact takes energy. The first three are of gases of grains: not of
 * perfectGas. Axes that the mesh lacks do not count. */
status scales_check(struct setup *s, const struct gas_models *models, const struct initial *i);

/* Warn of what grains and forces of a gas or of grains can hardly be:
 *   heavyGrains:   the mass of a grain over its volume is that of no matter;
 *   upwardGravity: gravity points along the last solved axis;
 *   faintShaking:  the plate is slower than free fall, or moves by less than a hundredth of a grain;
 *   elasticGrains: thresholdSpeed is above each speed: that of grains, sqrt(T), and of all else, `fastest`. */
status scales_grain(struct setup *s, const struct dict *properties, const struct material *m);
status scales_forces(struct setup *s, const struct forces *f, const struct material *m);
status scales_threshold(struct setup *s, const struct dict *properties, const struct material *m, double T,
                        double fastest);
double scales_fall(const struct setup *s, const struct sources *g); /* m/s: of free fall and of the plate */

/* Finds the longest step (s) that gravity allows, HUGE_VAL: any: a fifth of sqrt(2 h/|g|), in which gas at rest falls
 * through the flattest cell; |g|/h is the sum of |g . A| / (2 V) over its faces. The speed of sound alone would let
 * cold gas at rest fall through many cells in its first step. Where grains rub, what pulls along an axis that the mesh
 * lacks has a limit of its own, with the mean of 1/h: friction holds it, with coefficients that stand still in a step.
 */
status scales_longest_fall(const struct setup *s, const struct case_models *models, double *out);

/* Returns Enskog's mean free path (m) at rho: 1/(sqrt(2) pi d^2 n chi) of spheres, 1/(2 sqrt(2) d n chi) of disks, by
 * G = nu chi. */
double free_path(const struct gas_models *models, double rho);

#endif
