/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The implicit acoustic step of a bed (libcore/acoustics/bed.h): rest, conservation, bounds at any step, and the orders
 * that the header promises. */
#include "tests/libcore/acoustics/box_bed.h"

static struct comm *comm;
static const double DEEP = 9.81; /* m/s^2 */

static double total(const struct box *x, int v) {
    double sum = 0;
    for (int i = 0; i < x->bed.set.cells; i++) sum += x->bed.set.U[v][i] * volume_of(x, i);
    return sum;
}

static double alpha_of(const struct box *x, int i) {
    return x->bed.set.U[0][i] * packing_per_density(&x->material);
}

static double eps_at(const struct box *x, int i) {
    double square = 0;
    for (int k = 1; k <= x->bed.dim; k++) square += x->bed.set.U[k][i] * x->bed.set.U[k][i];
    return (x->bed.set.U[x->bed.dim + 1][i] - 0.5 * square / x->bed.set.U[0][i]) / x->bed.set.U[0][i];
}

/* A column at rest in which T is uniform, and its step of 300 times that of sound. */
static double lay_column(struct box *x, double alpha, double T) {
    double fastest = 0;
    for (int i = 0; i < x->bed.set.cells; i++) {
        double p, c2, gruneisen;
        const double rho = alpha / packing_per_density(&x->material), eps = eps_of(&x->material, T);
        set(x, i, alpha, T, 0, 0);
        x->bed.eos->state(&x->material, 1, &rho, &eps, &p, &c2, &gruneisen);
        fastest = larger(fastest, sqrt(c2));
        alpha = above(x, p, rho, T, 0.5 * DEEP * x->form.width);
    }
    return 300 * x->form.width / fastest;
}

static void test_a_column_at_rest_stays_so(void **state) {
    (void)state;
    static const char *const eos[] = {"GoldshteinShapiro", "TorquatoSpheres"};
    const double gravity[MAX_DIM] = {-DEEP};
    for (int k = 0; k < 2; k++) {
        struct box x;
        box_make(&x, comm, eos[k], 1, 30, 1, 1, false, false);
        const double T = 40, dt = lay_column(&x, 0.63, T), mass = total(&x, 0);
        for (int step = 0; step < 200; step++) {
            bool done;
            ok(bed_step(&x.bed, dt, gravity, &done));
            assert_true(done);
        }
        for (int i = 0; i < x.bed.set.cells; i++) {
            assert_true(fabs(x.bed.set.U[1][i] / x.bed.set.U[0][i]) < 1e-9 * sqrt(T));
            assert_true(fabs(temperature_of(&x.material, eps_at(&x, i)) - T) < 1e-9 * T);
        }
        assert_true(fabs(total(&x, 0) - mass) < 1e-13 * mass);
        box_free(&x);
    }
}

/* Gas of uniform density whose pressure carries it: P is the same on both sides of every face. */
static void test_gas_on_triangles_at_rest_stays_so(void **state) {
    (void)state;
    const double gravity[MAX_DIM] = {-0.3 * DEEP, -DEEP};
    struct box x;
    bool done;
    box_make(&x, comm, "TorquatoSpheres", 1, 6, 5, 1, false, true);
    const double rho = 0.63 / packing_per_density(&x.material), one = 1;
    double p, c2, gruneisen, fastest = 0;
    x.bed.eos->state(&x.material, 1, &rho, &one, &p, &c2, &gruneisen);
    double *eps = calloc((size_t)x.bed.set.cells, sizeof *eps);
    for (int i = 0; i < x.bed.set.cells; i++) {
        eps[i] = rho * (1000 + gravity[0] * x.centre[i][0] + gravity[1] * x.centre[i][1]) / p;
        set(&x, i, 0.63, temperature_of(&x.material, eps[i]), 0, 0);
        fastest = larger(fastest, sqrt(c2 * eps[i]));
    }
    const double dt = 300 / fastest;
    for (int step = 0; step < 200; step++) {
        ok(bed_step(&x.bed, dt, gravity, &done));
        assert_true(done);
    }
    for (int i = 0; i < x.bed.set.cells; i++) {
        assert_true(hypot(x.bed.set.U[1][i], x.bed.set.U[2][i]) / x.bed.set.U[0][i] < 1e-9 * sqrt(1000 * rho / p));
        assert_true(fabs(eps_at(&x, i) - eps[i]) < 1e-9 * eps[i]);
    }
    free(eps);
    box_free(&x);
}

/* Gas of any packing and temperature that rushes about, with steps far beyond that of sound: if a step succeeds, all is
 * admissible; mass, momentum and energy of a periodic box are conserved but for what lifting added. Acoustics leave a
 * cell 0.95 of eps at the root p of (*), or at the start if that is less: in some cells just that. */
