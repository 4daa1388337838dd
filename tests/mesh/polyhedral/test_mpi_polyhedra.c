/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Polyhedra on all ranks, of a mesh that each rank has and of one that is spread over them, against the same ones made
 * by each rank alone: the same lists and the same bits for every cell, face, ghost and mirror; ghosts filled with the
 * values of their cells. */
#define _GNU_SOURCE /* mkdtemp */
#include "mesh/polyhedral/polyhedra.h"
#include "mesh/spread/spread.h"

#include "tests/mesh/polyhedral/cells.h"
#include "tests/mesh/shared_folder.h"

static struct comm *alone;

static const struct cells_recipe recipes[] = {
    {"line", 1, BOXES, {2100, 1, 1}, {0, 1, 2}, 0.3, {false}},
    {"periodic line", 1, BOXES, {2100, 1, 1}, {1, 0, 2}, 0.3, {true}},
    {"triangles", 2, PRISMS, {40, 32, 1}, {0, 1, 2}, 0.2, {false}},
    {"triangles in x and z, periodic", 2, PRISMS, {40, 32, 1}, {0, 2, 1}, 0.2, {true, true}},
    {"quads, two wide, periodic", 2, BOXES, {1200, 2, 1}, {0, 1, 2}, 0.2, {true, true}},
    {"few quads", 2, BOXES, {9, 8, 1}, {0, 1, 2}, 0.2, {true, false}},
    {"hexahedra", 3, BOXES, {14, 13, 12}, {0, 1, 2}, 0.2, {true, false, true}},
    {"tetrahedra", 3, TETS, {8, 8, 7}, {0, 1, 2}, 0.12, {false}},
    {"periodic prisms", 3, PRISMS, {12, 10, 9}, {0, 1, 2}, 0.12, {false, true, false}},
};
enum { RECIPES = sizeof recipes / sizeof *recipes };

struct fixture {
    const struct cells_recipe *r;
    struct polymesh *mesh, *outline; /* outline: of the mesh that is spread, or NULL */
    struct mesh_part part;
    struct polyhedra *m, *whole;
    int *number; /* [ncells] of the cells in `whole` */
};

/* Writes the mesh, in one of four formats, and makes polyhedra of what the ranks read of it. */
static void begin_spread(struct fixture *x, int rings, int form) {
    const struct foam_format format = {.binary = form % 2, .compress = form / 2, .precision = 17};
    struct spread *spread;
    ok(comm_agree(world, comm_root(world) ? polymesh_write(x->mesh, folder, &format) : OK));
    ok(spread_read(folder, world, false, false, &spread, &x->outline));
    if (!spread) fail_msg("%s: form %d is not read in slices", x->r->name, form);
    ok(polyhedra_make_spread(x->outline, spread, rings, false, &x->part, &x->m));
    assert_int_equal(polymesh_checksum(x->outline), polymesh_checksum(x->mesh));
    spread_free(spread);
    ok(comm_agree(world, OK)); /* before the root writes another one */
}

/* The second time round, recipes are spread. */
static struct fixture begin(int recipe, int rings) {
    const struct cells_recipe *r = &recipes[recipe % RECIPES];
    struct fixture x = {.r = r, .mesh = cells_make(r)};
    if (recipe < RECIPES)
        ok(polyhedra_make(x.mesh, world, rings, &x.m));
    else
        begin_spread(&x, rings, recipe % 4);
    ok(polyhedra_make(x.mesh, alone, rings, &x.whole));
    x.number = calloc((size_t)x.mesh->ncells, sizeof *x.number);
    for (int i = 0; i < x.whole->nown; i++) x.number[x.whole->cell[i]] = i;
    return x;
}

static void end(struct fixture *x) {
    free(x->number);
    polyhedra_free(x->m);
    polyhedra_free(x->whole);
    part_free(&x->part);
    polymesh_free(x->mesh);
    polymesh_free(x->outline);
}

/* Lines of the two polyhedra at places i and j: the same bits. */
static void same(const struct fixture *x, const char *what, int n, double *const *a, long i, double *const *b, long j) {
    for (int k = 0; k < n; k++)
        if (memcmp(&a[k][i], &b[k][j], sizeof(double)) != 0)
            fail_msg("%s: %s %ld, component %d: %.17g, not %.17g", x->r->name, what, i, k, a[k][i], b[k][j]);
}

/* A cell as the polyMesh knows it, a mirror by its boundary face. */
static long name_of(const struct fixture *x, const struct polyhedra *m, int i) {
    if (i < m->ncells) return m->cell[i];
    int mirror = i - m->ncells;
    return -1L - x->mesh->patch[m->mirror.patch[mirror]].start - m->mirror.place[mirror];
}

