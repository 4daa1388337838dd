/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What every rank knows of a mesh of which no rank has the whole, compared with the whole: for the tests of
 * mesh/spread. Include after the standard headers. */
#ifndef TESTS_MESH_OUTLINES_H
#define TESTS_MESH_OUTLINES_H

#include "mesh/format/polymesh.h"

#include <string.h>

#include "tests/checks.h"
#include "tests/mesh/shared_folder.h"

static inline void write_mesh(const struct polymesh *m, int form) {
    const struct foam_format format = {.binary = form % 2, .compress = form / 2, .precision = 17};
    ok(comm_agree(world, comm_root(world) ? polymesh_write(m, folder, &format) : OK));
}

static inline void same_patches(const struct polymesh *m, const struct polymesh *outline) {
    assert_int_equal(m->npatches, outline->npatches);
    for (int p = 0; p < m->npatches; p++) {
        assert_string_equal(m->patch[p].name, outline->patch[p].name);
        assert_int_equal(m->patch[p].nfaces, outline->patch[p].nfaces);
        if (!strcmp(m->patch[p].type, "empty")) continue;
        for (int i = 0; i < m->patch[p].nfaces; i++) {
            double x[12];
            polymesh_patch_face(m, p, i, x, x + 3);
            polymesh_patch_face(outline, p, i, x + 6, x + 9);
            assert_memory_equal(x, x + 6, 6 * sizeof *x);
            assert_int_equal(polymesh_patch_cell(m, p, i), polymesh_patch_cell(outline, p, i));
        }
    }
}

static inline void same_outline(const struct polymesh *m, const struct polymesh *outline) {
    char shapes[2][POLYMESH_SHAPES];
    double box[12];
    int axis[2][3] = {{0}};
    assert_true(m->ncells == outline->ncells && m->nfaces == outline->nfaces && m->npoints == outline->npoints &&
                m->ninternal == outline->ninternal);
    assert_int_equal(polymesh_checksum(m), polymesh_checksum(outline));
    ok(polymesh_shapes(m, shapes[0]));
    ok(polymesh_shapes(outline, shapes[1]));
    assert_string_equal(shapes[0], shapes[1]);
    polymesh_bounds(m, box, box + 3);
    polymesh_bounds(outline, box + 6, box + 9);
    assert_memory_equal(box, box + 6, 6 * sizeof *box);
    assert_int_equal(polymesh_axes(m, axis[0]), polymesh_axes(outline, axis[1]));
    assert_memory_equal(axis[0], axis[1], sizeof axis[0]);
    same_patches(m, outline);
}

#endif
