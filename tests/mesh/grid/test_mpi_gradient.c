/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gradients of values in cells: exact for linear values on any mesh, and for quadratic ones on boxes, beside patches,
 * too; of second order on warped meshes. */
#include "mesh/grid/gradient.h"
#include "tests/mesh/meshes.h"

static struct comm *world;

static bool step_in_corner(int i, int j, int k) {
    (void)k;
    return i >= 70 && j < 66;
}

static const struct recipe recipes[] = {
    {.n = {200, 1, 1}, .width = {0.1, 1, 2}, .type = {NULL, NULL, "empty", "empty", "empty", "empty"}},
    {.n = {13, 1, 14}, .origin = {-3, 2, 1}, .width = {0.1, 1, 0.2}, .type = {NULL, NULL, "empty", "empty"}},
    {.n = {130, 140, 1}, .width = {0.1, 0.2, 1}, .hole = step_in_corner, .type = {[4] = "empty", [5] = "empty"}},
    {.n = {11, 9, 10}, .width = {0.1, 0.2, 0.3}},
    {.n = {9, 7, 2}, .width = {0.1, 0.2, 0.3}},
    {.n = {9, 7, 1}, .width = {0.1, 0.2, 0.3}},
};
enum { RECIPES = sizeof recipes / sizeof *recipes };

struct fixture {
    struct polymesh *m;
    struct lattice *l;
    struct grid *g;
    double *centre, *volume;
    long n;
    double *values[2], *gradient[6];
};

static void begin(struct fixture *x, const struct recipe *r, bool forest, int rings) {
    char why[256];
    *x = (struct fixture){.n = 0};
    ok(mesh_make(r, &x->m));
    double *face = malloc((size_t)x->m->nfaces * 24), *area = malloc((size_t)x->m->nfaces * 24);
    x->centre = malloc((size_t)x->m->ncells * 24), x->volume = malloc((size_t)x->m->ncells * 8);
    polymesh_face_geometry(x->m, face, area);
    ok(polymesh_cell_geometry(x->m, face, area, x->centre, x->volume));
    free(face), free(area);
    ok(lattice_recognise(x->m, &x->l, why));
    ok(grid_make(forest ? x->l : NULL, x->m, x->centre, world, rings, false, &x->g));
    for (int b = 0; b < x->g->nblocks; b++) x->n += x->g->block[b].ncells;
    for (int c = 0; c < 2; c++) x->values[c] = calloc((size_t)x->n + 1, 8);
    for (int k = 0; k < 6; k++) x->gradient[k] = calloc((size_t)x->n + 1, 8);
}

static void end(struct fixture *x) {
    for (int c = 0; c < 2; c++) free(x->values[c]);
    for (int k = 0; k < 6; k++) free(x->gradient[k]);
    grid_free(x->g);
    lattice_free(x->l);
    polymesh_free(x->m);
    free(x->centre), free(x->volume);
}

typedef double field(const double *x, int k); /* its value (k = -1), or its derivative along x_k */

static double linear(const double *x, int k) {
    static const double slope[3] = {1.3, -0.7, 2.1};
    return k < 0 ? slope[0] * x[0] + slope[1] * x[1] + slope[2] * x[2] : slope[k];
}
static double quadratic(const double *x, int k) {
    const double slope[3] = {x[0] - 0.5 * x[1] + 1.5 * x[2], -0.5 * x[0] + 0.6 * x[1] - 1.1 * x[2],
                             1.5 * x[0] - 1.1 * x[1] - 0.4 * x[2]};
    return k < 0 ? (slope[0] * x[0] + slope[1] * x[1] + slope[2] * x[2]) / 2 : slope[k];
}
static double wave(const double *x, int k) {
    const double at = x[0] + 2 * x[1] - x[2];
    return k < 0 ? sin(at) : cos(at) * (k == 0 ? 1 : k == 1 ? 2 : -1);
}

/* The largest error of the gradients, over all cells and axes but those that `skip` names; as values of polyhedra are
 * those in centres, fields are linear or meshes of boxes, whose moments are alike. */
