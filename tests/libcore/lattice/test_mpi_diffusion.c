/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Viscous stress and heat conduction on tiles: exact decays, the operator against its definition, what must not happen.
 */
#include "tests/libcore/gas/viscous.h" /* last: cmocka.h defines fail() */

static struct comm *world;

/* With s->models. wall: of both sides of every axis that is not periodic */
static void fill_scene(struct scene *s, int dim, const int n[3], int periodic, const char *wall, int tile) {
    set_walls(s, wall);
    open_box(s, world, dim, n, (double[3]){1, 1, 1}, (bool[3]){periodic > 0, periodic > 1, periodic > 2}, tile);
}

static void open_scene(struct scene *s, int dim, const int n[3], int periodic, const char *wall,
                       const struct transport *transport, const char *diffusion, int tile) {
    *s = (struct scene){.models = disks_models(transport, diffusion)};
    fill_scene(s, dim, n, periodic, wall, tile);
}

/* ---- exact decays --------------------------------------------------------------------------------------------------
 */

static int wave; /* 0: of T, 1: of the velocity along the wave, 2: across it */
static void wavy(const double x[3], double *rho, double u[3], double *T) {
    *rho = 2;
    *T = wave == 0 ? 1 + 0.3 * sin(TWO_PI * x[0]) : 1;
    for (int k = 1; k < 3; k++) u[k - 1] = wave == k ? 0.5 * sin(TWO_PI * x[0]) : 0;
}

/* The implicit one is slow where ranks share cores (test_mpi_implicit.c). */
static bool can(int scheme) {
    return diffusion_table[scheme].plan || (comm_size(world) == 1 && scheme_is_there(scheme));
}

static double decay_error(const char *diffusion, int dim, int n) {
    struct scene s;
    const double time = 0.02, rate[3] = {CONDUCTION, BULK_VISCOSITY + VISCOSITY, VISCOSITY}; /* of disks */
    open_scene(&s, dim, (int[3]){n, 4, 1}, 3, "slip", &CONSTANT, diffusion, 16);
    start(&s, wavy);
    spread(&s, n / 8, time / (n / 8));
    double *all = state_of(&s, world), error = 0, left = exp(-rate[wave] / 2 * TWO_PI * TWO_PI * time);
    for (int i = 0; i < s.cells; i++) {
        double found = wave ? all[wave * s.cells + i] / 2 / 0.5 : (temperature(all, dim, s.cells, i) - 1) / 0.3;
        error = fmax(error, fabs(found - left * sin(TWO_PI * s.centre[3 * i])));
    }
    free(all);
    close_scene(&s);
    return error;
}

static void waves_decay_at_second_order(void **state) {
    (void)state;
    for (int scheme = 0; scheme < diffusion_count; scheme++)
        for (wave = 0; wave < 3 && can(scheme); wave++) {
            double error[3];
            for (int i = 0; i < 3; i++)
                error[i] = decay_error(diffusion_table[scheme].model.name, wave < 2 ? 1 : 2, 16 << i);
            assert_near(error[2], 0, 2e-3);
            assert_near(log2(error[1] / error[2]), 2, 0.1);
        }
}

/* ---- the operator --------------------------------------------------------------------------------------------------
 */

enum gas_of { MADE_UP, OF_AXES, DISKS, SPHERES }; /* laws: all terms, `diagonal`, Jenkins & Richman, Garzo & Dufty */
static const char *const gas_name[] = {"made-up law", "diagonal stress", "disks", "spheres"};

/* Grains that cool and fall. */
static void open_manufactured(struct scene *s, int dim, int components, int n, enum gas_of gas, const char *diffusion) {
    const struct transport *law = gas == MADE_UP   ? &COMPLETE
                                  : gas == OF_AXES ? &DIAGONAL
                                                   : transport_find("JenkinsRichman");
    const char *eos = gas == DISKS ? "TorquatoDisks" : "TorquatoSpheres";
    *s = (struct scene){.models = gas == SPHERES ? spheres_models(0.8, 0.5, true, diffusion)
                                                 : grains_models(eos, 0.9, 0.5, law, diffusion)};
    s->models.source = (struct sources){.cooling = cooling_find("Haff"), .gravity = {3, -5, 2}};
    s->models.components = components;
    fill_scene(s, dim, (int[3]){n, n, n}, 3, "slip", 8);
}

