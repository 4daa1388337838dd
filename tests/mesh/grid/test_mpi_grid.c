/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What readers of fields know about a mesh: blocks, sums, gathered values, places. */
#include "mesh/grid/grid.h"
#include "tests/mesh/meshes.h"

static struct comm *world;

struct fixture {
    struct polymesh *m;
    struct lattice *l;
    struct grid *g;
    double *centre, *volume;
};

static bool big_hole(int i, int j, int k) {
    (void)k;
    return i >= 70 && j < 66;
}

/* Each mesh as a forest and as polyhedra; a warped one, which is no lattice. */
static const struct recipe recipes[] = {
    {.n = {200, 1, 1}, .width = {0.1, 1, 2}, .type = {NULL, NULL, "empty", "empty", "empty", "empty"}},
    {.n = {130, 1, 140}, .origin = {-3, 2, 1}, .width = {0.1, 1, 0.2}, .type = {NULL, NULL, "empty", "empty"}},
    {.n = {130, 140, 1}, .width = {0.1, 0.2, 1}, .hole = big_hole, .type = {[4] = "empty", [5] = "empty"}},
    {.n = {42, 13, 34}, .width = {0.1, 0.2, 0.3}, .type = {"cyclic", "cyclic"}},
    {.n = {13, 17, 12}, .width = {0.1, 0.2, 0.3}, .noise = 0.1},
};
enum { RECIPES = sizeof recipes / sizeof *recipes, KINDS = 2 * RECIPES };

static bool begin(struct fixture *x, int kind) {
    const struct recipe *r = &recipes[kind % RECIPES];
    char why[256];
    bool forest = kind < RECIPES;
    if (forest && r->noise > 0) return false;
    ok(mesh_make(r, &x->m));
    double *face = malloc((size_t)x->m->nfaces * 24), *area = malloc((size_t)x->m->nfaces * 24);
    x->centre = malloc((size_t)x->m->ncells * 24), x->volume = malloc((size_t)x->m->ncells * 8);
    polymesh_face_geometry(x->m, face, area);
    ok(polymesh_cell_geometry(x->m, face, area, x->centre, x->volume));
    free(face), free(area);
    ok(lattice_recognise(x->m, &x->l, why));
    assert_true((x->l == NULL) == (r->noise > 0));
    ok(grid_make(forest ? x->l : NULL, x->m, x->centre, world, 1 + kind % 2, false, &x->g));
    assert_true(forest ? x->g->forest && !x->g->polyhedra : x->g->polyhedra && !x->g->forest);
    return true;
}

static void end(struct fixture *x) {
    grid_free(x->g);
    lattice_free(x->l);
    polymesh_free(x->m);
    free(x->centre), free(x->volume);
}

static void blocks_cover_the_mesh_once(void **state) {
    (void)state;
    for (int s = 0; s < KINDS; s++) {
        struct fixture x;
        if (!begin(&x, s)) continue;
        const struct grid *g = x.g;
        int axis[3];
        assert_int_equal(g->dim, polymesh_axes(x.m, axis));
        assert_memory_equal(g->axis, axis, (size_t)g->dim * sizeof *axis);
        assert_int_equal(g->ncells_all, x.m->ncells);
        assert_true(g->nblocks_all >= (s < RECIPES ? 4 : 1) && g->mesh == x.m);
        long *seen = calloc((size_t)g->ncells_all + (size_t)g->nblocks_all, sizeof *seen);
        for (int b = 0; b < g->nblocks; b++) {
            seen[g->ncells_all + g->block[b].id]++;
            for (int i = 0; i < g->block[b].ncells; i++) {
                const int cell = g->block[b].cell[i];
                double centre[3];
                seen[cell]++;
                grid_centre(g, b, i, centre);
                for (int k = 0; k < 3; k++) assert_true(fabs(centre[k] - x.centre[3 * cell + k]) < 1e-12);
                assert_true(fabs(grid_volume(g, b, i) / x.volume[cell] - 1) < 1e-12);
            }
        }
        comm_sum_long(world, seen, g->ncells_all + g->nblocks_all);
        for (int i = 0; i < g->ncells_all + g->nblocks_all; i++) assert_int_equal(seen[i], 1);
        free(seen);
        end(&x);
    }
}

