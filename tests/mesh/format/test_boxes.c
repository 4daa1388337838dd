/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Meshes of boxes: numbers and places are inverse, the arrays that are made of them are a sound polyMesh whose lattice
 * is that of the boxes, and what is no union of equal boxes is refused by name. */
#include "mesh/format/boxes.h"
#include "mesh/lattice/lattice.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/checks.h" /* last */

/* An L of three blocks of cells 0.5 x 0.25 x 1, the second with its own axes turned: (own 0, 1, 2) = (y, z, x). */
static const double vertex[][3] = {{0, 0, 0}, {2, 0, 0}, {5, 0, 0}, {0, 1, 0}, {2, 1, 0}, {5, 1, 0},
                                   {0, 3, 0}, {2, 3, 0}, {0, 0, 3}, {2, 0, 3}, {5, 0, 3}, {0, 1, 3},
                                   {2, 1, 3}, {5, 1, 3}, {0, 3, 3}, {2, 3, 3}};
static const struct boxes_block blocks[3] = {{{0, 1, 4, 3, 8, 9, 12, 11}, {4, 4, 3}},
                                             {{1, 4, 12, 9, 2, 5, 13, 10}, {4, 3, 6}},
                                             {{3, 4, 7, 6, 11, 12, 15, 14}, {4, 8, 3}}};
static int left[][4] = {{0, 8, 11, 3}, {3, 11, 14, 6}}, floor_sides[][4] = {{0, 3, 4, 1}, {1, 2, 5, 4}, {3, 6, 7, 4}},
           lid[][4] = {{8, 9, 12, 11}, {9, 12, 13, 10}, {11, 12, 15, 14}};
static const struct boxes_patch patches[4] = {{"left", "patch", NULL, 2, left, NULL},
                                              {"floor", "cyclic", "lid", 3, floor_sides, NULL},
                                              {"lid", "cyclic", "floor", 3, lid, NULL},
                                              {"walls", "wall", NULL, 0, NULL, NULL}};

static struct polymesh *make(void) {
    struct boxes *b;
    struct polymesh *m;
    int culprit;
    ok(boxes_place(vertex[0], 3, blocks, &b, &culprit));
    ok(boxes_mesh(b, blocks, 4, patches, &m));
    return m;
}

static void numbers_and_places_are_inverse(void **state) {
    (void)state;
    struct polymesh *m = make();
    const struct boxes *b = m->boxes;
    assert_int_equal(m->ncells, 4 * 4 * 3 + 4 * 3 * 6 + 4 * 8 * 3);
    assert_true(b->n[0] == 10 && b->n[1] == 12 && b->n[2] == 3);
    bool *seen = calloc((size_t)m->ncells, sizeof *seen);
    int found = 0;
    for (int at[3] = {0}; at[2] < b->n[2]; at[2]++)
        for (at[1] = 0; at[1] < b->n[1]; at[1]++)
            for (at[0] = 0; at[0] < b->n[0]; at[0]++) {
                const long cell = boxes_cell(b, at);
                int back[3];
                assert_int_equal(cell >= 0, at[0] < 4 || at[1] < 4);
                if (cell < 0) continue;
                boxes_at(b, cell, back);
                assert_memory_equal(at, back, sizeof back);
                assert_false(seen[cell]);
                seen[cell] = true;
                found++;
            }
    assert_int_equal(found, m->ncells);
    /* the second block runs along y, then z, then x */
    assert_int_equal(boxes_cell(b, (const int[3]){4, 0, 0}), 48);
    assert_int_equal(boxes_cell(b, (const int[3]){4, 1, 0}), 49);
    assert_int_equal(boxes_cell(b, (const int[3]){4, 0, 1}), 52);
    assert_int_equal(boxes_cell(b, (const int[3]){5, 0, 0}), 60);
    free(seen);
    polymesh_free(m);
}

static void faces_of_patches_have_places(void **state) {
    (void)state;
    struct polymesh *m = make();
    assert_int_equal(m->npatches, 4);
    assert_int_equal(m->patch[0].nfaces, 3 * (4 + 8));
    assert_int_equal(m->patch[1].nfaces, 4 * 4 + 4 * 6 + 4 * 8);
    for (int p = 0; p < m->npatches; p++)
        for (int i = 0; i < m->patch[p].nfaces; i++) {
            int at[3], side;
            long face;
            boxes_face_at(m->boxes, p, i, at, &side);
            assert_int_equal(boxes_patch(m->boxes, at, side, &face), p);
            assert_int_equal(face, i);
        }
    polymesh_free(m);
}

