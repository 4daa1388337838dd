/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Local time steps on polyhedra: order, sums, the same bits on any ranks and after a restart, steps that stages do. */
#include "tests/libcore/gas/viscous.h" /* last: cmocka.h defines fail() */

static struct comm *world, *alone;

static void set_models(struct scene *s, const char *polynomial) {
    *s = (struct scene){
        .models = {.material = {.diameter = 0.1, .mass = 1, .restitution = 1, .gamma = 1.4, .alpha_max = 1},
                   .eos = eos_find("perfectGas"),
                   .flux = flux_find("common"),
                   .flux_params = own_defaults(&flux_find("common")->model),
                   .polynomial = polynomial_find(polynomial),
                   .stepper = stepper_find("local")}};
    set_walls(s, "slip");
}

/* Draws the points of a mesh together, in the middle of each axis, to a seventh of the largest width, in 0 .. length.
 */
static void grade(struct polymesh *m, int dim, const int n[3], double length) {
    const double pi = acos(-1);
    for (int i = 0; i < m->npoints; i++)
        for (int k = 0; k < dim; k++) {
            double *x = &m->points[3 * i + k];
            const double part = *x / (0.1 * (k + 1) * n[k]);
            *x = length * (part + 0.75 / (2 * pi) * sin(2 * pi * part));
        }
}

static void open_graded(struct scene *s, const struct comm *c, const struct cells_recipe *r, double length) {
    s->mesh = cells_make(r);
    s->dim = r->dim;
    grade(s->mesh, r->dim, r->n, length);
    open_mesh(s, c);
}

static int levels_of(const struct scene *s) {
    const struct gas_counts n = gas_counts(s->gas);
    int levels = 0;
    for (int k = 0; k < GAS_LEVELS; k++)
        if (n.levels[k] > 0) levels = k + 1;
    return levels;
}

static double volume(const struct scene *s, int i) {
    return s->centre[3L * s->cells + i];
}

/* ---- a vortex that moves through a periodic square (Yee, Vinokur & Djomehri 2000) ---- */

static double vortex_at(double t, const double x[2], double u[2], double *T) {
    double d[2], pi = acos(-1);
    for (int k = 0; k < 2; k++) d[k] = remainder(x[k] - 5 - t, 10);
    const double g = 5 / (2 * pi) * exp((1 - d[0] * d[0] - d[1] * d[1]) / 2);
    *T = 1 - g * g / 7;
    u[0] = 1 - g * d[1];
    u[1] = 1 + g * d[0];
    return pow(*T, 2.5);
}

/* Returns the mean error of rho at t = 1. */
static double vortex(int side) {
    const struct cells_recipe r = {"triangles", 2, PRISMS, {side, side, 1}, {0, 1, 2}, 0.1, {true, true, false}};
    struct scene s;
    set_models(&s, "linear");
    open_graded(&s, world, &r, 10);
    double *all = calloc(4 * (size_t)s.cells, sizeof *all), *u[2] = {all + s.cells, all + 2 * s.cells}, error = 0;
    for (int i = 0; i < s.cells; i++) {
        double v[2];
        all[i] = vortex_at(0, s.centre + 3L * i, v, &all[3 * s.cells + i]);
        for (int k = 0; k < 2; k++) u[k][i] = v[k];
    }
    ok(gas_set(s.gas, all, (const double *const[3]){u[0], u[1], NULL}, all + 3 * s.cells));
    double *start = state_of(&s, world);
    struct gas_speed speed;
    for (double t = 0, dt; t < 1 - 1e-12; t += dt) {
        gas_speed(s.gas, &speed);
        dt = fmin(1 / speed.rate, 1 - t);
        ok(gas_step(s.gas, t, &dt, 1, 0, 0, &speed));
    }
    assert_true(speed.levels > 1);
    double *end = state_of(&s, world);
    for (int v = 0; v < 4; v++) {
        double sum[2] = {0};
        for (int i = 0; i < s.cells; i++) {
            sum[0] += volume(&s, i) * start[v * s.cells + i];
            sum[1] += volume(&s, i) * end[v * s.cells + i];
        }
        assert_near(sum[1], sum[0], 1e-13 * fabs(sum[0]));
    }
    double u1[2], T, whole = 0;
    for (int i = 0; i < s.cells; i++) {
        error += volume(&s, i) * fabs(end[i] - vortex_at(1, s.centre + 3L * i, u1, &T));
        whole += volume(&s, i);
    }
    free(all);
    free(start);
    free(end);
    close_scene(&s);
    return error / whole;
}