static double error_of(struct fixture *x, field *const of[2], int skip) {
    const struct grid *g = x->g;
    double most = 0;
    for (long b = 0, at = 0; b < g->nblocks; b++)
        for (int i = 0; i < g->block[b].ncells; i++, at++)
            for (int c = 0; c < 2; c++) x->values[c][at] = of[c](x->centre + 3L * g->block[b].cell[i], -1);
    ok(grid_gradients(g, 2, (const double *const *)x->values, x->gradient));
    for (long b = 0, at = 0; b < g->nblocks; b++)
        for (int i = 0; i < g->block[b].ncells; i++, at++)
            for (int k = 0; k < g->dim; k++)
                for (int c = 0; c < 2 && k != skip; c++)
                    most = fmax(most, fabs(x->gradient[2 * k + c][at] -
                                           of[c](x->centre + 3L * g->block[b].cell[i], g->axis[k])));
    comm_max(world, &most, 1);
    return most;
}

/* A mesh two cells wide has no second derivative along that axis; one of one cell has no derivative. */
static void linear_and_quadratic_values_are_exact(void **state) {
    (void)state;
    for (int r = 0; r < RECIPES; r++)
        for (int rings = 0; rings < 3; rings++) { /* 0: a forest */
            struct fixture x;
            const bool flat = recipes[r].n[2] == 1 && !recipes[r].type[4], thin = flat || recipes[r].n[2] == 2;
            begin(&x, &recipes[r], rings == 0, rings ? rings : 1);
            const double error =
                error_of(&x, (field *const[2]){linear, thin || rings == 1 ? linear : quadratic}, flat ? 2 : -1);
            assert_true(error < 1e-9); /* values up to 1e3 over widths of 0.1: 10 times their round-off */
            end(&x);
        }
}

static void periodic_values_are_seen_across(void **state) {
    (void)state;
    const struct recipe r = {
        .n = {40, 6, 1}, .width = {0.1, 0.2, 1}, .type = {"cyclic", "cyclic", NULL, NULL, "empty", "empty"}};
    for (int forest = 0; forest < 2; forest++) {
        struct fixture x;
        begin(&x, &r, forest, 2);
        double most = 0;
        const double w = 2 * 3.14159265358979323846 / 4; /* of a domain 4 long */
        for (long b = 0, at = 0; b < x.g->nblocks; b++)
            for (int i = 0; i < x.g->block[b].ncells; i++, at++)
                x.values[0][at] = sin(w * x.centre[3L * x.g->block[b].cell[i]]);
        ok(grid_gradients(x.g, 1, (const double *const *)x.values, x.gradient));
        for (long b = 0, at = 0; b < x.g->nblocks; b++)
            for (int i = 0; i < x.g->block[b].ncells; i++, at++) {
                const double here = x.centre[3L * x.g->block[b].cell[i]];
                most = fmax(most, fabs(x.gradient[0][at] - w * cos(w * here)));
            }
        comm_max(world, &most, 1);
        /* central differences over h: w (w h)^2/6 = 6.5e-3 at h = 0.1, beside a patch twice that; fits over h and 2 h
         * with weights 1 and 1/4: 2.5 times that */
        assert_true(most < (forest ? 1.02 : 2.6) * w * w * w * 0.01 / 6);
        end(&x);
    }
}

/* On meshes moved by a tenth of their width, which are no refinements of each other: the error falls by 4 with each
 * halving in the limit, here by more than 3. */
static void warped_meshes_converge_at_second_order(void **state) {
    (void)state;
    double error[2];
    for (int level = 0; level < 2; level++) {
        struct fixture x;
        const int n = level ? 16 : 8;
        const struct recipe r = {.n = {n, n, n}, .width = {1. / n, 1. / n, 1. / n}, .noise = 0.1};
        begin(&x, &r, false, 2);
        error[level] = error_of(&x, (field *const[2]){linear, wave}, -1);
        end(&x);
    }
    print_message("warped: %g %g\n", error[0], error[1]);
    assert_true(error[1] < error[0] / 3);
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return status_print(s, true);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_and_quadratic_values_are_exact),
        cmocka_unit_test(periodic_values_are_seen_across),
        cmocka_unit_test(warped_meshes_converge_at_second_order),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