static void test_bounds_and_conservation_at_any_step(void **state) {
    (void)state;
    static const char *const eos[] = {"GoldshteinShapiro", "TorquatoSpheres", "TorquatoDisks"};
    const double gravity[MAX_DIM] = {0};
    unsigned seed = 7;
    int stood[2] = {0, 0}, lifted = 0;
    for (int k = 0; k < 120; k++) {
        struct box x;
        box_make(&x, comm, eos[k % 3], 0.8, 12, 8, 1, true, k >= 60);
        for (int i = 0; i < x.bed.set.cells; i++)
            set(&x, i, chance(&seed) < 0.2 ? 1e-8 : 0.64 * (1 - pow(10, -6 * chance(&seed)) * 0.9),
                pow(10, 4 * chance(&seed) - 2), chance(&seed) - 0.5, chance(&seed) - 0.5);
        const double dt = pow(10, -3 + 3 * chance(&seed)), before[] = {total(&x, 0), total(&x, 1), total(&x, 3)};
        bool done;
        ok(bed_step(&x.bed, dt, gravity, &done));
        for (int i = 0; done && i < x.bed.set.cells; i++) {
            assert_true(x.bed.set.U[0][i] > 0 && x.bed.set.U[0][i] < x.bed.limit);
            assert_true(eps_at(&x, i) > 0);
            const struct bed_lines *b = x.bed.lines;
            const double pressed = smaller(b->eps[i], b->eps[i] - b->p[i] * (1 / b->root[i] - 1 / b->rho[i]));
            assert_true(b->after[3][i] > 0.95 * pressed * (1 - 1e-12));
            lifted += b->after[3][i] < 0.95 * pressed * (1 + 1e-12);
        }
        if (done) {
            assert_true(fabs(total(&x, 0) - before[0]) < 1e-12 * before[0]);
            assert_true(fabs(total(&x, 1) - before[1]) < 1e-10 * before[2]);
            assert_true(fabs(total(&x, 3) - before[2] - x.bed.set.lift[0]) < 1e-10 * before[2]);
            stood[k >= 60]++;
        }
        box_free(&x);
    }
    assert_true(stood[0] > 30 && stood[1] > 20 && lifted > 20);
}

/* Cold gas that carries weight has 1e-12 of its volume left. Newton's method goes on while it would leave less: without
 * that, one in ten of these steps has a cell that is packed. */
static void test_cold_gas_that_is_pushed_is_not_packed(void **state) {
    (void)state;
    const double gravity[MAX_DIM] = {-DEEP};
    unsigned seed = 11;
    for (int times = 0; times < 100; times++) {
        struct box x;
        bool done;
        box_make(&x, comm, "TorquatoSpheres", 0.8, 30, 1, 1, false, false);
        (void)lay_column(&x, 0.64 * (1 - 1e-12), 1e-10);
        for (int i = 0; i < x.bed.set.cells; i++) set(&x, i, alpha_of(&x, i), 1e-10, 0.6 * (chance(&seed) - 0.5), 0);
        ok(bed_step(&x.bed, 0.01, gravity, &done));
        assert_true(done);
        for (int i = 0; i < x.bed.set.cells; i++) assert_true(x.bed.set.U[0][i] < x.bed.limit);
        box_free(&x);
    }
}

/* A packed column is thrown at a wall: it stops within a few steps, however long they are, and does not pass
 * packing. */
static void test_a_block_that_hits_a_wall_is_not_pressed_beyond_packing(void **state) {
    (void)state;
    const double gravity[MAX_DIM] = {0};
    struct box x;
    bool done = false;
    box_make(&x, comm, "TorquatoSpheres", 0.9, 20, 1, 1, false, false);
    for (int i = 0; i < 20; i++) set(&x, i, i < 15 ? 0.6399 : 1e-6, 1e-4, i < 15 ? -1 : 0, 0);
    for (int step = 0; step < 20; step++) {
        for (double dt = 0.2; !done && dt > 1e-4; dt *= 0.5) {
            double kept[3][20];
            for (int v = 0; v < 3; v++) memcpy(kept[v], x.bed.set.U[v], sizeof kept[v]);
            ok(bed_step(&x.bed, dt, gravity, &done));
            for (int v = 0; v < 3 && !done; v++) memcpy(x.bed.set.U[v], kept[v], sizeof kept[v]);
        }
        assert_true(done);
        done = false;
        for (int i = 0; i < 20; i++) assert_true(alpha_of(&x, i) < 0.64 && eps_at(&x, i) > 0);
    }
    for (int i = 0; i < 10; i++) assert_true(fabs(x.bed.set.U[1][i] / x.bed.set.U[0][i]) < 0.5);
    box_free(&x);
}

