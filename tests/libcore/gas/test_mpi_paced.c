/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fluxes that depend on dt/dx: which dt and dx their faces get, on a lattice and on polyhedra. */
#include "libcore/gas/gas.h"

#include "tests/libcore/oracle.h" /* last: cmocka.h defines fail() */
#include "tests/libcore/scene.h"

static struct comm *world;

static void set_models(struct scene *s, const char *eos, const char *flux, const char *stepper) {
    *s = (struct scene){
        .models = {.material = {.diameter = 0.1, .mass = 1, .restitution = 1, .gamma = 5. / 3, .alpha_max = 0.65},
                   .eos = eos_find(eos),
                   .flux = flux_find(flux),
                   .flux_params = own_defaults(&flux_find(flux)->model),
                   .reconstruct = reconstruct_find("firstOrder"),
                   .polynomial = polynomial_find("firstOrder"),
                   .stepper = stepper_find(stepper)}};
    set_walls(s, "slip");
}

/* Waves whose values belong to boxes of 0.1 by 0.2 by 0.3 that are numbered along x, y, z. */
static void start(struct scene *s) {
    const int n = s->cells;
    double *all = calloc(5 * (size_t)n, sizeof *all), *u[3] = {all + n, all + 2 * n, all + 3 * n};
    for (int i = 0; i < n; i++) {
        double x[3] = {0, 0, 0};
        for (int k = 0; k < s->dim; k++) x[k] = round(s->centre[3 * i + k] / (0.1 * (k + 1)) + 0.5);
        all[i] = 300 + 150 * sin(x[0] + 2 * x[1] - x[2]);
        all[4 * n + i] = 2 + cos(x[0] * x[1] + x[2]);
        for (int k = 0; k < s->dim; k++) u[k][i] = 3 * sin(x[k] + 0.1 * k) + k;
    }
    ok(gas_set(s->gas, all, (const double *const *)u, all + 4 * n));
    free(all);
}

static void go(struct scene *s, int steps, double dt) {
    struct gas_speed speed;
    for (int i = 0; i < steps; i++) {
        double given = dt;
        gas_speed(s->gas, &speed);
        assert_true(dt * speed.rate < 1);
        ok(gas_step(s->gas, i * dt, &given, 1, 0, 0, &speed));
        assert_true(given == dt);
    }
}

/* On boxes both engines give their faces the same dt/dx, that of the whole step in every stage: at first order the
 * states agree to round-off. */
static void boxes_are_boxes(void **state) {
    (void)state;
    for (int round = 0; round < 6; round++) {
        const int dim = 1 + round / 2, n[3] = {dim == 1 ? 30 : 9, dim > 1 ? 7 : 1, dim > 2 ? 5 : 1};
        const char *flux = round % 2 ? "MUSTA" : "FORCE";
        struct scene s, t;
        set_models(&s, "GoldshteinShapiro", flux, "SSPRK43");
        t = s;
        open_box(&s, world, dim, n, (double[3]){0.1 * n[0], 0.2 * n[1], 0.3 * n[2]}, (bool[3]){false}, 8);
        open_polyhedra(&t, world,
                       &(struct cells_recipe){"boxes", dim, BOXES, {n[0], n[1], n[2]}, {0, 1, 2}, 0, {false}});
        start(&s);
        start(&t);
        go(&s, 8, 1e-3);
        go(&t, 8, 1e-3);
        double *a = state_of(&s, world), *b = state_of(&t, world), scale[MAX_VAR] = {0};
        for (int i = 0; i < (dim + 2) * s.cells; i++) scale[i / s.cells] = fmax(scale[i / s.cells], fabs(a[i]));
        for (int i = 0; i < s.cells; i++) {
            long at = 0;
            for (int k = dim - 1; k >= 0; k--) at = at * n[k] + lround(t.centre[3 * i + k] / (0.1 * (k + 1)) - 0.5);
            for (int v = 0; v < dim + 2; v++) assert_near(b[v * s.cells + i], a[v * s.cells + at], 1e-11 * scale[v]);
        }
        free(a);
        free(b);
        close_scene(&s);
        close_scene(&t);
    }
}

/* The flux of FORCE of a perfect gas (gamma = 5/3) between two states. */
static void force(const double U[2][3], double pace, double out[3]) {
    double f[3][3], middle[3] = {0};
    for (int side = 0; side < 3; side++) {
        const double *q = side < 2 ? U[side] : middle, u = q[1] / q[0], p = 2. / 3 * (q[2] - 0.5 * q[1] * u);
        f[side][0] = q[1];
        f[side][1] = q[1] * u + p;
        f[side][2] = (q[2] + p) * u;
        for (int v = 0; v < 3 && side == 1; v++)
            middle[v] = 0.5 * (U[0][v] + U[1][v]) - 0.5 * pace * (f[1][v] - f[0][v]);
    }
    for (int v = 0; v < 3; v++) out[v] = 0.25 * (f[0][v] + f[1][v] + 2 * f[2][v] - (U[1][v] - U[0][v]) / pace);
}

/* Between cells of different widths dx is the harmonic mean of both: dt/dx = dt (1/h_l + 1/h_r)/2. */
static void cells_of_different_widths(void **state) {
    (void)state;
    const struct cells_recipe r = {"line", 1, BOXES, {30, 1, 1}, {0, 1, 2}, 0.4, {false, false, false}};
    const double dt = 1e-3;
    struct scene s;
    double width[30], edge = 0;
    set_models(&s, "perfectGas", "FORCE", "Euler");
    open_polyhedra(&s, world, &r);
    start(&s);
    double *before = state_of(&s, world);
    go(&s, 1, dt);
    double *after = state_of(&s, world);
    for (int i = 0; i < 30; i++) {
        width[i] = 2 * (s.centre[3 * i] - edge);
        edge += width[i];
    }
    assert_near(edge, 3, 1e-12);
    for (int i = 1; i < 29; i++) {
        double flux[2][3];
        for (int side = 0; side < 2; side++) {
            const int l = i - 1 + side;
            double U[2][3];
            for (int v = 0; v < 6; v++) U[v / 3][v % 3] = before[v % 3 * 30 + l + v / 3];
            force((const double(*)[3])U, 0.5 * dt * (1 / width[l] + 1 / width[l + 1]), flux[side]);
        }
        for (int v = 0; v < 3; v++) {
            const double known = before[v * 30 + i] + dt / width[i] * (flux[0][v] - flux[1][v]);
            assert_near(after[v * 30 + i], known, 1e-11 * (fabs(known) + before[60 + i]));
        }
    }
    free(before);
    free(after);
    close_scene(&s);
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_are_boxes),
        cmocka_unit_test(cells_of_different_widths),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
