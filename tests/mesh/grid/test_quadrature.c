/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Means over cells: second moments are the polyhedra's, integrals of quartics over a box of any cells are exact. */
#include "mesh/grid/quadrature.h"
#include "mesh/polyhedral/polyhedra.h"

#include "tests/mesh/polyhedral/cells.h"

static struct comm *world;

static const struct {
    struct cells_recipe recipe;
    int most; /* points of a cell */
} cases[] = {
    {{"line along z", 1, BOXES, {9, 1, 1}, {2, 0, 1}, 0.3, {false}}, 3},
    {{"quads", 2, BOXES, {7, 6, 1}, {0, 1, 2}, 0.2, {false}}, 24},
    {{"triangles in z and x", 2, PRISMS, {7, 6, 1}, {2, 0, 1}, 0.2, {false}}, 6},
    {{"warped hexahedra", 3, BOXES, {5, 4, 4}, {0, 1, 2}, 0.2, {false}}, 24 * 14},
    {{"prisms", 3, PRISMS, {4, 3, 3}, {0, 1, 2}, 0.2, {false}}, 14 * 14},
    {{"tetrahedra", 3, TETS, {4, 3, 3}, {0, 1, 2}, 0.15, {false}}, 14},
    {{"pyramids", 3, PYRAMIDS, {3, 4, 2}, {0, 1, 2}, 0.15, {false}}, 8 * 14},
};

struct fixture {
    const struct cells_recipe *r;
    struct polymesh *mesh;
    struct polyhedra *m;
    struct quadrature *q;
    double *centre, (*x)[3], *weight, extent[3];
};

static struct fixture begin(int i) {
    struct fixture f = {.r = &cases[i].recipe, .mesh = cells_make(&cases[i].recipe)};
    double *work = calloc(6 * (size_t)f.mesh->nfaces, sizeof *work);
    f.centre = calloc(4 * (size_t)f.mesh->ncells, sizeof *f.centre);
    polymesh_face_geometry(f.mesh, work, work + 3 * f.mesh->nfaces);
    ok(polymesh_cell_geometry(f.mesh, work, work + 3 * f.mesh->nfaces, f.centre, f.centre + 3 * f.mesh->ncells));
    free(work);
    ok(polyhedra_make(f.mesh, world, 1, &f.m));
    ok(quadrature_make(f.mesh, f.centre, f.m->dim, f.m->axis, &f.q));
    f.x = calloc((size_t)f.q->most, sizeof *f.x);
    f.weight = calloc((size_t)f.q->most, sizeof *f.weight);
    for (int k = 0; k < 3; k++) f.extent[f.r->axis[k]] = 0.1 * (k + 1) * f.r->n[k];
    return f;
}

static void end(struct fixture *f) {
    quadrature_free(f->q);
    polyhedra_free(f->m);
    polymesh_free(f->mesh);
    free(f->centre);
    free(f->x);
    free(f->weight);
}

static void near(const char *name, double found, double wanted, double most) {
    if (!(fabs(found - wanted) <= most)) fail_msg("%s: %.17g, not %.17g", name, found, wanted);
}

static void moments(void **state) {
    (void)state;
    for (int i = 0; i < (int)(sizeof cases / sizeof *cases); i++) {
        struct fixture f = begin(i);
        const struct polyhedra *m = f.m;
        int most = 0;
        for (int c = 0; c < m->ncells; c++) {
            int n = quadrature_cell(f.q, m->cell[c], f.x, f.weight);
            double sum = 0, first[3] = {0}, second[6] = {0};
            assert_true(n > 0 && n <= f.q->most);
            most = n > most ? n : most;
            for (int p = 0; p < n; p++) {
                double d[3];
                sum += f.weight[p];
                for (int k = 0; k < 3; k++) /* the empty axes stay in the middle */
                    if (f.extent[k] > 0 && k != m->axis[0] && k != m->axis[1] && m->dim == 2)
                        near(f.r->name, f.x[p][k], f.centre[3 * m->cell[c] + k], 0);
                for (int a = 0; a < m->dim; a++) {
                    d[a] = f.x[p][m->axis[a]] - m->centre[a][c];
                    first[a] += f.weight[p] * d[a];
                }
                for (int a = 0, j = 0; a < m->dim; a++)
                    for (int b = a; b < m->dim; b++) second[j++] += f.weight[p] * d[a] * d[b];
            }
            near(f.r->name, sum, 1, 1e-14);
            for (int a = 0; a < m->dim; a++) near(f.r->name, first[a], 0, 1e-15);
            for (int j = 0; j < m->dim * (m->dim + 1) / 2; j++) near(f.r->name, second[j], m->moment[j][c], 1e-15);
        }
        assert_int_equal(most, cases[i].most);
        end(&f);
    }
}

static double power(double x, int n) {
    return n ? x * power(x, n - 1) : 1;
}

/* A polynomial of degree 4 in all axes together */
static void quartics(void **state) {
    (void)state;
    for (int i = 0; i < (int)(sizeof cases / sizeof *cases); i++) {
        struct fixture f = begin(i);
        for (int a = 0; a <= 4; a++)
            for (int b = 0; a + b <= 4; b++) {
                const int degree[3] = {a, f.m->dim > 1 ? b : 0, f.m->dim > 2 ? 4 - a - b : 0};
                double found = 0, wanted = 1;
                for (int k = 0; k < f.m->dim; k++)
                    wanted *= power(f.extent[f.m->axis[k]], degree[k] + 1) / (degree[k] + 1);
                for (int c = 0; c < f.m->ncells; c++) {
                    int n = quadrature_cell(f.q, f.m->cell[c], f.x, f.weight);
                    for (int p = 0; p < n; p++) {
                        double value = f.m->volume[c] * f.weight[p];
                        for (int k = 0; k < f.m->dim; k++) value *= power(f.x[p][f.m->axis[k]], degree[k]);
                        found += value;
                    }
                }
                if (!(fabs(found - wanted) <= 1e-13 * wanted))
                    fail_msg("%s: x^%d y^%d z^%d: %.17g, not %.17g", f.r->name, degree[0], degree[1], degree[2], found,
                             wanted);
            }
        end(&f);
    }
}

int main(int argc, char **argv) {
    ok(comm_start(&argc, &argv, &world));
    const struct CMUnitTest tests[] = {cmocka_unit_test(moments), cmocka_unit_test(quartics)};
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
