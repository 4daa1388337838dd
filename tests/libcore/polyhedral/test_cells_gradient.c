/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gradients of cells on meshes that are as skewed as meshes get: exact for linear fields, and bounded. */
#include "libcore/polyhedral/cells_gradient.h"

#include "tests/libcore/gas/viscous.h" /* last: cmocka.h defines fail() */

static struct comm *world;

static void open_gas(struct scene *s, struct polymesh *mesh, int dim) {
    *s = (struct scene){.dim = dim, .mesh = mesh, .models = disks_models(&CONSTANT, "RKL2")};
    set_walls(s, "slip");
    open_mesh(s, world);
}

struct lines { /* a field on cells and mirrors, and its gradient in the cells */
    double *q, *gradient[MAX_DIM];
};

static struct lines lines_of(const struct polyhedra *m) {
    struct lines l;
    l.q = calloc((size_t)m->size + LANES, sizeof *l.q);
    for (int k = 0; k < MAX_DIM; k++) l.gradient[k] = calloc((size_t)m->size + LANES, sizeof *l.q);
    return l;
}

static void lines_free(struct lines *l) {
    free(l->q);
    for (int k = 0; k < MAX_DIM; k++) free(l->gradient[k]);
}

/* How far the gradients of a linear field are from its own, in all cells. */
static double linear_error(const struct polyhedra *m, const struct entries *r) {
    static const double slope[3] = {1.3, -0.7, 2.1};
    struct lines l = lines_of(m);
    double most = 0;
    for (int i = 0; i < m->size; i++)
        for (int k = 0; k < m->dim; k++) l.q[i] += slope[k] * m->centre[k][i];
    cells_gradients(m->dim, r, 1, 0, m->nown, &l.q, l.gradient);
    for (int i = 0; i < m->nown; i++)
        for (int k = 0; k < m->dim; k++) most = larger(most, fabs(l.gradient[k][i] - slope[k]));
    lines_free(&l);
    return most;
}

/* The largest component of the gradient in a cell of any field between -1 and 1, which is -1 or 1 in all cells. */
static double largest(const struct polyhedra *m, const struct entries *r, int cell) {
    struct lines l = lines_of(m);
    double sum[MAX_DIM] = {0}, most = 0;
    for (int i = 0; i < m->size; i++) { /* what a cell adds is linear in its value */
        l.q[i] = 1;
        cells_gradients(m->dim, r, 1, cell, cell + 1, &l.q, l.gradient);
        l.q[i] = 0;
        for (int k = 0; k < m->dim; k++) sum[k] += fabs(l.gradient[k][cell]);
    }
    for (int k = 0; k < m->dim; k++) most = larger(most, sum[k]);
    lines_free(&l);
    return most;
}

static void linear_fields_are_exact(void **state) {
    (void)state;
    static const struct cells_recipe rough[] = {
        {"line", 1, BOXES, {9, 1, 1}, {0, 1, 2}, 0.4, {false, false, false}},
        {"quads", 2, BOXES, {10, 10, 1}, {0, 1, 2}, 0.4, {false, false, false}},
        {"triangles", 2, PRISMS, {10, 10, 1}, {0, 1, 2}, 0.4, {false, false, false}},
        {"hexahedra", 3, BOXES, {5, 5, 5}, {0, 1, 2}, 0.3, {false, false, false}},
        {"tetrahedra", 3, TETS, {5, 5, 5}, {0, 1, 2}, 0.3, {false, false, false}},
        {"pyramids", 3, PYRAMIDS, {4, 4, 4}, {0, 1, 2}, 0.3, {false, false, false}},
    };
    for (int b = 0; b < (int)(sizeof rough / sizeof *rough); b++) {
        struct scene s;
        struct entries r = {0};
        open_gas(&s, cells_make(&rough[b]), rough[b].dim);
        ok(cells_gradient_weights(s.gas, &r));
        assert_near(linear_error(s.gas->cells->polyhedra, &r), 0, 1e-12);
        entries_free(&r);
        close_scene(&s);
    }
}

/* A triangle (0, 0), (1, 0), (0, 1) and one on each of its sides, as prisms. The tips of those at its legs lie further
 * along these the more `twist` there is, so that the lines of centres pass the sides far from their middles. */
