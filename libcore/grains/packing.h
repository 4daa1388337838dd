/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places and velocities of hard grains for a start: random sequential addition where there is room, else smaller grains
 * are added that then grow to their size while they move as elastic hard grains (Lubachevsky & Stillinger, J. Stat.
 * Phys. 60 (1990) 561; docs/physics.md 10.3). */
#ifndef LIBCORE_PACKING_H
#define LIBCORE_PACKING_H

#include "libcore/grains/grain_mesh.h"
#include "libcore/grains/grains.h"

/* The fields that a start shall have, on n[0] x n[1] x n[2] equal cells that fill the box; axis 0 fastest; or on the
 * cells of a mesh. */
struct packing_field {
    int n[3];                      /* 1 for axes >= dim */
    const struct grain_mesh *mesh; /* NULL: equal cells */
    const double *alpha;           /* [cells] packing fraction; NULL: the same everywhere */
    const double *T;               /* [cells] m^2/s^2, variance of each velocity component */
    const double *u[3];            /* [cells] m/s, box frame; NULL: 0 */
    /* of a mixture, the largest first: `diameter` is theirs, T is the mean of mass times variance over the mean mass,
     * and all kinds have the same energy; NULL: all are alike */
    const struct grain_kinds *kinds;
};
struct packing_report {
    double added;    /* diameter / final diameter at which the grains were added; 1: they did not have to grow */
    int64_t impacts; /* impacts during the growth */
    double seconds;  /* CPU time */
};

/* Returns the number of grains that have the packing fraction integrated over the box, to the nearest whole number;
 * it may be too large for an int. */
double packing_number(const struct grain_box *box, double diameter, const struct packing_field *f);

/* Places x[n] (m) within the box, no two nearer than a diameter, none nearer to a wall than half of one; a seed always
 * gives the same places. Fails with ERR_INPUT if the grains cannot fit (more than close packing: 0.9069 for disks,
 * 0.7405 for spheres), or if growth jams before (the message says at which packing fraction). */
status packing_places(const struct grain_box *box, double diameter, const struct packing_field *f, int n, uint64_t seed,
                      double (*x)[3], struct packing_report *report);
/* Draws velocities u (m/s, box frame) from a Maxwellian about the field u with the T of the cell a grain is in; total
 * momentum and energy are made exactly those of the fields. */
void packing_velocities(const struct grain_box *box, const struct packing_field *f, int n, uint64_t seed,
                        const double (*x)[3], double (*u)[3]);

#endif
