/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implicit diffusion on polyhedra beside that on tiles, explicit results, and fewer ranks. */
#include "tests/libcore/gas/viscous.h" /* last: cmocka.h defines fail() */

static struct comm *world, *alone;

#define OPEN                                                                                                           \
    { false, false, false }

/* Walls of every kind that stress and heat know; `mirrors`: none that drags. */
static void choose(struct scene *s, int dim, const struct transport *law, bool mirrors, const char *diffusion) {
    *s = (struct scene){.dim = dim, .models = disks_models(law, diffusion)};
    set_walls(s, mirrors ? "slip" : "noSlip");
    for (int p = 0; p < 2; p++)
        s->rules[p].temperature = (struct rule){.type = boundary_find("fixedValue"), .uniform = {3 + p}};
    s->rules[3].temperature = (struct rule){.type = boundary_find("granularWall"), .params = {{0.8}}};
    if (mirrors) return;
    s->rules[0].velocity = (struct rule){.type = boundary_find("JohnsonJacksonSlip"), .params = {{0.6, 0.8}}};
    s->rules[1].velocity = (struct rule){.type = boundary_find("slip")};
    s->rules[2].velocity = (struct rule){.type = boundary_find("translatingWallVelocity"), .params = {{0.5}}};
}

/* Where cell i of one scene is in another. */
static int same_cell(const struct scene *a, int i, const struct scene *b) {
    for (int j = 0; j < b->cells; j++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            const double off = b->centre[3 * j + k] - a->centre[3 * i + k];
            square += off * off;
        }
        if (square < 1e-12) return j;
    }
    fail_msg("no cell");
    return 0;
}

static void assert_few_iterations(const struct scene *s, int steps, int most) {
    const struct gas_counts n = gas_counts(s->gas);
    print_message("%g and %g iterations a step\n", (double)n.stages[VISCOUS] / steps, (double)n.stages[HEAT] / steps);
    for (int what = 0; what < 2; what++) assert_in_range(n.stages[what], steps, steps * most);
}

/* The same equations, so the same solution to what both solvers leave. */
static void boxes_are_a_lattice(void **state) {
    (void)state;
    for (int dim = 1; dim <= 3; dim++) {
        const int n = dim == 3 ? 8 : 16;
        const struct cells_recipe r = {
            "boxes", dim, BOXES, {n, dim > 1 ? n : 1, dim > 2 ? 2 : 1}, {0, 1, 2}, 0, {false, false, true}};
        struct scene s[2];
        double *end[2];
        for (int i = 0; i < 2; i++) {
            choose(&s[i], dim, &VARIED, true, "implicit");
            if (i)
                open_cells(&s[i], world, &r);
            else
                open_box(&s[i], world, dim, r.n, (double[3]){1, 1, 1}, r.cyclic, 8);
            start(&s[i], manufactured_fields);
            spread(&s[i], 4, 0.005);
            assert_few_iterations(&s[i], 4, comm_size(world) == 1 ? 10 : 20);
            end[i] = state_of(&s[i], world);
        }
        for (int i = 0; i < s[0].cells; i++) {
            const int same = same_cell(&s[0], i, &s[1]);
            for (int v = 0; v < dim + 2; v++)
                assert_near(end[1][v * s[1].cells + same], end[0][v * s[0].cells + i], 1e-5);
        }
        for (int i = 0; i < 2; i++) {
            free(end[i]);
            close_scene(&s[i]);
        }
    }
}

static const struct cells_recipe rough[] = {
    {"triangles", 2, PRISMS, {10, 10, 1}, {0, 1, 2}, 0.2, OPEN},
    {"tetrahedra", 3, TETS, {5, 5, 2}, {0, 1, 2}, 0.1, {false, false, true}},
};
enum { ROUGH = sizeof rough / sizeof *rough };

/* The state after n steps; iterations: the most of a step, 0: not counted. */
static double *spread_out(const struct cells_recipe *r, const char *scheme, int steps, int iterations, int *numbers) {
    struct scene s;
    choose(&s, r->dim, &OF_DENSITY, false, scheme);
    open_reshaped(&s, world, r, false, 0.3);
    start(&s, manufactured_fields);
    spread(&s, steps, 0.02 / steps);
    if (iterations) assert_few_iterations(&s, steps, iterations);
    assert_true(gas_counts(s.gas).repeated == 0);
    double *end = state_of(&s, world);
    *numbers = (s.dim + 2) * s.cells;
    close_scene(&s);
    return end;
}

/* Steps of each implicit scheme converge in second order towards the result of many explicit ones. */
static void many_steps_come_to_the_same(void **state) {
    (void)state;
    static const char *const schemes[] = {"implicit", "implicitMidpoint", "gaussLegendre"};
    if (comm_size(world) > 1) skip(); /* the next one */
    for (int b = 0; b < ROUGH; b++) {
        int n;
        double *exact = spread_out(&rough[b], "explicit", 400, 0, &n);
        for (int scheme = 0; scheme < 3; scheme++) {
            double error[2] = {0, 0};
            for (int k = 0; k < 2; k++) {
                double *end = spread_out(&rough[b], schemes[scheme], 32 << k, scheme == 2 ? 40 : 8, &n);
                for (int i = 0; i < n; i++) error[k] = fmax(error[k], fabs(end[i] - exact[i]));
                free(end);
            }
            print_message("%s, %s: %.3g, %.3g\n", rough[b].name, schemes[scheme], error[0], error[1]);
            assert_true(log2(error[0] / error[1]) > 1.8);
            assert_near(error[1], 0, 5e-4);
        }
        free(exact);
    }
}

/* A few whole steps on these ranks and on one; a rank may have no cells. */
static void ranks_agree(void **state) {
    (void)state;
    for (int b = 0; b < ROUGH; b++) {
        double *end[2], most[MAX_VAR] = {0};
        int cells = 0;
        for (int i = 0; i < 2; i++) {
            struct scene s;
            choose(&s, rough[b].dim, transport_find("JenkinsRichman"), false, "implicit");
            if (s.dim == 3) s.models = spheres_models(0.8, 0.2, true, "implicit");
            open_reshaped(&s, i ? alone : world, &rough[b], false, 0.3);
            start(&s, manufactured_fields);
            go(&s, 2, 1e-3);
            end[i] = state_of(&s, i ? alone : world);
            cells = s.cells;
            close_scene(&s);
        }
        for (int v = 0; v < rough[b].dim + 2; v++) {
            for (int i = v * cells; i < (v + 1) * cells; i++) most[v] = fmax(most[v], fabs(end[1][i]));
            for (int i = v * cells; i < (v + 1) * cells; i++) assert_near(end[0][i], end[1][i], 1e-5 * most[v]);
        }
        for (int i = 0; i < 2; i++) free(end[i]);
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (!s) s = comm_alone(&alone);
    if (s) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(boxes_are_a_lattice),
        cmocka_unit_test(many_steps_come_to_the_same),
        cmocka_unit_test(ranks_agree),
    };
    int failed = linear_module() ? cmocka_run_group_tests(tests, NULL, NULL) : SKIPPED;
    comm_alone_free(alone);
    comm_finish(world);
    return failed;
}
