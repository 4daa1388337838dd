/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The density floor: gas that flies apart stays above it on both mesh engines, what that adds is counted to round-off,
 * whatever the Runge-Kutta scheme, and the bits are those of one rank. */
#include "tests/libcore/scene.h" /* last: cmocka.h defines fail() */

static struct comm *world, *alone;
static const double FLOOR = 1e-4;

static void set_models(struct scene *s, const char *stepper) {
    memset(s, 0, sizeof *s);
    s->models = (struct gas_models){
        .material = {.diameter = 0.1, .mass = 1, .restitution = 0.9, .gamma = 5. / 3, .alpha_max = 0.65},
        .eos = eos_find("GoldshteinShapiro"),
        .flux = flux_find("common"),
        .reconstruct = reconstruct_find("WENO5"),
        .polynomial = polynomial_find("CWENO3"),
        .stepper = stepper_find(stepper),
        .alpha_floor = FLOOR,
        .skip_uniform = true};
    set_walls(s, "slip");
}

static void open_lattice(struct scene *s, const struct comm *c) {
    open_box(s, c, 1, (int[3]){100, 1, 1}, (double[3]){1, 1, 1}, (bool[3]){false, false, false}, 16);
}

static void open_triangles(struct scene *s, const struct comm *c) {
    static const struct cells_recipe r = {"triangles", 2, PRISMS, {16, 5, 1}, {0, 1, 2}, 0.2, {false, false, false}};
    open_polyhedra(s, c, &r);
}

/* Gas of packing fraction alpha flies apart at Mach numbers of some 10 from the middle of the box. */
static status start(struct scene *s, double alpha) {
    const int n = s->cells;
    double *all = calloc(5 * (size_t)n, sizeof *all), *u[3] = {all + n, all + 2 * n, all + 3 * n}, low = 1e30, high = 0;
    for (int i = 0; i < n; i++) {
        low = fmin(low, s->centre[3 * i]);
        high = fmax(high, s->centre[3 * i]);
    }
    for (int i = 0; i < n; i++) {
        all[i] = alpha * 6e3 / 3.14159265358979324;
        u[0][i] = s->centre[3 * i] < 0.5 * (low + high) ? -20 : 20;
        all[4 * n + i] = 1;
    }
    ok(gas_set(s->gas, all, (const double *const *)u, all + 4 * n));
    free(all);
    return gas_check(s->gas);
}

static void fly_apart(void (*open)(struct scene *, const struct comm *), const char *stepper, double alpha, int steps) {
    struct scene s, one;
    double before[MAX_VAR], after[MAX_VAR], least = HUGE_VAL;
    set_models(&s, stepper);
    one = s;
    open(&s, world);
    open(&one, alone);
    ok(start(&s, alpha));
    ok(start(&one, alpha));
    const int energy = gas_variables(s.gas) - 1;
    ok(gas_totals(s.gas, before));
    run(&s, steps, 0.4);
    run(&one, steps, 0.4);
    ok(gas_totals(s.gas, after));
    const struct gas_counts n = gas_counts(s.gas), m = gas_counts(one.gas);
    print_message("%s: %ld cells, mass %.3g of %.3g, %ld rejected\n", stepper, n.filled, n.fill[0], before[0],
                  n.rejected);
    assert_true(n.filled > 0 && n.fill[0] > 1e-8 * before[0]);
    if (!(fabs(after[0] - before[0] - n.fill[0]) <= 1e-13 * before[0]))
        fail_msg("%s: mass %.17g becomes %.17g, counted %.17g", stepper, before[0], after[0], n.fill[0]);
    if (!(fabs(after[energy] - before[energy] - n.fill[1] - n.energy) <= 1e-12 * before[energy]))
        fail_msg("%s: energy %.17g becomes %.17g, counted %.17g", stepper, before[energy], after[energy], n.fill[1]);
    assert_true(n.filled == m.filled && n.fill[0] == m.fill[0] && n.fill[1] == m.fill[1]);
    double *U = state_of(&s, world), *V = state_of(&one, alone);
    for (int i = 0; i < s.cells; i++) least = fmin(least, U[i]);
    assert_true(least * 3.14159265358979324 / 6e3 >= FLOOR * (1 - 1e-12));
    assert_memory_equal(U, V, (size_t)((energy + 1) * s.cells) * sizeof *U);
    free(U);
    free(V);
    close_scene(&s);
    close_scene(&one);
}

