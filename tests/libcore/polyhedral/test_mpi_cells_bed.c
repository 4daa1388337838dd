/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bed of implicit acoustics on polyhedra, on any rank: nothing of an earlier bed is left in a later one, and no
 * flux that a stage finds reads a polynomial that it left out. */
#include "libcore/polyhedral/cells.h"

#include "tests/libcore/polyhedral/scene.h" /* last: cmocka.h defines fail() */

static const struct cells_recipe quads = {"quads", 2, BOXES, {48, 40, 1}, {0, 1, 2}, 0.2, {false, false, false}};
static double edge; /* of the dense part, of the length */

static void half_dense(const struct scene *s, const double x[3], double *rho, double u[3], double *T) {
    (void)u;
    *rho = x[s->grid->axis[0]] > edge * s->length[0] ? 1180 : 10;
    *T = 0.01;
}

static void open_dense(struct scene *s) {
    open_scene(s, &quads, "TorquatoSpheres", "common", "linear");
    gas_free(s->gas);
    s->models.acoustics = acoustics_find("implicit");
    s->models.acoustics_params = own_defaults(&s->models.acoustics->model);
    ok(gas_make_polyhedral(s->grid, &s->models, 6, s->rules, &s->gas));
}

/* Makes a step with a bed from the start; returns the state. */
static double *step_from_start(struct scene *s) {
    struct gas_speed speed;
    const char *limit;
    start(s, half_dense);
    const long beds = gas_counts(s->gas).beds;
    gas_speed(s->gas, &speed);
    double dt = gas_bed_step(s->gas, 0.5, &speed, 1e9, &limit);
    assert_true(dt > 0);
    ok(gas_step(s->gas, 0, &dt, 0.5, 0, 1e-3, &speed));
    assert_int_equal(gas_counts(s->gas).beds, beds + 1);
    return state_of(s);
}

/* The edge moves by two cells at a time, so that ranks lose all dense cells while rings reach into them. */
static void beds_forget_earlier_ones(void **state) {
    (void)state;
    struct scene moved;
    open_dense(&moved);
    for (edge = 0.1; edge < 0.95; edge += 2. / 48) {
        struct scene fresh;
        open_dense(&fresh);
        double *a = step_from_start(&moved), *b = step_from_start(&fresh);
        assert_memory_equal(a, b, (size_t)(4 * fresh.cells) * sizeof *a);
        free(a);
        free(b);
        close_scene(&fresh);
    }
    close_scene(&moved);
}

static void spared_cells_lie_among_frozen_ones(void **state) {
    (void)state;
    struct scene s;
    long spared = 0;
    edge = 0.3;
    open_dense(&s);
    free(step_from_start(&s));
    const struct polyhedra *m = s.gas->cells->polyhedra;
    const double *part = s.gas->dense->part[0];
    for (int i = 0; i < m->nown; i++) spared += s.gas->cells->spared[i];
    for (int f = 0; f < m->face.ninternal; f++) {
        const int cell[2] = {m->face.left[f], m->face.right[f]};
        const bool frozen = part[cell[0]] >= BED_FROZEN && part[cell[1]] >= BED_FROZEN;
        for (int side = 0; side < 2; side++) assert_true(frozen || !s.gas->cells->spared[cell[side]]);
    }
    comm_sum_long(world, &spared, 1);
    assert_true(2 * spared > s.cells); /* 0.7 are dense */
    close_scene(&s);
}

int main(int argc, char **argv) {
    ok(comm_start(&argc, &argv, &world));
    const struct CMUnitTest tests[] = {cmocka_unit_test(beds_forget_earlier_ones),
                                       cmocka_unit_test(spared_cells_lie_among_frozen_ones)};
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
