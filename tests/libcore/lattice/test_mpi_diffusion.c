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

/* Disks in one and two dimensions, spheres in three; they cool and fall. */
static void open_manufactured(struct scene *s, int dim, int n, const struct transport *law) {
    const struct eos *eos = eos_find(dim < 3 ? "TorquatoDisks" : "TorquatoSpheres");
    *s = (struct scene){.models = disks_models(law, "RKL2")};
    s->models.eos = eos;
    s->models.material = grains_of(eos, 0.9, 0.5);
    s->models.source = (struct sources){.cooling = cooling_find("Haff"), .gravity = {3, -5, 2}};
    fill_scene(s, dim, (int[3]){n, n, n}, 3, "slip", 8);
    start(s, manufactured_fields);
}

/* The largest error of all cells over the largest rate, of the diffusion alone or of a whole step. */
static double operator_error(const struct transport *law, int dim, int n, enum manufactured_part parts) {
    struct scene s;
    const double dt = 1e-7;
    double error = 0, scale = 0, wanted[MAX_VAR];
    open_manufactured(&s, dim, n, law);
    double *before = state_of(&s, world), *after;
    if (parts == OF_ALL)
        go(&s, 1, dt);
    else
        spread(&s, 1, dt);
    after = state_of(&s, world);
    for (int i = 0; i < s.cells; i++) {
        manufactured_rates(&s.models, dim, parts, s.centre + 3 * i, wanted);
        for (int v = 0; v < dim + 2; v++) {
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
    for (int all = 0; all < 2; all++)
        for (int dim = 1; dim <= 3; dim++) {
            const enum manufactured_part parts = all ? OF_ALL : OF_STRESS | OF_HEAT;
            const struct transport *law = all && dim < 3 ? transport_find("JenkinsRichman") : &VARIED;
            const int n = dim == 3 ? 16 : 32;
            double coarse = operator_error(law, dim, n, parts), fine = operator_error(law, dim, 2 * n, parts);
            assert_near(fine, 0, dim == 3 ? 0.04 : 0.02);
            assert_near(log2(coarse / fine), 2, 0.15);
        }
}

/* All terms in whole steps: what keeps the manufactured fields steady is added in halves around each of them; what is
 * left at the end is the error of space and splitting. */
static double steady_error(int n) {
    struct scene s;
    const double time = 0.03;
    double error = 0;
    open_manufactured(&s, 2, n, transport_find("JenkinsRichman"));
    double *begin = state_of(&s, world), *drive = malloc(4 * (size_t)s.cells * sizeof *drive);
    for (int i = 0; i < s.cells; i++) {
        double rates[MAX_VAR];
        manufactured_rates(&s.models, 2, OF_ALL, s.centre + 3 * i, rates);
        for (int v = 0; v < 4; v++) drive[v * s.cells + i] = -rates[v];
    }
    const int count = 3 * n;
    for (int step = 0; step < 2 * count; step++) {
        double *now = state_of(&s, world);
        const double *U[MAX_VAR];
        for (int i = 0; i < 4 * s.cells; i++) now[i] += 0.5 * time / count * drive[i];
        for (int v = 0; v < 4; v++) U[v] = now + v * s.cells;
        gas_set_conserved(s.gas, U);
        free(now);
        if (step % 2 == 0) go(&s, 1, time / count);
    }
    double *end = state_of(&s, world);
    for (int i = 0; i < 4 * s.cells; i++) error = fmax(error, fabs(end[i] - begin[i]));
    free(begin);
    free(drive);
    free(end);
    close_scene(&s);
    return error;
}

static void driven_gas_stays_at_second_order(void **state) {
    (void)state;
    double error[2];
    for (int i = 0; i < 2; i++) error[i] = steady_error(24 << i);
    assert_near(error[1], 0, 0.02); /* of an energy of 9 */
    assert_near(log2(error[0] / error[1]), 2, 0.15);
}

/* ---- what must not happen ------------------------------------------------------------------------------------------
 */

/* Neither force nor heat from rigid rotation, whatever the viscosities; away from the edges, which do not turn. */
static void rotation_makes_no_heat(void **state) {
    (void)state;
    struct scene s;
    const int n = 24, edge = 5;
    open_scene(&s, 2, (int[3]){n, n, 1}, 0, "zeroGradient", &VARIED, "explicit", 8);
    start(&s, turning);
    double *before = state_of(&s, world), *after;
    spread(&s, 1, 1e-4);
    after = state_of(&s, world);
    for (int i = 0; i < s.cells; i++) {
        const int x = i % n, y = i / n;
        if (x < edge || y < edge || x >= n - edge || y >= n - edge) continue;
        for (int v = 0; v < 4; v++) assert_near(after[v * s.cells + i], before[v * s.cells + i], 1e-13);
    }
    assert_true(fabs(after[3 * s.cells] - before[3 * s.cells]) > 1e-6); /* a corner: something was done */
    free(before);
    free(after);
    close_scene(&s);
}

static long repeated; /* for cells that would have become inadmissible: these, too, conserve */

static void totals_stay(const char *wall, int periodic, const char *diffusion) {
    struct scene s;
    double before[MAX_VAR], after[MAX_VAR];
    open_scene(&s, 2, (int[3]){24, 18, 1}, periodic, wall, transport_find("JenkinsRichman"), diffusion, 8);
    start(&s, wild);
    ok(gas_totals(s.gas, before));
    const double all = fastest(&s, world);
    for (int i = 0; i < 2; i++) spread(&s, 2, (diffusion[0] == 'e' ? 3 : 50) / all); /* 50: one super step */
    ok(gas_totals(s.gas, after));
    repeated += gas_counts(s.gas).repeated;
    assert_true(after[0] == before[0]);
    assert_near(after[3], before[3], 1e-13 * before[3]);
    if (periodic > 0 && strcmp(wall, "noSlip") != 0) assert_near(after[1], before[1], 1e-14 * before[3]);
    if (periodic > 1) assert_near(after[2], before[2], 1e-14 * before[3]);
    close_scene(&s);
}

/* Periodic, in boxes that slip and that do not: neither mass nor energy gets lost, nor what momentum walls leave. */
static void totals_are_conserved(void **state) {
    (void)state;
    for (int scheme = 0; scheme < diffusion_count; scheme++)
        for (int periodic = 0; periodic < 3 && can(scheme); periodic++) {
            totals_stay("slip", periodic, diffusion_table[scheme].model.name);
            totals_stay("noSlip", periodic, diffusion_table[scheme].model.name);
        }
    assert_true(repeated > 0);
}

static bool swapped;
static void wild_or_swapped(const double x[3], double *rho, double u[3], double *T) {
    double y[3] = {swapped ? x[1] : x[0], swapped ? x[0] : x[1], 0}, v[3];
    wild(y, rho, v, T);
    u[0] = swapped ? v[1] : v[0];
    u[1] = swapped ? v[0] : v[1];
}

/* Whole steps, with walls, have the same bits for any tiles and when the axes are swapped. */
static void bits_know_neither_tiles_nor_axes(void **state) {
    (void)state;
    double *found[4];
    const int n = 24;
    for (int i = 0; i < 4; i++) {
        struct scene s;
        open_scene(&s, 2, (int[3]){n, n, 1}, 0, "noSlip", transport_find("JenkinsRichman"), "RKL2",
                   (const int[]){8, 12, 48, 8}[i]);
        swapped = i == 3;
        start(&s, wild_or_swapped);
        run(&s, 2, 0.3);
        assert_true(gas_counts(s.gas).halves >= 4);
        found[i] = state_of(&s, world);
        close_scene(&s);
    }
    for (int i = 1; i < 3; i++) assert_memory_equal(found[i], found[0], 4 * n * n * sizeof(double));
    for (int v = 0; v < 4; v++)
        for (int i = 0; i < n * n; i++) {
            const int other = v == 1 ? 2 : v == 2 ? 1 : v;
            assert_true(found[3][v * n * n + i] == found[0][other * n * n + i / n + n * (i % n)]);
        }
    for (int i = 0; i < 4; i++) free(found[i]);
}

/* Half steps that are done again count once in the budget, with heat from walls: nothing else has changed the energy.
 */
static void budget_counts_what_stands(void **state) {
    (void)state;
    struct scene s;
    struct gas_budget b;
    open_scene(&s, 2, (int[3]){24, 18, 1}, 0, "noSlip", transport_find("JenkinsRichman"), "RKL2", 8);
    for (int p = 0; p < 6; p++)
        s.rules[p].temperature = (struct rule){.type = boundary_find("fixedValue"), .uniform = {40}};
    start(&s, wild);
    ok(gas_audit(s.gas));
    run(&s, 12, 0.4);
    ok(gas_budget(s.gas, &b));
    assert_true(gas_counts(s.gas).repeated + gas_counts(s.gas).rejected > 0);
    assert_near(b.lost[0], 0, 1e-13 * b.mass);
    assert_near(b.lost[1], 0, 1e-13 * b.energy);
    assert_true(fabs(b.gained[GAS_HEAT]) > 1e-3 * b.energy);
    close_scene(&s);
}

static void uniform_gas_keeps_its_bits(void **state) {
    (void)state;
    struct scene s;
    open_scene(&s, 2, (int[3]){20, 10, 1}, 3, "slip", transport_find("JenkinsRichman"), "RKL2", 8);
    start(&s, uniform);
    double *before = state_of(&s, world);
    spread(&s, 3, 0.7);
    double *after = state_of(&s, world);
    assert_memory_equal(before, after, 4 * (size_t)s.cells * sizeof *before);
    free(before);
    free(after);
    close_scene(&s);
}

static void breeze(const double x[3], double *rho, double u[3], double *T) {
    *rho = 40 + 5 * sin(TWO_PI * x[0]);
    *T = 1 + 0.2 * cos(TWO_PI * x[0]);
    u[0] = 0.5 * sin(TWO_PI * x[0] + 1);
}

/* The state at t = 0.1 after `steps` steps. */
static double *blown(const struct transport *law, int steps) {
    struct scene s;
    open_scene(&s, 1, (int[3]){64, 1, 1}, 3, "slip", law, "RKL2", 16);
    start(&s, breeze);
    go(&s, steps, 0.1 / steps);
    double *all = state_of(&s, world);
    close_scene(&s);
    return all;
}

/* Splitting, super steps, stages and coefficients together. */
static void steps_are_of_second_order(void **state) {
    (void)state;
    const struct transport *law[2] = {&CONSTANT, transport_find("JenkinsRichman")};
    for (int i = 0; i < 2; i++) {
        double *fine = blown(law[i], 1536), error[2] = {0, 0};
        for (int k = 0; k < 2; k++) {
            double *all = blown(law[i], 48 << k);
            for (int v = 0; v < 3 * 64; v++) error[k] = fmax(error[k], fabs(all[v] - fine[v]));
            free(all);
        }
        free(fine);
        assert_true(log2(error[0] / error[1]) > 1.9);
        assert_near(error[1], 0, 5e-3); /* of a density of 40 */
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(waves_decay_at_second_order),
        cmocka_unit_test(operator_is_of_second_order),
        cmocka_unit_test(driven_gas_stays_at_second_order),
        cmocka_unit_test(rotation_makes_no_heat),
        cmocka_unit_test(totals_are_conserved),
        cmocka_unit_test(bits_know_neither_tiles_nor_axes),
        cmocka_unit_test(uniform_gas_keeps_its_bits),
        cmocka_unit_test(budget_counts_what_stands),
        cmocka_unit_test(steps_are_of_second_order),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
