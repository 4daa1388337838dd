/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/mesh/meshes.h"
#include <sys/stat.h>

static char folder[] = "/tmp/haff_polymesh_XXXXXX";

static struct polymesh *make(const struct recipe *r) {
    struct polymesh *m = NULL;
    ok(mesh_make(r, &m));
    return m;
}

static const struct recipe STEP = {
    .n = {6, 5, 1}, .width = {0.5, 0.25, 2}, .hole = step_hole, .type = {[4] = "empty", [5] = "empty"}};

static void test_order(void **state) {
    (void)state;
    struct recipe r = {.n = {4, 3, 2}, .width = {0.1, 0.2, 0.3}, .type = {"cyclic", "cyclic", "wall"}};
    struct polymesh *m = make(&r);
    assert_int_equal(m->ncells, 24);
    assert_int_equal(m->ninternal, 3 * 6 + 2 * 8 + 12);
    assert_int_equal(m->nfaces, 46 + 2 * (6 + 8 + 12));
    for (int f = 0; f < m->ninternal; f++) {
        assert_true(m->owner[f] < m->neighbour[f]);
        assert_true(f == 0 || m->owner[f] > m->owner[f - 1] ||
                    (m->owner[f] == m->owner[f - 1] && m->neighbour[f] > m->neighbour[f - 1]));
    }
    double fc[98 * 3], fa[98 * 3], cc[24 * 3], v[24];
    polymesh_face_geometry(m, fc, fa);
    ok(polymesh_cell_geometry(m, fc, fa, cc, v));
    for (int c = 0; c < 24; c++) {
        assert_true(fabs(v[c] - 0.006) < 1e-15);
        assert_true(fabs(cc[3 * c] - 0.1 * (c % 4 + 0.5)) < 1e-14);
        assert_true(fabs(cc[3 * c + 1] - 0.2 * (c / 4 % 3 + 0.5)) < 1e-14);
    }
    for (int i = 0; i < m->npatches; i++)
        for (int f = m->patch[i].start; f < m->patch[i].start + m->patch[i].nfaces; f++) {
            assert_true((i % 2 ? 1 : -1) * fa[3 * f + i / 2] > 0);
            assert_true(fabs(fc[3 * f + i / 2] - (i % 2 ? r.n[i / 2] * r.width[i / 2] : 0)) < 1e-14);
        }
    ok(polymesh_check(m));
    polymesh_free(m);
}

/* A tetrahedron: volume 1/6, centre 1/4, closed forms of the decomposition. */
static void test_tetrahedron(void **state) {
    (void)state;
    double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, fc[12], fa[12], cc[3], v[1];
    int start[] = {0, 3, 6, 9, 12}, faces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}, owner[] = {0, 0, 0, 0};
    struct polymesh m = {.npoints = 4,
                         .nfaces = 4,
                         .ncells = 1,
                         .points = points,
                         .face_start = start,
                         .face_points = faces,
                         .owner = owner};
    polymesh_face_geometry(&m, fc, fa);
    ok(polymesh_cell_geometry(&m, fc, fa, cc, v));
    assert_true(fabs(v[0] - 1.0 / 6) < 1e-15);
    for (int k = 0; k < 3; k++) assert_true(fabs(cc[k] - 0.25) < 1e-15 && fabs(fa[9 + k] - 0.5) < 1e-15);
}

static void test_round_trip(void **state) {
    (void)state;
    struct recipe r = {
        .n = {4, 3, 2}, .origin = {1e3, 0.1, -7}, .width = {0.1, 1.0 / 3, 0.3}, .type = {"cyclic", "cyclic"}};
    for (int i = 0; i < 5; i++) { /* the last: ascii after compressed, whose files must go */
        struct polymesh *m = make(i % 2 ? &STEP : &r), *back;
        struct foam_format format = {.binary = i & 1, .compress = i & 2, .precision = 17};
        ok(polymesh_write(m, folder, &format));
        ok(polymesh_read(folder, &back));
        assert_int_equal(polymesh_checksum(m), polymesh_checksum(back));
        assert_memory_equal(m->points, back->points, (size_t)m->npoints * 24);
        assert_int_equal(back->ncells, m->ncells);
        for (int p = 0; p < m->npatches; p++) {
            assert_string_equal(m->patch[p].name, back->patch[p].name);
            assert_string_equal(m->patch[p].type, back->patch[p].type);
            assert_int_equal(m->patch[p].start, back->patch[p].start);
            assert_int_equal(m->patch[p].neighbour != NULL, back->patch[p].neighbour != NULL);
        }
        ok(polymesh_check(back));
        back->points[4] += 1e-9;
        assert_int_not_equal(polymesh_checksum(m), polymesh_checksum(back));
        polymesh_free(m);
        polymesh_free(back);
    }
}

/* Replaces the first `from` in a file of the folder after `after`. */
static void edit(const char *name, const char *after, const char *from, const char *to) {
    char path[256];
    static char text[1 << 17];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *f = fopen(path, "r");
    assert_non_null(f);
    size_t n = fread(text, 1, sizeof text - 1, f);
    text[n] = 0;
    fclose(f);
    char *at = strstr(text, after);
    if (at) at = strstr(at, from);
    if (!at) fail_msg("%s holds no '%s' after '%s'", name, from, after);
    f = fopen(path, "w");
    fwrite(text, 1, (size_t)(at - text), f);
    fputs(to, f);
    fputs(at + strlen(from), f);
    fclose(f);
}

