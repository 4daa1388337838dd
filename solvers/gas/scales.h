/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Are the sizes and speeds of a start those of a granular gas? A number in other units passes every other check. */
#ifndef SOLVERS_SCALES_H
#define SOLVERS_SCALES_H

#include "solvers/case/case.h"
#include "solvers/gas/initial.h"

/* Warns (warnings.h) of
 *   largeGrains: a grain is wider than the domain, or than the cells that hold more than a tenth of the mass;
 *   fewGrains:   more than a tenth of the mass sits in cells that are wider, with less than one grain in a cube of the
 *                cell's width;
 *   rarefied:    more than a tenth of it sits where the mean free path exceeds a tenth of the domain;
 *   temperature: the mean T is far from every other speed squared: of the mean flow, the walls, free fall and the
 * shaking. The first three are of gases of grains: not of perfectGas. Axes that the mesh lacks do not count. */
status scales_check(struct setup *s, const struct gas_models *models, const struct initial *i);

/* Returns Enskog's mean free path (m) at rho: 1/(sqrt(2) pi d^2 n chi) of spheres, 1/(2 sqrt(2) d n chi) of disks, by
 * G = nu chi. */
double free_path(const struct gas_models *models, double rho);

#endif
