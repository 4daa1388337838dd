/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Meshes spread over the ranks: what every rank knows of them is what the whole mesh says; parts are those of the whole
 * mesh; what is wrong with a mesh is found in its slices, too; slices show which meshes are no lattices. */
#define _GNU_SOURCE /* mkdtemp */
#include "mesh/lattice/lattice.h"
#include "mesh/spread/spread.h"

#include "tests/mesh/polyhedral/cells.h"
#include "tests/mesh/spread/outlines.h"

static const struct cells_recipe recipes[] = {
    {"triangles in x and z, periodic", 2, PRISMS, {20, 16, 1}, {0, 2, 1}, 0.2, {true, true}},
    {"tetrahedra", 3, TETS, {4, 5, 3}, {0, 1, 2}, 0.12, {false}},
    {"prisms and others", 3, MIXED, {6, 4, 4}, {0, 1, 2}, 0.1, {false, true, false}},
    {"line", 1, BOXES, {50, 1, 1}, {0, 1, 2}, 0.3, {false}},
    {"quads", 2, BOXES, {8, 9, 1}, {0, 1, 2}, 0.2, {true, false}},
    {"boxes", 3, BOXES, {5, 4, 6}, {0, 1, 2}, 0, {true, false, false}},
};
enum { RECIPES = sizeof recipes / sizeof *recipes };

static void outlines_are_those_of_the_whole(void **state) {
    (void)state;
    for (int r = 0; r < RECIPES; r++)
        for (int form = 0; form < 4; form++) {
            struct polymesh *m = cells_make(&recipes[r]), *outline;
            struct polymesh_geometry g;
            struct spread *s;
            write_mesh(m, form);
            ok(spread_read(folder, world, false, false, &s, &outline));
            assert_non_null(s);
            same_outline(m, outline);
            ok(polymesh_geometry_make(m, &g));
            for (long c = s->cells.first; c < s->cells.end; c++) {
                double x[3], volume = spread_volume(s, c);
                spread_centre(s, c, x);
                assert_memory_equal(x, g.cell_centre + 3 * c, sizeof x);
                assert_memory_equal(&volume, g.volume + c, sizeof volume);
            }
            ok(polymesh_complete(outline)); /* the whole mesh, for who needs it */
            assert_memory_equal(m->owner, outline->owner, (size_t)m->nfaces * sizeof *m->owner);
            same_outline(m, outline);
            polymesh_geometry_free(&g);
            polymesh_free(m);
            polymesh_free(outline);
            spread_free(s);
            ok(comm_agree(world, OK));
        }
}

/* Has the part the faces that the whole mesh has at its whole cells? */
static void check_part(const struct polymesh *m, const struct mesh_part *p, long n, const int *cell) {
    int *start, *face, *near, *near_start;
    ok(polymesh_cell_faces(m, &start, &face));
    ok(polymesh_cell_faces(&p->mesh, &near_start, &near));
    long whole = 0;
    for (int c = 0; c < p->mesh.ncells; c++) whole += p->whole[c];
    assert_int_equal(whole, n);
    for (long i = 0; i < n; i++) {
        const long here = part_cell(p, cell[i]);
        const int faces = start[cell[i] + 1] - start[cell[i]];
        assert_true(here >= 0 && p->whole[here]);
        assert_int_equal(near_start[here + 1] - near_start[here], faces);
        for (int k = 0; k < faces; k++) {
            const int a = face[start[cell[i]] + k], b = near[near_start[here] + k];
            assert_int_equal(p->face[b], a);
            assert_int_equal(p->cell[p->mesh.owner[b]], m->owner[a]);
            for (int j = 0; j < m->face_start[a + 1] - m->face_start[a]; j++) {
                const long x = m->face_points[m->face_start[a] + j], y = p->mesh.face_points[p->mesh.face_start[b] + j];
                assert_memory_equal(m->points + 3 * x, p->mesh.points + 3 * y, 3 * sizeof(double));
            }
        }
    }
    free(start);
    free(face);
    free(near);
    free(near_start);
}

