/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mesh/lattice/box.h"
#include "tests/checks.h"

#include <limits.h>

/* Every side of every cell at the edge has a face of its own in the patch of that side, and no other cell has one. */
static void check_box(int dim, const int n[3], const bool periodic[3]) {
    struct box b;
    const int m[3] = {n[0], dim > 1 ? n[1] : 1, dim > 2 ? n[2] : 1};
    ok(box_make(&b, dim, n, (double[3]){2, 3, 4}, periodic));
    assert_int_equal(b.mesh.ncells, m[0] * m[1] * m[2]);
    assert_int_equal(b.mesh.npatches, 2 * dim);
    int faces = b.mesh.ninternal;
    for (int side = 0; side < 6; side++) {
        const int k = side / 2;
        const struct patch *p = &b.mesh.patch[side];
        int next = faces;
        for (int i = 0; i < b.mesh.ncells; i++) {
            const int at[3] = {i % m[0], i / m[0] % m[1], i / m[0] / m[1]}, f = b.lattice.face[6 * i + side];
            assert_int_equal(b.lattice.cell[i], i);
            if (k >= dim)
                assert_int_equal(f, -1);
            else if (at[k] == (side % 2 ? m[k] - 1 : 0))
                assert_int_equal(f, next++);
            else
                assert_true(f >= 0 && f < b.mesh.ninternal);
        }
        if (k >= dim) continue;
        assert_int_equal(p->start, faces);
        assert_int_equal(p->nfaces, b.mesh.ncells / m[k]);
        assert_string_equal(p->type, periodic[k] ? "cyclic" : "wall");
        assert_true(b.lattice.width[k] == (k + 2.) / m[k]);
        faces = next;
    }
    assert_int_equal(b.mesh.nfaces, faces);
    box_free(&b);
}

static void test_faces(void **state) {
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (int bits = 0; bits < 8; bits++) check_box(dim, (int[3]){5, 4, 3}, (bool[3]){bits & 1, bits & 2, bits & 4});
}

static void test_refused(void **state) {
    (void)state;
    const int wrong[][3] = {{0, 1, 1}, {4, -1, 4}, {100000, 100000, 1}, {INT_MAX, INT_MAX, INT_MAX}};
    struct box b;
    for (int i = 0; i < 4; i++)
        says(box_make(&b, 3, wrong[i], (double[3]){1, 1, 1}, (bool[3]){false}), "a box of |cells: from 1 to 2e8");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_faces), cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
