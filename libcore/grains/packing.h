/* Places and velocities of hard grains for a start: random sequential addition where there is room, else of smaller
 * grains that then grow to their size while they move as elastic hard grains (Lubachevsky & Stillinger, J. Stat. Phys.
 * 60 (1990) 561). */
#ifndef LIBCORE_PACKING_H
#define LIBCORE_PACKING_H

#include "libcore/grains/grains.h"

/* What a start shall look like, on n[0] x n[1] x n[2] equal cells that fill the box; axis 0 fastest; lengths in cells.
 */
struct packing_field {
    int n[3];            /* 1 for axes >= dim */
    const double *alpha; /* [cells] packing fraction; NULL: the same everywhere */
    const double *T;     /* [cells] m^2/s^2, variance of each velocity component */
    const double *u[3];  /* [cells] m/s, box frame; NULL: 0 */
};
struct packing_report {
    double added;    /* diameter / final diameter at which they were added; 1: nothing had to grow */
    int64_t impacts; /* of the growth */
    double seconds;  /* CPU */
};

/* Grains in the box for a packing fraction integrated over it, to the nearest whole number. */
int packing_number(const struct grain_box *box, double diameter, const struct packing_field *f);

/* x[n] within the box, no two nearer than a diameter, none nearer to a wall than half of one; the same for a seed.
 * ERR_INPUT: they cannot fit (more than close packing: 0.9069 for disks, 0.7405 for spheres), or growth jams before
 * (says at which packing fraction). */
status packing_places(const struct grain_box *box, double diameter, const struct packing_field *f, int n, uint64_t seed,
                      double (*x)[3], struct packing_report *report);
/* Maxwellian about u with the T of the cell a grain is in; total momentum and energy are made exactly those of the
 * fields. */
void packing_velocities(const struct grain_box *box, const struct packing_field *f, int n, uint64_t seed,
                        const double (*x)[3], double (*u)[3]);

#endif