static void smooth_flow_is_of_second_order(void **state) {
    (void)state;
    const double coarse = vortex(20), fine = vortex(40);
    print_message("errors %g, %g: order %.2f\n", coarse, fine, log2(coarse / fine));
    assert_true(log2(coarse / fine) > 1.9);
}

/* ---- spheres that cool and conduct, against manufactured fields (tests/libcore/gas/manufactured.h) ---- */

static double driven(int side, int count, bool falls) {
    const struct cells_recipe r = {"triangles", 2, PRISMS, {side, side, 1}, {0, 1, 2}, 0.1, {true, true, false}};
    struct scene s = {.models = spheres_models(0.8, 0.5, true, "RKJ2")};
    double error[2];
    set_walls(&s, "slip");
    s.models.stepper = stepper_find("local");
    s.models.source = (struct sources){.cooling = cooling_find("Haff")};
    for (int k = 0; k < 2 && falls; k++) s.models.source.gravity[k] = k ? -50 : 30;
    open_graded(&s, world, &r, 1);
    drive(&s, world, OF_ALL, 0.02, count, error);
    assert_true(levels_of(&s) > 2);
    close_scene(&s);
    return error[1];
}

static void transport_and_gravity_are_of_second_order(void **state) {
    (void)state;
    for (int falls = 0; falls < 2; falls++) {
        const double coarse = driven(12, 6, falls), fine = driven(24, 12, falls);
        print_message("errors %g, %g: order %.2f\n", coarse, fine, log2(coarse / fine));
        assert_true(log2(coarse / fine) > 1.8);
    }
}

/* ---- a blast in a graded box of tetrahedra between an inlet, an outlet and walls ---- */

enum { SIDE = 7 };

struct blast {
    const char *polynomial;
    double jump;    /* of the density and of T */
    bool conducts;  /* spheres with transport between walls that hold them? */
    double gravity; /* along the third axis */
    double fed;     /* kg/m^2 s that the first patch gives; 0: it has a state of its own, and the second one is open */
};

static void open_blast(struct scene *s, const struct comm *c, const struct blast *b) {
    const struct cells_recipe r = {"tetrahedra", 3, TETS, {SIDE, SIDE, SIDE}, {0, 1, 2}, 0.1, {false}};
    const double jump = b->jump;
    set_models(s, b->polynomial);
    if (b->conducts) {
        s->models = spheres_models(0.8, 0.2, true, "RKJ2");
        s->models.stepper = stepper_find("local");
        set_walls(s, "noSlip");
    }
    s->models.source.gravity[2] = b->gravity;
    for (int p = 0; p < 2; p++) {
        const struct boundary_type *type = boundary_find(p ? "zeroGradient" : "fixedValue");
        s->rules[p].density.type = s->rules[p].velocity.type = s->rules[p].temperature.type = type;
        s->rules[p].density.uniform[0] = s->rules[p].velocity.uniform[0] = s->rules[p].temperature.uniform[0] = 1;
    }
    if (b->fed > 0) {
        s->rules[0].velocity.type = boundary_find("flowRateInletVelocity");
        for (int k = 0; k < 3; k++) s->rules[0].velocity.uniform[k] = b->fed;
        s->rules[1] = s->rules[2];
    }
    open_graded(s, c, &r, 1);
    const int n = s->cells;
    double *all = calloc(5 * (size_t)n, sizeof *all);
    for (int i = 0; i < n; i++) {
        double square = 0;
        for (int k = 0; k < 3; k++) square += pow(s->centre[3 * i + k] - 0.4, 2);
        const bool inside = square < 0.04;
        all[i] = inside ? 1 : 1 / sqrt(jump);
        all[n + i] = 0.3;
        all[4 * n + i] = inside ? 1 : 1 / sqrt(jump);
    }
    ok(gas_set(s->gas, all, (const double *const[3]){all + n, all + 2 * n, all + 3 * n}, all + 4 * n));
    free(all);
}

