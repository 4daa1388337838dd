/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mesh/grid/search.h"
#include "tests/mesh/meshes.h"

struct fixture {
    struct polymesh *m;
    struct search *s;
    double *face, *area, *centre, *volume;
    int dim, axis[3];
};

static void begin(struct fixture *x, const struct recipe *r) {
    ok(mesh_make(r, &x->m));
    ok(polymesh_check(x->m));
    x->face = malloc((size_t)x->m->nfaces * 24), x->area = malloc((size_t)x->m->nfaces * 24);
    x->centre = malloc((size_t)x->m->ncells * 24), x->volume = malloc((size_t)x->m->ncells * 8);
    polymesh_face_geometry(x->m, x->face, x->area);
    ok(polymesh_cell_geometry(x->m, x->face, x->area, x->centre, x->volume));
    x->dim = polymesh_axes(x->m, x->axis);
    ok(search_make(x->m, x->centre, x->dim, x->axis, &x->s));
}

static void end(struct fixture *x) {
    search_free(x->s);
    polymesh_free(x->m);
    free(x->face), free(x->area), free(x->centre), free(x->volume);
}

/* Lowest cell that has the point among its corners; -1: none. */
static int lowest_at(const struct polymesh *m, int point) {
    int lowest = -1;
    for (int f = 0; f < m->nfaces; f++)
        for (int i = m->face_start[f]; i < m->face_start[f + 1]; i++)
            if (m->face_points[i] == point && (lowest < 0 || m->owner[f] < lowest)) lowest = m->owner[f];
    return lowest;
}

/* Centres belong to their cells, what cells share to the lowest of them, whatever the axes that do not count say. */
static void check_places(const struct fixture *x, bool flat) {
    const struct polymesh *m = x->m;
    for (int c = 0; c < m->ncells; c++) assert_int_equal(search_cell(x->s, x->centre + 3L * c), c);
    for (int c = 0; c < m->ncells; c++) {
        double p[3] = {1e30, 1e30, 1e30};
        for (int k = 0; k < x->dim; k++) p[x->axis[k]] = x->centre[3L * c + x->axis[k]];
        assert_int_equal(search_cell(x->s, p), c);
    }
    for (int f = 0; flat && f < m->nfaces; f++) assert_int_equal(search_cell(x->s, x->face + 3L * f), m->owner[f]);
    for (int p = 0; p < m->npoints; p++) {
        int wanted = lowest_at(m, p);
        if (wanted >= 0) assert_int_equal(search_cell(x->s, m->points + 3L * p), wanted);
    }
}

static double noise(unsigned *seed) {
    *seed = *seed * 1664525u + 1013904223u;
    return (double)(*seed >> 8) / 16777216;
}

static void boxes_in_every_dimension(void **state) {
    (void)state;
    for (int gone = 0; gone < 7; gone++) {
        struct recipe r = {.n = {7, 5, 6}, .origin = {-1, 0.3, 2}, .width = {0.1, 0.02, 0.3}, .hole = step_hole};
        for (int k = 0; k < 3; k++)
            if (gone >> k & 1) {
                r.type[2 * k] = r.type[2 * k + 1] = "empty";
                r.n[k] = 1;
            }
        if (gone & 3) r.hole = NULL; /* it needs x and y */
        struct fixture x;
        begin(&x, &r);
        assert_int_equal(x.dim, 3 - __builtin_popcount((unsigned)gone));
        for (int k = 1; k < x.dim; k++) assert_true(x.axis[k] > x.axis[k - 1]);
        check_places(&x, true);
        for (int k = 0; k < x.dim; k++)
            for (int side = -1; side <= 1; side += 2) {
                double p[3] = {-1 + 0.05, 0.3 + 0.09, 2 + 0.15};
                p[x.axis[k]] = r.origin[x.axis[k]] + r.width[x.axis[k]] * (side > 0 ? r.n[x.axis[k]] + 1e-4 : -1e-4);
                assert_int_equal(search_cell(x.s, p), -1);
                p[x.axis[k]] = side * 1e300;
                assert_int_equal(search_cell(x.s, p), -1);
                p[x.axis[k]] = NAN;
                assert_int_equal(search_cell(x.s, p), -1);
            }
        if (r.hole) assert_int_equal(search_cell(x.s, (double[]){-1 + 0.35, 0.3 + 0.03, 2.1}), -1);
        end(&x);
    }
}

/* Warped faces: no point inside is lost, and the shares of random points are those of the volumes. */
static void warped_cells_leave_no_gaps(void **state) {
    (void)state;
    const struct recipe r = {.n = {6, 5, 4}, .width = {0.1, 0.2, 0.3}, .noise = 0.12};
    enum { POINTS = 120000 };
    struct fixture x;
    begin(&x, &r);
    check_places(&x, false);
    unsigned seed = 7;
    int *count = calloc((size_t)x.m->ncells, sizeof *count), found = 0, inner = 0, at;
    double box = 1, volume = 0;
    for (int k = 0; k < 3; k++) box *= (r.n[k] + 2) * r.width[k];
    for (int i = 0; i < POINTS; i++) {
        double p[3];
        bool inside = true;
        for (int k = 0; k < 3; k++) {
            double u = noise(&seed) * (r.n[k] + 2) - 1; /* in cells */
            p[k] = u * r.width[k];
            inside = inside && u > 0.13 && u < r.n[k] - 0.13;
        }
        at = search_cell(x.s, p);
        inner += inside;
        assert_true(at >= 0 || !inside);
        if (at < 0) continue;
        found++;
        count[at]++;
    }
    assert_true(inner > POINTS / 5);
    for (int c = 0; c < x.m->ncells; c++) {
        double expected = POINTS * x.volume[c] / box;
        assert_true(fabs(count[c] - expected) < 5 * sqrt(expected));
        volume += x.volume[c];
    }
    assert_true(fabs(found - POINTS * volume / box) < 5 * sqrt(POINTS));
    free(count);
    end(&x);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_in_every_dimension),
        cmocka_unit_test(warped_cells_leave_no_gaps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