static void test_bad_files(void **state) {
    (void)state;
    static const struct {
        const char *file, *after, *from, *to, *says;
    } bad[] = {
        {"owner", ")\n", ")", "", "owner"},
        {"owner", "(\n", "0\n", "-1\n", "owner:|face 0: cell -1"},
        {"owner", "(\n", "0\n", "99999\n", "owner:|face 0: cell 99999|has cells from 0"},
        {"neighbour", "(\n", "1\n", "0\n", "neighbour:|face 0: neighbour 0, owner 0"},
        {"neighbour", "(\n", "1\n", "7\n", "neighbour:|face 1|sorted by owner|renumberMesh"},
        {"neighbour", "}", "37", "36", "neighbour"},
        {"faces", "(\n", "4(", "3(", "faces:"},
        {"faces", "(\n", "4(", "4(777 ", "faces:"},
        {"points", "(\n", "(", "(x ", "points:"},
        {"points", "(\n", "0 ", "nan ", "points:"},
        {"boundary", "x1", "startFace", "startFacee", "boundary:|'x1'|needs nFaces and startFace"},
        {"boundary", "x0", "nFaces          5", "nFaces          4", "boundary:|'x1'|allowed is"},
        {"boundary", "x0", "nFaces          5", "nFaces          4000", "boundary:|whole number from 0 to"},
        {"boundary", "x1", "patch", "pach", "boundary:|'pach'|allowed are patch wall"},
        {"boundary", "x0", "patch", "cyclic", "boundary:|'x0'|neighbourPatch"},
        {"boundary", "x0", "patch;", "cyclic; neighbourPatch x1;", "boundary|'x0'|name the other"},
        {"boundary", "\n}", "7", "8", "boundary:|7 patches; the list announced 8"},
        {"boundary", "\n}", "7", "6", "boundary:|'inner'|more than the 6"},
        {"boundary", "x1", "x1", "x0", "boundary:|a second patch"},
    };
    struct polymesh *m = make(&STEP), *back;
    struct foam_format format = {.precision = 6};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        ok(polymesh_write(m, folder, &format));
        edit(bad[i].file, bad[i].after, bad[i].from, bad[i].to);
        back = NULL;
        says(polymesh_read(folder, &back), bad[i].says);
        assert_null(back);
    }
    ok(polymesh_write(m, folder, &format));
    edit("boundary", "\n}", "7", "7 // entry0");
    edit("boundary", "version", "2.0", "2");
    edit("boundary", "x0", "nFaces", "inGroups 2(a b); physicalType x; sub { a (1 2); } nFaces");
    ok(polymesh_read(folder, &back));
    polymesh_free(back);
    polymesh_free(m);
}

static void test_truncated(void **state) {
    (void)state;
    static const char *const names[] = {"points", "faces", "owner", "neighbour", "boundary"};
    struct polymesh *m = make(&STEP), *back;
    for (int i = 0; i < 20; i++) {
        char path[256];
        struct stat st;
        struct foam_format format = {.binary = i % 2, .precision = 6};
        ok(polymesh_write(m, folder, &format));
        snprintf(path, sizeof path, "%s/%s", folder, names[i % 5]);
        assert_int_equal(stat(path, &st), 0);
        assert_int_equal(truncate(path, st.st_size * (i + 4) / 30), 0);
        says(polymesh_read(folder, &back), names[i % 5]);
    }
    polymesh_free(m);
}

static void test_checks(void **state) {
    (void)state;
    struct recipe r = STEP;
    r.n[2] = 2;
    struct polymesh *m = make(&r);
    says(polymesh_check(m), "cells that empty patches do not close|Layers{1}|cell 0 at (0.25, 0.125, 1)|along z");
    polymesh_free(m);
    m = make(&STEP);
    ok(polymesh_check(m));
    int *p = m->face_points + m->face_start[3], swap = p[1];
    p[1] = p[3], p[3] = swap;
    says(polymesh_check(m), "2 bad cells|is not closed");
    swap = p[1], p[1] = p[3], p[3] = swap;
    ok(polymesh_check(m));
    double x = m->points[3 * m->face_points[0]];
    m->points[3 * m->face_points[0]] += 2; /* one corner far out: some cell turns inside out */
    says(polymesh_check(m), "bad faces|does not point out of its owner");
    m->points[3 * m->face_points[0]] = 1e150; /* its volume would be infinite */
    says(polymesh_check(m), "mesh: point|1e+150|another unit");
    m->points[3 * m->face_points[0]] = x;
    polymesh_free(m);
    r = (struct recipe){
        .n = {2, 2, 2}, .width = {1, 1, 1}, .type = {"empty", "empty", "empty", "empty", "empty", "empty"}};
    r.n[0] = r.n[1] = r.n[2] = 1;
    m = make(&r);
    says(polymesh_check(m), "empty patches close x, y and z");
    polymesh_free(m);
    r = (struct recipe){.n = {3, 3, 1}, .width = {1, 1, 1}, .type = {"cyclic", "patch"}};
    says(mesh_make(&r, &m), "cyclic patch 'x0'|each half must be cyclic");
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_order),      cmocka_unit_test(test_tetrahedron),
                                       cmocka_unit_test(test_round_trip), cmocka_unit_test(test_bad_files),
                                       cmocka_unit_test(test_truncated),  cmocka_unit_test(test_checks)};
    if (!mkdtemp(folder)) return 1;
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    static const char *const names[] = {"points", "faces", "owner", "neighbour", "boundary"};
    for (int i = 0; i < 10; i++) {
        char path[256];
        snprintf(path, sizeof path, "%s/%s%s", folder, names[i / 2], i % 2 ? ".gz" : "");
        unlink(path);
    }
    rmdir(folder);
    return failed;
}