/* The largest error of all cells over the largest rate, of the diffusion alone or of a whole step. */
static double operator_error(enum gas_of gas, int dim, int components, int n, enum manufactured_part parts) {
    struct scene s;
    const double dt = 1e-7;
    double error = 0, scale = 0, wanted[MAX_VAR];
    open_manufactured(&s, dim, components, n, gas, "RKL2");
    start(&s, manufactured_fields);
    double *before = state_of(&s, world), *after;
    if (parts == OF_ALL)
        go(&s, 1, dt);
    else
        spread(&s, 1, dt);
    after = state_of(&s, world);
    for (int i = 0; i < s.cells; i++) {
        manufactured_rates(&s.models, dim, parts, s.centre + 3 * i, wanted);
        for (int v = 0; v < components + 2; v++) {
            int at = v * s.cells + i;
            error = fmax(error, fabs((after[at] - before[at]) / dt - wanted[v]));
            scale = fmax(scale, fabs(wanted[v]));
        }
    }
    free(before);
    free(after);
    close_scene(&s);
    return error / scale;
}

static void operator_is_of_second_order(void **state) {
    (void)state;
    for (enum gas_of gas = MADE_UP; gas <= SPHERES; gas++)
        for (int dim = 1; dim <= (gas == DISKS || comm_size(world) > 1 ? 2 : 3); dim++) {
            const enum manufactured_part parts = gas < DISKS ? OF_DIFFUSION : OF_ALL;
            const int n = dim == 3 ? 16 : 32;
            for (int all = 0; all < (dim < 3 ? 2 : 1); all++) {
                const int m = all ? 3 : dim; /* components */
                const double coarse = operator_error(gas, dim, m, n, parts),
                             fine = operator_error(gas, dim, m, 2 * n, parts);
                print_message("%s, %d dimensions, %d components: %.3g, %.3g: order %.2f\n", gas_name[gas], dim, m,
                              coarse, fine, log2(coarse / fine));
                assert_near(fine, 0, dim == 3 ? 0.04 : 0.02);
                assert_near(log2(coarse / fine), 2, 0.15);
            }
        }
}

/* All terms in whole steps, in the worst cell. */
static double driven_error(enum gas_of gas, int dim, int n, const char *diffusion) {
    struct scene s;
    double error[2];
    open_manufactured(&s, dim, dim, n, gas, diffusion);
    drive(&s, world, OF_ALL, dim == 3 ? 0.01 : 0.03, dim == 3 ? n : 3 * n, error);
    close_scene(&s);
    return error[0];
}

static void driven_gas_stays_at_second_order(void **state) {
    (void)state;
    const int some = comm_size(world) > 1 ? 1 : diffusion_count; /* other ranks: the same bits */
    for (int scheme = 0; scheme < some; scheme++)
        for (int dim = 2; dim <= (comm_size(world) > 1 ? 2 : 3) && can(scheme); dim++) {
            const enum gas_of gas = dim == 2 ? DISKS : SPHERES;
            const int n = dim == 2 ? 24 : 12;
            const char *diffusion = diffusion_table[scheme].model.name;
            const double coarse = driven_error(gas, dim, n, diffusion), fine = driven_error(gas, dim, 2 * n, diffusion);
            print_message("%s, %s: %.3g, %.3g: order %.2f\n", gas_name[gas], diffusion, coarse, fine,
                          log2(coarse / fine));
            assert_near(fine, 0, dim == 2 ? 0.02 : 0.1); /* of an energy of 9 */
            assert_near(log2(coarse / fine), 2, 0.15);
        }
}

/* ---- what must not happen ------------------------------------------------------------------------------------------
 */

enum { EDGE = 5 }; /* cells beside walls, which do not turn */
static bool inside(int dim, int n, int cell) {
    bool in = true;
    for (int k = 0; k < dim; k++, cell /= n) in = in && cell % n >= EDGE && cell % n < n - EDGE;
    return in;
}