static void parts_have_whole_cells(void **state) {
    (void)state;
    for (int r = 0; r < RECIPES; r++) {
        struct polymesh *m = cells_make(&recipes[r]), *outline;
        struct mesh_part part;
        struct spread *s;
        int *cell = calloc((size_t)m->ncells, sizeof *cell), n = 0;
        write_mesh(m, 1);
        ok(spread_read(folder, world, false, false, &s, &outline));
        for (int c = comm_rank(world); c < m->ncells && comm_rank(world) != 1; c += 5 + r) cell[n++] = c;
        ok(spread_part(s, outline, n, cell, &part)); /* rank 1 asks for none */
        check_part(m, &part, n, cell);
        for (int p = 0; p < m->npatches; p++) /* halves of cyclic patches come together */
            if (m->patch[p].neighbour)
                assert_int_equal(part.mesh.patch[p].nfaces,
                                 part.mesh.patch[polymesh_find_patch(m, m->patch[p].neighbour)].nfaces);
        part_free(&part);
        spread_free(s);
        polymesh_free(m);
        polymesh_free(outline);
        free(cell);
        ok(comm_agree(world, OK));
    }
}

/* ---- what is wrong ----------------------------------------------------------------------------------------------- */

enum defect { NONE, CELL, CORNER, TWICE, ORDER, FLIPPED, OPEN, FAR, NEIGHBOUR, NARROW, HALVES, TURNED, DEFECTS };

static void swap(int *a, int *b) {
    const int c = *a;
    *a = *b;
    *b = c;
}

/* Damages a mesh of tetrahedra or, for the cyclic ones, of periodic triangles. */
static void damage(struct polymesh *m, enum defect kind) {
    const int face = m->nfaces / 3, last = m->nfaces - 1;
    int *p = m->face_points + m->face_start[face];
    const struct patch *q = m->patch;
    if (kind == CELL) m->owner[last] = m->nfaces;
    if (kind == CORNER) p[1] = m->npoints;
    if (kind == TWICE) p[1] = p[0];
    if (kind == ORDER) swap(&m->owner[face], &m->owner[face + 5]), swap(&m->neighbour[face], &m->neighbour[face + 5]);
    if (kind == FLIPPED) swap(&p[0], &p[2]);
    if (kind == OPEN) m->owner[last] = m->owner[last] ? 0 : 1;
    if (kind == FAR) m->points[3] = 1e61;
    if (kind == NEIGHBOUR) m->neighbour[face] = m->owner[face];
    if (kind == NARROW)
        for (int i = 0; i < m->npoints; i++)
            if (m->points[3 * i] > 0) m->points[3 * i] = 1 + 1e-14 * m->points[3 * i];
    while (kind >= HALVES && !q->neighbour) q++;
    p = m->face_points + m->face_start[q->start + q->nfaces / 2];
    if (kind == HALVES) swap(&m->owner[q->start], &m->owner[q->start + q->nfaces / 2]);
    const int first = p[0];
    for (int i = 0; kind == TURNED && i < 4; i++) p[i] = i < 3 ? p[i + 1] : first;
}

/* Slices are sound where the whole mesh is, and all ranks agree. */
static void defects_are_found_in_slices(void **state) {
    (void)state;
    for (int kind = 0; kind < DEFECTS; kind++)
        for (int form = 0; form < 2; form++) {
            struct polymesh *m = cells_make(&recipes[kind < HALVES]), *outline, *whole;
            struct spread *s;
            damage(m, (enum defect)kind);
            write_mesh(m, form);
            ok(spread_read(folder, world, false, false, &s, &outline));
            status e = polymesh_read(folder, &whole);
            if (!e) e = polymesh_check(whole);
            if ((kind == NONE) != !e) fail_msg("defect %d of the whole mesh: %s", kind, e ? status_text(e) : "none");
            if ((kind == NONE) != (s != NULL)) fail_msg("defect %d in slices, form %d", kind, form);
            status_free(e);
            polymesh_free(m);
            polymesh_free(whole);
            polymesh_free(outline);
            spread_free(s);
            ok(comm_agree(world, OK));
        }
}

/* Puts a text into the file `name` before its first '(' that follows the header, or, with `cut`, in place of the
 * rest. */
