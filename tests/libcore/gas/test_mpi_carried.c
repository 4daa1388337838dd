/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Carried quantities on both mesh engines: a uniform one keeps its bits, others keep their bounds and their sum, also
 * in steps that are mended, refused and halved; the gas does not feel them; the bits are those of one rank; and the
 * orders are those of exact solutions. */
#include "tests/libcore/scene.h" /* last: cmocka.h defines fail() */

static struct comm *world, *alone;
static const double PI = 3.14159265358979324;
enum { UNIFORM, STEP, MIXTURE, CARRIED };

static struct rule all_rules[6][CARRIED];

static void set_models(struct scene *s, const char *stepper) {
    memset(s, 0, sizeof *s);
    s->models = (struct gas_models){
        .material = {.diameter = 0.1, .mass = 1, .restitution = 0.9, .gamma = 5. / 3, .alpha_max = 0.65},
        .eos = eos_find("GoldshteinShapiro"),
        .flux = flux_find("common"),
        .reconstruct = reconstruct_find("WENO5"),
        .polynomial = polynomial_find("CWENO3"),
        .stepper = stepper_find(stepper),
        .skip_uniform = true};
    set_walls(s, "slip");
}

/* Gives the gas quantities of a kind with the numbers of its parameters, in their order. */
static void carry(struct scene *s, struct carried_choice *choice, int n, const char *kind, const double *numbers) {
    for (int i = 0; i < n; i++) {
        choice[i] = (struct carried_choice){"phi", NULL, {{0}}};
        for (int k = 0; k < carried_count; k++)
            if (!strcmp(carried_table[k].model.name, kind)) choice[i].kind = &carried_table[k];
        for (int p = 0; p < choice[i].kind->model.nparam; p++) {
            const struct param *param = &choice[i].kind->model.param[p];
            const int word = numbers ? (int)numbers[p] : 0;
            const double number = numbers ? numbers[p] : param->standard;
            if (param->kind == PARAM_NUMBER)
                memcpy((char *)&choice[i].params + param->offset, &number, sizeof number);
            else
                memcpy((char *)&choice[i].params + param->offset, &word, sizeof word);
        }
    }
    s->models.carried = choice;
    s->models.ncarried = n;
    for (int p = 0; p < 6; p++) {
        for (int i = 0; i < n; i++) all_rules[p][i] = (struct rule){.type = boundary_find("zeroGradient")};
        s->rules[p].carried = all_rules[p];
    }
}

static void open_line(struct scene *s, const struct comm *c) {
    open_box(s, c, 1, (int[3]){100, 1, 1}, (double[3]){1, 1, 1}, (bool[3]){false, false, false}, 16);
}
static void open_plane(struct scene *s, const struct comm *c) {
    open_box(s, c, 2, (int[3]){40, 12, 1}, (double[3]){1, 0.3, 1}, (bool[3]){false, false, false}, 8);
}
static void open_cube(struct scene *s, const struct comm *c) {
    open_box(s, c, 3, (int[3]){16, 8, 8}, (double[3]){1, 0.5, 0.5}, (bool[3]){false, true, false}, 8);
}
static void open_triangles(struct scene *s, const struct comm *c) {
    static const struct cells_recipe r = {"triangles", 2, PRISMS, {16, 5, 1}, {0, 1, 2}, 0.2, {false, false, false}};
    open_polyhedra(s, c, &r);
}
static void open_tetrahedra(struct scene *s, const struct comm *c) {
    static const struct cells_recipe r = {"tetrahedra", 3, TETS, {6, 3, 3}, {0, 1, 2}, 0.1, {false, true, false}};
    open_polyhedra(s, c, &r);
}

static void set_phi(struct scene *s, int q, double (*phi)(const double x[3])) {
    double *all = calloc((size_t)s->cells, sizeof *all);
    for (int i = 0; i < s->cells; i++) all[i] = phi(s->centre + 3 * i);
    gas_set_carried(s->gas, q, false, all);
    free(all);
}
static double *phi_of(const struct scene *s, int q) {
    double *all = calloc((size_t)s->cells, sizeof *all);
    ok(gas_get_carried(s->gas, q, all));
    comm_broadcast(world, all, (long)sizeof *all * s->cells);
    return all;
}
static double uniform(const double x[3]) {
    (void)x;
    return 0.1;
}
static double step(const double x[3]) {
    return x[0] + 0.3 * x[1] < 0.5 ? 1 : 0;
}