static struct polymesh *twisted_mesh(double twist) {
    static const struct cells_recipe r = {"twisted", 2, PRISMS, {1, 1, 1}, {0, 1, 2}, 0, {false, false, false}};
    static const int triangle[4][3] = {{0, 1, 2}, {1, 0, 3}, {2, 1, 4}, {0, 2, 5}};
    const double point[6][2] = {{0, 0}, {1, 0}, {0, 1}, {0.5 + twist, -0.3}, {0.8, 0.8}, {-0.3, 0.5 + twist}};
    struct polymesh *m = calloc(1, sizeof *m);
    struct soup s = {.r = &r, .m = m, .face = calloc(20, sizeof *s.face)};
    int *patch = calloc(20, sizeof *patch);
    m->points = calloc(36, sizeof *m->points);
    m->face_start = calloc(21, sizeof *m->face_start);
    m->face_points = calloc(80, sizeof *m->face_points);
    m->owner = calloc(20, sizeof *m->owner);
    m->neighbour = calloc(20, sizeof *m->neighbour);
    for (; m->npoints < 12; m->npoints++) {
        for (int k = 0; k < 2; k++) m->points[3 * m->npoints + k] = point[m->npoints % 6][k];
        m->points[3 * m->npoints + 2] = m->npoints < 6 ? 0 : 0.3; /* 0.3: the recipe's */
    }
    for (; m->ncells < 4; m->ncells++) {
        const int *p = triangle[m->ncells];
        soup_add(&s, m->ncells, 3, (int[]){p[0], p[2], p[1]});
        soup_add(&s, m->ncells, 3, (int[]){p[0] + 6, p[1] + 6, p[2] + 6});
        for (int i = 0; i < 3; i++) {
            const int a = p[i], b = p[(i + 1) % 3];
            soup_add(&s, m->ncells, 4, (int[]){a, b, b + 6, a + 6});
        }
    }
    soup_join(&s, patch);
    for (int f = 0; f < m->nfaces; f++)
        if (m->neighbour[f] < 0 && patch[f] < 4) patch[f] = 0;
    soup_patches(&s);
    ok(polymesh_order(m, patch));
    ok(polymesh_check(m));
    free(patch);
    free(s.face);
    return m;
}

/* The cell of the first triangle; the others have two walls. */
static int middle_of(const struct polyhedra *m) {
    for (int i = 0; i < m->nown; i++) {
        int walls = 0;
        for (int j = m->face_start[i]; j < m->face_start[i + 1]; j++) {
            const int face = m->face_of_cell[j] < 0 ? ~m->face_of_cell[j] : m->face_of_cell[j];
            walls += face >= m->face.ninternal;
        }
        if (walls == 0) return i;
    }
    fail_msg("no cell without walls");
    return -1;
}

/* On the way from a mild mesh to a twisted one Gauss's theorem finds less and less of the gradient of a linear field,
 * at last none. What divides by that would make any noise grow without bound: where the determinant is below 0.2 least
 * squares take its place, so that gradients of noise are less than 1/0.2 of those on the mild mesh. */
static void twisted_cells_have_bounded_gradients(void **state) {
    (void)state;
    double mild = 0, most = 0;
    for (int i = 0; i <= 400; i++) {
        struct scene s;
        struct entries r = {0};
        open_gas(&s, twisted_mesh(0.01 * i), 2);
        const struct polyhedra *m = s.gas->cells->polyhedra;
        ok(cells_gradient_weights(s.gas, &r));
        assert_near(linear_error(m, &r), 0, 1e-12);
        const double now = largest(m, &r, middle_of(m));
        if (i == 0) mild = now;
        most = larger(most, now);
        entries_free(&r);
        close_scene(&s);
    }
    print_message("largest gradients: %.3g on the mild mesh, %.3g at most\n", mild, most);
    assert_true(mild > 0 && most < mild / 0.2);
    assert_true(most > 2 * mild); /* there are twisted meshes among these */
}

int main(int argc, char **argv) {
    ok(comm_start(&argc, &argv, &world));
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_fields_are_exact),
        cmocka_unit_test(twisted_cells_have_bounded_gradients),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
