/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bed of a body of revolution (struct bed_round of libcore/acoustics/bed.h): rest, conservation, and friction with
 * its hoop component, on boxes and triangles that reach the axis. */
#include "tests/libcore/acoustics/round_bed.h"

enum { CELLS = 72, UNKNOWNS = 2 * CELLS };
static const struct box_form FORM[2] = {{.n = {8, 9, 1}, .width = 1},
                                        {.n = {6, 6, 1}, .width = 1, .triangles = true, .askew = 0.2}};

static void make_round(struct round_box *x, int kind, double mu, double inner) {
    struct box_form f = FORM[kind];
    if (mu > 0) f.friction = law("Coulomb", mu);
    if (mu > 1) f.friction.params.cohesion = 1e9; /* nothing yields */
    if (mu > 0)
        make(&x->box, &f);
    else
        box_make_of(&x->box, comm, "TorquatoSpheres", 1, &f);
    turn(x, inner);
}

static double sum_of(const struct box *x, int v) {
    double sum = 0;
    for (int i = 0; i < CELLS; i++) sum += x->bed.set.U[v][i] * volume_of(x, i);
    return sum;
}

/* Gas of uniform density whose pressure carries it: P is the same on both sides of every face. */
static void test_gas_at_rest_stays_so(void **state) {
    (void)state;
    const double gravity[MAX_DIM] = {-9.81};
    for (int kind = 0; kind < 4; kind++) {
        struct round_box x;
        bool done;
        make_round(&x, kind % 2, 0, kind / 2 * 3.0);
        const double rho = 0.63 / packing_per_density(&x.box.material), one = 1;
        double p, c2, gruneisen, fastest = 0, eps[CELLS];
        x.box.bed.eos->state(&x.box.material, 1, &rho, &one, &p, &c2, &gruneisen);
        for (int i = 0; i < CELLS; i++) {
            eps[i] = rho * (1000 + gravity[0] * x.box.centre[i][0]) / p;
            set(&x.box, i, 0.63, temperature_of(&x.box.material, eps[i]), 0, 0);
            fastest = larger(fastest, sqrt(c2 * eps[i]));
        }
        for (int step = 0; step < 200; step++) {
            ok(bed_step(&x.box.bed, 300 / fastest, gravity, &done));
            assert_true(done);
        }
        for (int i = 0; i < CELLS; i++)
            assert_true(hypot(x.box.bed.set.U[1][i], x.box.bed.set.U[2][i]) / x.box.bed.set.U[0][i] <
                        1e-9 * sqrt(1000 * rho / p));
        round_free(&x);
    }
}

/* Packed gas that is sheared and shaken, on rough walls. */
static void set_shaken(struct box *x) {
    unsigned seed = 3;
    for (int i = 0; i < CELLS; i++) {
        const double shear[2] = {0.01 * x->centre[i][1], 0.002 * x->centre[i][1]};
        const double u[3] = {shear[0] + 0.02 * (chance(&seed) - 0.5), shear[1] + 0.02 * (chance(&seed) - 0.5)};
        set_moving(x, i, 0.56 + 0.05 * chance(&seed), 1e-4, u);
    }
    for (int f = 0; f < x->bed.set.faces && x->bed.rub; f++)
        if (x->bed.set.kind[f] == BED_WALL && x->shapes.area[f] > 1e-9)
            x->bed.set.wall_friction[f] = f % 2 ? HUGE_VAL : 0.2;
}

/* What leaves through the walls in a step of dt: of variable v, and the sum of its sizes. */
static double through_walls(const struct box *x, double dt, int v, double *size) {
    double sum = 0;
    for (int f = 0; f < x->bed.set.faces; f++) {
        const double flux = dt * x->shapes.area[f] * x->bed.set.kept[v][f];
        if (x->bed.set.kind[f] != BED_WALL) continue;
        sum += x->bed.set.left[f] < 0 ? -flux : flux;
        *size += fabs(flux);
    }
    return sum;
}

/* A can keeps its mass, and its energy but for what lifting and friction gave; friction takes energy. The momentum
 * along the axis changes by pressure and friction on the walls. */
static void test_sums_are_kept(void **state) {
    (void)state;
    const double none[MAX_DIM] = {0}, dt = 0.2;
    for (int kind = 0; kind < 8; kind++) {
        struct round_box x;
        make_round(&x, kind % 2, kind / 2 % 2 ? 0.38 : 0, kind / 4 * 2.5);
        set_shaken(&x.box);
        const double before[4] = {sum_of(&x.box, 0), sum_of(&x.box, 1), 0, sum_of(&x.box, 3)};
        double lifted = 0, rubbed = 0, out = 0, size = 0;
        for (int n = 0; n < 60; n++) {
            bool done;
            ok(bed_step(&x.box.bed, dt, none, &done));
            assert_true(done);
            lifted += x.box.bed.set.lift[0];
            rubbed += x.box.bed.set.rubbed[0];
            out += through_walls(&x.box, dt, 1, &size);
        }
        assert_true(x.box.bed.rub ? -rubbed > 0.1 * before[3] : rubbed == 0);
        assert_true(fabs(sum_of(&x.box, 0) - before[0]) < 1e-13 * before[0]);
        assert_true(fabs(sum_of(&x.box, 1) - before[1] + out) < 1e-13 * size);
        assert_true(fabs(sum_of(&x.box, 3) - before[3] - rubbed - lifted) < 1e-12 * before[3]);
        round_free(&x);
    }
}