/* The sum of rho phi V. */
static double sum_of(const struct scene *s, int q) {
    double *U = state_of(s, world), *phi = phi_of(s, q), sum = 0;
    const double *volumes = s->centre + 3 * s->cells; /* open_mesh */
    for (int i = 0; i < s->cells; i++) {
        const double volume = s->grid ? volumes[i] : 1;
        sum += volume * U[i] * phi[i];
    }
    free(U);
    free(phi);
    return sum;
}

/* Gas flies apart at Mach numbers of some 10 from the middle of the box, and piles up on the walls. */
static void start(struct scene *s, double alpha) {
    const int n = s->cells;
    double *all = calloc(5 * (size_t)n, sizeof *all), *u[3] = {all + n, all + 2 * n, all + 3 * n}, low = 1e30, high = 0;
    for (int i = 0; i < n; i++) {
        low = fmin(low, s->centre[3 * i]);
        high = fmax(high, s->centre[3 * i]);
    }
    for (int i = 0; i < n; i++) {
        const double *x = s->centre + 3 * i;
        all[i] = alpha * 6e3 / PI;
        u[0][i] = x[0] < 0.5 * (low + high) ? -20 : 20;
        if (s->dim > 1) u[1][i] = x[0] < 0.7 * high ? 0 : sin(40 * x[0]);
        all[4 * n + i] = 1;
    }
    ok(gas_set(s->gas, all, (const double *const *)u, all + 4 * n));
    free(all);
}

static void start_all(struct scene *s) {
    start(s, 0.05);
    set_phi(s, UNIFORM, uniform);
    set_phi(s, STEP, step);
    set_phi(s, MIXTURE, step);
}

static void fly_apart(void (*open)(struct scene *, const struct comm *), const char *stepper, int steps) {
    struct scene s, one, plain;
    struct carried_choice choice[CARRIED], mixture;
    set_models(&s, stepper);
    plain = s;
    carry(&s, choice, CARRIED, "passive", NULL);
    carry(&s, &mixture, 1, "segregation", (double[]){0, -3, 0, 1, 0.01});
    choice[MIXTURE] = mixture;
    s.models.carried = choice;
    s.models.ncarried = CARRIED;
    for (int p = 0; p < 6; p++)
        for (int i = 0; i < CARRIED; i++) all_rules[p][i] = (struct rule){.type = boundary_find("zeroGradient")};
    s.models.source.gravity[0] = plain.models.source.gravity[0] = -0.1;
    one = s;
    open(&s, world);
    open(&one, alone);
    open(&plain, world);
    start_all(&s);
    start_all(&one);
    start(&plain, 0.05);
    const double before[] = {sum_of(&s, STEP), sum_of(&s, MIXTURE)};
    run(&s, steps, 0.4);
    run(&one, steps, 0.4);
    run(&plain, steps, 0.4);
    const struct gas_counts n = gas_counts(s.gas);
    double *U = state_of(&s, world), *V = state_of(&plain, world);
    assert_memory_equal(U, V, (size_t)(gas_variables(s.gas) * s.cells) * sizeof *U);
    for (int q = 0; q < CARRIED; q++) {
        double *phi = phi_of(&s, q), *other = phi_of(&one, q), low = 1, high = 0;
        assert_memory_equal(phi, other, (size_t)s.cells * sizeof *phi);
        for (int i = 0; i < s.cells; i++) {
            low = fmin(low, phi[i]);
            high = fmax(high, phi[i]);
        }
        if (q == UNIFORM && !(low == 0.1 && high == 0.1)) fail_msg("%.17g .. %.17g", low, high);
        if (!(low >= -1e-13 && high <= 1 + 1e-13)) fail_msg("%d: %.17g .. %.17g", q, low, high);
        if (q != UNIFORM && !(high - low > 0.5)) fail_msg("%d: %.17g .. %.17g", q, low, high);
        free(phi);
        free(other);
    }
    const double after[] = {sum_of(&s, STEP), sum_of(&s, MIXTURE)};
    print_message("%s: %ld cells limited, %ld rejected, sums %.2g %.2g\n", stepper, n.cells, n.rejected,
                  after[0] / before[0] - 1, after[1] / before[1] - 1);
    for (int i = 0; i < 2; i++) assert_true(fabs(after[i] - before[i]) <= 1e-12 * before[i]);
    free(U);
    free(V);
    close_scene(&s);
    close_scene(&one);
    close_scene(&plain);
}