static void lattice(void **state) {
    (void)state;
    for (int i = 0; i < stepper_count; i++)
        if (!stepper_table[i].local) fly_apart(open_lattice, stepper_table[i].model.name, 0.05, 150);
}

static void polyhedra(void **state) {
    (void)state;
    fly_apart(open_triangles, "SSPRK3", 3 * FLOOR, 100);
    fly_apart(open_triangles, "SSPRK104", 3 * FLOOR, 100);
}

/* Gas that leaves through open patches while others of its cells are raised to the floor: what left and what the floor
 * added are kept apart in the budget, although both happen in the same stages. */
static void budget_of_open_patches(void **state) {
    (void)state;
    void (*const open[])(struct scene *, const struct comm *) = {open_lattice, open_triangles};
    for (int i = 0; i < 2; i++) {
        struct scene s;
        struct gas_budget b;
        double before[MAX_VAR], after[MAX_VAR];
        set_models(&s, "SSPRK3");
        for (int p = 0; p < 2; p++) s.rules[p].velocity.type = boundary_find("zeroGradient");
        open[i](&s, world);
        ok(start(&s, 3 * FLOOR));
        const int energy = gas_variables(s.gas) - 1;
        ok(gas_totals(s.gas, before));
        ok(gas_audit(s.gas));
        run(&s, 100, 0.4);
        ok(gas_totals(s.gas, after));
        ok(gas_budget(s.gas, &b));
        const struct gas_counts n = gas_counts(s.gas);
        const double added = n.fill[1] + n.energy, left = after[energy] - before[energy] - added;
        assert_true(n.fill[0] > 1e-6 * before[0] && added > 1e-6 * before[energy]);
        assert_true(b.flowed < -0.1 * before[0] && left < -0.1 * before[energy]);
        assert_true(fabs(b.filled - n.fill[0]) <= 1e-13 * before[0]);
        assert_true(fabs(b.flowed - (after[0] - before[0] - n.fill[0])) <= 1e-13 * before[0]);
        assert_true(fabs(b.gained[GAS_FLOORS] - added) <= 1e-13 * before[energy]);
        if (!(fabs(b.gained[GAS_FLOW] - left) <= 1e-12 * before[energy]))
            fail_msg("energy that flowed %.17g, expected %.17g", b.gained[GAS_FLOW], left);
        assert_true(fabs(b.lost[0]) <= 1e-13 * before[0] && fabs(b.lost[1]) <= 1e-12 * before[energy]);
        close_scene(&s);
    }
}

/* A start below the floor is refused, with the cure; one on it is not. */
static void starts(void **state) {
    (void)state;
    void (*const open[])(struct scene *, const struct comm *) = {open_lattice, open_triangles};
    for (int i = 0; i < 2; i++) {
        struct scene s;
        set_models(&s, "SSPRK3");
        open[i](&s, world);
        ok(start(&s, FLOOR));
        status bad = start(&s, 0.999 * FLOOR);
        assert_true(bad && status_kind(bad) == ERR_STATE);
        assert_non_null(strstr(status_text(bad), "alphaFloor"));
        status_free(bad);
        close_scene(&s);
    }
}

int main(int argc, char **argv) {
    ok(comm_start(&argc, &argv, &world));
    ok(comm_alone(&alone));
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lattice),
        cmocka_unit_test(polyhedra),
        cmocka_unit_test(budget_of_open_patches),
        cmocka_unit_test(starts),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_alone_free(alone);
    comm_finish(world);
    return failed;
}
