/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gradients, values at points and anywhere in cells, and surfaces through them, on every shape of cells: linear fields
 * are exact, beside the ends of the mesh as inside; level sets converge to spheres and have no gaps. */
#include "mesh/grid/slices.h"

#include "tests/mesh/polyhedral/cells.h"

static const struct cells_recipe recipes[] = {
    {"line", 1, BOXES, {13, 1, 1}, {0, 1, 2}, 0.3, {false}},
    {"line along z", 1, BOXES, {9, 1, 1}, {2, 0, 1}, 0.3, {false}},
    {"quads", 2, BOXES, {7, 6, 1}, {0, 1, 2}, 0.2, {false}},
    {"quads in x and z", 2, BOXES, {7, 6, 1}, {0, 2, 1}, 0.2, {false}},
    {"triangles", 2, PRISMS, {7, 6, 1}, {0, 1, 2}, 0.2, {false}},
    {"triangles in y and z", 2, PRISMS, {6, 7, 1}, {1, 2, 0}, 0.2, {false}},
    {"boxes", 3, BOXES, {5, 4, 4}, {0, 1, 2}, 0, {false}},
    {"warped hexahedra", 3, BOXES, {5, 4, 4}, {0, 1, 2}, 0.2, {false}},
    {"prisms", 3, PRISMS, {4, 3, 3}, {0, 1, 2}, 0.2, {false}},
    {"tetrahedra", 3, TETS, {4, 3, 3}, {0, 1, 2}, 0.15, {false}},
    {"pyramids", 3, PYRAMIDS, {3, 4, 2}, {0, 1, 2}, 0.15, {false}},
    {"mixed", 3, MIXED, {6, 3, 3}, {0, 1, 2}, 0.1, {false}},
};
enum { RECIPES = sizeof recipes / sizeof *recipes };
static const double slope[3] = {2, -3, 0.7};

struct fixture {
    const struct cells_recipe *r;
    struct polymesh *m;
    struct vicinity *v;
    double *face, *area, *centre, *volume, *value;
    int dim, axis[3];
};

static struct fixture begin(const struct cells_recipe *r) {
    struct fixture x = {.r = r, .m = cells_make(r)};
    x.face = malloc((size_t)x.m->nfaces * 24), x.area = malloc((size_t)x.m->nfaces * 24);
    x.centre = malloc((size_t)x.m->ncells * 24), x.volume = malloc((size_t)x.m->ncells * 8);
    x.value = calloc((size_t)x.m->ncells, sizeof *x.value);
    polymesh_face_geometry(x.m, x.face, x.area);
    ok(polymesh_cell_geometry(x.m, x.face, x.area, x.centre, x.volume));
    x.dim = polymesh_axes(x.m, x.axis);
    ok(vicinity_make(x.m, x.centre, x.dim, x.axis, &x.v));
    return x;
}

static void end(struct fixture *x) {
    vicinity_free(x->v);
    polymesh_free(x->m);
    free(x->face), free(x->area), free(x->centre), free(x->volume), free(x->value);
}

static double line_at(const struct fixture *x, const double *at) {
    double sum = 0.3;
    for (int k = 0; k < x->dim; k++) sum += slope[x->axis[k]] * at[x->axis[k]];
    return sum;
}

static void near(const struct fixture *x, const char *what, long at, double found, double wanted) {
    if (!(fabs(found - wanted) <= 1e-11)) fail_msg("%s: %s %ld: %.17g, not %.17g", x->r->name, what, at, found, wanted);
}

static void lines_are_exact(void **state) {
    (void)state;
    for (int i = 0; i < RECIPES; i++) {
        struct fixture x = begin(&recipes[i]);
        struct vicinity_field kept, f = {x.v, x.value, 1, NULL, NULL};
        for (int c = 0; c < x.m->ncells; c++) x.value[c] = line_at(&x, x.centre + 3L * c);
        ok(vicinity_field_make(x.v, x.value, 1, &kept));
        for (int c = 0; c < x.m->ncells; c++) {
            double g[3], wanted[3] = {0};
            vicinity_gradient(&f, c, g);
            for (int k = 0; k < x.dim; k++) wanted[x.axis[k]] = slope[x.axis[k]];
            for (int k = 0; k < 3; k++) near(&x, "gradient", c, g[k], wanted[k]);
        }
        for (int p = 0; p < x.m->npoints; p++) {
            near(&x, "point", p, vicinity_at_point(&f, p), line_at(&x, x.m->points + 3L * p));
            for (int again = 0; again < 2; again++)
                assert_true(vicinity_at_point(&kept, p) == vicinity_at_point(&f, p));
        }
        vicinity_field_free(&kept);
        end(&x);
    }
}