static void keeps_bounds_and_sums(void **state) {
    (void)state;
    for (int i = 0; i < stepper_count; i++)
        if (!stepper_table[i].local) fly_apart(open_line, stepper_table[i].model.name, 120);
    fly_apart(open_plane, "SSPRK43", 60);
    fly_apart(open_cube, "SSPRK3", 30);
    fly_apart(open_triangles, "SSPRK3", 60);
    fly_apart(open_tetrahedra, "SSPRK43", 30);
}

/* ---- orders ---- */

typedef double exact(const double x[3], double t);
static double wave_length, diffusivity;
static double velocity[2]; /* of the gas */

static double carried_wave(const double x[3], double t) {
    const double k = 2 * PI / wave_length;
    return 0.5 + 0.4 * sin(k * (x[0] - velocity[0] * t)) * cos(k * (x[1] - velocity[1] * t));
}

static double spreading_wave(const double x[3], double t) {
    const double k = 2 * PI / wave_length;
    return 0.5 + 0.4 * sin(k * x[0]) * cos(k * x[1]) * exp(-2 * k * k * diffusivity * t);
}

/* Returns the mean error of phi after a time t, in gas of uniform density that moves by u. */
static double error_of(struct scene *s, exact *phi, double t, double courant) {
    const int n = s->cells;
    double *all = calloc(6 * (size_t)n, sizeof *all), *u[3] = {all + n, all + 2 * n, all + 3 * n}, sum = 0, at = 0;
    for (int i = 0; i < n; i++) {
        all[i] = 100;
        for (int k = 0; k < 2; k++) u[k][i] = velocity[k];
        all[4 * n + i] = 1;
        all[5 * n + i] = phi(s->centre + 3 * i, 0);
    }
    ok(gas_set(s->gas, all, (const double *const *)u, all + 4 * n));
    gas_set_carried(s->gas, 0, false, all + 5 * n);
    free(all);
    while (at < t * (1 - 1e-12)) {
        struct gas_speed speed;
        gas_speed(s->gas, &speed);
        double dt = fmin(courant / speed.rate, t - at);
        ok(gas_step(s->gas, at, &dt, courant, 0, 0, &speed));
        at += dt;
    }
    double *now = phi_of(s, 0);
    for (int i = 0; i < n; i++) sum += fabs(now[i] - phi(s->centre + 3 * i, t)) / n;
    free(now);
    return sum;
}

static double lattice_error(int n, exact *phi, double t, double courant) {
    struct scene s;
    struct carried_choice choice;
    set_models(&s, "SSPRK3");
    s.models.material.restitution = 1;
    carry(&s, &choice, 1, "passive", &diffusivity);
    open_box(&s, world, 2, (int[3]){n, n, 1}, (double[3]){1, 1, 1}, (bool[3]){true, true, false}, 16);
    wave_length = 1;
    const double e = error_of(&s, phi, t, courant);
    close_scene(&s);
    return e;
}

static double triangles_error(int n, exact *phi, double t, double courant) {
    const struct cells_recipe r = {"triangles", 2, PRISMS, {n, n, 1}, {0, 1, 2}, 0.15, {true, true, false}};
    struct scene s;
    struct carried_choice choice;
    set_models(&s, "SSPRK3");
    s.models.material.restitution = 1;
    wave_length = 0.1 * n; /* the mesh is as large: times and diffusivities are, too */
    const double per_length = diffusivity;
    diffusivity = per_length * wave_length;
    carry(&s, &choice, 1, "passive", &diffusivity);
    open_polyhedra(&s, world, &r);
    const double e = error_of(&s, phi, t * wave_length, courant);
    close_scene(&s);
    diffusivity = per_length;
    return e;
}