static void edit(const char *name, const char *text, bool cut) {
    char path[128], all[1 << 16];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *f = fopen(path, "rb");
    const size_t n = fread(all, 1, sizeof all - 1, f);
    all[n] = 0;
    fclose(f);
    const size_t at = (size_t)(strchr(strchr(all, '}'), '\n') - all) + 1;
    f = fopen(path, "wb");
    fwrite(all, 1, at, f);
    fputs(text, f);
    if (!cut) fwrite(all + at, 1, n - at, f);
    fclose(f);
}

static void unusual_files_are_left_to_who_reads_the_whole(void **state) {
    (void)state;
    const struct {
        const char *name, *text;
        bool cut, read;
    } edits[] = {{"points", "// by hand\n", false, true},
                 {"owner", "3(0 0", true, false},
                 {"neighbour", "", true, false},
                 {"faces", "", true, false},
                 {"owner", "/* two\nlines */ ", false, true}};
    for (size_t i = 0; i < sizeof edits / sizeof *edits; i++) {
        struct polymesh *m = cells_make(&recipes[1]), *outline, *whole;
        struct spread *s;
        write_mesh(m, 0);
        if (comm_root(world)) edit(edits[i].name, edits[i].text, edits[i].cut);
        ok(comm_agree(world, OK));
        ok(spread_read(folder, world, false, false, &s, &outline));
        const status e = polymesh_read(folder, &whole);
        if (edits[i].read != !e) fail_msg("edit %zu: %s", i, e ? status_text(e) : "read");
        if (s) same_outline(m, outline); /* comments before a list are understood */
        assert_true(edits[i].read || !s);
        status_free(e);
        polymesh_free(m);
        polymesh_free(whole);
        polymesh_free(outline);
        spread_free(s);
        ok(comm_agree(world, OK));
    }
}

static void more_than_labels_count_is_refused(void **state) {
    (void)state;
    struct polymesh *m = cells_make(&recipes[1]), *outline;
    struct spread *s;
    for (int form = 0; form < 2; form++) {
        write_mesh(m, form);
        if (comm_root(world)) edit("owner", "3000000000\n(\n0\n", true);
        ok(comm_agree(world, OK));
        says(spread_read(folder, world, false, false, &s, &outline),
             "/owner: 3000000000 entries|labels of 32 bits|2147483646");
        assert_true(!s && !outline);
        ok(comm_agree(world, OK));
    }
    polymesh_free(m);
}

/* ---- lattices ---------------------------------------------------------------------------------------------------- */

static void slices_tell_what_is_no_lattice(void **state) {
    (void)state;
    for (int r = 0; r < RECIPES; r++) {
        struct polymesh *m = cells_make(&recipes[r]), *outline;
        struct spread *s;
        struct lattice *l;
        char why[2][256];
        bool ruled_out;
        write_mesh(m, 1);
        ok(spread_read(folder, world, false, false, &s, &outline));
        const struct mesh_part *h = &s->home;
        const struct lattice_part part = {world, &h->mesh, h->whole, h->cell, h->face, m->ncells, m->nfaces};
        ok(lattice_rule_out(&part, &ruled_out, why[0]));
        ok(lattice_recognise(m, &l, why[1]));
        assert_int_equal(ruled_out, l == NULL);
        assert_int_equal(ruled_out, recipes[r].noise > 0);
        if (ruled_out) assert_string_equal(why[0], why[1]);
        lattice_free(l);
        polymesh_free(m);
        polymesh_free(outline);
        spread_free(s);
        ok(comm_agree(world, OK));
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return status_print(s, true);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outlines_are_those_of_the_whole),
        cmocka_unit_test(parts_have_whole_cells),
        cmocka_unit_test(defects_are_found_in_slices),
        cmocka_unit_test(unusual_files_are_left_to_who_reads_the_whole),
        cmocka_unit_test(more_than_labels_count_is_refused),
        cmocka_unit_test(slices_tell_what_is_no_lattice),
    };
    int failed = cmocka_run_group_tests(tests, make_folder, remove_folder);
    comm_finish(world);
    return failed;
}
