/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What one step of each implicit scheme leaves of a mode: R(z) as measured, z = -dt times the mode's rate. */
#include "tests/libcore/gas/viscous.h" /* last: cmocka.h defines fail() */

static struct comm *world;
enum { N = 16 };

static int kind; /* 0: T, 1: the velocity along the wave, 2: across it */
static void zigzag(const double x[3], double *rho, double u[3], double *T) {
    const double sign = (int)(x[0] * N) % 2 ? -1 : 1;
    *rho = 2;
    *T = kind ? 1 : 1 + 0.3 * sign;
    for (int k = 1; k < 3; k++) u[k - 1] = kind == k ? 0.5 * sign : 0;
}

/* The mode of neighbours that differ in sign, the stiffest: its amplitude after `steps` steps that cover dt times its
 * rate of `z` together, over that before. */
static double left_of(const char *diffusion, double z, int steps) {
    struct scene s = {.models = disks_models(&CONSTANT, diffusion)};
    double rate[2], left = 0;
    set_walls(&s, "slip");
    open_box(&s, world, 2, (int[3]){N, 4, 1}, (double[3]){1, 1, 1}, (bool[3]){true, true, false}, 8);
    start(&s, zigzag);
    s.gas->engine->diffusion.rates(s.gas, &s.gas->U, rate, NULL);
    /* of disks: rho dT/dt = CONDUCTION d2T/dx2, rho du/dt = (BULK_VISCOSITY + VISCOSITY) d2u/dx2, VISCOSITY d2u/dx2 */
    const double coefficient[] = {CONDUCTION, BULK_VISCOSITY + VISCOSITY, VISCOSITY}, rho = 2;
    spread(&s, steps, z / steps / (4 * N * N * coefficient[kind] / rho));
    assert_true(gas_counts(s.gas).repeated == 0);
    double *all = state_of(&s, world);
    for (int i = 0; i < s.cells; i++) {
        const double sign = (int)(s.centre[3 * i] * N) % 2 ? -1 : 1;
        const double found = kind ? all[kind * s.cells + i] / rho / 0.5 : (temperature(all, 2, s.cells, i) - 1) / 0.3;
        left += sign * found / s.cells;
    }
    free(all);
    close_scene(&s);
    return left;
}

static double by_sdirk(double z) {
    const double gamma = 1 - sqrt(0.5);
    return (1 - (1 - 2 * gamma) * z) / ((1 + gamma * z) * (1 + gamma * z));
}
static double by_midpoint(double z) {
    return (1 - z / 2) / (1 + z / 2);
}
static double by_gauss(double z) {
    return (1 - z / 2 + z * z / 12) / (1 + z / 2 + z * z / 12);
}
static const struct scheme {
    const char *name;
    double (*R)(double z);
    int order;
} SCHEME[] = {{"implicit", by_sdirk, 2}, {"implicitMidpoint", by_midpoint, 2}, {"gaussLegendre", by_gauss, 4}};

/* Every implicit row leaves what its rational function says, to the solver's 1e-6 of T, or of the speed that the cell's
 * energy amounts to: stiff modes die, flip their sign, or stay. On more ranks, where all iterations wait for all, T and
 * two z only. */
static void rational_functions(void **state) {
    (void)state;
    static const double z[] = {10, 5e4, 0.5, 100, 1e3};
    const bool alone = comm_size(world) == 1;
    int found = 0;
    for (int i = 0; i < diffusion_count; i++) found += !diffusion_table[i].plan;
    assert_int_equal(found, 3); /* a new row needs its R here */
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < (alone ? 5 : 2); i++)
            for (kind = 0; kind < (alone ? 3 : 1); kind++) {
                const double R = left_of(SCHEME[k].name, z[i], 1);
                if (kind == 0) print_message("%-17s z = -%-6g R = %9.6f\n", SCHEME[k].name, z[i], R);
                assert_near(R, SCHEME[k].R(z[i]), kind ? 2e-5 : 1e-5);
            }
}

/* With frozen coefficients the error of a mode falls with dt to the order of the scheme. */
static void orders(void **state) {
    (void)state;
    if (comm_size(world) > 1) skip();
    for (int k = 0; k < 3; k++)
        for (kind = 0; kind < 3; kind++) {
            const double exact = exp(-4),
                         error[2] = {fabs(left_of(SCHEME[k].name, 4, SCHEME[k].order == 4 ? 2 : 16) - exact),
                                     fabs(left_of(SCHEME[k].name, 4, SCHEME[k].order == 4 ? 4 : 32) - exact)};
            const double order = log2(error[0] / error[1]);
            print_message("%s, kind %d: %.2e, %.2e: order %.2f\n", SCHEME[k].name, kind, error[0], error[1], order);
            assert_near(order, SCHEME[k].order, 0.35);
        }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rational_functions),
        cmocka_unit_test(orders),
    };
    int failed = linear_module() ? cmocka_run_group_tests(tests, NULL, NULL) : SKIPPED;
    comm_finish(world);
    return failed;
}