static void values_arrive_at_their_cells(void **state) {
    (void)state;
    for (int s = 0; s < KINDS; s++) {
        struct fixture x;
        if (!begin(&x, s)) continue;
        const struct grid *g = x.g;
        double *values = calloc((size_t)g->ncells_all, sizeof *values), *next = values;
        double *all = comm_root(world) ? calloc((size_t)g->ncells_all, sizeof *all) : NULL;
        for (int b = 0; b < g->nblocks; b++)
            for (int i = 0; i < g->block[b].ncells; i++) *next++ = sqrt(g->block[b].cell[i] + 1);
        ok(grid_gather(g, values, all));
        for (int c = 0; all && c < g->ncells_all; c++) assert_true(all[c] == sqrt(c + 1));
        free(values);
        free(all);
        end(&x);
    }
}

static void sums_have_the_same_bits_on_any_number_of_ranks(void **state) {
    (void)state;
    for (int s = 0; s < KINDS; s++) {
        struct fixture x;
        if (!begin(&x, s)) continue;
        double *mine = malloc(((size_t)x.g->nblocks + 1) * sizeof *mine), serial = 0, sum;
        for (int b = 0; b < x.g->nblocks; b++) mine[b] = sin(1e4 * x.g->block[b].id) / 3;
        for (int id = 0; id < x.g->nblocks_all; id++) serial += sin(1e4 * id) / 3;
        ok(grid_sum(x.g, mine, &sum));
        assert_memory_equal(&sum, &serial, sizeof sum);
        free(mine);
        end(&x);
    }
}

/* The cell that holds a point: exactly one rank has it, or none; -1. */
static long find(const struct grid *g, const double point[3]) {
    int block, cell;
    long found[2] = {0};
    ok(grid_locate(g, point, &block, &cell));
    if (block >= 0) {
        found[0] = 1;
        found[1] = g->block[block].cell[cell];
    }
    comm_sum_long(world, found, 2);
    assert_in_range(found[0], 0, 1);
    return found[0] ? found[1] : -1;
}

static void points_are_found_by_one_rank(void **state) {
    (void)state;
    for (int s = 0; s < KINDS; s++) {
        struct fixture x;
        const struct recipe *r = &recipes[s % RECIPES];
        if (!begin(&x, s)) continue;
        for (int c = 0; c < x.m->ncells; c += 101) {
            double p[3] = {-1e9, -1e9, -1e9}, away = r->noise > 0 ? 0.2 : 0.49; /* -1e9: where it does not count */
            for (int k = 0; k < x.g->dim; k++)
                p[x.g->axis[k]] = x.centre[3L * c + x.g->axis[k]] + away * r->width[x.g->axis[k]];
            assert_int_equal(find(x.g, p), c);
            for (int k = 0; k < x.g->dim && r->noise == 0; k++)
                p[x.g->axis[k]] = x.centre[3L * c + x.g->axis[k]] - 0.5 * r->width[x.g->axis[k]];
            assert_true(find(x.g, p) >= 0); /* a corner: one of the cells about it */
        }
        for (int k = 0; k < x.g->dim; k++) {
            double p[3] = {x.centre[0], x.centre[1], x.centre[2]};
            p[x.g->axis[k]] = r->origin[x.g->axis[k]] - 0.2 * r->width[x.g->axis[k]];
            assert_int_equal(find(x.g, p), -1);
        }
        end(&x);
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return status_print(s, true);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_cover_the_mesh_once),
        cmocka_unit_test(values_arrive_at_their_cells),
        cmocka_unit_test(sums_have_the_same_bits_on_any_number_of_ranks),
        cmocka_unit_test(points_are_found_by_one_rank),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
