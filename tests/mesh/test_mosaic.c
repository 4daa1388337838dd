/* Geometry and stencils of a mosaic against exact values and against their definitions, on one rank. */
#include "mesh/mosaic.h"

#include "tests/mesh/cells.h"

static struct comm *world;

static const struct cells_recipe recipes[] = {
    {"line", 1, BOXES, {13, 1, 1}, {0, 1, 2}, 0.3, {false}},
    {"periodic line along z", 1, BOXES, {9, 1, 1}, {2, 0, 1}, 0.3, {true}},
    {"two periodic cells", 1, BOXES, {2, 1, 1}, {0, 1, 2}, 0.3, {true}},
    {"one periodic cell", 1, BOXES, {1, 1, 1}, {0, 1, 2}, 0, {true}},
    {"quads", 2, BOXES, {7, 6, 1}, {0, 1, 2}, 0.2, {false}},
    {"quads in x and z, periodic in x", 2, BOXES, {7, 6, 1}, {0, 2, 1}, 0.2, {true, false}},
    {"triangles", 2, PRISMS, {7, 6, 1}, {0, 1, 2}, 0.2, {false}},
    {"triangles, two boxes wide, periodic", 2, PRISMS, {8, 2, 1}, {1, 2, 0}, 0.2, {true, true}},
    {"warped hexahedra", 3, BOXES, {5, 4, 4}, {0, 1, 2}, 0.2, {false}},
    {"hexahedra, two wide, periodic", 3, BOXES, {2, 4, 3}, {0, 1, 2}, 0.2, {true, false, true}},
    {"prisms", 3, PRISMS, {4, 3, 3}, {0, 1, 2}, 0.2, {false}},
    {"tetrahedra", 3, TETS, {4, 3, 3}, {0, 1, 2}, 0.15, {false}},
    {"periodic tetrahedra", 3, TETS, {3, 3, 3}, {0, 1, 2}, 0.15, {true, true, true}},
};
enum { RECIPES = sizeof recipes / sizeof *recipes };

struct fixture {
    const struct cells_recipe *r;
    struct polymesh *mesh;
    struct mosaic *m;
};

static struct fixture begin(int recipe, int rings) {
    struct fixture x = {&recipes[recipe], cells_make(&recipes[recipe]), NULL};
    ok(mosaic_make(x.mesh, world, rings, &x.m));
    return x;
}

static void end(struct fixture *x) {
    mosaic_free(x->m);
    polymesh_free(x->mesh);
}

static void near(const struct fixture *x, const char *what, int at, double found, double wanted, double scale) {
    if (!(fabs(found - wanted) <= 2e-14 * scale))
        fail_msg("%s: %s %d: %.17g, not %.17g", x->r->name, what, at, found, wanted);
}

static double extent(const struct fixture *x, int k) { /* of the box along computational axis k */
    for (int a = 0; a < 3; a++)
        if (x->r->axis[a] == x->m->axis[k]) return 0.1 * (a + 1) * x->r->n[a];
    return 0;
}

static void axes_and_sizes(void **state) {
    (void)state;
    for (int i = 0; i < RECIPES; i++) {
        struct fixture x = begin(i, 2);
        const struct mosaic *m = x.m;
        double box = 1, thickness = 1, sum = 0;
        assert_int_equal(m->dim, x.r->dim);
        for (int k = 0; k < 3; k++) *(k < m->dim ? &box : &thickness) *= extent(&x, k);
        for (int k = 1; k < m->dim; k++) assert_true(m->axis[k] > m->axis[k - 1]);
        assert_int_equal(m->ncells_all, x.mesh->ncells);
        assert_true(m->nown == m->ncells_all && m->ninner == m->nown && m->nnear == m->nown && m->ncells == m->nown);
        assert_int_equal(m->face.nlocal, m->face.ninternal);
        for (int c = 0; c < m->nown; c++) sum += m->volume[c];
        near(&x, "volume", 0, sum, box, box);
        near(&x, "thickness", 0, m->thickness, thickness, thickness);
        end(&x);
    }
}

static void cells_are_closed(void **state) {
    (void)state;
    for (int i = 0; i < RECIPES; i++) {
        struct fixture x = begin(i, 1);
        const struct mosaic *m = x.m;
        for (int c = 0; c < m->nown; c++) {
            double sum[3] = {0}, all = 0;
            for (int k = m->face_start[c]; k < m->face_start[c + 1]; k++) {
                int f = m->face_of_cell[k], face = f < 0 ? ~f : f;
                assert_int_equal(f < 0 ? m->face.right[face] : m->face.left[face], c);
                all += m->face.area[face];
                for (int a = 0; a < m->dim; a++)
                    sum[a] += (f < 0 ? -1 : 1) * m->face.area[face] * m->face.normal[a][face];
            }
            for (int a = 0; a < m->dim; a++) near(&x, "gap of cell", c, sum[a], 0, all);
        }
        end(&x);
    }
}

/* Volume and centroid once more, by the divergence theorem from the points of the faces: their integrands x and x_a x
 * are of degree 2 at most, which the points integrate exactly. */