static void order(const char *name, double (*error)(int, exact *, double, double), int n, exact *phi, double t,
                  double least) {
    const double coarse = error(n, phi, t, 0.4), fine = error(2 * n, phi, t, 0.4), found = log2(coarse / fine);
    print_message("%s: error %.3g, %.3g with twice as many cells: order %.2f\n", name, coarse, fine, found);
    if (!(found >= least)) fail_msg("%s: order %.2f", name, found);
}

/* Second order, but where slopes are cut at extremes. */
static void orders(void **state) {
    (void)state;
    velocity[0] = 1;
    velocity[1] = 0.5;
    diffusivity = 0;
    order("lattice, carried", lattice_error, 24, carried_wave, 0.5, 1.7);
    order("triangles, carried", triangles_error, 12, carried_wave, 0.5, 1.7);
    velocity[0] = velocity[1] = 0;
    diffusivity = 0.01;
    order("lattice, diffused", lattice_error, 16, spreading_wave, 0.5, 1.9);
    order("triangles, diffused", triangles_error, 12, spreading_wave, 0.5, 1.5);
}

/* The mixture at rest, D phi' = f phi (1 - phi) along gravity: phi = 1/(1 + exp(-f (y - y0)/D)). Returns the mean
 * error. */
static double settled_error(struct scene *s, double height) {
    const double f = -4, D = 0.4 * height;
    const int n = s->cells;
    double *all = calloc(4 * (size_t)n, sizeof *all), t = 0, sum = 0;
    const double *u[3] = {all + n, all + n, all + n};
    for (int i = 0; i < n; i++) {
        all[i] = 100;
        all[2 * n + i] = 1;
        all[3 * n + i] = 0.5;
    }
    ok(gas_set(s->gas, all, u, all + 2 * n));
    gas_set_carried(s->gas, 0, false, all + 3 * n);
    while (t < 0.7 * height) {
        struct gas_speed speed;
        gas_speed(s->gas, &speed);
        double dt = 0.8 / speed.rate;
        ok(gas_step(s->gas, t, &dt, 0.8, 0, 0, &speed));
        t += dt;
    }
    double *phi = phi_of(s, 0);
    for (int i = 0; i < n; i++) sum += fabs(phi[i] - 1 / (1 + exp(-f * (s->centre[3 * i + 1] - 0.5 * height) / D))) / n;
    free(phi);
    free(all);
    return sum;
}

static void set_mixture(struct scene *s, struct carried_choice *choice, double height) {
    set_models(s, "SSPRK3");
    s->models.material.restitution = 1;
    s->models.source.gravity[1] = -1e-9;
    carry(s, choice, 1, "segregation", (double[]){0, -4, 0, 1, 0.4 * height});
}

static double lattice_settled(int n) {
    struct scene s;
    struct carried_choice choice;
    set_mixture(&s, &choice, 1);
    open_box(&s, world, 2, (int[3]){4, n, 1}, (double[3]){4. / n, 1, 1}, (bool[3]){true, false, false}, 8);
    const double e = settled_error(&s, 1);
    close_scene(&s);
    return e;
}

static double triangles_settled(int n) {
    const struct cells_recipe r = {"triangles", 2, PRISMS, {4, n, 1}, {0, 1, 2}, 0.15, {false, false, false}};
    struct scene s;
    struct carried_choice choice;
    set_mixture(&s, &choice, 0.2 * n);
    open_polyhedra(&s, world, &r);
    const double e = settled_error(&s, 0.2 * n);
    close_scene(&s);
    return e;
}

static void settles(void **state) {
    (void)state;
    double (*const error[])(int) = {lattice_settled, triangles_settled};
    for (int i = 0; i < 2; i++) {
        const double coarse = error[i](10), fine = error[i](20);
        print_message("%s: error %.3g, %.3g\n", i ? "triangles" : "lattice", coarse, fine);
        assert_true(fine < coarse / 2.8 && fine < 4e-3);
    }
}

int main(int argc, char **argv) {
    ok(comm_start(&argc, &argv, &world));
    ok(comm_alone(&alone));
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(keeps_bounds_and_sums),
        cmocka_unit_test(orders),
        cmocka_unit_test(settles),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_alone_free(alone);
    comm_finish(world);
    return failed;
}
