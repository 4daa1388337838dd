/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Smooth faces of the flux `common`: which faces they are, and which flux those get. */
#include "libcore/schemes/flux_rules.h"

#include "tests/libcore/oracle.h"

#include "tests/libcore/schemes/strip.h"

enum { FACE = 5 };

/* A wave of all variables, `length` cells long, of the given height, about the middle of face FACE. */
static struct strip wave(int dim, double length, double height, double u) {
    struct strip s = {.dim = dim};
    for (int i = 0; i < CELLS; i++) {
        const double swing = height * sin(0.4 + 2 * acos(-1) * (i - FACE) / length);
        s.U[0][i] = 1 + swing;
        s.eps[i] = 3 - swing;
        for (int k = 0; k < dim; k++) s.u[k][i] = u + (k + 1) * swing;
    }
    close_strip(&s);
    return s;
}

static void flux_by(struct strip *s, bool smooth, const char *reconstruct, int face, int n) {
    const struct flux *common = flux_find("common");
    struct own_params params = {{0}};
    for (int i = 0; i < common->model.nparam; i++) model_put(&common->model, &params, common->model.param[i].name, 0);
    model_put(&common->model, &params, "smooth", smooth);
    flux_with(s, common, reconstruct_find(reconstruct), face, n, &params);
}

static bool is_smooth(const struct strip *s, const char *reconstruct, int face) {
    struct strip with = *s, without = *s;
    bool same = true;
    flux_by(&with, true, reconstruct, face, 1);
    flux_by(&without, false, reconstruct, face, 1);
    for (int v = 0; v < s->dim + 2; v++) same &= with.out[v][0] == without.out[v][0];
    return !same;
}

/* Fine waves are smooth for the schemes of five points alone; coarse ones, steps, shears and gas under gravity are not.
 */
static void faces_are_told_apart(void **state) {
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct strip fine = wave(dim, 24, 0.05, 0.3), coarse = wave(dim, 4, 0.05, 0.3), step = fine;
        for (const char *const *r = (const char *const[]){"WPENO5", "WENO5", "WENOZ", "TENO5", NULL}; *r; r++)
            assert_true(is_smooth(&fine, *r, FACE));
        assert_false(is_smooth(&fine, "PHM", FACE));
        assert_false(is_smooth(&fine, "firstOrder", FACE));
        assert_false(is_smooth(&coarse, "WPENO5", FACE));
        fine.falls = true;
        assert_false(is_smooth(&fine, "WPENO5", FACE));
        for (int i = FACE + 3; i < CELLS; i++) step.U[0][i] *= 1.2;
        close_strip(&step);
        assert_false(is_smooth(&step, "WPENO5", FACE));
        for (int k = 1; k < dim; k++) { /* a shear that rho and p do not see */
            struct strip sheared = wave(dim, 24, 0, 0.3);
            for (int i = 0; i < CELLS; i++) sheared.u[k][i] = i > FACE ? 1 : -1;
            close_strip(&sheared);
            assert_false(is_smooth(&sheared, "WPENO5", FACE));
        }
    }
}

/* A shear of a thousandth of c that a wall mirrors has a kink and is rough, with two cells that are equal; a straight
 * one is not. */
static void kinks_at_walls_count(void **state) {
    (void)state;
    for (int wall = FACE - 2; wall <= FACE + 2; wall++) { /* between cells `wall` and `wall + 1` */
        struct strip straight = wave(2, 24, 0.01, 0.3), kinked = straight;
        for (int i = 0; i < CELLS; i++) {
            straight.u[1][i] = 1e-3 * (i - wall - 0.5);
            kinked.u[1][i] = fabs(straight.u[1][i]);
        }
        close_strip(&straight);
        close_strip(&kinked);
        assert_true(is_smooth(&straight, "WPENO5", FACE));
        assert_false(is_smooth(&kinked, "WPENO5", FACE));
    }
}