static void centres_are_centroids(void **state) {
    (void)state;
    for (int i = 0; i < RECIPES; i++) {
        struct fixture x = begin(i, 2);
        const struct mosaic *m = x.m;
        bool warped = x.r->shape != TETS && m->dim == 3; /* a bilinear patch is not the triangles of the cell */
        for (int c = 0; c < m->nown && !warped; c++) {
            double volume = 0, first[3] = {0}, size = pow(m->volume[c], 1.0 / m->dim);
            for (int k = m->face_start[c]; k < m->face_start[c + 1]; k++) {
                int f = m->face_of_cell[k], side = f < 0, face = side ? ~f : f;
                for (int p = m->face.point_start[face]; p < m->face.point_start[face + 1]; p++) {
                    double out = 0, w = (side ? -1 : 1) * m->face.area[face] * m->point.weight[p];
                    assert_int_equal(m->point.face[p], face);
                    for (int a = 0; a < m->dim; a++) out += w * m->point.arm[side][a][p] * m->face.normal[a][face];
                    volume += out / m->dim;
                    for (int a = 0; a < m->dim; a++) first[a] += out * m->point.arm[side][a][p] / (m->dim + 1);
                }
            }
            near(&x, "volume of cell", c, volume, m->volume[c], 10 * m->volume[c]);
            for (int a = 0; a < m->dim; a++) near(&x, "centroid of cell", c, first[a], 0, 10 * m->volume[c] * size);
        }
        end(&x);
    }
}

/* Of simplices: mean (x-c)_a (x-c)_b = sum_i (v_i - c)_a (v_i - c)_b / ((d + 1) (d + 2)). */
static void moments_of_simplices(void **state) {
    (void)state;
    for (int i = 0; i < RECIPES; i++) {
        if (!(recipes[i].dim == 1 || recipes[i].shape == TETS || (recipes[i].dim == 2 && recipes[i].shape == PRISMS)))
            continue;
        struct fixture x = begin(i, 1);
        const struct mosaic *m = x.m;
        const int d = m->dim, ncells = x.mesh->ncells;
        int *point = calloc((size_t)ncells * 8, sizeof *point), *count = calloc((size_t)ncells, sizeof *count);
        for (int f = 0; f < x.mesh->nfaces; f++)
            for (int side = 0; side < (f < x.mesh->ninternal ? 2 : 1); side++)
                for (int k = x.mesh->face_start[f]; k < x.mesh->face_start[f + 1]; k++) {
                    int c = side ? x.mesh->neighbour[f] : x.mesh->owner[f], p = x.mesh->face_points[k], j = 0;
                    for (int a = d; a < 3; a++)
                        if (x.mesh->points[3 * p + m->axis[a]] > 1e-9) j = 99;
                    while (j < count[c] && point[8 * c + j] != p) j++;
                    if (j == count[c]) point[8 * c + count[c]++] = p;
                }
        for (int c = 0; c < ncells; c++) {
            int at = m->cell[c], k = 0;
            assert_int_equal(count[at], d + 1);
            for (int a = 0; a < d; a++)
                for (int b = a; b < d; b++, k++) {
                    double wanted = 0, centre[3] = {0};
                    for (int v = 0; v <= d; v++)
                        for (int e = 0; e < d; e++)
                            centre[e] += x.mesh->points[3 * point[8 * at + v] + m->axis[e]] / (d + 1);
                    for (int v = 0; v <= d; v++)
                        wanted += (x.mesh->points[3 * point[8 * at + v] + m->axis[a]] - centre[a]) *
                                  (x.mesh->points[3 * point[8 * at + v] + m->axis[b]] - centre[b]);
                    near(&x, "moment of cell", c, m->moment[k][c], wanted / ((d + 1) * (d + 2)), 0.1);
                    near(&x, "centre of cell", c, m->centre[a][c], centre[a], 1);
                }
        }
        free(point);
        free(count);
        end(&x);
    }
}

/* Moments of all cells add up to those of the box, warped or not. */
static void moments_add_up(void **state) {
    (void)state;
    for (int i = 0; i < RECIPES; i++) {
        struct fixture x = begin(i, 1);
        const struct mosaic *m = x.m;
        for (int a = 0, k = 0; a < m->dim; a++)
            for (int b = a; b < m->dim; b++, k++) {
                double sum = 0, box = 1;
                for (int c = 0; c < m->nown; c++)
                    sum += m->volume[c] * (m->moment[k][c] + m->centre[a][c] * m->centre[b][c]);
                for (int e = 0; e < m->dim; e++) box *= extent(&x, e);
                double wanted = box * extent(&x, a) * extent(&x, b) / (a == b ? 3 : 4);
                near(&x, "sum of moments", k, sum, wanted, 10 * wanted);
            }
        end(&x);
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return status_print(s, true);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(axes_and_sizes),        cmocka_unit_test(cells_are_closed),
        cmocka_unit_test(centres_are_centroids), cmocka_unit_test(moments_of_simplices),
        cmocka_unit_test(moments_add_up),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
