/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mesh/lattice/lattice.h"
#include "tests/mesh/meshes.h"

static struct lattice *recognise(const struct recipe *r, struct polymesh **m, char why[256]) {
    struct lattice *l = NULL;
    ok(mesh_make(r, m));
    ok(lattice_recognise(*m, &l, why));
    return l;
}

/* What the header promises: cell[] and face[] agree with the mesh's own owner and neighbour and its geometry. */
static void check_lattice(const struct polymesh *m, const struct lattice *l, double tolerance) {
    double *fc = malloc((size_t)m->nfaces * 24), *fa = malloc((size_t)m->nfaces * 24);
    double *cc = malloc((size_t)m->ncells * 24), *v = malloc((size_t)m->ncells * 8);
    polymesh_face_geometry(m, fc, fa);
    ok(polymesh_cell_geometry(m, fc, fa, cc, v));
    int seen = 0;
    for (int i = 0; i < l->n[0] * l->n[1] * l->n[2]; i++) {
        int c = l->cell[i], at[3] = {i % l->n[0], i / l->n[0] % l->n[1], i / l->n[0] / l->n[1]};
        if (c < 0) continue;
        seen++;
        assert_true(fabs(v[c] / (l->width[0] * l->width[1] * l->width[2]) - 1) < tolerance);
        for (int k = 0; k < l->dim; k++) {
            assert_true(fabs((cc[3 * c + l->axis[k]] - l->origin[k]) / l->width[k] - at[k] - 0.5) < tolerance);
            for (int side = 0; side < 2; side++) {
                int f = l->face[6 * c + 2 * k + side], to[3] = {at[0], at[1], at[2]};
                to[k] += side ? 1 : -1;
                bool inside = to[k] >= 0 && to[k] < l->n[k];
                int other = inside ? l->cell[to[0] + l->n[0] * (to[1] + l->n[1] * to[2])] : -1;
                assert_true(m->owner[f] == c || (f < m->ninternal && m->neighbour[f] == c));
                assert_int_equal(f < m->ninternal ? m->owner[f] + m->neighbour[f] - c : -1, other);
                double x = (fc[3 * f + l->axis[k]] - l->origin[k]) / l->width[k];
                assert_true(fabs(x - at[k] - side) < tolerance);
            }
        }
        for (int k = 2 * l->dim; k < 6; k++) assert_int_equal(l->face[6 * c + k], -1);
    }
    assert_int_equal(seen, m->ncells);
    free(fc), free(fa), free(cc), free(v);
}

static void test_dimensions(void **state) {
    (void)state;
    for (int gone = 0; gone < 8; gone++) { /* every set of empty axes */
        struct recipe r = {.n = {5, 4, 3}, .origin = {-1, 0.3, 2}, .width = {0.1, 0.2, 0.3}};
        int left = 0;
        double thickness = 1;
        for (int k = 0; k < 3; k++) {
            if (gone >> k & 1) {
                r.type[2 * k] = r.type[2 * k + 1] = "empty";
                r.n[k] = 1;
                thickness *= r.width[k];
            } else
                left++;
        }
        struct polymesh *m;
        struct lattice *l = NULL;
        char why[256];
        if (left == 0) {
            ok(mesh_make(&r, &m));
            says(lattice_recognise(m, &l, why), "empty patches close x, y and z");
            polymesh_free(m);
            continue;
        }
        l = recognise(&r, &m, why);
        if (!l) fail_msg("%s", why);
        assert_int_equal(l->dim, left);
        for (int k = 0; k < 3; k++) {
            assert_int_equal(l->n[k], r.n[l->axis[k]]);
            assert_true(fabs(l->width[k] - r.width[l->axis[k]]) < 1e-14);
            assert_true(fabs(l->origin[k] - r.origin[l->axis[k]]) < 1e-14);
            if (k > 0 && k < left) assert_true(l->axis[k] > l->axis[k - 1]);
            assert_false(l->periodic[k]);
        }
        assert_true(fabs(l->thickness - thickness) < 1e-14);
        check_lattice(m, l, 1e-9);
        lattice_free(l);
        polymesh_free(m);
    }
}