static void check_cell(const struct fixture *x, int i, int j) {
    const struct polyhedra *m = x->m, *w = x->whole;
    same(x, "volume", 1, &x->m->volume, i, &x->whole->volume, j);
    same(x, "centre", m->dim, m->centre, i, w->centre, j);
    same(x, "moment", m->dim * (m->dim + 1) / 2, m->moment, i, w->moment, j);
}

static void check_stencil(const struct fixture *x, int i, int j) {
    const struct polyhedra *m = x->m, *w = x->whole;
    int a = m->stencil_start[i], b = w->stencil_start[j], n = w->stencil_start[j + 1] - b;
    assert_int_equal(m->stencil_start[i + 1] - a, n);
    for (int k = 0; k < n; k++) {
        assert_int_equal(name_of(x, m, m->stencil[a + k]), name_of(x, w, w->stencil[b + k]));
        assert_int_equal(m->ring[a + k], w->ring[b + k]);
        same(x, "offset", m->dim, m->offset, a + k, w->offset, b + k);
        check_cell(x, m->stencil[a + k], w->stencil[b + k]);
    }
    int corners = w->corner_start[j + 1] - w->corner_start[j];
    assert_int_equal(m->corner_start[i + 1] - m->corner_start[i], corners);
    for (int k = 0; k < corners; k++) {
        int c = m->corner_first[m->corner_start[i] + k], d = w->corner_first[w->corner_start[j] + k];
        int members = w->corner_first[w->corner_start[j] + k + 1] - d;
        assert_int_equal(m->corner_first[m->corner_start[i] + k + 1] - c, members);
        assert_memory_equal(m->corner_member + c, w->corner_member + d, (size_t)members * sizeof(int));
    }
}

static void check_face(const struct fixture *x, int i, int j) {
    const struct polyhedra *m = x->m, *w = x->whole;
    assert_int_equal(name_of(x, m, m->face.left[i]), name_of(x, w, w->face.left[j]));
    assert_int_equal(name_of(x, m, m->face.right[i]), name_of(x, w, w->face.right[j]));
    same(x, "area", 1, &x->m->face.area, i, &x->whole->face.area, j);
    same(x, "normal", m->dim, m->face.normal, i, w->face.normal, j);
    same(x, "shift", m->dim, m->face.shift, i, w->face.shift, j);
    for (int t = 0; t < m->dim - 1; t++) same(x, "tangent", m->dim, m->face.tangent[t], i, w->face.tangent[t], j);
    int a = m->face.point_start[i], b = w->face.point_start[j], n = w->face.point_start[j + 1] - b;
    assert_int_equal(m->face.point_start[i + 1] - a, n);
    for (int p = 0; p < n; p++) {
        assert_int_equal(m->point.face[a + p], i);
        same(x, "weight", 1, &x->m->point.weight, a + p, &x->whole->point.weight, b + p);
        for (int side = 0; side < 2; side++)
            same(x, "arm", m->dim, m->point.arm[side], a + p, w->point.arm[side], b + p);
    }
}

static void check_faces(const struct fixture *x, int i, int j) {
    const struct polyhedra *m = x->m, *w = x->whole;
    int a = m->face_start[i], b = w->face_start[j], n = w->face_start[j + 1] - b;
    assert_int_equal(m->face_start[i + 1] - a, n);
    for (int k = 0; k < n; k++) {
        int f = m->face_of_cell[a + k], g = w->face_of_cell[b + k];
        assert_true((f < 0) == (g < 0));
        check_face(x, f < 0 ? ~f : f, g < 0 ? ~g : g);
    }
}

static void lists_and_bits_are_those_of_one_rank(void **state) {
    (void)state;
    for (int r = 0; r < 2 * RECIPES; r++) {
        struct fixture x = begin(r, 2 - r % 2);
        const struct polyhedra *m = x.m;
        long cells = m->nown;
        for (int i = 0; i < m->ncells; i++) check_cell(&x, i, x.number[m->cell[i]]);
        for (int i = 0; i < m->nnear; i++) check_stencil(&x, i, x.number[m->cell[i]]);
        for (int i = 0; i < m->nown; i++) check_faces(&x, i, x.number[m->cell[i]]);
        comm_sum_long(world, &cells, 1);
        assert_int_equal(cells, x.mesh->ncells);
        assert_int_equal(m->ncells_all, x.mesh->ncells);
        end(&x);
    }
}

