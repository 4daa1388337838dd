/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whole steps of the gas on polyhedra: free stream, conservation, order, bits, the limiter; against the tiles. */
#include "tests/libcore/polyhedral/scene.h"

#define OPEN                                                                                                           \
    { false, false, false }
#define CYCLIC                                                                                                         \
    { true, true, true }
static const struct cells_recipe boxes[] = {
    {"line", 1, BOXES, {41, 1, 1}, {0, 1, 2}, 0.3, OPEN},
    {"quads", 2, BOXES, {11, 9, 1}, {0, 1, 2}, 0.2, OPEN},
    {"triangles", 2, PRISMS, {10, 9, 1}, {0, 2, 1}, 0.2, OPEN},
    {"warped hexahedra", 3, BOXES, {6, 5, 6}, {0, 1, 2}, 0.2, OPEN},
    {"tetrahedra", 3, TETS, {4, 4, 4}, {0, 1, 2}, 0.15, OPEN},
    {"periodic quads", 2, BOXES, {11, 9, 1}, {0, 1, 2}, 0.2, CYCLIC},
    {"periodic triangles", 2, PRISMS, {10, 9, 1}, {0, 1, 2}, 0.2, CYCLIC},
    {"periodic prisms", 3, PRISMS, {5, 6, 5}, {0, 1, 2}, 0.2, CYCLIC},
    {"periodic tetrahedra", 3, TETS, {4, 4, 4}, {0, 1, 2}, 0.15, CYCLIC},
};
enum { BOX_COUNT = sizeof boxes / sizeof *boxes };

static void stream(const struct scene *s, const double x[3], double *rho, double u[3], double *T) {
    (void)x;
    *rho = 343.7;
    *T = 14.39;
    const double velocity[3] = {44.5, -14.5, 3};
    for (int k = 0; k < s->dim; k++) u[k] = velocity[k];
}

/* Areas times normals close every cell to round-off, and so a uniform stream keeps its state to it. Where polynomials
 * are fitted, all cells stay equal to the bit. */
static void free_stream(void **state) {
    (void)state;
    for (int b = 0; b < BOX_COUNT; b++)
        for (int p = 0; p < polynomial_count; p++) {
            struct scene s;
            if (!boxes[b].cyclic[0]) continue;
            open_scene(&s, &boxes[b], "GoldshteinShapiro", "common", polynomial_table[p].model.name);
            start(&s, stream);
            double *before = state_of(&s);
            run(&s, 20, 0.5, 1e9);
            double *after = state_of(&s);
            for (int i = 0; i < (s.dim + 2) * s.cells; i++) {
                double scale = fabs(before[i / s.cells == s.dim + 1 ? i : s.cells]) + fabs(before[i]);
                if (!(fabs(after[i] - before[i]) <= 1e-12 * scale))
                    fail_msg("%s, %s: %g becomes %.17g", boxes[b].name, polynomial_table[p].model.name, before[i],
                             after[i]);
                assert_true(p == 0 || after[i] == after[i - i % s.cells]);
            }
            free(before);
            free(after);
            close_scene(&s);
        }
}

/* A puff in a stream. */
static void puff(const struct scene *s, const double x[3], double *rho, double u[3], double *T) {
    double square = 0;
    for (int k = 0; k < s->dim; k++) square += pow(x[s->grid->axis[k]] / s->length[s->grid->axis[k]] - 0.3, 2);
    stream(s, x, rho, u, T);
    *rho *= square < 0.002 ? 1.2 : 1;
    *T *= square < 0.002 ? 1.5 : 1;
}

static void puff_at_rest(const struct scene *s, const double x[3], double *rho, double u[3], double *T) {
    puff(s, x, rho, u, T);
    for (int k = 0; k < s->dim; k++) u[k] = 0;
}

/* Gas ahead of a disturbance costs little (docs/physics.md 6.13): the same bits as where all cells are computed, and
 * those out of reach of the puff are still equal. */
