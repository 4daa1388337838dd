/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps beside a bed (libcore/step). Their scheme has few stages; if the limiter cannot mend one of these, SSPRK43 does
 * the step at once, with the same dt; half of dt follows only if that fails, too. Diffusion takes all of dt at once. */
#include "libcore/gas/gas_private.h"

#include "tests/defaults.h"
#include "tests/libcore/scene.h" /* last: cmocka.h defines fail() */

static struct comm *world;

static void open_line(struct scene *s, const char *reconstruct, const char *acoustics, const char *transport) {
    memset(s, 0, sizeof *s);
    s->models = (struct gas_models){
        .material = {.diameter = 0.1, .mass = 1, .restitution = 1, .gamma = 5. / 3, .alpha_max = 0.65},
        .eos = eos_find("TorquatoSpheres"),
        .flux = flux_find("common"),
        .flux_params = own_defaults(&flux_find("common")->model),
        .reconstruct = reconstruct_find(reconstruct),
        .stepper = stepper_find("SSPRK43"),
        .acoustics = acoustics_find(acoustics),
        .acoustics_params = own_defaults(&acoustics_find(acoustics)->model),
        .skip_uniform = true};
    set_walls(s, "slip");
    if (transport) {
        s->models.transport = transport_find(transport);
        s->models.transport_params = own_defaults(&s->models.transport->model);
        s->models.diffusion = diffusion_find("RKJ2");
    }
    open_box(s, world, 1, (int[3]){48, 1, 1}, (double[3]){1, 1, 1}, (bool[3]){false, false, false}, 8);
}

static double pressure(const struct scene *s, double rho, double T) {
    double eps = 1.5 * T, p, c2, gruneisen;
    s->models.eos->state(&s->models.material, 1, &rho, &eps, &p, &c2, &gruneisen);
    return p;
}

/* On the right a bed, on the left gas of its pressure, with two streams of `speed` that meet, or warmer by a share. */
static void start(struct scene *s, double rho, double speed, double warmer) {
    const int n = s->cells;
    const double packed = (1 - 1e-5) * s->models.material.alpha_max / packing_per_density(&s->models.material),
                 T = 0.01;
    double *all = calloc(5 * (size_t)n, sizeof *all), *u[3] = {all + n, all + 2 * n, all + 3 * n};
    for (int i = 0; i < n; i++) {
        const double x = s->centre[3 * i];
        all[i] = x > 0.5 ? packed : rho;
        all[4 * n + i] = x > 0.5 ? pressure(s, rho, T) / pressure(s, packed, 1) : T;
        if (fabs(x - 0.25) > 0.1) continue;
        all[4 * n + i] *= 1 + warmer;
        u[0][i] = x < 0.25 ? speed : -speed;
    }
    ok(gas_set(s->gas, all, (const double *const *)u, all + 4 * n));
    free(all);
}

/* Makes a step with a bed, that share of the planned dt long; returns the planned one. */
static double step_with_bed(struct scene *s, double share, double *dt) {
    struct gas_speed speed;
    const char *limit;
    gas_speed(s->gas, &speed);
    const double planned = gas_bed_step(s->gas, 1, &speed, HUGE_VAL, &limit);
    *dt = share * planned;
    assert_true(planned > 0);
    ok(gas_step(s->gas, 0, dt, 1, 0, 1e-3, &speed));
    assert_int_equal(gas_counts(s->gas).beds, 1);
    return planned;
}

/* Makes a step in streams of rho (kg/m^3), which is to be rejected some times, then a share of dt long. */
static void meet(double rho, int rejected, double share) {
    struct scene s;
    double dt;
    open_line(&s, "PHM", "implicit", NULL);
    start(&s, rho, 1, 0);
    const double planned = step_with_bed(&s, 1, &dt);
    assert_int_equal(gas_counts(s.gas).rejected, rejected);
    assert_true(dt == share * planned);
    close_scene(&s);
}

/* The denser the streams are, the sooner they pack, and the limiter's speed of a face grows with that, which dt does
 * not know. From 870 to 940 kg/m^3 SSPRK43 alone mends them. */
static void steps_beside_beds_fall_back_to_more_stages(void **state) {
    (void)state;
    meet(800, 0, 1);
    meet(905, 1, 1);
    meet(970, 2, 0.5);
}

/* Returns how many stages a step of that share of the planned dt has, at which the Courant number of the gas is 1/2. */
static int stages_of(const char *reconstruct, double share) {
    struct scene s;
    double dt;
    open_line(&s, reconstruct, "implicit", NULL);
    start(&s, 90, 0, 0.2);
    step_with_bed(&s, share, &dt);
    assert_float_equal(s.gas->dense->beside * dt, 0.5 * share, 1e-12);
    long updates = s.gas->counts.all;
    comm_sum_long(world, &updates, 1);
    assert_int_equal(updates % s.cells, 0);
    const int stages = (int)(updates / s.cells);
    close_scene(&s);
    return stages;
}

static void steps_beside_beds_have_as_few_stages_as_are_stable(void **state) {
    (void)state;
    assert_int_equal(stages_of("PHM", 1), 2);
    assert_int_equal(stages_of("WPENO5", 1), 3);
    assert_int_equal(stages_of("WPENO5", 0.81), 3);
    assert_int_equal(stages_of("WPENO5", 0.79), 2);
}

/* Advances gas without beds by dt, in explicit steps. */
static void go_to(struct scene *s, double end) {
    for (double t = 0, dt; t < end; t += dt) {
        struct gas_speed speed;
        gas_speed(s->gas, &speed);
        dt = fmin(1 / speed.rate, end - t);
        ok(gas_step(s->gas, t, &dt, 1, 0, 1e-3, &speed));
    }
}

/* Warm gas cools by conduction as in explicit steps: energies of the 14 cells that are out of reach of the bed are off
 * by 0.108 of what conduction does to them, by 0.485 if it has half of its time. */
static void steps_beside_beds_conduct_for_all_of_dt(void **state) {
    (void)state;
    double *U[3], dt = 0, moved = 0, off = 0;
    for (int i = 0; i < 3; i++) {
        struct scene s;
        open_line(&s, "PHM", i ? "explicit" : "implicit", i < 2 ? "GarzoDufty" : NULL);
        start(&s, 90, 0, 0.2);
        if (i)
            go_to(&s, dt);
        else
            step_with_bed(&s, 1, &dt);
        U[i] = state_of(&s, world);
        close_scene(&s);
    }
    for (int i = 2 * 48; i < 2 * 48 + 14; i++) {
        moved = fmax(moved, fabs(U[2][i] - U[1][i]));
        off = fmax(off, fabs(U[0][i] - U[1][i]));
    }
    print_message("off by %.3g of %.3g\n", off / moved, moved);
    assert_true(off < 0.14 * moved);
    for (int i = 0; i < 3; i++) free(U[i]);
}

int main(int argc, char **argv) {
    ok(comm_start(&argc, &argv, &world));
    const struct CMUnitTest tests[] = {cmocka_unit_test(steps_beside_beds_fall_back_to_more_stages),
                                       cmocka_unit_test(steps_beside_beds_have_as_few_stages_as_are_stable),
                                       cmocka_unit_test(steps_beside_beds_conduct_for_all_of_dt)};
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