/* At places between the centre of a cell and its points and faces' centres: inside the simplices for flat faces. */
static void check_place(const struct fixture *x, int cell, const double *to, double share) {
    const struct vicinity_field f = {x->v, x->value, 1, NULL, NULL};
    double at[3], weight[4], found = 0, all = 0, least = 1;
    long node[4];
    bool *wanted = calloc((size_t)x->m->ncells, sizeof *wanted);
    for (int k = 0; k < 3; k++) at[k] = x->centre[3L * cell + k] + share * (to[k] - x->centre[3L * cell + k]);
    const int n = vicinity_locate(x->v, cell, at, node, weight);
    assert_int_equal(n, x->dim + 1);
    for (int k = 0; k < n; k++) {
        found += weight[k] * vicinity_at_node(&f, node[k]);
        all += weight[k];
        least = fmin(least, weight[k]);
        vicinity_mark_node(x->v, node[k], wanted);
    }
    near(x, "place in cell", cell, found, line_at(x, at));
    near(x, "weights", cell, all, 1);
    assert_true(least > -1e-9);
    struct vicinity_field few = f; /* values of cells that were not marked do not count */
    double *some = malloc((size_t)x->m->ncells * sizeof *some);
    for (int c = 0; c < x->m->ncells; c++) some[c] = wanted[c] ? x->value[c] : NAN;
    few.value = some;
    for (int k = 0; k < n; k++) assert_true(vicinity_at_node(&few, node[k]) == vicinity_at_node(&f, node[k]));
    free(some);
    free(wanted);
}

static void places_are_exact(void **state) {
    (void)state;
    for (int i = 0; i < RECIPES; i++) {
        struct fixture x = begin(&recipes[i]);
        for (int c = 0; c < x.m->ncells; c++) x.value[c] = line_at(&x, x.centre + 3L * c);
        for (int f = 0; f < x.m->nfaces; f++) {
            const double *p = x.m->points + 3L * x.m->face_points[x.m->face_start[f]];
            check_place(&x, x.m->owner[f], p, 0.999);
            check_place(&x, x.m->owner[f], p, 0.5);
            check_place(&x, x.m->owner[f], x.face + 3L * f, 0.8);
        }
        end(&x);
    }
}

/* A jump makes no new extremes at points that cells surround. */
static void jumps_stay_in_range(void **state) {
    (void)state;
    struct fixture x = begin(&recipes[7]);
    const struct vicinity_field f = {x.v, x.value, 1, NULL, NULL};
    int inside = 0;
    for (int c = 0; c < x.m->ncells; c++) x.value[c] = x.centre[3L * c] > 0.2 ? 1 : 1e-6;
    for (int p = 0; p < x.m->npoints; p++) {
        if (x.v->border[p]) continue;
        inside++;
        assert_true(vicinity_at_point(&f, p) >= 1e-6 && vicinity_at_point(&f, p) <= 1);
    }
    assert_true(inside > 20);
    end(&x);
}

/* ---- surfaces ---- */

static double area_of(const struct slice *s, int polygon, double normal[3]) {
    const int *p = s->around + s->start[polygon], n = s->start[polygon + 1] - s->start[polygon];
    normal[0] = normal[1] = normal[2] = 0;
    for (int i = 0; i < n; i++)
        for (int k = 0; k < 3; k++) {
            const double *a = s->x[p[i]], *b = s->x[p[(i + 1) % n]], *o = s->x[p[0]];
            const int l = (k + 1) % 3, m = (k + 2) % 3;
            normal[k] += 0.5 * ((a[l] - o[l]) * (b[m] - o[m]) - (a[m] - o[m]) * (b[l] - o[l]));
        }
    return sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
}

/* Counts the edges that no polygon goes along the other way; all others must be gone along once each way. */
static int open_edges(const struct slice *s) {
    int lone = 0;
    for (int p = 0; p < s->npolygons; p++)
        for (int i = s->start[p]; i < s->start[p + 1]; i++) {
            const int a = s->around[i], b = s->around[i + 1 < s->start[p + 1] ? i + 1 : s->start[p]];
            int back = 0, again = 0;
            for (int q = 0; q < s->npolygons; q++)
                for (int j = s->start[q]; j < s->start[q + 1]; j++) {
                    const int c = s->around[j], d = s->around[j + 1 < s->start[q + 1] ? j + 1 : s->start[q]];
                    back += c == b && d == a;
                    again += c == a && d == b;
                }
            assert_int_equal(again, 1);
            assert_true(back <= 1);
            lone += !back;
        }
    return lone;
}