/* Neither force nor heat from rigid rotation, whatever the axis and the viscosities. */
static void rotation_makes_no_heat(void **state) {
    (void)state;
    for (int dim = 2; dim <= 3; dim++) {
        struct scene s;
        const int n = dim == 2 ? 24 : 14;
        open_scene(&s, dim, (int[3]){n, n, n}, 0, "zeroGradient", &VARIED, "explicit", 8);
        turn(dim);
        start(&s, turning);
        double *before = state_of(&s, world), *after;
        shear(&s, 1e-4);
        after = state_of(&s, world);
        for (int i = 0; i < s.cells; i++)
            for (int v = 0; v < dim + 2 && inside(dim, n, i); v++)
                assert_near(after[v * s.cells + i], before[v * s.cells + i], 1e-13);
        assert_true(fabs(after[(dim + 1) * s.cells] - before[(dim + 1) * s.cells]) >
                    1e-6); /* a corner: something was done */
        free(before);
        free(after);
        close_scene(&s);
    }
}

/* The largest error of the heat of rotation over the largest heat, with the stress of derivatives across faces alone.
 */
static double turning_error(int dim, int n) {
    struct scene s;
    const double dt = 1e-7, square = spin[0] * spin[0] + spin[1] * spin[1] + spin[2] * spin[2];
    double error = 0, most = 0;
    open_scene(&s, dim, (int[3]){n, n, n}, 0, "zeroGradient", &DIAGONAL, "explicit", 8);
    start(&s, turning);
    double *before = state_of(&s, world), *after;
    shear(&s, dt);
    after = state_of(&s, world);
    for (int i = 0; i < s.cells; i++) {
        double bulk, viscosity, heat, T = 2, rise = 0;
        bool middle = inside(dim, n, i);
        for (int k = 0; k < dim; k++) middle = middle && fabs(s.centre[3 * i + k] - 0.5) < 0.11;
        if (!middle) continue;
        manufactured_law(NULL, &(struct closure_line){.n = 1, .rho = &before[i], .T = &T}, &bulk, &viscosity, &heat);
        for (int side = 0; side < 2; side++)
            rise += (side ? 1 : -1) * before[i] * temperature(side ? after : before, dim, s.cells, i) / dt;
        error = fmax(error, fabs(rise - 2 * viscosity * square));
        most = fmax(most, 2 * viscosity * square);
    }
    free(before);
    free(after);
    close_scene(&s);
    return error / most;
}

/* 2 shear w^2 a volume, as Shakeri et al. have it. */
static void diagonal_stress_heats_rotation(void **state) {
    (void)state;
    for (int dim = 2; dim <= 3; dim++) {
        turn(dim);
        const double coarse = turning_error(dim, 14), fine = turning_error(dim, 28);
        print_message("%d dimensions: %.3g, %.3g\n", dim, coarse, fine);
        assert_near(fine, 0, 1e-3);
        assert_near(log2(coarse / fine), 2, 0.2);
    }
}

static long repeated; /* for cells that would have become inadmissible: these, too, conserve */

/* A box of grains of each kind (models_of), of 24 x 18 or 12 x 10 x 8 cells. */
static void open_kind(struct scene *s, int dim, int periodic, const char *wall, const char *diffusion) {
    *s = (struct scene){.models = models_of(dim, diffusion)};
    fill_scene(s, dim, dim < 3 ? (int[]){24, 18, 1} : (int[]){12, 10, 8}, periodic, wall, 8);
}

static void totals_stay(int dim, const char *wall, int periodic, const char *diffusion) {
    struct scene s;
    double before[MAX_VAR], after[MAX_VAR];
    open_kind(&s, dim, periodic, wall, diffusion);
    start(&s, wild);
    ok(gas_totals(s.gas, before));
    const double all = fastest(&s, world);
    for (int i = 0; i < 2; i++) spread(&s, 2, (diffusion[0] == 'e' ? 3 : 50) / all); /* 50: one super step */
    ok(gas_totals(s.gas, after));
    repeated += gas_counts(s.gas).repeated;
    assert_true(after[0] == before[0]);
    assert_near(after[dim + 1], before[dim + 1], 1e-13 * before[dim + 1]);
    for (int k = 0; k < periodic && k < dim; k++)
        if (strcmp(wall, "noSlip") != 0 || periodic >= dim)
            assert_near(after[k + 1], before[k + 1], 1e-14 * before[dim + 1]);
    close_scene(&s);
}

