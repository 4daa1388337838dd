/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mesh/format/gmsh.h"
#include "mesh/lattice/lattice.h"
#include "tests/mesh/meshes.h"

static char path[] = "/tmp/haff_gmsh_XXXXXX";

static void write_text(const char *text, size_t n) {
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fwrite(text, 1, n, f);
    fclose(f);
}

static status read_text(const char *text, struct polymesh **m) {
    write_text(text, strlen(text));
    return gmsh_read(path, NULL, 0, m);
}

#define FORMAT "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
#define NAMES  "$PhysicalNames\n3\n1 1 \"wallSide\"\n1 2 \"open\"\n2 3 \"gas\"\n$EndPhysicalNames\n"
/* two unit squares side by side; node 99 is used by nothing, numbers are sparse and unsorted */
#define NODES             "$Nodes\n7\n70 2 1 0\n1 0 0 0\n5 1 0 0\n99 7 7 7\n1000000 2 0 0\n3 0 1 0\n8 1 1 0\n$EndNodes\n"
#define QUADS             "10 3 2 3 1 1 5 8 3\n11 3 2 3 1 5 1000000 70 8\n"
#define EDGES             "1 1 2 1 1 1 5\n2 1 2 1 1 5 1000000\n3 1 2 2 2 1000000 70\n4 1 2 1 3 70 8\n5 1 2 1 3 8 3\n"
#define LAST              "6 1 2 2 4 3 1\n"
#define ELEMENTS(n, text) "$Elements\n" n "\n" text "$EndElements\n"

static void test_squares(void **state) {
    (void)state;
    struct polymesh *m;
    struct lattice *l;
    char why[256];
    ok(read_text(FORMAT NAMES NODES ELEMENTS("9", EDGES LAST QUADS "11 3 2 3 1 5 1000000 70 8\n"), &m)); /* one twice */
    assert_int_equal(m->ncells, 2);
    assert_int_equal(m->npoints, 12);
    assert_int_equal(m->nfaces, 11);
    static const char *const names[] = {"wallSide", "open", "back", "front"};
    static const char *const types[] = {"wall", "patch", "empty", "empty"};
    static const int counts[] = {4, 2, 2, 2};
    assert_int_equal(m->npatches, 4);
    for (int i = 0; i < 4; i++) {
        assert_string_equal(m->patch[i].name, names[i]);
        assert_string_equal(m->patch[i].type, types[i]);
        assert_int_equal(m->patch[i].nfaces, counts[i]);
    }
    ok(polymesh_check(m));
    ok(lattice_recognise(m, &l, why));
    assert_non_null(l);
    assert_int_equal(l->n[0], 2);
    assert_true(fabs(l->thickness - 1) < 1e-15); /* sqrt(area / cells) */
    lattice_free(l);
    polymesh_free(m);
}

static void test_line(void **state) {
    (void)state;
    struct polymesh *m;
    struct lattice *l;
    char why[256];
    ok(read_text(
        FORMAT "$PhysicalNames\n2\n0 1 \"low\"\n0 2 \"high\"\n$EndPhysicalNames\n"
               "$Nodes\n4\n1 0 0 3\n2 0 0.5 3\n3 0 1.5 3\n4 0 1 3\n$EndNodes\n"
               "$Elements\n5\n1 15 2 1 1 1\n2 15 2 2 2 3\n3 1 2 7 1 1 2\n4 1 2 7 1 4 2\n5 1 2 7 1 4 3\n$EndElements\n",
        &m));
    ok(polymesh_check(m));
    ok(lattice_recognise(m, &l, why));
    assert_non_null(l);
    assert_int_equal(l->dim, 1);
    assert_int_equal(l->axis[0], 1);
    assert_int_equal(l->n[0], 3);
    assert_true(fabs(l->thickness - 0.25) < 1e-15); /* (length / cells)^2 */
    assert_int_equal(m->npatches, 3);
    assert_string_equal(m->patch[2].name, "sides");
    assert_int_equal(m->patch[2].nfaces, 12);
    double x = m->points[3 * m->face_points[m->face_start[m->patch[0].start]] + 1];
    assert_true(fabs(x) < 1e-15);
    lattice_free(l);
    polymesh_free(m);
}