static void inner_cells_read_nothing_remote(void **state) {
    (void)state;
    for (int r = 0; r < 2 * RECIPES; r++) {
        struct fixture x = begin(r, 1 + r % 2);
        const struct polyhedra *m = x.m;
        for (int i = 0; i < m->nown; i++) {
            bool remote = false;
            for (int k = m->stencil_start[i]; k < m->stencil_start[i + 1]; k++)
                remote = remote || (m->stencil[k] >= m->nown && m->stencil[k] < m->ncells);
            assert_int_equal(remote, i >= m->ninner);
        }
        char *across = calloc((size_t)m->size + 1, 1);
        for (int f = 0; f < m->face.n; f++) {
            int left = m->face.left[f], right = m->face.right[f];
            assert_true(f >= m->face.ninternal || (left < m->nnear && right < m->nnear));
            assert_true(left < m->nown || right < m->nown);
            assert_int_equal(f < m->face.nlocal, left < m->ninner && right < m->ninner);
            assert_int_equal(f < m->face.ninternal, right < m->ncells);
            across[left] = across[right] = 1;
        }
        for (int i = m->nown; i < m->ncells; i++) assert_int_equal(across[i], i < m->nnear);
        free(across);
        end(&x);
    }
}

static double value(int cell, int v, int round) {
    return 1000.0 * cell + v + 0.25 * round;
}

static void ghosts_get_the_values_of_their_cells(void **state) {
    (void)state;
    for (int r = 0; r < 2 * RECIPES; r++) {
        struct fixture x = begin(r, 2);
        struct polyhedra *m = x.m;
        double *data[POLYHEDRA_VARIABLES];
        for (int v = 0; v < POLYHEDRA_VARIABLES; v++) data[v] = malloc(((size_t)m->size + 1) * sizeof(double));
        for (int round = 0; round < 3; round++) {
            const int nvar = round == 1 ? POLYHEDRA_VARIABLES : 3;
            for (int v = 0; v < nvar; v++)
                for (int i = 0; i < m->size; i++) data[v][i] = i < m->nown ? value(m->cell[i], v, round) : -i;
            polyhedra_fill_start(m, nvar, data);
            polyhedra_fill_finish(m);
            for (int v = 0; v < nvar; v++)
                for (int i = 0; i < m->size; i++)
                    if (data[v][i] != (i < m->ncells ? value(m->cell[i], v, round) : -i))
                        fail_msg("%s: variable %d of cell %d of %d: %g", x.r->name, v, i, m->nown, data[v][i]);
        }
        for (int v = 0; v < POLYHEDRA_VARIABLES; v++) free(data[v]);
        int *ints = malloc(((size_t)m->size + 1) * sizeof *ints);
        for (int i = 0; i < m->size; i++) ints[i] = i < m->nown ? m->cell[i] : -i;
        polyhedra_fill_int(m, ints);
        for (int i = 0; i < m->size; i++) assert_int_equal(ints[i], i < m->ncells ? m->cell[i] : -i);
        free(ints);
        end(&x);
    }
}

static void blocks_are_those_of_one_rank(void **state) {
    (void)state;
    for (int r = 0; r < 2 * RECIPES; r++) {
        struct fixture x = begin(r, 1);
        const struct polyhedra *m = x.m, *w = x.whole;
        long nblocks = m->nblocks;
        double most = m->nown, least = m->nown;
        assert_int_equal(m->nblocks_all, w->nblocks_all);
        for (int b = 0; b < m->nblocks; b++) {
            int id = m->block_id[b], n = m->block_start[b + 1] - m->block_start[b];
            assert_true(b == 0 || id > m->block_id[b - 1]);
            assert_int_equal(n, w->block_start[id + 1] - w->block_start[id]);
            for (int k = 0; k < n; k++)
                assert_int_equal(m->cell[m->block_cell[m->block_start[b] + k]],
                                 w->cell[w->block_cell[w->block_start[id] + k]]);
        }
        comm_sum_long(world, &nblocks, 1);
        comm_max(world, &most, 1);
        comm_min(world, &least, 1);
        assert_int_equal(nblocks, m->nblocks_all);
        assert_true(least > 0 || m->nblocks_all < comm_size(world));
        if (comm_size(world) == 2 && m->nblocks_all % 2 == 0) assert_true(most < 1.1 * x.mesh->ncells / 2);
        end(&x);
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (!s) s = comm_alone(&alone);
    if (s) return status_print(s, true);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_and_bits_are_those_of_one_rank),
        cmocka_unit_test(inner_cells_read_nothing_remote),
        cmocka_unit_test(ghosts_get_the_values_of_their_cells),
        cmocka_unit_test(blocks_are_those_of_one_rank),
    };
    int failed = cmocka_run_group_tests(tests, make_folder, remove_folder);
    comm_alone_free(alone);
    comm_finish(world);
    return failed;
}