/* Periodic, in boxes that slip and that do not: neither mass nor energy gets lost, nor what momentum walls leave. */
static void totals_are_conserved(void **state) {
    (void)state;
    for (int scheme = 0; scheme < diffusion_count; scheme++)
        for (int dim = 2; dim <= 3; dim++)
            for (int periodic = 0; periodic <= dim && can(scheme); periodic++) {
                totals_stay(dim, "slip", periodic, diffusion_table[scheme].model.name);
                totals_stay(dim, "noSlip", periodic, diffusion_table[scheme].model.name);
            }
    assert_true(repeated > 0);
}

static bool swapped;
static void wild_or_swapped(const double x[3], double *rho, double u[3], double *T) {
    const double y[3] = {swapped ? x[1] : x[0], swapped ? x[0] : x[1], x[2]};
    double v[3];
    wild(y, rho, v, T);
    u[0] = swapped ? v[1] : v[0];
    u[1] = swapped ? v[0] : v[1];
    u[2] = v[2];
}

/* Whole steps, with walls, have the same bits for any tiles and, in two dimensions, when the axes are swapped. */
static void bits_know_neither_tiles_nor_axes(void **state) {
    (void)state;
    for (int dim = 2; dim <= 3; dim++) {
        double *found[4];
        const int n = dim == 2 ? 24 : 14, cells = dim == 2 ? n * n : n * n * n;
        for (int i = 0; i < (dim == 2 ? 4 : 3); i++) {
            struct scene s = {.models = models_of(dim, "RKL2")};
            if (dim == 3) s.models = spheres_models(0.8, 0.2, true, "RKJ2");
            fill_scene(&s, dim, (int[3]){n, n, n}, 0, "noSlip", (const int[]){n / 3, n / 2, 48, n / 3}[i]);
            swapped = i == 3;
            start(&s, wild_or_swapped);
            run(&s, 2, 0.3);
            assert_true(gas_counts(s.gas).halves >= 4);
            found[i] = state_of(&s, world);
            close_scene(&s);
        }
        for (int i = 1; i < 3; i++)
            assert_memory_equal(found[i], found[0], (size_t)((dim + 2) * cells) * sizeof(double));
        for (int v = 0; v < 4 && dim == 2; v++)
            for (int i = 0; i < cells; i++) {
                const int other = v == 1 ? 2 : v == 2 ? 1 : v;
                assert_true(found[3][v * cells + i] == found[0][other * cells + i / n + n * (i % n)]);
            }
        for (int i = 0; i < (dim == 2 ? 4 : 3); i++) free(found[i]);
    }
}

/* Half steps that are done again count once in the budget, with heat from walls and, of spheres, from zeta_U: nothing
 * else has changed the energy. */
static void budget_counts_what_stands(void **state) {
    (void)state;
    for (int dim = 2; dim <= 3; dim++) {
        struct scene s;
        struct gas_budget b;
        open_kind(&s, dim, 0, "noSlip", "RKL2");
        for (int p = 0; p < 6; p++)
            s.rules[p].temperature = (struct rule){.type = boundary_find("fixedValue"), .uniform = {40}};
        if (dim == 3) {
            gas_free(s.gas);
            s.models = spheres_models(0.8, 0.2, true, "RKL2");
            ok(gas_make(s.forest, &s.models, 6, s.rules, &s.gas));
        }
        start(&s, wild);
        ok(gas_audit(s.gas));
        run(&s, 12, 4); /* steps so long that some are done again */
        ok(gas_budget(s.gas, &b));
        assert_true(gas_counts(s.gas).repeated + gas_counts(s.gas).rejected > 0);
        assert_near(b.lost[0], 0, 1e-13 * b.mass);
        assert_near(b.lost[1], 0, 1e-13 * b.energy);
        assert_true(fabs(b.gained[GAS_HEAT]) > 1e-3 * b.energy);
        assert_true((fabs(b.gained[GAS_DILATION]) > 1e-3 * b.energy) == (dim == 3));
        close_scene(&s);
    }
}