/* The arrays are a polyMesh that passes all checks, and the lattice that is recognised in it is that of the boxes. */
static void arrays_are_a_sound_mesh(void **state) {
    (void)state;
    struct polymesh *m = make(), *known = make();
    struct lattice *l, *of_boxes;
    char why[256];
    ok(polymesh_complete(m));
    boxes_free(m->boxes);
    m->boxes = NULL; /* it is now as if it had been read */
    ok(polymesh_check(m));
    ok(lattice_recognise(m, &l, why));
    assert_non_null(l);
    ok(lattice_of_boxes(known, &of_boxes));
    assert_int_equal(m->nfaces, known->boxes->nfaces);
    assert_int_equal(m->ninternal, known->boxes->ninternal);
    assert_true(l->dim == of_boxes->dim && l->thickness == of_boxes->thickness);
    assert_memory_equal(l->axis, of_boxes->axis, sizeof l->axis);
    assert_memory_equal(l->n, of_boxes->n, sizeof l->n);
    assert_memory_equal(l->origin, of_boxes->origin, sizeof l->origin);
    assert_memory_equal(l->width, of_boxes->width, sizeof l->width);
    assert_memory_equal(l->periodic, of_boxes->periodic, sizeof l->periodic);
    int *row = malloc((size_t)l->n[0] * sizeof *row);
    for (int at[3] = {0}; at[2] < l->n[2]; at[2]++)
        for (at[1] = 0; at[1] < l->n[1]; at[1]++) {
            at[0] = 0;
            lattice_row(of_boxes, at, l->n[0], row);
            for (; at[0] < l->n[0]; at[0]++) {
                assert_int_equal(row[at[0]], lattice_cell(l, at));
                assert_int_equal(lattice_cell(of_boxes, at), lattice_cell(l, at));
                for (int side = 0; side < 6 && row[at[0]] >= 0; side++) {
                    long one, other;
                    assert_int_equal(lattice_patch(l, m, at, side, &one),
                                     lattice_patch(of_boxes, known, at, side, &other));
                    assert_int_equal(one, other);
                }
            }
        }
    ok(lattice_complete(of_boxes, known));
    assert_memory_equal(of_boxes->face, l->face, 6 * (size_t)m->ncells * sizeof(int));
    assert_memory_equal(of_boxes->cell, l->cell, (size_t)l->n[0] * l->n[1] * l->n[2] * sizeof(int));
    free(row);
    lattice_free(l);
    lattice_free(of_boxes);
    polymesh_free(m);
    polymesh_free(known);
}

static void a_face_has_its_cell_and_its_area(void **state) {
    (void)state;
    struct polymesh *m = make(), *whole = make();
    ok(polymesh_complete(whole));
    double *centre = malloc((size_t)whole->nfaces * 24), *area = malloc((size_t)whole->nfaces * 24);
    polymesh_face_geometry(whole, centre, area);
    for (int p = 0; p < m->npatches; p++)
        for (int i = 0; i < m->patch[p].nfaces; i++) {
            double c[3], a[3];
            const long face = whole->patch[p].start + (long)i;
            polymesh_patch_face(m, p, i, c, a);
            assert_memory_equal(c, centre + 3 * face, sizeof c);
            assert_memory_equal(a, area + 3 * face, sizeof a);
            assert_int_equal(polymesh_patch_cell(m, p, i), whole->owner[face]);
        }
    free(centre);
    free(area);
    polymesh_free(m);
    polymesh_free(whole);
}

/* ---- what is refused ---- */

static void refuse_blocks(int n, const struct boxes_block *b, const double *v, int where, const char *text) {
    struct boxes *out;
    int culprit;
    says(boxes_place(v, n, b, &out, &culprit), text);
    assert_null(out);
    assert_int_equal(culprit, where);
}

