/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The budget of energy by source: every change of a uniform gas belongs to the source that made it, whatever others are
 * on; the gas has the same bits with the budget, and with uniform cells left out. Lattice and polyhedra. */
#include "tests/libcore/sources.h"

#include "tests/libcore/gas/viscous.h" /* last: cmocka.h defines fail() */

static struct comm *world;

/* The sources whose bits are set in `which`. */
static struct sources some(int which) {
    static const double value[] = {3, 2, -1, 0.5}; /* as many as a row may ask for */
    struct sources s = {0};
    for (int row = 0; row < source_count; row++)
        if (which >> row & 1) choose_source(&s, source_table[row].model.name, value);
    if (which & 1) s.cooling = cooling_find("Haff");
    if (which & 2) s.gravity[0] = 5, s.gravity[1] = -7;
    return s;
}

static void even(const double x[3], double *rho, double u[3], double *T) {
    (void)x;
    *rho = 40;
    *T = 1.5;
    u[0] = 0.3;
    u[1] = -0.2;
}

static void uneven(const double x[3], double *rho, double u[3], double *T) {
    const bool inside = fabs(x[0] - 0.5) < 0.1 && fabs(x[1] - 0.4) < 0.1;
    even(x, rho, u, T);
    if (inside) *rho = 60, *T = 4;
}

static void open_scene(struct scene *s, int which, bool polyhedral, bool viscous, initial *at) {
    const struct cells_recipe boxes = {"boxes", 2, BOXES, {96, 80, 1}, {0, 1, 2}, 0, {true, true, true}};
    *s = (struct scene){.dim = 2, .models = disks_models(&CONSTANT, "RKJ2")};
    if (!viscous) s->models.transport = NULL;
    s->models.source = some(which);
    s->models.skip_uniform = true;
    set_walls(s, "slip");
    if (polyhedral) {
        s->mesh = cells_make(&boxes);
        for (int i = 0; i < 3 * s->mesh->npoints; i++) s->mesh->points[i] /= 0.1 * (i % 3 + 1) * 96;
        open_mesh(s, world);
    } else {
        open_box(s, world, 2, boxes.n, (double[3]){1, 80. / 96, 1}, boxes.cyclic, 16);
    }
    start(s, at);
}

/* What each source gives to one cell in a step without flow, in the middle of which gravity acts; rho: of the cell. */
static void alone(const struct gas_models *m, double rho, double dt, double given[SOURCE_MOST]) {
    double x[3] = {0}, u[3] = {0}, T, before = 0, U[4], *at[MAX_VAR] = {U, U + 1, U + 2, U + 3};
    double kick[MAX_DIM], warm = 0;
    struct source_plan plan;
    source_kick(&m->source, 0, dt, kick);
    even(x, &rho, u, &T);
    U[0] = rho;
    U[1] = rho * u[0];
    U[2] = rho * u[1];
    U[3] = before = rho * (T / (m->material.gamma - 1) + 0.5 * (u[0] * u[0] + u[1] * u[1]));
    for (int row = 0; row < source_count; row++) given[row] = 0;
    for (int half = 0; half < 2; half++) {
        source_plan(&m->source, m->eos, &m->material, 2, 0.5 * dt * half, 0.5 * dt, half, &plan);
        for (int i = 0; i < plan.n; i++) {
            struct source_plan one = {.n = 1, .step = {plan.step[i]}, .warm = -1};
            source_apply(&one, 1, at, &warm, NULL, NULL);
            given[plan.step[i].row - source_table] += U[3] - before;
            before = U[3];
        }
        for (int k = 0; k < 2 && !half; k++) {
            U[3] += kick[k] * (U[k + 1] + 0.5 * rho * kick[k]);
            U[k + 1] += rho * kick[k];
        }
        given[source_gravity_row()] += U[3] - before;
        before = U[3];
    }
}

/* All combinations of sources: the budget tells them apart, and closes. */
static void sources_are_told_apart(void **state) {
    (void)state;
    for (int which = 1; which < 1 << source_count; which++)
        for (int polyhedral = 0; polyhedral < 2; polyhedral++) {
            struct scene s;
            struct gas_budget b;
            struct gas_speed speed;
            double given[SOURCE_MOST], totals[MAX_VAR], dt = 1e-3;
            open_scene(&s, which, polyhedral, false, even);
            ok(gas_audit(s.gas));
            ok(gas_totals(s.gas, totals));
            gas_speed(s.gas, &speed);
            ok(gas_step(s.gas, 0, &dt, 0.4, 0, 0, &speed));
            assert_true(dt == 1e-3);
            ok(gas_budget(s.gas, &b));
            alone(&s.models, 40, dt, given);
            for (int row = 0; row < source_count; row++) {
                assert_near(b.sourced[row], given[row] * totals[0] / 40, 1e-13 * b.energy);
                assert_true((b.sourced[row] != 0) == (which >> row & 1));
            }
            assert_near(b.lost[1], 0, 1e-13 * b.energy);
            close_scene(&s);
        }
}

/* With flow, with and without diffusion: the same bits with and without a budget, which closes, and with and without
 * leaving out what is uniform. */
static void budget_and_skipping_change_no_bit(void **state) {
    (void)state;
    const int every = (1 << source_count) - 1;
    for (int c = 0; c < 3; c++) { /* an inviscid gas on each mesh, a viscous one on a lattice */
        double *all[3];
        struct scene s;
        for (int i = 0; i < 3; i++) {
            struct gas_budget b;
            open_scene(&s, every, c == 1, c == 2, uneven);
            if (i == 1) ok(gas_audit(s.gas));
            if (i == 2 && c == 0) {
                gas_free(s.gas);
                s.models.skip_uniform = false;
                ok(gas_make(s.forest, &s.models, 6, s.rules, &s.gas));
                start(&s, uneven);
            }
            run(&s, 3, 0.4);
            all[i] = state_of(&s, world);
            if (i == 1) {
                ok(gas_budget(s.gas, &b));
                assert_near(b.lost[1], 0, 1e-13 * b.energy);
                for (int row = 0; row < source_count; row++) assert_true(b.sourced[row] != 0);
            }
            if (i == 0 && c == 0) assert_true(gas_computed_share(s.gas) < 0.9);
            if (i < 2) close_scene(&s);
        }
        for (int i = 0; i < 4 * s.cells; i++) assert_true(all[0][i] == all[1][i] && all[0][i] == all[2][i]);
        close_scene(&s);
        for (int i = 0; i < 3; i++) free(all[i]);
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sources_are_told_apart),
        cmocka_unit_test(budget_and_skipping_change_no_bit),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