/* Sets packed gas, with a hollow of thin gas, to the velocity u[cells][2]. */
static void set_velocities(struct box *x, const double *u, bool hollow) {
    unsigned seed = 11;
    for (int i = 0; i < CELLS; i++) {
        const double packing = 0.53 + 0.08 * chance(&seed);
        const bool thin = hollow && distance(x, i, (const double[]){4, 4, 0}) < 1;
        set_moving(x, i, thin ? THIN : packing, 1, u + 2 * i);
        x->bed.set.pressure[i] = PRESSURE;
    }
    for (int t = 0; t < 3; t++) memset(x->bed.set.stress[t], 0, (size_t)x->bed.set.faces * sizeof(double));
}

/* The uniform stress of u = (b x, a r) pushes no cell beside a floor that bears no friction: the hoop stress does not
 * end at it. */
static void test_hoop_stress_reaches_the_floor(void **state) {
    (void)state;
    const double b = 0.07, a = 0.04;
    for (int kind = 0; kind < 2; kind++) {
        struct round_box x;
        const double inner = kind * 2.5;
        int compared = 0;
        make_round(&x, 0, 2, inner);
        for (int i = 0; i < CELLS; i++) {
            const double u[3] = {b * x.box.centre[i][0], a * (x.box.centre[i][1] + inner)};
            set_moving(&x.box, i, 0.6, 1, u);
            x.box.bed.set.pressure[i] = PRESSURE;
        }
        for (int t = 0; t < 3; t++) memset(x.box.bed.set.stress[t], 0, (size_t)x.box.bed.set.faces * sizeof(double));
        for (int f = 0; f < x.box.bed.set.faces; f++)
            if (x.box.bed.set.kind[f] == BED_WALL) x.box.bed.set.wall_friction[f] = 0;
        rub(&x.box, 1e-9);
        double most = 0;
        for (int f = 0; f < x.box.bed.set.faces; f++) most = larger(most, fabs(x.box.bed.set.stress[2][f]));
        for (int i = 0; i < CELLS; i++) {
            const double *c = x.box.centre[i], r = c[1] + inner;
            if (c[0] > 1 || c[1] > FORM[0].n[1] - 1 || c[1] < 1) continue;
            const double push = x.box.bed.lines->rho[i] * x.box.bed.lines->rubbed[1][i] / 1e-9;
            assert_true(fabs(push) * r < 1e-9 * most);
            compared++;
        }
        assert_int_equal(compared, FORM[0].n[1] - 2);
        round_free(&x);
    }
}

/* D' of linear velocities, with u_r/r around the axis, is exact on faces between cells that have no wall but the axis.
 */
static void test_strain_is_exact(void **state) {
    (void)state;
    const double dt = 1e-9, b = 0.07, a = 0.04;
    for (int kind = 0; kind < 4; kind++) {
        struct round_box x;
        const double inner = kind / 2 * 2.5;
        double u[UNKNOWNS];
        int compared = 0;
        make_round(&x, kind % 2, 2, inner);
        for (int i = 0; i < CELLS; i++) {
            u[2 * i] = b * x.box.centre[i][0];
            u[2 * i + 1] = a * (x.box.centre[i][1] + inner);
        }
        set_velocities(&x.box, u, false);
        rub(&x.box, dt);
        const struct bed_set *set = &x.box.bed.set;
        const double wanted[3] = {b - (b + 2 * a) / 3, 0, a - (b + 2 * a) / 3};
        for (int f = 0; f < set->faces; f++) {
            if (set->kind[f] != BED_INNER) continue;
            const double *l = x.box.centre[set->left[f]], *r = x.box.centre[set->right[f]];
            if (smaller(l[0], r[0]) < 1 || larger(l[0], r[0]) > FORM[kind % 2].n[0] - 1 ||
                larger(l[1], r[1]) > FORM[kind % 2].n[1] - 1 || (inner > 0 && smaller(l[1], r[1]) < 1))
                continue;
            const double *rho = x.box.bed.lines->rho, light = smaller(rho[set->left[f]], rho[set->right[f]]);
            const double stiff = 2 * modulus_of(&x.box) * dt * light / x.box.bed.limit;
            for (int t = 0; t < 3; t++) assert_true(fabs(set->stress[t][f] / stiff - wanted[t]) < 1e-10 * b);
            compared++;
        }
        assert_true(compared > 20);
        round_free(&x);
    }
}