/* Gas that is uniform on three cells of one side keeps the nonlinear flux; where all is uniform the flux is that of the
 * cells to the bit. */
static void uniform_gas_stays(void **state) {
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        struct strip s = wave(dim, 24, 1e-6, 0.3), all = wave(dim, 24, 0, 0.3);
        assert_true(is_smooth(&s, "WPENO5", FACE));
        for (int i = FACE - 1; i >= 0; i--) {
            s.U[0][i] = s.U[0][FACE];
            s.eps[i] = s.eps[FACE];
            for (int k = 0; k < dim; k++) s.u[k][i] = s.u[k][FACE];
        }
        close_strip(&s);
        assert_false(is_smooth(&s, "WPENO5", FACE));
        flux_by(&all, true, "WPENO5", FACE, 1);
        for (int v = 0; v < dim + 2; v++) assert_true(all.out[v][0] == all.F[v][FACE]);
    }
}

/* The flux of a face is the same in every batch that holds it, smooth faces or not beside it. */
static void batches_do_not_matter(void **state) {
    (void)state;
    struct strip s = wave(3, 24, 0.05, 0.3);
    s.eps[10] *= 2;
    close_strip(&s);
    struct strip whole = s;
    flux_by(&whole, true, "WENOZ", 2, CELLS - 5);
    for (int i = 0; i < CELLS - 5; i++) {
        flux_by(&s, true, "WENOZ", 2 + i, 1);
        for (int v = 0; v < s.dim + 2; v++) assert_true(s.out[v][0] == whole.out[v][i]);
    }
}

/* The mirror image of a strip has the mirror image of the flux, to the bit. */
static void mirrors_agree(void **state) {
    (void)state;
    struct strip s = wave(2, 30, 0.03, 0.1), t = s;
    for (int i = 0; i < CELLS; i++) {
        t.U[0][i] = s.U[0][CELLS - 1 - i];
        t.eps[i] = s.eps[CELLS - 1 - i];
        t.u[0][i] = -s.u[0][CELLS - 1 - i];
        t.u[1][i] = s.u[1][CELLS - 1 - i];
    }
    close_strip(&t);
    flux_by(&s, true, "WPENO5", FACE, 1);
    flux_by(&t, true, "WPENO5", CELLS - 2 - FACE, 1);
    for (int v = 0; v < 4; v++) assert_true(s.out[v][0] == (v == 1 ? t.out[v][0] : -t.out[v][0]));
}

/* The difference of the fluxes of two faces is of fifth order: with cells half as wide the error of the flux of the
 * mass, whose values at cells are averages of the flux's primitive, falls 2^5 times. */
static double error_of(int cells) {
    struct strip s = {.dim = 1};
    const double pi = acos(-1), h = 2 * pi / cells;
    for (int i = 0; i < CELLS; i++) { /* density carried at constant u and p: F of the mass is u rho */
        const double x = 0.6 + h * (i - FACE), unit = 1,
                     rho = 1 + 0.1 * (cos(x - h) - cos(x)) / h; /* x: its right face */
        double p, c2, g;
        eos_find("GoldshteinShapiro")->state(&granular, 1, &rho, &unit, &p, &c2, &g);
        s.U[0][i] = rho;
        s.eps[i] = 2 / p;
        s.u[0][i] = 0.7;
    }
    close_strip(&s);
    flux_by(&s, true, "WENO5", FACE, 1);
    return fabs(s.out[0][0] - 0.7 * (1 + 0.1 * sin(0.6)));
}
static void order_is_five(void **state) {
    (void)state;
    const double coarse = error_of(40), fine = error_of(80);
    if (!(coarse > 24 * fine)) fail_msg("errors %g and %g", coarse, fine);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(faces_are_told_apart), cmocka_unit_test(uniform_gas_stays),
        cmocka_unit_test(kinks_at_walls_count), cmocka_unit_test(batches_do_not_matter),
        cmocka_unit_test(mirrors_agree),        cmocka_unit_test(order_is_five),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