static void uniform_gas_is_left_out(void **state) {
    static const struct cells_recipe large[] = {{"triangles", 2, PRISMS, {40, 36, 1}, {0, 1, 2}, 0.2, CYCLIC},
                                                {"quads", 2, BOXES, {48, 40, 1}, {0, 1, 2}, 0.2, CYCLIC},
                                                {"open triangles", 2, PRISMS, {40, 36, 1}, {0, 1, 2}, 0.2, OPEN}};
    (void)state;
    for (int k = 0; k < 6; k++) {
        initial *begin = large[k / 2].cyclic[0] ? puff : puff_at_rest;
        struct scene s;
        open_scene(&s, &large[k / 2], "GoldshteinShapiro", "common", k % 2 ? "CWENO3" : "linear");
        start(&s, begin);
        run(&s, 3, 0.5, 1e9);
        double *some = state_of(&s);
        assert_true(gas_computed_share(s.gas) < 0.98);
        gas_free(s.gas);
        s.models.skip_uniform = false;
        ok(gas_make_polyhedral(s.grid, &s.models, 6, s.rules, &s.gas));
        start(&s, begin);
        run(&s, 3, 0.5, 1e9);
        double *all = state_of(&s);
        assert_memory_equal(some, all, (size_t)((s.dim + 2) * s.cells) * sizeof(double));
        int equal = 0;
        for (int i = 0; i < s.cells; i++) equal += all[i] == all[s.cells - 1];
        assert_true(equal > s.cells / 10);
        free(some);
        free(all);
        close_scene(&s);
    }
}

static void splash(const struct scene *s, const double x[3], double *rho, double u[3], double *T) {
    double a = 6.283185307179586 * x[s->grid->axis[0]] / s->length[0], b = 0;
    if (s->dim > 1) b = 6.283185307179586 * x[s->grid->axis[1]] / s->length[1];
    *rho = 300 + 150 * sin(a + b);
    *T = 2 + cos(a - b);
    for (int k = 0; k < s->dim; k++) u[k] = 2 * sin(a + k) + 0.3 * k;
}

static void conservation(void **state) {
    (void)state;
    for (int b = 0; b < BOX_COUNT; b++)
        for (int flux = 0; flux < flux_count; flux++)
            for (int p = flux ? polynomial_count - 1 : 0; p < polynomial_count; p++) {
                struct scene s;
                double before[MAX_VAR], after[MAX_VAR];
                open_scene(&s, &boxes[b], "GoldshteinShapiro", flux_table[flux].model.name,
                           polynomial_table[p].model.name);
                start(&s, splash);
                ok(gas_totals(s.gas, before));
                run(&s, 10, 0.5, 1e9);
                ok(gas_totals(s.gas, after));
                double scale = before[s.dim + 1];
                if (!(fabs(after[0] - before[0]) < 1e-13 * before[0]))
                    fail_msg("%s, %s, %s: mass %.17g becomes %.17g", boxes[b].name, flux_table[flux].model.name,
                             polynomial_table[p].model.name, before[0], after[0]);
                assert_true(fabs(after[s.dim + 1] - before[s.dim + 1]) < 1e-13 * scale);
                for (int k = 1; k <= s.dim && boxes[b].cyclic[0]; k++)
                    assert_true(fabs(after[k] - before[k]) < 1e-13 * scale);
                ok(gas_check(s.gas));
                close_scene(&s);
            }
}

/* A wave of density carried by a uniform stream of a perfect gas: an exact solution, in which all conserved variables
 * are linear in the density, so that cell averages follow from its moments (to third order). */
static double wave_average(const struct scene *s, int local, double t, const double u[3]) {
    const struct polyhedra *m = s->grid->polyhedra;
    double phase = 0, k[3] = {0}, mean = 0;
    for (int a = 0; a < s->dim; a++) {
        k[a] = 6.283185307179586 / s->length[a];
        phase += k[a] * (m->centre[a][local] - u[a] * t);
    }
    for (int a = 0, j = 0; a < s->dim; a++)
        for (int b = a; b < s->dim; b++, j++) mean += (a == b ? 0.5 : 1) * k[a] * k[b] * m->moment[j][local];
    return 1 + 0.4 * sin(phase) * (1 - mean);
}