static void test_hole(void **state) {
    (void)state;
    struct recipe r = {.n = {6, 5, 1}, .width = {1, 1, 1}, .hole = step_hole, .type = {[4] = "empty", [5] = "empty"}};
    struct polymesh *m;
    char why[256];
    struct lattice *l = recognise(&r, &m, why);
    if (!l) fail_msg("%s", why);
    assert_int_equal(m->ncells, 24);
    assert_int_equal(l->cell[5], -1);
    check_lattice(m, l, 1e-9);
    lattice_free(l);
    polymesh_free(m);
}

static bool inner_hole(int i, int j, int k) {
    return i == 2 && j == 2 && k == 1;
}

/* An axis may be uniform that is periodic, longer than a cell, and without holes. */
static void test_uniform(void **state) {
    (void)state;
    for (int hole = 0; hole < 2; hole++) {
        struct recipe r = {.n = {6, 5, 1},
                           .width = {1, 1, 1},
                           .hole = hole ? inner_hole : NULL,
                           .type = {[2] = "cyclic", [3] = "cyclic", [4] = "cyclic", [5] = "cyclic"}};
        if (hole) r.n[2] = 4;
        struct polymesh *m;
        char why[256];
        struct lattice *l = recognise(&r, &m, why);
        if (!l) fail_msg("%s", why);
        for (int k = 0; k < 3; k++) {
            assert_int_equal(lattice_may_be_uniform(l, m, k), !hole && k == 1);
            assert_false(l->uniform[k]);
        }
        lattice_free(l);
        polymesh_free(m);
    }
}

/* The centres of a layer of cells have the same bits, and are the cells' centres but for the noise. */
static void check_centres(const struct polymesh *m, const struct lattice *l) {
    double *centre = malloc((size_t)m->ncells * 24);
    lattice_centres(l, centre);
    for (int i = 0; i < l->n[0] * l->n[1] * l->n[2]; i++) {
        const int at[3] = {i % l->n[0], i / l->n[0] % l->n[1], i / l->n[0] / l->n[1]};
        for (int k = 0; k < l->dim; k++) {
            const double x = centre[3 * l->cell[i] + l->axis[k]], exact = l->origin[k] + (at[k] + 0.5) * l->width[k];
            const int first = l->cell[k == 0 ? at[0] : k == 1 ? at[1] * l->n[0] : at[2] * l->n[0] * l->n[1]];
            assert_memory_equal(&x, &centre[3 * first + l->axis[k]], sizeof x);
            assert_true(fabs(x - exact) < 1e-15 * fabs(exact) + 1e-15);
        }
    }
    free(centre);
}

static void test_noise(void **state) {
    (void)state;
    struct recipe r = {.n = {40, 30, 2}, .origin = {1000, -3, 0}, .width = {0.01, 0.01, 0.01}, .noise = 2e-7};
    struct polymesh *m;
    char why[256];
    struct lattice *l = recognise(&r, &m, why);
    if (!l) fail_msg("%s", why);
    check_lattice(m, l, 1e-6);
    check_centres(m, l);
    lattice_free(l);
    polymesh_free(m);
    r.noise = 1e-5;
    assert_null(recognise(&r, &m, why));
    assert_non_null(strstr(why, "cell "));
    assert_non_null(strstr(why, " at ("));
    polymesh_free(m);
}

static void test_periodic(void **state) {
    (void)state;
    struct recipe r = {.n = {5, 4, 1}, .width = {1, 2, 3}, .type = {[0] = "empty", "empty", "cyclic", "cyclic"}};
    r.n[0] = 1, r.n[2] = 5;
    struct polymesh *m;
    char why[256];
    struct lattice *l = recognise(&r, &m, why);
    if (!l) fail_msg("%s", why);
    assert_int_equal(l->dim, 2);
    assert_int_equal(l->axis[0], 1);
    assert_true(l->periodic[0] && !l->periodic[1]);
    check_lattice(m, l, 1e-9);
    lattice_free(l);
    polymesh_free(m);
    r = (struct recipe){.n = {6, 5, 1}, .width = {1, 1, 1}, .hole = step_hole, .type = {[4] = "empty", [5] = "empty"}};
    r.type[0] = r.type[1] = "cyclic"; /* the step takes two of five faces of x1 away */
    says(mesh_make(&r, &m), "cyclic patch 'x0' has 5 faces and 'x1' has 3");
}

