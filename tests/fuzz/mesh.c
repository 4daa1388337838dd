/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mesh/lattice/lattice.h"
#include "tests/fuzz/target.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void write_and_read(const struct polymesh *m, const struct foam_format *format) {
    char dir[256];
    struct polymesh *again = NULL;
    snprintf(dir, sizeof dir, "%s/written", scratch());
    PROMISE(accepted(polymesh_write(m, dir, format)), "a mesh can be written");
    PROMISE(accepted(polymesh_read(dir, &again)), "a mesh that was written can be read");
    PROMISE(polymesh_checksum(m) == polymesh_checksum(again), "a mesh is the same when it was written and read");
    polymesh_free(again);
}

void try_mesh(struct polymesh *m) {
    struct lattice *l = NULL;
    char why[256], shapes[POLYMESH_SHAPES];
    int axis[3];
    if (accepted(polymesh_check(m))) {
        PROMISE(accepted(polymesh_shapes(m, shapes)), "cells have shapes");
        PROMISE(polymesh_axes(m, axis) > 0, "a sound mesh has an axis");
        if (accepted(lattice_recognise(m, &l, why))) lattice_free(l);
        for (int i = 0; i < 2; i++)
            write_and_read(m, &(struct foam_format){.binary = i == 1, .compress = i == 1, .precision = 17});
    }
    polymesh_free(m);
}