static void test_errors(void **state) {
    (void)state;
#define GOOD EDGES LAST QUADS
    static const struct {
        const char *text, *says;
    } bad[] = {
        {"", "empty"},
        {"hello", ":1:|expected a section"},
        {"$MeshFormat\n4 0 8\n$EndMeshFormat\n", ":2:|format 4; read are 2.2 and 4.1|msh41"},
        {"$MeshFormat\n2.2 0 4\n$EndMeshFormat\n", "4 bytes"},
        {NODES, "first section|$MeshFormat"},
        {"$NOD\n1\n1 0 0 0\n$ENDNOD\n", ":2:|$NOD|gmsh's format 1|-format msh41"},
        {"$Comments\nhello $Nodes\n$EndComments\n", "no $MeshFormat"},
        {FORMAT "$ParametricNodes\n1\n1 0 0 0 4 1\n$EndParametricNodes\n", "dimension 4"},
        {FORMAT NAMES NODES ELEMENTS("7", EDGES QUADS),
         "1 of 10 boundary faces are in no physical group, the first at (0, 0.5, 0.5)|Physical Curve"},
        {FORMAT NAMES NODES ELEMENTS("8", GOOD "9 1 2 1 4 3 1\n"), "expected $EndElements"},
        {FORMAT NAMES NODES ELEMENTS("9", GOOD "9 1 2 1 4 3 1\n"),
         "(0, 0.5, 0.5) is in two groups, 'open' and 'wallSide'"},
        {FORMAT NAMES NODES ELEMENTS("9", GOOD "9 1 2 1 4 5 8\n"), "'wallSide' has a face inside the mesh, at (1, 0.5"},
        {FORMAT NAMES NODES ELEMENTS("9", GOOD "9 1 2 1 4 1 8\n"), "'wallSide' has an element at|no face of a cell"},
        {FORMAT NAMES NODES ELEMENTS("9", GOOD "9 1 2 1 4 1 99\n"), "'wallSide'|belongs to no cell"},
        {FORMAT NAMES NODES ELEMENTS("9", GOOD "9 3 2 3 1 5 8 70 1\n"), "belongs to three cells"},
        {FORMAT NAMES NODES ELEMENTS("9", GOOD "9 1 2 1 4 3 4\n"), "node 4, which is not among the 7"},
        {FORMAT NAMES NODES ELEMENTS("9", GOOD "9 8 2 1 4 3 1 5\n"), "line of 3 nodes|Mesh.ElementOrder = 1"},
        {FORMAT NAMES NODES ELEMENTS("9", GOOD "9 3 2 3 1 5 5 70 8\n"), "has node 5 twice"},
        {FORMAT NAMES NODES ELEMENTS("10", GOOD), "whole number"},
        {FORMAT NAMES NODES ELEMENTS("1000000000", GOOD), "1000000000 elements cannot be"},
        {FORMAT NAMES NODES ELEMENTS("9", GOOD "9 1 2 9 4 3 1\n"), "two groups"},
        {FORMAT NODES ELEMENTS("8", GOOD), "Physical Curve(1) has no name"},
        {FORMAT NODES ELEMENTS("2", "1 3 2 0 1 1 5 8 3\n2 3 2 0 1 5 1000000 70 8\n"),
         "no physical groups|Physical Curve"},
        {FORMAT NAMES NODES ELEMENTS("2", QUADS), "their boundary is in no physical group"},
        {FORMAT NAMES NODES ELEMENTS("6", EDGES LAST), "call gmsh with -2"},
        {FORMAT "$PhysicalNames\n2\n1 1 \"a b\"\n1 2 \"open\"\n$EndPhysicalNames\n" NODES ELEMENTS("8", GOOD),
         "Physical Curve(\"a b\")|\"a_b\""},
        {FORMAT "$PhysicalNames\n2\n1 1 \"12\"\n1 2 \"open\"\n$EndPhysicalNames\n" NODES ELEMENTS("8", GOOD),
         "\"patch12\""},
        {FORMAT "$PhysicalNames\n2\n1 1 \"open\"\n1 2 \"open\"\n$EndPhysicalNames\n" NODES ELEMENTS("8", GOOD),
         "two physical groups have the name 'open'"},
        {FORMAT "$PhysicalNames\n2\n1 1 \"front\"\n1 2 \"open\"\n$EndPhysicalNames\n" NODES ELEMENTS("8", GOOD),
         "'front'|rename it"},
        {FORMAT "$PhysicalNames\n2\n1 1 \"cyclicA\"\n1 2 \"open\"\n$EndPhysicalNames\n" NODES ELEMENTS("8", GOOD),
         "'cyclicA'|system/meshDict"},
        {FORMAT
         "$PhysicalNames\n3\n1 1 \"a\"\n1 2 \"open\"\n3 4 \"gas\"\n$EndPhysicalNames\n" NODES ELEMENTS("8", GOOD),
         "'gas' of Physical Volume has no elements|Recombine"},
        {FORMAT NAMES "$Nodes\n2\n1 0 0 0\n1 1 0 0\n$EndNodes\n" ELEMENTS("1", "1 1 2 1 1 1 1\n"),
         "node number 1 stands twice"},
        {FORMAT NAMES "$Nodes\n1\n1 nan 0 0\n$EndNodes\n", "finite number"},
        {FORMAT NAMES "$Nodes\n1\n1 0 0 zero\n$EndNodes\n", ":12:|found 'zero'; expected a number"},
        {FORMAT "$PartitionedEntities\n1\n$EndPartitionedEntities\n", "partitioned"},
        {FORMAT NAMES "$Nodes\n4\n1 0 0 0\n2 1 0 0.5\n3 1 1 0\n4 0 1 1\n$EndNodes\n"
                      "$Elements\n2\n1 1 2 1 1 1 2\n2 3 2 3 1 1 2 3 4\n$EndElements\n",
         "in no plane normal to x, y or z|Physical Volume"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct polymesh *m = NULL;
        says(read_text(bad[i].text, &m), bad[i].says);
        assert_null(m);
    }
    struct polymesh *m;
    says(gmsh_read("/nonexistent/mesh.msh", NULL, 0, &m), "/nonexistent/mesh.msh");
}

/* Cut anywhere, a file is an error and nothing worse (the sanitizers look on). */
static void test_truncated(void **state) {
    (void)state;
    static const char text[] = FORMAT NAMES NODES ELEMENTS("8", GOOD);
    struct polymesh *m;
    for (size_t n = 0; n + 2 < sizeof text - 1; n++) {
        write_text(text, n);
        status s = gmsh_read(path, NULL, 0, &m);
        if (!s) fail_msg("a file cut after %zu bytes was read", n);
        status_free(s);
    }
}

static void test_rules(void **state) {
    (void)state;
    static const char text[] =
        FORMAT "$PhysicalNames\n4\n1 1 \"side\"\n1 2 \"left\"\n1 4 \"right\"\n2 3 \"gas\"\n$EndPhysicalNames\n" NODES
               "$Elements\n8\n1 1 2 1 1 1 5\n2 1 2 1 1 5 1000000\n3 1 2 4 2 1000000 70\n4 1 2 1 3 70 8\n5 1 2 1 3 8 3\n"
               "6 1 2 2 4 3 1\n" QUADS "$EndElements\n";
    struct gmsh_rule rules[] = {
        {"left", "cyclic", "right", "D:1"}, {"right", "cyclic", "left", "D:2"}, {"side", "symmetryPlane", NULL, "D:3"}};
    struct polymesh *m;
    struct lattice *l;
    char why[256];
    write_text(text, sizeof text - 1);
    ok(gmsh_read(path, rules, 3, &m));
    ok(polymesh_check(m));
    assert_string_equal(m->patch[polymesh_find_patch(m, "left")].neighbour, "right");
    ok(lattice_recognise(m, &l, why));
    assert_non_null(l);
    assert_true(l->periodic[0] && !l->periodic[1]);
    lattice_free(l);
    polymesh_free(m);
    rules[1].neighbour = "side";
    says(gmsh_read(path, rules, 3, &m), "'left'|each half must be cyclic and name the other");
    rules[1].neighbour = NULL;
    says(gmsh_read(path, rules, 3, &m), "D:2|'right'|neighbourPatch");
    rules[1] = (struct gmsh_rule){"rigt", "patch", NULL, "D:2"};
    says(gmsh_read(path, rules, 3, &m), "D:2: the mesh has no patch 'rigt'; it has| side left right");
    rules[1] = (struct gmsh_rule){"front", "wall", NULL, "D:2"};
    says(gmsh_read(path, rules + 1, 2, &m), "D:2|'front'|can only be empty");
    rules[2].type = "symetry";
    says(gmsh_read(path, rules + 2, 1, &m), "D:3|'symetry'|allowed are patch wall");
}

static void test_byte_order(void **state) {
    (void)state;
    static const char text[] = "$MeshFormat\n4.1 1 8\n\0\0\0\1\n$EndMeshFormat\n";
    struct polymesh *m;
    write_text(text, sizeof text - 1);
    says(gmsh_read(path, NULL, 0, &m), "byte|other byte order");
}

/* A section of comments in front, and nodes with their parameters on points, curves and surfaces. */
static void test_other_sections(void **state) {
    (void)state;
    static const char nodes[] = "$ParametricNodes\n6\n70 2 1 0 0 3\n1 0 0 0 1 1 0.5\n5 1 0 0 2 1 0.5 0.25\n"
                                "1000000 2 0 0 0 2\n3 0 1 0 0 4\n8 1 1 0 3 1\n$EndParametricNodes\n";
    char text[2000];
    struct polymesh *plain, *m;
    snprintf(text, sizeof text, "$Comments\nhello $Nodes\n$EndComments\n%s%s%s", FORMAT NAMES, nodes,
             ELEMENTS("8", EDGES LAST QUADS));
    ok(read_text(text, &m));
    ok(read_text(FORMAT NAMES NODES ELEMENTS("8", EDGES LAST QUADS), &plain));
    assert_int_equal(polymesh_checksum(m), polymesh_checksum(plain));
    polymesh_free(plain);
    polymesh_free(m);
}

/* A plane mesh gets the depth that the caller gives, or the size of a cell. */
static void test_thickness(void **state) {
    (void)state;
    struct polymesh *m;
    double low[3], high[3];
    (void)read_text(FORMAT NAMES NODES ELEMENTS("8", EDGES LAST QUADS), &m);
    polymesh_free(m);
    ok(gmsh_read_thick(path, NULL, 0, 2.5, &m));
    polymesh_bounds(m, low, high);
    assert_true(low[2] == 0 && high[2] == 2.5);
    polymesh_free(m);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_squares),        cmocka_unit_test(test_line),
                                       cmocka_unit_test(test_errors),         cmocka_unit_test(test_truncated),
                                       cmocka_unit_test(test_rules),          cmocka_unit_test(test_byte_order),
                                       cmocka_unit_test(test_other_sections), cmocka_unit_test(test_thickness)};
    int fd = mkstemp(path);
    if (fd < 0) return 1;
    close(fd);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(path);
    return failed;
}