static double wave_error(const struct cells_recipe *r, const char *polynomial) {
    static const double u[3] = {1, 0.6, 0.4};
    struct scene s;
    open_scene(&s, r, "perfectGas", "common", polynomial);
    const struct polyhedra *m = s.grid->polyhedra;
    double *all = calloc(5 * (size_t)s.cells, sizeof *all), *U[MAX_VAR], end = 0.1 * s.length[0], square = 0;
    for (int v = 0; v < s.dim + 2; v++) U[v] = all + v * s.cells;
    for (int k = 0; k < s.dim; k++) square += u[k] * u[k];
    for (int i = 0; i < m->nown; i++) {
        double rho = wave_average(&s, i, 0, u);
        U[0][m->cell[i]] = rho;
        for (int k = 0; k < s.dim; k++) U[k + 1][m->cell[i]] = rho * u[k];
        U[s.dim + 1][m->cell[i]] = 1 / (5. / 3 - 1) + 0.5 * rho * square;
    }
    gas_set_conserved(s.gas, (const double *const *)U);
    run(&s, 10000, 0.4, end);
    double *found = state_of(&s), error[2] = {0, 0};
    for (int i = 0; i < m->nown; i++) {
        error[0] += m->volume[i] * fabs(found[m->cell[i]] - wave_average(&s, i, end, u));
        error[1] += m->volume[i];
    }
    double *parts;
    long total;
    ok(comm_gather(world, error, 2, &parts, &total));
    error[0] = error[1] = 0;
    for (long i = 0; parts && i < total; i++) error[i % 2] += parts[i];
    free(parts);
    comm_broadcast(world, error, sizeof error);
    free(found);
    free(all);
    close_scene(&s);
    return error[0] / error[1];
}

static void order_on_perturbed_meshes(void **state) {
    (void)state;
    static const struct {
        struct cells_recipe recipe;
        const char *polynomial;
        double order;
    } cases[] = {
        {{"line", 1, BOXES, {40, 1, 1}, {0, 1, 2}, 0.2, CYCLIC}, "firstOrder", 0.8},
        {{"triangles", 2, PRISMS, {16, 16, 1}, {0, 1, 2}, 0.15, CYCLIC}, "linear", 1.7},
        {{"tetrahedra", 3, TETS, {6, 6, 6}, {0, 1, 2}, 0.1, CYCLIC}, "linear", 1.7},
        {{"line", 1, BOXES, {40, 1, 1}, {0, 1, 2}, 0.2, CYCLIC}, "CWENO3", 2.7},
        {{"quads", 2, BOXES, {16, 16, 1}, {0, 1, 2}, 0.15, CYCLIC}, "CWENO3", 2.8},
        {{"triangles", 2, PRISMS, {16, 16, 1}, {0, 1, 2}, 0.15, CYCLIC}, "CWENO3", 2.8},
        {{"tetrahedra", 3, TETS, {8, 8, 8}, {0, 1, 2}, 0.1, CYCLIC}, "CWENO3", 2.3},
    };
    for (int c = 0; c < (int)(sizeof cases / sizeof *cases); c++) {
        struct cells_recipe fine = cases[c].recipe;
        for (int k = 0; k < fine.dim; k++) fine.n[k] *= 2;
        double coarse = wave_error(&cases[c].recipe, cases[c].polynomial),
               error = wave_error(&fine, cases[c].polynomial);
        double order = log2(coarse / error);
        print_message("%s, %s: %.3g, %.3g: order %.2f\n", fine.name, cases[c].polynomial, coarse, error, order);
        assert_true(order > cases[c].order);
    }
}

static void slab(const struct scene *s, const double x[3], double *rho, double u[3], double *T) {
    bool in = x[s->grid->axis[0]] < 0.5 * s->length[0];
    *rho = in ? 600 : 30;
    *T = in ? 8 : 0.5;
    for (int k = 0; k < s->dim; k++) u[k] = in ? -12 + k : 12; /* towards vacuum in the middle */
}

/* A strong rarefaction and, at its walls, strong shocks: cells are limited, mass and energy stay. */
static void vacuum(void **state) {
    (void)state;
    long mended = 0;
    for (int b = 0; b < 5; b++)
        for (int p = 0; p < polynomial_count; p++) {
            struct scene s;
            double before[MAX_VAR], after[MAX_VAR];
            open_scene(&s, &boxes[b], "GoldshteinShapiro", "common", polynomial_table[p].model.name);
            start(&s, slab);
            ok(gas_totals(s.gas, before));
            run(&s, 40, 0.5, 1e9);
            ok(gas_totals(s.gas, after));
            ok(gas_check(s.gas));
            assert_true(fabs(after[0] - before[0]) < 1e-13 * before[0]);
            assert_true(fabs(after[s.dim + 1] - before[s.dim + 1]) < 1e-12 * before[s.dim + 1]);
            mended += gas_counts(s.gas).cells;
            close_scene(&s);
        }
    print_message("%ld cells mended\n", mended);
    assert_true(mended > 0);
}

int main(int argc, char **argv) {
    ok(comm_start(&argc, &argv, &world));
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(free_stream),  cmocka_unit_test(uniform_gas_is_left_out),
        cmocka_unit_test(conservation), cmocka_unit_test(order_on_perturbed_meshes),
        cmocka_unit_test(vacuum),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
