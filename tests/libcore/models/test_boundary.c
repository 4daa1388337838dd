/* Every boundary type: the ghost values it makes of a line of cells. */
#include "tests/libcore/oracle.h"

#include "libcore/models/boundary.h"

static void ghosts_of(const char *name, int components, int normal, const double values[][3], double out[3][4]) {
    static const double x[] = {1, -2, 3, 4}, y[] = {5, 6, -7, 8}, z[] = {-9, 10, 11, 12}, outflow[] = {1, -1, 0, -2};
    static const int face[] = {3, 2, 1, 0};
    struct rule rule = {.type = boundary_find(name), .uniform = {70, 80, 90}, .values = values ? &values[0][0] : NULL};
    struct ghost_line line = {.n = 4,
                              .components = components,
                              .face = face,
                              .inner = {x, y, z},
                              .outflow = outflow,
                              .normal = normal,
                              .ghost = {out[0], out[1], out[2]}};
    rule.type->ghost(&rule, &line);
}

static void check(double out[3][4], int c, double a, double b, double d, double e) {
    const double expected[] = {a, b, d, e};
    for (int i = 0; i < 4; i++) assert_true(out[c][i] == expected[i]);
}

static void walls(void **state) {
    (void)state;
    double out[3][4];
    for (int k = 0; k < boundary_count; k++) {
        if (!boundary_table[k].wall) continue;
        const char *name = boundary_table[k].model.name;
        const bool whole = !boundary_is_smooth(&boundary_table[k]);
        ghosts_of(name, 3, 1, NULL, out);
        check(out, 1, -5, -6, 7, -8);
        if (whole)
            check(out, 0, -1, 2, -3, -4);
        else
            check(out, 0, 1, -2, 3, 4);
        if (boundary_table[k].scalar) {
            ghosts_of(name, 1, -1, NULL, out);
            check(out, 0, 1, -2, 3, 4);
        }
    }
}

static void open_ends(void **state) {
    (void)state;
    double out[3][4];
    ghosts_of("zeroGradient", 2, 0, NULL, out);
    check(out, 1, 5, 6, -7, 8);
    ghosts_of("fixedValue", 3, 0, NULL, out);
    check(out, 2, 90, 90, 90, 90);
    ghosts_of("inletOutlet", 2, 0, NULL, out); /* outflow > 0, < 0, = 0, < 0 */
    check(out, 0, 1, 70, 3, 70);
    check(out, 1, 5, 80, -7, 80);
}

static void values_per_face(void **state) {
    (void)state;
    const double values[4][3] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}};
    double out[3][4];
    ghosts_of("fixedValue", 3, 0, values, out);
    check(out, 0, 10, 7, 4, 1);
    check(out, 2, 12, 9, 6, 3);
}

static void names(void **state) {
    (void)state;
    assert_int_equal(boundary_count, 9); /* a new row needs its test here */
    for (int k = 0; k < boundary_count; k++) {
        assert_ptr_equal(boundary_find(boundary_table[k].model.name), &boundary_table[k]);
        assert_true(boundary_table[k].scalar || boundary_table[k].vector);
    }
    assert_null(boundary_find("wall"));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walls),
        cmocka_unit_test(open_ends),
        cmocka_unit_test(values_per_face),
        cmocka_unit_test(names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