/* The same bits as on one rank, and as after a restart from the conserved variables. */
static void bits_do_not_depend_on_ranks_or_restarts(void **state) {
    (void)state;
    static const struct blast blast[] = {{"linear", .jump = 4},
                                         {"firstOrder", .jump = 4},
                                         {"linear", .jump = 1e10},
                                         {"linear", .jump = 4, .conducts = true},
                                         {"linear", .jump = 4, .conducts = true, .gravity = -3},
                                         {"linear", .jump = 1e10, .gravity = -1},
                                         {"linear", .jump = 4, .fed = 0.5}};
    for (unsigned round = 0; round < sizeof blast / sizeof *blast; round++) {
        struct scene s, one, again;
        open_blast(&s, world, &blast[round]);
        open_blast(&one, alone, &blast[round]);
        open_blast(&again, world, &blast[round]);
        run(&one, 6, 1);
        run(&s, 3, 1);
        double *middle = state_of(&s, world), *U[MAX_VAR];
        for (int v = 0; v < 5; v++) U[v] = middle + v * s.cells;
        gas_set_conserved(again.gas, (const double *const *)U);
        run(&s, 3, 1);
        run(&again, 3, 1);
        double *a = state_of(&s, world), *b = state_of(&one, alone), *c = state_of(&again, world);
        assert_true(levels_of(&s) > 2);
        assert_memory_equal(a, b, 5 * (size_t)s.cells * sizeof *a);
        assert_memory_equal(a, c, 5 * (size_t)s.cells * sizeof *a);
        free(middle);
        free(a);
        free(b);
        free(c);
        close_scene(&s);
        close_scene(&one);
        close_scene(&again);
    }
}

/* Whatever the steps of the cells are. */
static void fed_patches_give_their_mass(void **state) {
    (void)state;
    static const struct blast blast = {"linear", .jump = 4, .fed = 0.5};
    struct scene s;
    struct gas_speed speed;
    double before[MAX_VAR], after[MAX_VAR], t = 0;
    open_blast(&s, world, &blast);
    ok(gas_totals(s.gas, before));
    for (int step = 0; step < 6; step++) {
        gas_speed(s.gas, &speed);
        double dt = 1 / speed.rate;
        ok(gas_step(s.gas, t, &dt, 1, 0, 0, &speed));
        t += dt;
    }
    ok(gas_totals(s.gas, after));
    assert_true(levels_of(&s) > 2);
    assert_near(fabs(after[0] - before[0]), blast.fed * t, 1e-13 * before[0]);
    close_scene(&s);
}

static void add_face(void *left, const struct gas_face *face) {
    double *sum = left;
    sum[0] += face->mass;
    for (int k = 0; k < 3; k++) sum[k + 1] += face->pressure[k];
    sum[4] += face->energy;
}

/* What the state loses has left through the faces of patches, also where stages do the step. */
static void tally_knows_what_left(void **state) {
    (void)state;
    static const struct blast blast[] = {{"linear", .jump = 4}, {"linear", .jump = 1e10}};
    for (int round = 0; round < 2; round++) {
        struct scene s;
        double before[MAX_VAR], after[MAX_VAR], left[5] = {0}, all[5] = {0};
        open_blast(&s, world, &blast[round]);
        ok(gas_tally(s.gas));
        ok(gas_totals(s.gas, before));
        for (int step = 0; step < 5; step++) {
            double now[5] = {0};
            run(&s, 1, 1);
            for (int block = 0; block < s.grid->polyhedra->nblocks; block++)
                gas_tally_faces(s.gas, block, add_face, now);
            for (int v = 0; v < 5; v++) left[v] += gas_tally_step(s.gas) * now[v];
        }
        comm_take_turn(world, all, 5);
        for (int v = 0; v < 5; v++) all[v] += left[v];
        comm_end_turn(world, all, 5);
        ok(gas_totals(s.gas, after));
        const long staged = gas_counts(s.gas).staged;
        print_message("jump %g: %ld steps by stages\n", round ? 1e10 : 4., staged);
        assert_true(round ? staged > 0 : staged == 0);
        for (int v = 0; v < 5; v++) assert_near(before[v] - after[v], all[v], 1e-13 * before[4]);
        ok(gas_check(s.gas));
        close_scene(&s);
    }
}

