/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sums over soft grains and their contacts at a moment: energies, what dampers and friction take, forces on walls.
 *
 * A damper takes gamma v^2, along the normal and, of contacts that stick, along the tangent. Friction takes the rest of
 * what the tangential force does: the work on it, less what its damper takes and what its spring keeps. */
#ifndef SOLVERS_DEM_SUMS_H
#define SOLVERS_DEM_SUMS_H

#include "libcore/grains/coarse.h"
#include "solvers/dem/dem_engine.h"

struct dem_sums {
    int n;
    long contacts;
    double T;                               /* m^2/s^2: variance of a velocity component over all grains */
    double kinetic, spin, potential;        /* J, relative to the box; gravity without shaking */
    double normal_spring, tangent_spring;   /* J */
    double normal_loss, tangent_loss, drag; /* W: dampers; all that the tangential forces do, springs included */
    double momentum[3];                     /* kg m/s */
    double work;                            /* W, of walls that move */
    double force[DEM_MOST_WALLS][3];        /* N, on the walls */
};
void dem_sums(const struct dem_law *law, const struct dem_moment *m, struct dem_sums *out);

/* Lists the contacts for coarse graining. */
void dem_stresses(const struct dem_moment *m, struct coarse_contact *out);

#endif
