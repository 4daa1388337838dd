/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cells of any shape, in which grains are counted (coarse.h) and put (packing.h). */
#ifndef LIBCORE_GRAIN_MESH_H
#define LIBCORE_GRAIN_MESH_H

#include <stdbool.h>

struct grain_mesh { /* the first member of what the owner of the cells knows */
    long cells;
    const double *volume;      /* [cells] m^3; disks: m^2 */
    const double (*centre)[3]; /* [cells] m */
    const double (*bounds)[6]; /* [cells] m: low corner, high corner of the box around a cell */
    /* Returns the cell that holds x, *inside: false if it is outside of all; then it is one near x. */
    long (*locate)(const struct grain_mesh *self, const double x[3], bool *inside);
};

#endif
