/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The scheme of a step beside a bed (libcore/step/step.c): one of few stages; if the limiter cannot mend one of these,
 * SSPRK43 at once, with the same dt; half of dt only if that fails, too. */
#include "tests/defaults.h"
#include "tests/libcore/scene.h" /* last: cmocka.h defines fail() */

static struct comm *world;

static void open_line(struct scene *s) {
    memset(s, 0, sizeof *s);
    s->models = (struct gas_models){
        .material = {.diameter = 0.1, .mass = 1, .restitution = 1, .gamma = 5. / 3, .alpha_max = 0.65},
        .eos = eos_find("TorquatoSpheres"),
        .flux = flux_find("common"),
        .flux_params = own_defaults(&flux_find("common")->model),
        .reconstruct = reconstruct_find("PHM"),
        .stepper = stepper_find("SSPRK43"),
        .acoustics = acoustics_find("implicit"),
        .acoustics_params = own_defaults(&acoustics_find("implicit")->model),
        .skip_uniform = true};
    set_walls(s, "slip");
    open_box(s, world, 1, (int[3]){48, 1, 1}, (double[3]){1, 1, 1}, (bool[3]){false, false, false}, 8);
}

static double pressure(const struct scene *s, double rho, double T) {
    double eps = 1.5 * T, p, c2, gruneisen;
    s->models.eos->state(&s->models.material, 1, &rho, &eps, &p, &c2, &gruneisen);
    return p;
}

/* On the right a bed, on the left gas of its pressure; there two streams of 1 m/s meet. The denser they are, the sooner
 * their grains pack, and the limiter's speed of a face grows with that, but dt does not know of it. */
static void start(struct scene *s, double rho) {
    const int n = s->cells;
    const double packed = (1 - 1e-5) * s->models.material.alpha_max / packing_per_density(&s->models.material),
                 T = 0.01;
    double *all = calloc(5 * (size_t)n, sizeof *all), *u[3] = {all + n, all + 2 * n, all + 3 * n};
    for (int i = 0; i < n; i++) {
        const double x = s->centre[3 * i];
        all[i] = x > 0.5 ? packed : rho;
        all[4 * n + i] = x > 0.5 ? pressure(s, rho, T) / pressure(s, packed, 1) : T;
        u[0][i] = fabs(x - 0.25) > 0.1 ? 0 : x < 0.25 ? 1 : -1;
    }
    ok(gas_set(s->gas, all, (const double *const *)u, all + 4 * n));
    free(all);
}

/* Makes a step with a bed in streams of rho (kg/m^3), which is to be rejected some times, then a share of dt long. */
static void step(double rho, int rejected, double share) {
    struct scene s;
    struct gas_speed speed;
    const char *limit;
    open_line(&s);
    start(&s, rho);
    gas_speed(s.gas, &speed);
    const double planned = gas_bed_step(s.gas, 1, &speed, HUGE_VAL, &limit);
    double dt = planned;
    assert_true(planned > 0);
    ok(gas_step(s.gas, 0, &dt, 1, 0, 1e-3, &speed));
    const struct gas_counts counts = gas_counts(s.gas);
    assert_int_equal(counts.beds, 1);
    assert_int_equal(counts.rejected, rejected);
    assert_true(dt == share * planned);
    close_scene(&s);
}

/* Streams from 870 to 940 kg/m^3 are mended by SSPRK43 alone. */
static void steps_beside_beds_fall_back_to_more_stages(void **state) {
    (void)state;
    step(800, 0, 1);
    step(905, 1, 1);
    step(970, 2, 0.5);
}

int main(int argc, char **argv) {
    ok(comm_start(&argc, &argv, &world));
    const struct CMUnitTest tests[] = {cmocka_unit_test(steps_beside_beds_fall_back_to_more_stages)};
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