/* Halves swapped by one row: each pair is a pure shift no longer along one axis. */
static void test_skew_cyclic(void **state) {
    (void)state;
    struct recipe r = {.n = {3, 3, 1}, .width = {1, 1, 1}, .type = {"cyclic", "cyclic", [4] = "empty", [5] = "empty"}};
    struct polymesh *m;
    struct lattice *l;
    char why[256];
    ok(mesh_make(&r, &m));
    int f = m->patch[1].start, o = m->owner[f];
    m->owner[f] = m->owner[f + 1];
    m->owner[f + 1] = o;
    for (int i = 0; i < 4; i++) {
        int *a = &m->face_points[m->face_start[f] + i], *b = &m->face_points[m->face_start[f + 1] + i], p = *a;
        *a = *b, *b = p;
    }
    says(polymesh_check(m), "pairs of cyclic faces do not match|'x0'|'x1'");
    ok(lattice_recognise(m, &l, why));
    assert_null(l);
    assert_non_null(strstr(why, "do not wrap"));
    polymesh_free(m);
}

static void test_refused(void **state) {
    (void)state;
    struct polymesh *m;
    char why[256];
    struct recipe r = {.n = {4, 2, 1}, .width = {1, 1, 1}, .type = {[4] = "empty", [5] = "empty"}, .crack = {1, 2}};
    assert_null(recognise(&r, &m, why));
    assert_non_null(strstr(why, "a wall without thickness"));
    polymesh_free(m);
    r.crack[1] = 1;
    ok(mesh_make(&r, &m));
    for (int p = 0; p < m->npoints; p++) m->points[3 * p] *= 1 + 0.1 * m->points[3 * p]; /* graded */
    struct lattice *l;
    ok(lattice_recognise(m, &l, why));
    assert_null(l);
    assert_non_null(strstr(why, "long along x, the mean cell is"));
    for (int p = 0; p < m->npoints; p++) m->points[3 * p] += 0.5 * m->points[3 * p + 1]; /* sheared */
    ok(lattice_recognise(m, &l, why));
    assert_null(l);
    assert_non_null(strstr(why, "is no box"));
    polymesh_free(m);
}

static void round_points(struct polymesh *m, int digits) {
    char text[32];
    for (long i = 0; i < 3L * m->npoints; i++) {
        snprintf(text, sizeof text, "%.*g", digits, m->points[i]);
        m->points[i] = strtod(text, NULL);
    }
}

/* Meshes that were written with few digits: equal cells differ by the rounding, and no more. */
static void test_digits(void **state) {
    (void)state;
    struct recipe r = {.n = {300, 7, 1},
                       .origin = {0, -0.5, 0},
                       .width = {2.0 / 300, 1.0 / 7, 0.1},
                       .type = {[4] = "empty", [5] = "empty"}};
    for (int digits = 5; digits <= 12; digits++) {
        struct polymesh *m;
        char why[256];
        struct lattice *l = recognise(&r, &m, why);
        lattice_free(l);
        round_points(m, digits);
        ok(lattice_recognise(m, &l, why));
        assert_non_null(l);
        assert_int_equal(l->n[0], 300);
        check_lattice(m, l, 2.1 * 0.5 * pow(10, 1 - digits) / r.width[0] + 1e-9);
        lattice_free(l);
        for (long p = 0; p < m->npoints; p++) /* one layer is moved by ten units of the last digit */
            if (fabs(m->points[3 * p] - 1) < 1e-3 * r.width[0] + pow(10, 1 - digits))
                m->points[3 * p] = 1 + 10 * pow(10, 1 - digits);
        ok(lattice_recognise(m, &l, why));
        assert_true(!l == (digits < 11)); /* with 11 digits that is 1.5e-7 of a cell */
        lattice_free(l);
        polymesh_free(m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_dimensions), cmocka_unit_test(test_hole),
                                       cmocka_unit_test(test_uniform),    cmocka_unit_test(test_noise),
                                       cmocka_unit_test(test_periodic),   cmocka_unit_test(test_skew_cyclic),
                                       cmocka_unit_test(test_refused),    cmocka_unit_test(test_digits)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