/* The force of u_r = r^2 is 2 G times 2 per volume, since D'_rr = r and D'_tt = 0: exact on boxes. */
static void test_force_of_bent_velocities(void **state) {
    (void)state;
    const double dt = 1e-9;
    for (int far = 0; far < 2; far++) {
        struct round_box x;
        const double inner = far * 2.5;
        make_round(&x, 0, 2, inner);
        for (int i = 0; i < CELLS; i++) {
            const double r = x.box.centre[i][1] + inner;
            set_moving(&x.box, i, PACKED, 1, (const double[]){0, 0.01 * r * r});
            x.box.bed.set.pressure[i] = PRESSURE;
        }
        rub(&x.box, dt);
        const double rho = PACKED / packing_per_density(&x.box.material);
        const double gain = 0.01 * 2 * dt / rho * 2 * modulus_of(&x.box) * dt * rho / x.box.bed.limit;
        for (int i = 0; i < CELLS; i++) {
            const double *c = x.box.centre[i];
            if (c[0] < 2 || c[0] > FORM[0].n[0] - 2 || c[1] > FORM[0].n[1] - 2 || c[1] < 2) continue;
            assert_true(fabs(x.box.bed.lines->rubbed[1][i] - gain) < 1e-9 * gain);
        }
        round_free(&x);
    }
}

/* Finds the matrix of the work that friction does: u.M v in a short step. */
static void find_matrix(struct box *x, double dt, double M[UNKNOWNS][UNKNOWNS]) {
    for (int j = 0; j < UNKNOWNS; j++) {
        double u[UNKNOWNS] = {0};
        u[j] = 1;
        set_velocities(x, u, true);
        rub(x, dt);
        for (int i = 0; i < UNKNOWNS; i++)
            M[i][j] = x->bed.lines->rho[i / 2] * volume_of(x, i / 2) * x->bed.lines->rubbed[i % 2][i / 2];
    }
}

/* Friction takes energy, whatever the velocities are. On boxes between smooth walls its force along the axis adds up to
 * nothing; on triangles its operator is symmetric. */
static void test_friction_takes_energy(void **state) {
    (void)state;
    static double M[UNKNOWNS][UNKNOWNS];
    unsigned seed = 5;
    for (int kind = 0; kind < 4; kind++) {
        struct round_box x;
        double most = 0;
        make_round(&x, kind % 2, 2, kind / 2 * 2.5);
        find_matrix(&x.box, 1e-9, M);
        for (int i = 0; i < UNKNOWNS; i++) most = larger(most, fabs(M[i][i]));
        for (int i = 0; i < UNKNOWNS && kind % 2; i++)
            for (int j = 0; j < i; j++) assert_true(fabs(M[i][j] - M[j][i]) < 1e-12 * most);
        for (int j = 0; j < UNKNOWNS; j++) {
            double along = 0;
            for (int i = 0; i < CELLS; i++) along += M[2 * i][j];
            assert_true(kind % 2 || fabs(along) < 1e-12 * most);
        }
        for (int times = 0; times < 200; times++) {
            double v[UNKNOWNS], work = 0;
            for (int i = 0; i < UNKNOWNS; i++) v[i] = chance(&seed) - 0.5;
            for (int i = 0; i < UNKNOWNS; i++)
                for (int j = 0; j < UNKNOWNS; j++) work += v[i] * M[i][j] * v[j];
            assert_true(work < 0);
        }
        round_free(&x);
    }
}

/* Steps of many stages bring random velocities of elastic gas to rest, at the axis, too. */
static void test_many_stages_are_stable(void **state) {
    (void)state;
    const double weightless[MAX_DIM] = {0};
    for (int kind = 0; kind < 2; kind++) {
        struct round_box x;
        double u[UNKNOWNS], first = 0, last = 0;
        unsigned seed = 5;
        bool done;
        make_round(&x, kind, 2, 0);
        for (int f = 0; f < x.box.bed.set.faces; f++)
            if (x.box.bed.set.kind[f] == BED_WALL && fabs(x.box.shapes.normal[0][f]) > 0.5)
                x.box.bed.set.wall_friction[f] = HUGE_VAL;
        for (int i = 0; i < UNKNOWNS; i++) u[i] = 1e-3 * (chance(&seed) - 0.5);
        set_velocities(&x.box, u, true);
        for (int n = 0; n < 60; n++) {
            ok(bed_rub_alone(&x.box.bed, 0.1, weightless, &done));
            assert_true(done);
            last = 0;
            for (int i = 0; i < CELLS; i++) {
                x.box.bed.set.pressure[i] = PRESSURE;
                for (int k = 1; k < 3 && x.box.bed.lines->rho[i] > 0.5 * x.box.bed.limit; k++)
                    last = larger(last, fabs(x.box.bed.set.U[k][i] / x.box.bed.set.U[0][i]));
            }
            if (n == 0) first = last;
            assert_true(last <= 2 * first);
        }
        assert_true(last < 1e-6 * first);
        round_free(&x);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_gas_at_rest_stays_so),     cmocka_unit_test(test_sums_are_kept),
        cmocka_unit_test(test_strain_is_exact),          cmocka_unit_test(test_hoop_stress_reaches_the_floor),
        cmocka_unit_test(test_friction_takes_energy),    cmocka_unit_test(test_many_stages_are_stable),
        cmocka_unit_test(test_force_of_bent_velocities),
    };
    return cmocka_run_group_tests(tests, start, finish);
}