/* A step that was rejected and shortened has the bits of one that was begun with that dt: levels follow from the state
 * and the step alone. */
static void shortened_steps_have_the_bits_of_short_ones(void **state) {
    (void)state;
    long rejected = 0;
    for (int round = 0; round < 3; round++) {
        struct scene s, again;
        struct gas_speed speed;
        const struct blast blast = {"linear", .jump = pow(10, 6 + 2 * round)};
        open_blast(&s, world, &blast);
        open_blast(&again, world, &blast);
        for (int step = 0; step < 4; step++) {
            gas_speed(s.gas, &speed);
            double dt = 4 / speed.rate;
            const long before = gas_counts(s.gas).rejected;
            ok(gas_step(s.gas, 0, &dt, 4, 0, 0, &speed));
            gas_speed(again.gas, &speed);
            double same = dt;
            ok(gas_step(again.gas, 0, &same, 4, 0, 0, &speed));
            rejected += gas_counts(s.gas).rejected - before;
            double *a = state_of(&s, world), *b = state_of(&again, world);
            assert_true(same == dt);
            assert_memory_equal(a, b, 5 * (size_t)s.cells * sizeof *a);
            free(a);
            free(b);
        }
        close_scene(&s);
        close_scene(&again);
    }
    assert_true(rejected > 0);
}

/* ---- what it is not there for ---- */

static void expect_refused(const struct scene *s, const char *what) {
    struct gas *none;
    status failed = s->forest ? gas_make(s->forest, &s->models, 6, s->rules, &none)
                              : gas_make_polyhedral(s->grid, &s->models, 6, s->rules, &none);
    assert_non_null(failed);
    assert_non_null(strstr(status_text(failed), what));
    status_free(failed);
}

/* A gas that local steps would advance wrongly, or not at all, is not made. */
static void other_models_are_refused(void **state) {
    (void)state;
    const int n[3] = {4, 4, 1};
    const double length[3] = {1, 1, 1};
    const struct cells_recipe r = {"boxes", 2, BOXES, {4, 4, 1}, {0, 1, 2}, 0.1, {false, false, false}};
    struct scene box, s;
    set_models(&box, "linear");
    box.models.reconstruct = reconstruct_find("firstOrder");
    box.models.stepper = stepper_find("SSPRK43");
    open_box(&box, world, 2, n, length, (const bool[3]){false}, 4);
    box.models.stepper = stepper_find("local");
    expect_refused(&box, "a lattice");
    close_scene(&box);
    set_models(&s, "linear");
    open_polyhedra(&s, world, &r);
    const struct scene good = s;
    s.models.polynomial = polynomial_find("CWENO3");
    expect_refused(&s, "quadratics");
    s = good;
    s.models.flux = flux_find("FORCE");
    expect_refused(&s, "depends on the time step");
    s = good;
    close_scene(&s);
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s || comm_alone(&alone)) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(smooth_flow_is_of_second_order),
        cmocka_unit_test(transport_and_gravity_are_of_second_order),
        cmocka_unit_test(bits_do_not_depend_on_ranks_or_restarts),
        cmocka_unit_test(fed_patches_give_their_mass),
        cmocka_unit_test(tally_knows_what_left),
        cmocka_unit_test(shortened_steps_have_the_bits_of_short_ones),
        cmocka_unit_test(other_models_are_refused),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_alone_free(alone);
    comm_finish(world);
    return failed;
}