/* With transport, of spheres with all its terms: in the diffusion, and in whole steps. */
static void uniform_gas_keeps_its_bits(void **state) {
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (int whole = 0; whole < 2; whole++) {
            struct scene s = {.models = dim == 2 ? models_of(dim, "RKL2") : spheres_models(0.8, 0.2, true, "RKJ2")};
            fill_scene(&s, dim, (int[3]){20, 10, 9}, 3, "slip", 8);
            start(&s, uniform);
            double *before = state_of(&s, world);
            if (whole)
                run(&s, 3, 0.5);
            else
                spread(&s, 3, 0.7);
            double *after = state_of(&s, world);
            assert_memory_equal(before, after, (size_t)((dim + 2) * s.cells) * sizeof *before);
            free(before);
            free(after);
            close_scene(&s);
        }
}

static int waves_along; /* axes along which the breeze varies */
static void breeze(const double x[3], double *rho, double u[3], double *T) {
    double phase = 0;
    for (int k = 0; k < waves_along; k++) phase += TWO_PI * x[k];
    *rho = 40 + 5 * sin(phase);
    *T = 1 + 0.2 * cos(phase - TWO_PI * x[2]);
    u[0] = 0.5 * sin(phase + 1);
    u[1] = waves_along > 1 ? 0.4 * cos(TWO_PI * x[0]) : 0;
    u[2] = waves_along > 1 ? 0.3 * sin(TWO_PI * x[1]) : 0;
}

/* The state at t = 0.1 after `steps` steps; spheres cool and fall. */
static double *blown(const struct transport *law, int dim, int steps) {
    struct scene s = {.models = law ? disks_models(law, "RKL2") : spheres_models(0.8, 0.2, true, "RKL2")};
    if (!law) s.models.source = (struct sources){.cooling = cooling_find("GarzoDufty"), .gravity = {3, -5, 2}};
    waves_along = dim;
    fill_scene(&s, dim, dim == 1 ? (int[3]){64, 1, 1} : (int[3]){8, 8, 8}, 3, "slip", 16);
    start(&s, breeze);
    go(&s, steps, 0.1 / steps);
    double *all = state_of(&s, world);
    close_scene(&s);
    return all;
}

/* Splitting, super steps, stages, coefficients and sources together. */
static void steps_are_of_second_order(void **state) {
    (void)state;
    static const struct {
        int dim, steps, numbers;
    } rows[] = {{1, 48, 3 * 64}, {1, 48, 3 * 64}, {1, 48, 3 * 64}, {3, 16, 5 * 512}};
    for (int i = 0; i < 4; i++) {
        if (comm_size(world) > 1 && i != 2) continue; /* other ranks: the same bits */
        const struct transport *law = i == 0 ? &CONSTANT : i == 1 ? transport_find("JenkinsRichman") : NULL;
        double *fine = blown(law, rows[i].dim, (rows[i].dim == 3 ? 8 : 32) * rows[i].steps), error[2] = {0, 0};
        for (int k = 0; k < 2; k++) {
            double *all = blown(law, rows[i].dim, rows[i].steps << k);
            for (int v = 0; v < rows[i].numbers; v++) error[k] = fmax(error[k], fabs(all[v] - fine[v]));
            free(all);
        }
        free(fine);
        print_message("%d dimensions: %.3g, %.3g: order %.2f\n", rows[i].dim, error[0], error[1],
                      log2(error[0] / error[1]));
        assert_true(log2(error[0] / error[1]) > 1.9);
        assert_near(error[1], 0, rows[i].dim == 3 ? 0.01 : 0.005); /* of a density of 40 */
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(waves_decay_at_second_order),      cmocka_unit_test(operator_is_of_second_order),
        cmocka_unit_test(driven_gas_stays_at_second_order), cmocka_unit_test(rotation_makes_no_heat),
        cmocka_unit_test(diagonal_stress_heats_rotation),   cmocka_unit_test(totals_are_conserved),
        cmocka_unit_test(bits_know_neither_tiles_nor_axes), cmocka_unit_test(uniform_gas_keeps_its_bits),
        cmocka_unit_test(budget_counts_what_stands),        cmocka_unit_test(steps_are_of_second_order),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