static void blocks_that_do_not_fit(void **state) {
    (void)state;
    struct boxes_block b[3];
    double v[16][3];
    memcpy(b, blocks, sizeof b);
    b[2].n[1] = 4;
    refuse_blocks(3, b, vertex[0], 2, "block 2: 4 cells along y are 0.5 m long, those of block 0 0.25 m");
    memcpy(b, blocks, sizeof b);
    memcpy(b[1].vertex, (const int[8]){4, 1, 9, 12, 5, 2, 10, 13}, sizeof b[1].vertex);
    refuse_blocks(3, b, vertex[0], 1, "block 1: it is inside out");
    memcpy(b[1].vertex, (const int[8]){1, 4, 12, 9, 5, 2, 13, 10}, sizeof b[1].vertex);
    refuse_blocks(3, b, vertex[0], 1, "block 1");
    b[1] = (struct boxes_block){{0, 1, 7, 6, 8, 9, 15, 14}, {4, 12, 3}};
    refuse_blocks(2, b, vertex[0], 1, "block 1: it overlaps block 0");
    memcpy(b, blocks, sizeof b);
    memcpy(v, vertex, sizeof v);
    v[7][0] = 2.1;
    refuse_blocks(3, b, v[0], 2, "block 2: vertex 7 at (2.1 3 0) lies 0.2 of a cell beside the lattice along x");
    memcpy(v, vertex, sizeof v);
    v[1][2] = 1;
    refuse_blocks(3, b, v[0], 0, "block 0: vertex 1 is no corner of a box along the axes");
    /* the third block as wide as both others below it: its floor is no side of either */
    b[2] = (struct boxes_block){{3, 5, 7, 6, 11, 13, 15, 14}, {10, 8, 3}};
    memcpy(v, vertex, sizeof v);
    v[7][0] = v[15][0] = 5;
    refuse_blocks(3, b, v[0], 2,
                  "block 2: it touches block 0 at y = 1, but they do not share the four vertices of a side");
    b[0].vertex[1] = 0;
    refuse_blocks(3, b, vertex[0], 0, "block 0: its edges do not lie along x, y and z");
    for (int k = 0; k < 3; k++) b[0].n[k] = 2000;
    memcpy(b[0].vertex, blocks[0].vertex, sizeof b[0].vertex);
    refuse_blocks(1, b, vertex[0], 0, "with it the mesh has 8000000000 cells; OpenFOAM's labels of 32 bits count");
}

static void refuse_patches(const struct boxes_patch p[4], const char *text) {
    struct boxes *b;
    struct polymesh *m;
    int culprit;
    ok(boxes_place(vertex[0], 3, blocks, &b, &culprit));
    says(boxes_mesh(b, blocks, 4, p, &m), text);
    assert_null(m);
    boxes_free(b);
}

static void patches_that_do_not_fit(void **state) {
    (void)state;
    static int inside[][4] = {{4, 1, 9, 12}}, nowhere[][4] = {{0, 1, 2, 3}}, twice[][4] = {{0, 3, 11, 8}},
               other_order[][4] = {{9, 12, 13, 10}, {8, 9, 12, 11}, {11, 12, 15, 14}};
    struct boxes_patch p[4];
    memcpy(p, patches, sizeof p);
    p[0] = (struct boxes_patch){"left", "patch", NULL, 1, inside, NULL};
    refuse_patches(p, "patch 'left': the side (4 1 9 12) lies inside, between blocks");
    p[0].face = nowhere;
    refuse_patches(p, "patch 'left': (0 1 2 3) are not the vertices of a side of a block");
    p[0] = patches[0];
    p[3] = p[2];
    p[2] = p[1];
    p[1] = (struct boxes_patch){"again", "wall", NULL, 1, twice, NULL};
    refuse_patches(p, "patch 'again': the side (0 3 11 8) belongs to patch 'left' already");
    memcpy(p, patches, sizeof p);
    p[2].face = other_order;
    refuse_patches(p, "patch 'floor': it and 'lid' are not opposite ends of the whole mesh");
    memcpy(p, patches, sizeof p);
    p[2].neighbour = "left";
    refuse_patches(p, "patch 'floor': its neighbourPatch 'lid' is no cyclic patch that names 'floor'");
    memcpy(p, patches, sizeof p);
    p[1].nfaces = p[2].nfaces = 2;
    refuse_patches(p, "cyclic only in part");
    memcpy(p, patches, sizeof p);
    p[1].type = p[2].type = "empty";
    p[1].neighbour = p[2].neighbour = NULL;
    refuse_patches(p, "empty patches close z, but not on both sides of block 0, or it is more than one cell thick");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_and_places_are_inverse), cmocka_unit_test(faces_of_patches_have_places),
        cmocka_unit_test(arrays_are_a_sound_mesh),        cmocka_unit_test(a_face_has_its_cell_and_its_area),
        cmocka_unit_test(blocks_that_do_not_fit),         cmocka_unit_test(patches_that_do_not_fit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
