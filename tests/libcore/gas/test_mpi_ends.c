/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps that are left because somebody asked for an end, diffusion that would have none, and the cell that limits dt,
 * on both mesh engines. */
#include <unistd.h>

#include "tests/libcore/gas/viscous.h" /* last: cmocka.h defines fail() */

static struct comm *world;
enum { NX = 24, NY = 18, CELLS = NX * NY, SPOT = 3 * NX + 5 };
static const char *const schemes[] = {"RKJ2", "RKL2", "explicit", "implicit"};

static double factor; /* of all coefficients */
static void sticky_law(const struct own_params *params, const struct closure_line *cells, double *restrict bulk,
                       double *restrict shear, double *restrict heat) {
    (void)params;
    for (int i = 0; i < cells->n; i++) bulk[i] = shear[i] = heat[i] = factor;
}
static const struct transport STICKY = {.coefficients = sticky_law};

/* One thin cell in a shear flow: the stiffest one. */
static void spot(const double x[3], double *rho, double u[3], double *T) {
    const bool here = (int)(10 * x[0]) == 5 && (int)(5 * x[1]) == 3;
    *rho = here ? 10 : 40;
    *T = 1;
    u[0] = 0.1 * sin(x[1]);
    u[1] = 0;
}

static void open_scene(struct scene *s, bool lattice, const char *diffusion, double coefficients) {
    *s = (struct scene){.models = disks_models(&STICKY, diffusion)};
    factor = coefficients;
    set_walls(s, "slip");
    if (lattice)
        open_box(s, world, 2, (int[3]){NX, NY, 1}, (double[3]){2.4, 3.6, 1}, (bool[3]){true, false, false}, 8);
    else
        open_polyhedra(s, world, &(struct cells_recipe){"boxes", 2, BOXES, {NX, NY, 1}, {0, 1, 2}, 0, {true, false}});
    start(s, spot);
}

static status step(struct scene *s, double *dt) {
    struct gas_speed speed;
    gas_speed(s->gas, &speed);
    *dt = 0.5 / speed.rate;
    return gas_step(s->gas, 0, dt, 0.5, 0, 0, &speed);
}

static int questions, yes_from;
static bool says_yes(void) { /* to one rank only */
    return comm_rank(world) + 1 == comm_size(world) && yes_from > 0 && ++questions >= yes_from;
}

static void same_bits(struct scene *s, const double *wanted) {
    double *found = state_of(s, world);
    assert_memory_equal(found, wanted, 4 * CELLS * sizeof *found);
    free(found);
}

/* A step that is left has changed nothing: the state is that before it, and the next attempt has the bits of a step
 * that nobody asked about. */
static void left_steps(void **state) {
    (void)state;
    for (int k = 0; k < 8; k++) {
        struct scene s;
        double dt, whole;
        if (k % 4 == 3 && !linear_module()) continue;
        open_scene(&s, k < 4, schemes[k % 4], k % 4 == 3 ? 10 : k % 4 == 2 ? 1e3 : 4e4);
        double *before = state_of(&s, world);
        ok(step(&s, &whole));
        double *after = state_of(&s, world);
        for (yes_from = 1; yes_from < 6; yes_from += 2) {
            start(&s, spot);
            questions = 0;
            gas_heed(s.gas, says_yes);
            ok(step(&s, &dt));
            assert_true(dt == 0);
            same_bits(&s, before);
        }
        yes_from = 0;
        ok(step(&s, &dt));
        assert_true(dt == whole);
        same_bits(&s, after);
        free(before);
        free(after);
        close_scene(&s);
    }
}

/* Diffusion that no scheme gets through is refused before its first stage, with the stiffest cell. */
static void endless_diffusion(void **state) {
    (void)state;
    for (int k = 0; k < 8; k++) {
        struct scene s;
        double dt;
        if (k % 4 == 3 && !linear_module()) continue;
        open_scene(&s, k < 4, schemes[k % 4], k % 4 == 3 || k % 2 == 0 ? 1e18 : 1e13);
        double *before = state_of(&s, world);
        char place[100];
        snprintf(place, sizeof place, "in the cell at (%.6g %.6g", s.centre[3 * SPOT], s.centre[3 * SPOT + 1]);
        (void)alarm(60);
        status e = step(&s, &dt);
        (void)alarm(0);
        assert_non_null(e);
        assert_int_equal(status_kind(e), ERR_STATE);
        const char *parts[] = {"viscous stress is too stiff at t = 0", place, "T = 1:", "checkCase", schemes[k % 4]};
        for (int i = 0; i < 5; i++)
            if (!strstr(status_text(e), parts[i])) fail_msg("'%s' does not say '%s'", status_text(e), parts[i]);
        status_free(e);
        same_bits(&s, before);
        assert_int_equal(gas_counts(s.gas).stages[VISCOUS], 0);
        free(before);
        close_scene(&s);
    }
}

static void twins(const double x[3], double *rho, double u[3], double *T) {
    const int i = (int)(10 * x[0]), j = (int)(5 * x[1]);
    *rho = 40;
    *T = (i == 3 && j == 6) || (i == 6 && j == 2) ? 4 : 1;
    u[0] = u[1] = 0;
}

/* Of two cells that limit dt alike the one with the smaller x is named, on any mesh and any ranks. */
static void ties(void **state) {
    (void)state;
    for (int lattice = 0; lattice < 2; lattice++) {
        struct scene s;
        struct gas_speed speed;
        double place[3];
        const double *wanted;
        open_scene(&s, lattice, "explicit", 1);
        wanted = s.centre + 3 * (6 * NX + 3);
        start(&s, twins);
        gas_speed(s.gas, &speed);
        gas_fastest_place(s.gas, &speed, place);
        for (int k = 0; k < 2; k++) assert_true(fabs(place[k] - wanted[k]) < 1e-12);
        close_scene(&s);
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return status_print(s, true);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(left_steps),
        cmocka_unit_test(endless_diffusion),
        cmocka_unit_test(ties),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
