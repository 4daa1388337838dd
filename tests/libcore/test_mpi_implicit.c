/* Implicit diffusion on tiles beside exact and explicit results; what a stiff step must not do. */
#include "libcore/state.h"
#include "tests/box.h"

#include "tests/libcore/oracle.h" /* last: cmocka.h defines fail() */

static struct comm *world;
enum { NX = 24, NY = 18, CELLS = NX * NY };

/* Coefficients that do not change with T or u: what is left in time is the schemes. */
static void of_density(const struct transport_numbers *t, const struct eos *eos, const struct material *m, int n,
                       const double *restrict rho, const double *restrict T, double *restrict bulk,
                       double *restrict shear, double *restrict heat) {
    (void)t, (void)eos, (void)m, (void)T;
    for (int i = 0; i < n; i++) {
        bulk[i] = 0.4 * rho[i];
        shear[i] = 0.7 * rho[i] * rho[i];
        heat[i] = 1.1 / rho[i];
    }
}
static const struct transport LAW = {.coefficients = of_density};

struct scene {
    struct box box;
    struct forest *forest;
    struct gas *gas;
    struct patch_rules rules[6];
};

static void must(status s) {
    if (s) fail_msg("%s", status_text(s));
}

static void open_scene(struct scene *s, const char *wall, const struct transport *transport, const char *diffusion) {
    box_make(&s->box, 2, (int[3]){NX, NY, 1}, (double[3]){1, 1, 1}, (bool[3]){true, false, false});
    const struct gas_models models = {.material = grains_of(eos_find("TorquatoDisks"), 0.9, 0.1),
                                      .eos = eos_find("TorquatoDisks"),
                                      .flux = flux_find("common"),
                                      .reconstruct = reconstruct_find("WENO5"),
                                      .stepper = stepper_find("SSPRK3"),
                                      .transport = transport,
                                      .numbers = {1e-4, 1},
                                      .diffusion = diffusion_find(diffusion)};
    memset(s->rules, 0, sizeof s->rules);
    for (int p = 0; p < 6; p++) {
        s->rules[p].density.type = s->rules[p].temperature.type = boundary_find("zeroGradient");
        s->rules[p].velocity.type = boundary_find(wall);
    }
    must(forest_make(&s->box.lattice, &s->box.mesh, world, 8, &s->forest));
    must(gas_make(s->forest, &models, 6, s->rules, &s->gas));
}

static void close_scene(struct scene *s) {
    gas_free(s->gas);
    forest_free(s->forest);
    box_free(&s->box);
}

typedef void initial(int i, int j, double *rho, double u[2], double *T);

static void start(struct scene *s, initial *at) {
    static double rho[CELLS], u[3][CELLS], T[CELLS];
    for (int i = 0; i < CELLS; i++) {
        double v[2] = {0, 0};
        at(i % NX, i / NX, &rho[i], v, &T[i]);
        u[0][i] = v[0];
        u[1][i] = v[1];
    }
    must(gas_set(s->gas, rho, (const double *const[3]){u[0], u[1], u[2]}, T));
}

static void spread(struct scene *s, int steps, double dt) {
    struct gas *g = s->gas;
    for (int i = 0; i < steps; i++) {
        assert_true(diffuse(g, &g->U, &g->U0, dt, i % 2, 0));
        struct state moved = g->U0;
        g->U0 = g->U;
        g->U = moved;
    }
    must(gas_check(g));
}

static void state_of(const struct scene *s, double all[4][CELLS]) {
    must(gas_get_conserved(s->gas, (double *const[MAX_VAR]){all[0], all[1], all[2], all[3]}));
    comm_broadcast(world, all, 4 * CELLS * (long)sizeof(double));
}

/* (gamma - 1) is 1 */
static double temperature(double all[4][CELLS], int i) {
    return (all[3][i] - 0.5 * (all[1][i] * all[1][i] + all[2][i] * all[2][i]) / all[0][i]) / all[0][i];
}

