/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geometry and stencils of polyhedra against exact values and against their definitions, on one rank. */
#include "mesh/polyhedral/polyhedra.h"

#include "tests/mesh/meshes.h"
#include "tests/mesh/polyhedral/cells.h"

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
    {"pyramids", 3, PYRAMIDS, {3, 4, 2}, {0, 1, 2}, 0.15, {false, true, false}},
    {"periodic tetrahedra", 3, TETS, {3, 3, 3}, {0, 1, 2}, 0.15, {true, true, true}},
};
enum { RECIPES = sizeof recipes / sizeof *recipes };

struct fixture {
    const struct cells_recipe *r;
    struct polymesh *mesh;
    struct polyhedra *m;
};

static struct fixture begin(int recipe, int rings) {
    struct fixture x = {&recipes[recipe], cells_make(&recipes[recipe]), NULL};
    ok(polyhedra_make(x.mesh, world, rings, &x.m));
    return x;
}

static void end(struct fixture *x) {
    polyhedra_free(x->m);
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
        const struct polyhedra *m = x.m;
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

/* Local faces stand in the order of their higher cells, on all meshes. */
static void faces_follow_cells(void **state) {
    (void)state;
    for (int i = 0; i < RECIPES; i++) {
        struct fixture x = begin(i, 1);
        for (int f = 0, before = 0; f < x.m->face.nlocal; f++) {
            const int l = x.m->face.left[f], r = x.m->face.right[f], higher = l > r ? l : r;
            assert_true(higher >= before);
            before = higher;
        }
        end(&x);
    }
}

/* Of 40 x 40 cells in three blocks none is further from a neighbour than two fronts hold. */
static void neighbours_stand_near(void **state) {
    (void)state;
    static const struct cells_recipe recipe = {"quads", 2, BOXES, {40, 40, 1}, {0, 1, 2}, 0.2, {false}};
    struct fixture x = {&recipe, cells_make(&recipe), NULL};
    ok(polyhedra_make(x.mesh, world, 1, &x.m));
    assert_true(x.m->nblocks > 1 && x.m->face.nlocal == 2 * 39 * 40);
    for (int f = 0; f < x.m->face.nlocal; f++) assert_true(abs(x.m->face.left[f] - x.m->face.right[f]) <= 2 * 40);
    end(&x);
}

/* The walk through 6 x 20 cells goes row by row from the end of the longer axis. */
static void fronts_are_straight(void **state) {
    (void)state;
    static const struct cells_recipe recipe = {"quads", 2, BOXES, {6, 20, 1}, {0, 1, 2}, 0.2, {false}};
    struct fixture x = {&recipe, cells_make(&recipe), NULL};
    ok(polyhedra_make(x.mesh, world, 1, &x.m));
    assert_int_equal(x.m->nown, 6 * 20);
    for (int i = 0; i < x.m->nown; i++) assert_int_equal((int)(x.m->centre[1][i] / 0.2), 19 - i / 6);
    end(&x);
}

static void cells_are_closed(void **state) {
    (void)state;
    for (int i = 0; i < RECIPES; i++) {
        struct fixture x = begin(i, 1);
        const struct polyhedra *m = x.m;
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
        const struct polyhedra *m = x.m;
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

/* Second moments of a simplex: mean (x-c)_a (x-c)_b = sum_i (v_i - c)_a (v_i - c)_b / ((d + 1) (d + 2)). */
static void moments_of_simplices(void **state) {
    (void)state;
    for (int i = 0; i < RECIPES; i++) {
        if (!(recipes[i].dim == 1 || recipes[i].shape == TETS || (recipes[i].dim == 2 && recipes[i].shape == PRISMS)))
            continue;
        struct fixture x = begin(i, 1);
        const struct polyhedra *m = x.m;
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
        const struct polyhedra *m = x.m;
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

/* ---- faces ------------------------------------------------------------------------------------------------------- */

static double in_frame(const struct polyhedra *m, const double *const *e, const double *const *f, int i, int j, int c) {
    double sum = 0;
    for (int a = 0, k = 0; a < m->dim; a++)
        for (int b = a; b < m->dim; b++, k++) {
            sum += m->moment[k][c] * e[a][i] * f[b][j];
            if (a != b) sum += m->moment[k][c] * e[b][i] * f[a][j];
        }
    return sum;
}

static void frames_and_mirrors(void **state) {
    (void)state;
    for (int i = 0; i < RECIPES; i++) {
        struct fixture x = begin(i, 1);
        const struct polyhedra *m = x.m;
        const struct polyhedra_mirrors *mirror = &m->mirror;
        assert_int_equal(mirror->n, m->face.n - m->face.ninternal);
        assert_int_equal(m->size, m->ncells + mirror->n);
        for (int q = 0; q < mirror->n; q++) {
            const int f = m->face.ninternal + q, c = mirror->cell[q], image = m->ncells + q;
            const struct patch *patch = &x.mesh->patch[mirror->patch[q]];
            assert_true(m->face.left[f] == c && m->face.right[f] == image && m->volume[image] == m->volume[c]);
            assert_in_range(mirror->place[q], 0, patch->nfaces - 1);
            assert_int_equal(x.mesh->owner[patch->start + mirror->place[q]], m->cell[c]);
            assert_true(q == 0 || mirror->patch[q] >= mirror->patch[q - 1]);
            const double *axis[3][3] = {{mirror->normal[0], mirror->normal[1], mirror->normal[2]},
                                        {mirror->tangent[0][0], mirror->tangent[0][1], mirror->tangent[0][2]},
                                        {mirror->tangent[1][0], mirror->tangent[1][1], mirror->tangent[1][2]}};
            double depth = 0, height = 0;
            for (int a = 0; a < m->dim; a++) {
                double centre = 0.5 * (m->centre[a][c] + m->centre[a][image]);
                depth += axis[0][a][q] * (centre - m->centre[a][c]);
                height += axis[0][a][q] * m->point.arm[0][a][m->face.point_start[f]];
            }
            near(&x, "depth of mirror", q, depth, height, 1);
            for (int s = 0; s < m->dim; s++) {
                double along = 0;
                for (int a = 0; a < m->dim; a++) along += axis[s][a][q] * (m->centre[a][image] - m->centre[a][c]);
                near(&x, "direction of mirror", q, along, s ? 0 : 2 * depth, 1);
                for (int t = s; t < m->dim; t++)
                    near(&x, "moment of mirror", q, in_frame(m, axis[s], axis[t], q, q, image),
                         (s == 0 && t > 0 ? -1 : 1) * in_frame(m, axis[s], axis[t], q, q, c), 0.1);
            }
        }
        for (int f = 0; f < m->face.n; f++) {
            double e[3][3] = {{0}};
            for (int a = 0; a < m->dim; a++) {
                e[0][a] = m->face.normal[a][f];
                for (int t = 1; t < m->dim; t++) e[t][a] = m->face.tangent[t - 1][a][f];
            }
            for (int k = m->dim; k < 3; k++) e[k][k] = 1;
            double volume = e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
                            e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
                            e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
            if (m->dim > 1) near(&x, "volume of frame", f, volume, 1, 1);
            for (int s = 0; s < m->dim; s++)
                for (int t = s; t < m->dim; t++)
                    near(&x, "frame", f, e[s][0] * e[t][0] + e[s][1] * e[t][1] + e[s][2] * e[t][2], s == t, 1);
        }
        end(&x);
    }
}

/* One face, points in the order of the polygon, in the plane z = 0: weights and points against the integrals of
 * quadratic monomials by Green's theorem. */
static void points_are_exact_for_quadratics(void **state) {
    (void)state;
    static const struct {
        int n;
        double x[6][2];
    } polygons[] = {{3, {{0, 0}, {2, 0.3}, {0.4, 1}}},
                    {4, {{0, 0}, {2, 0.3}, {1.5, 1.4}, {-0.2, 0.9}}},
                    {5, {{0, 0}, {2, 0.3}, {2.2, 1}, {1.1, 1.7}, {-0.3, 0.8}}},
                    {6, {{0, 0}, {1, -0.1}, {2, 0.3}, {1.8, 1.1}, {1, 1.6}, {-0.2, 0.7}}}};
    for (int i = 0; i < 4; i++) { /* a pyramid on each, its only cell */
        const int n = polygons[i].n;
        struct polymesh mesh = {.npoints = n + 1, .nfaces = n + 1, .ncells = 1, .npatches = 1};
        double points[21] = {0}, wanted[6] = {0}, found[6] = {0};
        int start[8] = {0}, vertex[32], owner[8] = {0};
        struct patch wall = {(char[]){"wall"}, (char[]){"wall"}, NULL, 0, n + 1, NULL, NULL};
        for (int v = 0; v < n; v++) {
            const double *a = polygons[i].x[v], *b = polygons[i].x[(v + 1) % n];
            const double c = a[0] * b[1] - a[1] * b[0], sx = a[0] + b[0], sy = a[1] + b[1];
            const double term[6] = {c / 2,
                                    c * sx / 6,
                                    c * sy / 6,
                                    c * (a[0] * a[0] + b[0] * b[0] + sx * sx) / 24,
                                    c * (a[0] * a[1] + b[0] * b[1] + sx * sy) / 24,
                                    c * (a[1] * a[1] + b[1] * b[1] + sy * sy) / 24};
            for (int k = 0; k < 6; k++) wanted[k] += term[k];
            points[3 * v] = a[0], points[3 * v + 1] = a[1];
            vertex[n - 1 - v] = v;
            vertex[n + 3 * v] = v, vertex[n + 3 * v + 1] = (v + 1) % n, vertex[n + 3 * v + 2] = n;
            start[v + 1] = n + 3 * v;
        }
        start[n + 1] = 4 * n;
        points[3 * n] = 0.9, points[3 * n + 1] = 0.6, points[3 * n + 2] = 0.8;
        mesh.points = points, mesh.face_start = start, mesh.face_points = vertex, mesh.owner = owner;
        mesh.patch = &wall;
        ok(polymesh_check(&mesh));
        struct polyhedra *m;
        ok(polyhedra_make(&mesh, world, 2, &m));
        int face = 0;
        while (m->face.place[face] != 0) face++;
        assert_int_equal(m->face.point_start[face + 1] - m->face.point_start[face], n <= 4 ? n : 3 * n);
        for (int p = m->face.point_start[face]; p < m->face.point_start[face + 1]; p++) {
            double x = m->centre[0][0] + m->point.arm[0][0][p], y = m->centre[1][0] + m->point.arm[0][1][p];
            double w = m->face.area[face] * m->point.weight[p], term[6] = {1, x, y, x * x, x * y, y * y};
            for (int k = 0; k < 6; k++) found[k] += w * term[k];
        }
        for (int k = 0; k < 6; k++)
            if (!(fabs(found[k] - wanted[k]) < 1e-13))
                fail_msg("polygon of %d, monomial %d: %.17g, not %.17g", n, k, found[k], wanted[k]);
        polyhedra_free(m);
    }
}

/* ---- stencils ---------------------------------------------------------------------------------------------------- */

struct node {
    int cell, ring;
    double offset[3];
};

static bool is_known(const struct node *list, int n, const struct node *x) {
    for (int i = 0; i < n; i++) {
        double off = 0;
        for (int k = 0; k < 3; k++) off = fmax(off, fabs(list[i].offset[k] - x->offset[k]));
        if (list[i].cell == x->cell && off < 1e-9) return true;
    }
    return false;
}

/* Adds the cells across the faces of list[of]; the offset of a step is the difference of the arms of a face point. */
static int add_across(const struct polyhedra *m, struct node *list, int n, int of) {
    for (int k = m->face_start[list[of].cell]; k < m->face_start[list[of].cell + 1]; k++) {
        int side = m->face_of_cell[k] < 0, f = side ? ~m->face_of_cell[k] : m->face_of_cell[k];
        int p = m->face.point_start[f];
        struct node x = {.cell = side ? m->face.left[f] : m->face.right[f], .ring = list[of].ring + 1};
        for (int a = 0; a < m->dim; a++)
            x.offset[a] = list[of].offset[a] + m->point.arm[side][a][p] - m->point.arm[!side][a][p];
        if (x.cell >= m->ncells && x.ring > 1) continue;
        if (!is_known(list, n, &x)) list[n++] = x;
    }
    return n;
}

static int grow(const struct polyhedra *m, int cell, int rings, struct node *list) {
    int n = 1, wanted[2][3] = {{2, 4, 6}, {3, 8, 14}};
    list[0] = (struct node){.cell = cell};
    for (int ring = 1, from = 0; ring <= rings || (n - 1 < wanted[rings - 1][m->dim - 1] && ring <= 6); ring++)
        for (int to = n; from < to; from++)
            if (list[from].cell < m->ncells) n = add_across(m, list, n, from);
    return n;
}

static void check_stencil(const struct fixture *x, int c, const struct node *list, int n) {
    const struct polyhedra *m = x->m;
    int start = m->stencil_start[c];
    assert_int_equal(m->stencil_start[c + 1] - start, n - 1);
    for (int i = 1; i < n; i++) {
        int at = start + i - 1;
        struct node found = {m->stencil[at], m->ring[at], {0}};
        for (int k = 0; k < m->dim; k++) found.offset[k] = m->offset[k][at];
        assert_true(is_known(list, n, &found));
        assert_false(is_known(list, 1, &found));
        if (list[i].ring == 1)
            assert_int_equal(found.cell, list[i].cell);
        else if (m->ring[at - 1] == found.ring)
            assert_true(m->cell[m->stencil[at - 1]] <= m->cell[found.cell]);
        assert_int_equal(found.ring, list[i].ring);
    }
}

static void stencils_are_rings(void **state) {
    (void)state;
    static struct node list[3000];
    for (int i = 0; i < RECIPES; i++)
        for (int rings = 1; rings <= 2; rings++) {
            struct fixture x = begin(i, rings);
            for (int c = 0; c < x.m->nnear; c++) check_stencil(&x, c, list, grow(x.m, c, rings, list));
            end(&x);
        }
}

/* Every vertex of the kinds of cells here has dim faces: so has each corner dim members, and each face as many corners
 * as it has vertices. */
static void corners_share_vertices(void **state) {
    (void)state;
    for (int i = 0; i < RECIPES; i++) {
        if (recipes[i].shape == PYRAMIDS) continue; /* four faces at the apex */
        struct fixture x = begin(i, 1);
        const struct polyhedra *m = x.m;
        const int d = m->dim;
        const int vertices = d == 1 ? 2 : recipes[i].shape == TETS ? 4 : (recipes[i].shape == PRISMS ? 3 : 4) * (d - 1);
        for (int c = 0; c < m->nnear; c++) {
            int first = m->stencil_start[c], nfaces = 0, used[8] = {0};
            while (first + nfaces < m->stencil_start[c + 1] && m->ring[first + nfaces] == 1) nfaces++;
            assert_int_equal(m->corner_start[c + 1] - m->corner_start[c], vertices);
            for (int k = m->corner_start[c]; k < m->corner_start[c + 1]; k++) {
                assert_int_equal(m->corner_first[k + 1] - m->corner_first[k], d);
                for (int j = m->corner_first[k]; j < m->corner_first[k + 1]; j++) {
                    assert_in_range(m->corner_member[j], 0, nfaces - 1);
                    used[m->corner_member[j]]++;
                }
            }
            for (int f = 0; f < nfaces; f++) assert_in_range(used[f], d, d == 3 ? 4 : d);
        }
        end(&x);
    }
}

static void the_apex_of_a_pyramid_is_a_corner_of_four(void **state) {
    (void)state;
    const struct cells_recipe r = {"pyramids", 3, PYRAMIDS, {3, 2, 2}, {0, 1, 2}, 0.1, {false}};
    struct polymesh *mesh = cells_make(&r);
    struct polyhedra *m;
    ok(polyhedra_make(mesh, world, 1, &m));
    for (int c = 0; c < m->nnear; c++) {
        int count[5] = {0};
        for (int k = m->corner_start[c]; k < m->corner_start[c + 1]; k++)
            count[m->corner_first[k + 1] - m->corner_first[k]]++;
        assert_true(count[3] == 4 && count[4] == 1);
    }
    polyhedra_free(m);
    polymesh_free(mesh);
}

/* ---- blocks ------------------------------------------------------------------------------------------------------ */

static void blocks_hold_all_cells_once(void **state) {
    (void)state;
    const struct cells_recipe r = {"many triangles", 2, PRISMS, {60, 50, 1}, {0, 1, 2}, 0.2, {false}};
    struct polymesh *mesh = cells_make(&r);
    struct polyhedra *m;
    ok(polyhedra_make(mesh, world, 1, &m));
    char *seen = calloc((size_t)mesh->ncells, 1);
    assert_int_equal(m->nblocks, m->nblocks_all);
    assert_in_range(m->nblocks, 10, 12);
    long far = 0;
    for (int b = 0; b < m->nblocks; b++) {
        assert_int_equal(m->block_id[b], b);
        assert_in_range(m->block_start[b + 1] - m->block_start[b], 400, 600);
        for (int k = m->block_start[b]; k < m->block_start[b + 1]; k++) seen[m->cell[m->block_cell[k]]]++;
    }
    for (int c = 0; c < mesh->ncells; c++) assert_int_equal(seen[c], 1);
    for (int f = 0; f < m->face.ninternal; f++) far += abs(m->face.left[f] - m->face.right[f]) > 100;
    assert_true(far < m->face.ninternal / 4);
    free(seen);
    polyhedra_free(m);
    polymesh_free(mesh);
}

static bool middle(int i, int j, int k) {
    (void)j, (void)k;
    return i == 30;
}

static void a_mesh_in_two_parts_is_cut_as_well(void **state) {
    (void)state;
    const struct recipe r = {
        .n = {61, 40, 1}, .width = {1, 1, 1}, .hole = middle, .type = {[4] = "empty", [5] = "empty"}};
    struct polymesh *mesh = NULL;
    struct polyhedra *m;
    ok(mesh_make(&r, &mesh));
    ok(polyhedra_make(mesh, world, 1, &m));
    assert_int_equal(m->nblocks, 4);
    for (int i = 0; i < m->nown; i++) assert_true(m->volume[i] == 1);
    polyhedra_free(m);
    polymesh_free(mesh);
}

/* The area of the faces of a cell over its volume rises from cell to cell, but for cells of one class; no cell is lost.
 */
static void sizes_stand_in_order(void **state) {
    (void)state;
    for (int which = 0; which < (int)(sizeof recipes / sizeof *recipes); which++) {
        struct polymesh *mesh = cells_make(&recipes[which]);
        struct polyhedra *m;
        ok(polyhedra_make_sized(mesh, world, 1, &m));
        long left = (long)mesh->ncells * (mesh->ncells - 1) / 2;
        double most = 0;
        for (int i = 0; i < m->nown; i++) {
            double rate = 0;
            for (int k = m->face_start[i]; k < m->face_start[i + 1]; k++)
                rate += m->face.area[m->face_of_cell[k] < 0 ? ~m->face_of_cell[k] : m->face_of_cell[k]] / m->volume[i];
            if (rate > most) most = rate;
            assert_true(rate * 1.1893 > most); /* 2^(1/4) */
            left -= m->cell[i];
        }
        assert_int_equal(m->nown, mesh->ncells);
        assert_int_equal(left, 0);
        polyhedra_free(m);
        polymesh_free(mesh);
    }
}

static void what_cannot_be_solved_is_refused(void **state) {
    (void)state;
    struct polyhedra *m;
    struct polymesh *mesh = cells_make(&recipes[6]);
    says(polyhedra_make(mesh, world, 3, &m), "3 rings|1 or 2");
    assert_null(m);
    double *z = &mesh->points[3 * 20 + 2];
    *z += *z > 0.1 ? -0.06 : 0.06;
    says(polyhedra_make(mesh, world, 1, &m), "point 20|between the two planes|z = 0");
    polymesh_free(mesh);
    mesh = cells_make(&recipes[11]);
    memcpy(mesh->points + 3 * 26, mesh->points + 3 * 31, 3 * sizeof(double));
    says(polyhedra_make(mesh, world, 1, &m), "constant/polyMesh");
    polymesh_free(mesh);
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return status_print(s, true);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(axes_and_sizes),
        cmocka_unit_test(faces_follow_cells),
        cmocka_unit_test(neighbours_stand_near),
        cmocka_unit_test(fronts_are_straight),
        cmocka_unit_test(cells_are_closed),
        cmocka_unit_test(centres_are_centroids),
        cmocka_unit_test(moments_of_simplices),
        cmocka_unit_test(moments_add_up),
        cmocka_unit_test(frames_and_mirrors),
        cmocka_unit_test(points_are_exact_for_quadratics),
        cmocka_unit_test(stencils_are_rings),
        cmocka_unit_test(corners_share_vertices),
        cmocka_unit_test(the_apex_of_a_pyramid_is_a_corner_of_four),
        cmocka_unit_test(blocks_hold_all_cells_once),
        cmocka_unit_test(a_mesh_in_two_parts_is_cut_as_well),
        cmocka_unit_test(sizes_stand_in_order),
        cmocka_unit_test(what_cannot_be_solved_is_refused),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