/* A wave of density and temperature at uniform pressure is carried along x; returns the mean error of rho. */
static double carried(int n, bool triangles) {
    struct box x;
    const double gravity[MAX_DIM] = {0}, width = 1. / n, u = 1e-3, dt = (triangles ? 0.2 : 0.4) * width / u, T0 = 1;
    box_make(&x, comm, "TorquatoSpheres", 1, n, triangles ? 2 : 1, width, true, triangles);
    const double per = packing_per_density(&x.material), mean = 0.6 / per;
    double p0 = 0, error = 0, *first = malloc((size_t)x.bed.set.cells * sizeof *first);
    for (int i = 0; i < x.bed.set.cells; i++) {
        const double place = triangles ? x.centre[i][0] / width : i + 0.5;
        const double rho = (0.6 + 0.02 * sin(2 * acos(-1) * place / n)) / per;
        double p, c2, gruneisen, eps = eps_of(&x.material, T0);
        x.bed.eos->state(&x.material, 1, &rho, &eps, &p, &c2, &gruneisen);
        if (i == 0) p0 = p;
        set(&x, i, rho * per, T0 * p0 / p, u, 0);
        first[i] = rho;
    }
    const int steps = (int)lround(1 / (u * dt));
    for (int s = 0; s < steps; s++) {
        bool done;
        ok(bed_step(&x.bed, dt, gravity, &done));
        assert_true(done);
    }
    for (int i = 0; i < x.bed.set.cells; i++) error += fabs(x.bed.set.U[0][i] - first[i]) / (x.bed.set.cells * mean);
    box_free(&x);
    free(first);
    return error;
}

static void test_slow_flow_is_carried_at_second_order(void **state) {
    (void)state;
    for (int triangles = 0; triangles < 2; triangles++) {
        const double coarse = carried(40, triangles), fine = carried(80, triangles);
        assert_true(coarse < 0.01);
        assert_true(coarse / fine > 3);
    }
}

/* Returns what a step of omega dt = `turn` takes of a sound wave that travels, or stands and is at its fastest, in gas
 * of mean velocity u: its energy of motion is half of all, or all. */
static double damped(double turn, double amplitude, double u, bool travels) {
    enum { N = 64 };
    const double gravity[MAX_DIM] = {0}, k = 2 * acos(-1) / N, T = 1, alpha = 0.6;
    struct box x;
    double p, c2, gruneisen;
    bool done;
    box_make(&x, comm, "TorquatoSpheres", 1, N, 1, 1, true, false);
    const double rho = alpha / packing_per_density(&x.material), eps = eps_of(&x.material, T);
    x.bed.eos->state(&x.material, 1, &rho, &eps, &p, &c2, &gruneisen);
    const double c = sqrt(c2);
    for (int i = 0; i < N; i++) {
        const double wave = amplitude * sin(k * (i + 0.5)), denser = travels ? wave : 0;
        set(&x, i, alpha * (1 + denser), T * (1 + p / (rho * eps) * denser), u + c * wave, 0);
    }
    bed_note_start(&x.bed);
    ok(bed_step(&x.bed, turn / (c * k), gravity, &done));
    assert_true(done);
    box_free(&x);
    return x.bed.blur.whole;
}

/* Backward Euler leaves 1/(1 + (omega dt)^2) of the energy, of any wave in any stream; 64 cells a wave know omega to
 * 0.2 %, of which the square counts. */
static void test_what_a_step_takes_of_sound_is_known(void **state) {
    (void)state;
    for (double turn = 0.1; turn < 2; turn *= 2) {
        const double taken = turn * turn / (1 + turn * turn);
        assert_true(fabs(damped(turn, 1e-4, 0, false) / taken - 1) < 0.01);
        assert_true(fabs(damped(turn, 1e-3, 0, true) / (2 * taken) - 1) < 0.01);
        assert_true(fabs(damped(turn, 1e-4, 1, false) / taken - 1) < 0.01);
    }
}

/* A closed cell that cooled since the start of the step keeps its state, although Newton's method starts from the
 * pressure of before, here 1.5 times as high. The volume of gas is nearly linear in 1/p: two or three iterations do.
 * On the tangent of p they would be five. */