/* A linear field's level set is a plane, as large as what the plane cuts out, with normals to lower values. */
static void planes_and_levels_agree(void **state) {
    (void)state;
    for (int i = 0; i < RECIPES; i++) {
        struct fixture x = begin(&recipes[i]);
        struct slice plane = {0}, level = {0};
        const struct vicinity_field f = {x.v, x.value, 1, NULL, NULL};
        double middle[3] = {0}, down[3] = {0}, area[2] = {0}, n[3];
        for (int p = 0; p < x.m->npoints; p++)
            for (int k = 0; k < 3; k++) middle[k] += x.m->points[3L * p + k] / x.m->npoints;
        for (int k = 0; k < x.dim; k++) down[x.axis[k]] = -slope[x.axis[k]];
        for (int c = 0; c < x.m->ncells; c++) x.value[c] = line_at(&x, x.centre + 3L * c);
        ok(slice_plane(x.v, middle, down, &plane));
        ok(slice_level(&f, line_at(&x, middle), &level));
        for (int p = 0; p < plane.npolygons; p++) {
            area[0] += area_of(&plane, p, n);
            assert_true(n[0] * down[0] + n[1] * down[1] + n[2] * down[2] > 0);
        }
        for (int p = 0; p < level.npolygons; p++) {
            const double size = area_of(&level, p, n);
            area[1] += size;
            assert_true(size < 1e-12 || n[0] * down[0] + n[1] * down[1] + n[2] * down[2] > 0);
        }
        for (int c = 0; c < plane.ncorners; c++)
            near(&x, "corner of a plane", c, slice_value(&f, &plane.corner[c]), line_at(&x, plane.x[c]));
        for (int c = 0; c < level.ncorners; c++) {
            near(&x, "corner of a level set", c, slice_value(&f, &level.corner[c]), line_at(&x, middle));
            near(&x, "place of a corner", c, line_at(&x, level.x[c]), line_at(&x, middle));
        }
        assert_true(area[0] > 0.001);
        if (fabs(area[1] / area[0] - 1) > 1e-9) fail_msg("%s: areas %.17g and %.17g", x.r->name, area[0], area[1]);
        slice_free(&plane);
        slice_free(&level);
        end(&x);
    }
}

/* The sphere inside a box of cells: its area's error falls as the square of the cells' size; no edge is open. */
static void spheres_close(void **state) {
    (void)state;
    static const enum cell_shape shapes[] = {BOXES, TETS, PYRAMIDS};
    const double radius = 0.3;
    for (int i = 0; i < 3; i++) {
        double error[3];
        for (int fine = 0; fine < 3; fine++) {
            const int n = (int[]){6, 10, 20}[fine];
            const struct cells_recipe r = {"sphere", 3, shapes[i], {n, n, n}, {0, 1, 2}, 0.1, {false}};
            struct fixture x = begin(&r);
            struct slice s = {0};
            struct vicinity_field f;
            double high[3] = {0}, area = 0, normal[3];
            for (int p = 0; p < 3 * x.m->npoints; p++) high[p % 3] = fmax(high[p % 3], x.m->points[p]);
            for (int p = 0; p < 3 * x.m->npoints; p++) x.m->points[p] /= high[p % 3]; /* a unit cube */
            for (int c = 0; c < 3 * x.m->ncells; c++) x.centre[c] /= high[c % 3];
            for (int c = 0; c < x.m->ncells; c++) {
                const double *at = x.centre + 3L * c;
                x.value[c] = pow(at[0] - 0.51, 2) + pow(at[1] - 0.48, 2) + pow(at[2] - 0.5, 2);
            }
            ok(vicinity_field_make(x.v, x.value, 1, &f));
            ok(slice_level(&f, radius * radius, &s));
            for (int p = 0; p < s.npolygons; p++) area += area_of(&s, p, normal);
            error[fine] = fabs(area / (4 * acos(-1) * radius * radius) - 1);
            if (!fine) assert_int_equal(open_edges(&s), 0);
            vicinity_field_free(&f);
            slice_free(&s);
            end(&x);
        }
        if (!(error[1] < 0.75 * 0.01 / (radius * radius) && error[2] < 0.3 * error[1])) /* of r^2: 3/4 of h^2 at most */
            fail_msg("shape %d: %g, then %g", (int)shapes[i], error[1], error[2]);
    }
}

/* Levels that are values of nodes: surfaces through points, along faces, and along none are closed or empty. */
static void levels_at_nodes(void **state) {
    (void)state;
    const struct cells_recipe r = {"cubes", 3, BOXES, {4, 4, 4}, {0, 1, 2}, 0, {false}};
    struct fixture x = begin(&r);
    const struct vicinity_field f = {x.v, x.value, 1, NULL, NULL};
    struct slice s = {0};
    for (int c = 0; c < x.m->ncells; c++) {
        int at[3] = {0};
        for (int k = 0; k < 3; k++) at[k] = (int)floor(x.centre[3L * c + k] / (0.1 * (k + 1)));
        x.value[c] = at[0] % 3 && at[1] % 3 && at[2] % 3 ? 1 : 0; /* 1 in the eight cells in the middle */
    }
    for (int i = 0; i < 5; i++) {
        ok(slice_level(&f, (double[]){1, 0.5, 0.125, 0.25, 2}[i], &s));
        assert_int_equal(open_edges(&s), 0);
        assert_true(i == 4 ? !s.npolygons : i == 0 || s.npolygons > 0);
        slice_free(&s);
    }
    end(&x);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lines_are_exact),     cmocka_unit_test(places_are_exact),
        cmocka_unit_test(jumps_stay_in_range), cmocka_unit_test(planes_and_levels_agree),
        cmocka_unit_test(spheres_close),       cmocka_unit_test(levels_at_nodes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
