/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Implicit diffusion on tiles beside exact and explicit results; what a stiff step must not do. */
#include "tests/libcore/gas/viscous.h" /* last: cmocka.h defines fail() */

static struct comm *world;
enum { NX = 24, NY = 18, CELLS = NX * NY };

static void open_scene(struct scene *s, const char *wall, const struct transport *transport, const char *diffusion) {
    *s = (struct scene){.models = disks_models(transport, diffusion)};
    set_walls(s, wall);
    for (int p = 0; p < 6; p++) s->rules[p].velocity.params.room[0] = 0.6; /* of walls with friction */
    open_box(s, world, 2, (int[3]){NX, NY, 1}, (double[3]){1, 1, 1}, (bool[3]){true, false, false}, 8);
}

static void gentle(const double at[3], double *rho, double u[3], double *T) {
    const double x = TWO_PI * (at[0] - 0.5 / NX), y = TWO_PI * (at[1] - 0.5 / NY);
    *rho = 1.5 + 0.4 * sin(x) * cos(y);
    *T = 3 + sin(x + y) + 0.5 * cos(x);
    u[0] = cos(y) + 0.3 * sin(x);
    u[1] = 0.5 * sin(x - y);
}

static const char *const schemes[] = {"implicit", "implicitMidpoint", "gaussLegendre"};
enum { SCHEMES = sizeof schemes / sizeof *schemes };

/* The largest difference from `exact` after n steps of a scheme; iterations: the most of a step. */
static double error_of(const char *wall, const char *scheme, int steps, int iterations, const double *exact) {
    struct scene s;
    double error = 0;
    open_scene(&s, wall, &OF_DENSITY, scheme);
    start(&s, gentle);
    spread(&s, steps, 0.01 / steps);
    for (int what = 0; what < 2; what++) {
        const long each = gas_counts(s.gas).stages[what] / steps;
        assert_true(each > 0 && each < iterations);
    }
    assert_true(gas_counts(s.gas).repeated == 0);
    double *found = state_of(&s, world);
    close_scene(&s);
    for (int i = 0; i < 4 * CELLS; i++) error = fmax(error, fabs(found[i] - exact[i]));
    free(found);
    return error;
}

/* Implicit steps converge in second order, which is that of friction and conduction together, towards the result of
 * many explicit ones, with walls of each kind; on more ranks only close, as all iterations wait for all ranks.
 * Iterations are few, as the preconditioner is nearly the system; the coupled stages of Gauss & Legendre take some ten
 * solutions. */
static void many_steps_come_to_the_same(void **state) {
    (void)state;
    static const char *const walls[] = {"slip", "noSlip", "JohnsonJacksonSlip"};
    const bool alone = comm_size(world) == 1;
    for (int wall = 0; wall < (alone ? 3 : 1); wall++) {
        struct scene s;
        open_scene(&s, walls[wall], &OF_DENSITY, "explicit");
        start(&s, gentle);
        spread(&s, 400, 0.01 / 400);
        double *exact = state_of(&s, world);
        close_scene(&s);
        for (int k = 0; k < (alone ? SCHEMES : 1); k++) {
            const int most = k == 2 ? 100 : 30;
            const double coarse = alone ? error_of(walls[wall], schemes[k], 32, most, exact) : 0;
            const double fine = error_of(walls[wall], schemes[k], alone ? 64 : 8, most, exact);
            print_message("%s, %s: %.3g, %.3g\n", walls[wall], schemes[k], coarse, fine);
            if (alone) assert_true(log2(coarse / fine) > 1.8);
            assert_near(fine, 0, alone ? 5e-4 : 5e-3);
        }
        free(exact);
    }
}

static double spot_T;
static void spot(const double x[3], double *rho, double u[3], double *T) {
    const bool here = (int)(x[0] * NX) == 5 && (int)(x[1] * NY) == 7;
    (void)u;
    *rho = here ? 1e-3 : 40;
    *T = here ? spot_T : 1;
}

/* One hot thin cell in dense gas: temperatures become even, and no cell is left colder than the coldest was. After one
 * very stiff step it may be, by 5/z of its excess: R(z). */
static void a_hot_thin_cell_adapts(void **state) {
    (void)state;
    for (int stiff = 0; stiff < 2; stiff++) {
        struct scene s;
        double before[MAX_VAR], after[MAX_VAR], rate[2], low = HUGE_VAL, high = 0;
        spot_T = stiff ? 1e6 : 50;
        open_scene(&s, "slip", transport_find("JenkinsRichman"), "implicit");
        start(&s, spot);
        ok(gas_totals(s.gas, before));
        s.gas->engine->diffusion.rates(s.gas, &s.gas->U, rate, NULL);
        comm_max(world, rate, 2);
        spread(&s, stiff ? 2 : 1, (stiff ? 1e8 : 8) / rate[HEAT]);
        ok(gas_totals(s.gas, after));
        assert_near(after[3], before[3], 1e-14 * before[3]);
        double *all = state_of(&s, world);
        for (int i = 0; i < CELLS; i++) {
            low = fmin(low, temperature(all, 2, CELLS, i));
            high = fmax(high, temperature(all, 2, CELLS, i));
        }
        assert_true(low > 1 - 1e-5);
        assert_true(high < (stiff ? 1.1 : 0.5 * spot_T));
        if (!stiff) assert_true(gas_counts(s.gas).repeated == 1); /* R < 0 there, so backward Euler took over */
        free(all);
        close_scene(&s);
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(many_steps_come_to_the_same),
        cmocka_unit_test(a_hot_thin_cell_adapts),
    };
    int failed = linear_module() ? cmocka_run_group_tests(tests, NULL, NULL) : SKIPPED;
    comm_finish(world);
    return failed;
}