static void gentle(int i, int j, double *rho, double u[2], double *T) {
    const double x = 6.283185307179586 * i / NX, y = 6.283185307179586 * j / NY;
    *rho = 1.5 + 0.4 * sin(x) * cos(y);
    *T = 3 + sin(x + y) + 0.5 * cos(x);
    u[0] = cos(y) + 0.3 * sin(x);
    u[1] = 0.5 * sin(x - y);
}

/* Of second order in time towards what many explicit steps come to, with walls of either kind; on more ranks only
 * close, as all iterations wait for all ranks. */
static void many_steps_come_to_the_same(void **state) {
    (void)state;
    static double exact[4][CELLS], found[4][CELLS];
    static const char *const walls[] = {"slip", "noSlip"};
    const bool alone = comm_size(world) == 1;
    for (int wall = 0; wall < 1 + alone; wall++) {
        struct scene s;
        double error[2] = {0, 0};
        open_scene(&s, walls[wall], &LAW, "explicit");
        start(&s, gentle);
        spread(&s, 400, 0.01 / 400);
        state_of(&s, exact);
        close_scene(&s);
        for (int k = alone ? 0 : 1; k < 2; k++) {
            const int steps = alone ? 32 << k : 8;
            open_scene(&s, walls[wall], &LAW, "implicit");
            start(&s, gentle);
            spread(&s, steps, 0.01 / steps);
            for (int what = 0; what < 2; what++) { /* few, as the preconditioner is nearly the system */
                const long each = gas_counts(s.gas).stages[what] / steps;
                assert_true(each > 0 && each < 30);
            }
            assert_true(gas_counts(s.gas).repeated == 0);
            state_of(&s, found);
            close_scene(&s);
            for (int v = 0; v < 4; v++)
                for (int i = 0; i < CELLS; i++) error[k] = fmax(error[k], fabs(found[v][i] - exact[v][i]));
        }
        if (alone) assert_true(log2(error[0] / error[1]) > 1.8);
        assert_near(error[1], 0, alone ? 1e-3 : 1e-2); /* of an energy of 10 */
    }
}

static double spot_T;
static void spot(int i, int j, double *rho, double u[2], double *T) {
    const bool here = i == 5 && j == 7;
    (void)u;
    *rho = here ? 1e-3 : 40;
    *T = here ? spot_T : 1;
}

/* One hot thin cell in dense gas: temperatures become even, and no cell is left colder than the coldest was. After one
 * very stiff step it may be, by 5/z of its excess: R(z). */
static void a_hot_thin_cell_adapts(void **state) {
    (void)state;
    static double all[4][CELLS];
    for (int stiff = 0; stiff < 2; stiff++) {
        struct scene s;
        double before[MAX_VAR], after[MAX_VAR], rate[2], low = HUGE_VAL, high = 0;
        spot_T = stiff ? 1e6 : 50;
        open_scene(&s, "slip", transport_find("JenkinsRichman"), "implicit");
        start(&s, spot);
        must(gas_totals(s.gas, before));
        s.gas->engine->diffusion_rates(s.gas, &s.gas->U, rate);
        comm_max(world, rate, 2);
        spread(&s, stiff ? 2 : 1, (stiff ? 1e8 : 8) / rate[HEAT]);
        must(gas_totals(s.gas, after));
        assert_near(after[3], before[3], 1e-14 * before[3]);
        state_of(&s, all);
        for (int i = 0; i < CELLS; i++) {
            low = fmin(low, temperature(all, i));
            high = fmax(high, temperature(all, i));
        }
        assert_true(low > 1 - 1e-5);
        assert_true(high < (stiff ? 1.1 : 0.5 * spot_T));
        if (!stiff) assert_true(gas_counts(s.gas).repeated == 1); /* R < 0 there, so backward Euler took over */
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
    int failed = implicit_available() ? cmocka_run_group_tests(tests, NULL, NULL) : 0;
    comm_finish(world);
    return failed;
}