static void test_newton_follows_the_volume_of_a_cell(void **state) {
    const double gravity[MAX_DIM] = {0}, packing[] = {0.01, 0.3, 0.6, 0.639};
    (void)state;
    for (int k = 0; k < 4; k++) {
        struct box x;
        bool done;
        box_make(&x, comm, "TorquatoSpheres", 1, 1, 1, 1, true, false);
        set(&x, 0, packing[k], 1.5, 0, 0);
        bed_note_start(&x.bed);
        set(&x, 0, packing[k], 1, 0, 0);
        const double rho = x.bed.set.U[0][0], E = x.bed.set.U[2][0];
        ok(bed_step(&x.bed, 1, gravity, &done));
        assert_true(done && x.bed.newton <= 3);
        assert_true(fabs(x.bed.set.U[0][0] / rho - 1) < 1e-8 && fabs(x.bed.set.U[2][0] / E - 1) < 1e-8);
        box_free(&x);
    }
}

/* q_f of a face (bed.h), of gas of one density and sound speed, h between the cells: -z du/2, whose z is the least of
 * rho c, 0.4 rho h/dt and rho (speeds + |du| + s h/dt), which is small where the gas is slow. */
static double braked(double rho, double c, double stiff, double soft, double speeds, double du) {
    const double slow = speeds + fabs(du) + soft * stiff;
    return -0.5 * du * rho * smaller(smaller(c, 0.4 * stiff), slow);
}

/* Returns which of the three is z of the inner faces, after checking all faces of a row between walls in which every
 * other cell moves the other way, at `mach` c: slopes are 0 there. courant: c dt/h. */
static int brake_of(double mach, double courant, double soft) {
    enum { N = 6 };
    const double gravity[MAX_DIM] = {0}, alpha = 0.6, T = 1;
    struct box x;
    double p, c2, gruneisen;
    bool done;
    box_make(&x, comm, "TorquatoSpheres", 1, N, 1, 1, false, false);
    x.bed.params.soft = soft;
    const double rho = alpha / packing_per_density(&x.material), eps = eps_of(&x.material, T);
    x.bed.eos->state(&x.material, 1, &rho, &eps, &p, &c2, &gruneisen);
    const double c = sqrt(c2), v = mach * c, stiff = c / courant, slow = 4 * v + soft * stiff;
    for (int i = 0; i < N; i++) set(&x, i, alpha, T, i % 2 ? -v : v, 0);
    ok(bed_step(&x.bed, x.form.width / stiff, gravity, &done));
    assert_true(done);
    for (int f = 0; f < x.bed.set.faces; f++) {
        const struct bed_lines *b = x.bed.lines;
        const int l = x.bed.set.left[f], r = x.bed.set.right[f], cell = l < 0 ? r : l;
        const double mean = 0.5 * (b->P[l < 0][f] + b->P[r >= 0][f]), away = (l < 0 ? -1 : 1) * (cell % 2 ? -v : v);
        const double q = braked(rho, c, stiff, soft, 2 * v, -2 * away);
        assert_true(fabs(b->p_face[f] - mean - q) < 1e-12 * (mean + fabs(q)));
    }
    box_free(&x);
    return slow < smaller(c, 0.4 * stiff) ? 2 : c < 0.4 * stiff ? 0 : 1;
}

/* Sound brakes where the step is short, the step itself where it is long, and slow gas is hardly braked: by `soft`. */
static void test_slow_flow_is_hardly_braked(void **state) {
    (void)state;
    assert_int_equal(brake_of(0.01, 0.05, 0.2), 0);
    assert_int_equal(brake_of(0.1, 10, 0.2), 1);
    assert_int_equal(brake_of(0.001, 10, 0.2), 2);
    assert_int_equal(brake_of(0.001, 10, 0.3), 2);
    assert_int_equal(brake_of(0.001, 10, 0), 2);
}

static int start(void **state) {
    int argc = 0;
    char **argv = NULL;
    (void)state;
    ok(comm_start(&argc, &argv, &comm));
    return 0;
}
static int finish(void **state) {
    (void)state;
    comm_finish(comm);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_column_at_rest_stays_so),
        cmocka_unit_test(test_gas_on_triangles_at_rest_stays_so),
        cmocka_unit_test(test_bounds_and_conservation_at_any_step),
        cmocka_unit_test(test_cold_gas_that_is_pushed_is_not_packed),
        cmocka_unit_test(test_a_block_that_hits_a_wall_is_not_pressed_beyond_packing),
        cmocka_unit_test(test_slow_flow_is_carried_at_second_order),
        cmocka_unit_test(test_what_a_step_takes_of_sound_is_known),
        cmocka_unit_test(test_newton_follows_the_volume_of_a_cell),
        cmocka_unit_test(test_slow_flow_is_hardly_braked),
    };
    return cmocka_run_group_tests(tests, start, finish);
}
