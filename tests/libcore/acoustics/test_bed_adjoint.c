/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Friction in a bed of triangles (libcore/acoustics/bed_adjoint.c): force and strain are adjoint. */
#include "tests/libcore/acoustics/friction_bed.h"

enum { ASKEW_CELLS = 72, ASKEW_UNKNOWNS = 2 * ASKEW_CELLS };
static const struct box_form askew_form = {
    .n = {6, 6, 1}, .width = 1, .components = 2, .triangles = true, .askew = 0.28};

/* Sets packed gas with a hollow of thin gas, beside two rough walls and two smooth ones, without stress, to the
 * velocity u. */
static void set_askew(struct box *x, const double *u) {
    unsigned seed = 11;
    for (int i = 0; i < ASKEW_CELLS; i++) {
        const bool hollow = distance(x, i, (const double[]){4, 4, 0}) < 1;
        const double packing = 0.53 + 0.08 * chance(&seed);
        set_moving(x, i, hollow ? THIN : packing, 1, u + 2 * i);
        x->bed.set.pressure[i] = PRESSURE;
    }
    for (int t = 0; t < 3; t++) memset(x->bed.set.stress[t], 0, (size_t)x->bed.set.faces * sizeof(double));
    for (int f = 0; f < x->bed.set.faces; f++)
        if (x->bed.set.kind[f] == BED_WALL &&
            x->shapes.normal[0][x->bed.set.shape[f]] + x->shapes.normal[1][x->bed.set.shape[f]] < 0)
            x->bed.set.wall_friction[f] = HUGE_VAL;
}

static struct box_form askew_elastic(void) {
    struct box_form f = askew_form;
    f.friction = law("Coulomb", 1);
    f.friction.params.cohesion = 1e9; /* nothing yields */
    return f;
}

/* Returns the largest of the cells' sums 4/3 A 2 G dt^2/(d rho V), by which stages are counted. */
static double rate_bound(const struct box *x, double dt) {
    double most = 0;
    for (int i = 0; i < ASKEW_CELLS; i++) {
        const double *rho = x->bed.lines->rho;
        double sum = 0;
        for (int j = x->bed.set.face_start[i]; j < x->bed.set.face_start[i + 1]; j++) {
            const struct bed_side s = bed_side(&x->bed, j);
            const bool inner = x->bed.set.kind[s.face] == BED_INNER;
            if (!inner && x->bed.set.wall_friction[s.face] == 0) continue;
            const double light = inner ? smaller(rho[i], rho[bed_across(&x->bed, &s)]) : rho[i];
            const double d = x->shapes.depth[s.right][s.shape] + (inner ? x->shapes.depth[!s.right][s.shape] : 0);
            sum += 8. / 3 * x->shapes.area[s.shape] * modulus_of(x) * light / x->bed.limit / d;
        }
        most = larger(most, sum * dt * dt / (rho[i] * volume_of(x, i)));
    }
    return most;
}

/* Finds the matrix of the work that friction does: u.M v in a short step. */
static void find_matrix(struct box *x, double dt, double M[ASKEW_UNKNOWNS][ASKEW_UNKNOWNS]) {
    for (int j = 0; j < ASKEW_UNKNOWNS; j++) {
        double u[ASKEW_UNKNOWNS] = {0};
        u[j] = 1;
        set_askew(x, u);
        rub(x, dt);
        for (int i = 0; i < ASKEW_UNKNOWNS; i++)
            M[i][j] = x->bed.lines->rho[i / 2] * volume_of(x, i / 2) * x->bed.lines->rubbed[i % 2][i / 2];
    }
}

/* Returns the largest size of a rate, by the power method. */
static double largest_rate(const struct box *x, double M[ASKEW_UNKNOWNS][ASKEW_UNKNOWNS]) {
    double v[ASKEW_UNKNOWNS], most = 0;
    unsigned seed = 7;
    for (int i = 0; i < ASKEW_UNKNOWNS; i++) v[i] = chance(&seed) - 0.5;
    for (int times = 0; times < 1000; times++) {
        double w[ASKEW_UNKNOWNS] = {0};
        most = 0;
        for (int i = 0; i < ASKEW_UNKNOWNS; i++) {
            for (int j = 0; j < ASKEW_UNKNOWNS; j++) w[i] -= M[i][j] * v[j];
            w[i] /= x->bed.lines->rho[i / 2] * volume_of(x, i / 2);
            most = larger(most, fabs(w[i]));
        }
        for (int i = 0; i < ASKEW_UNKNOWNS; i++) v[i] = w[i] / most;
    }
    return most;
}

/* The force of friction on cell i by the velocity of cell j is that on j by the velocity of i, and takes energy: so
 * the operator has a real spectrum, of no positive number. Its largest is below the bound that stages go by. */
static void test_operator_is_symmetric_on_triangles(void **state) {
    (void)state;
    static double M[ASKEW_UNKNOWNS][ASKEW_UNKNOWNS];
    const double dt = 1e-9;
    unsigned seed = 5;
    for (int k = 0; k < 3; k++) {
        struct box x;
        struct box_form f = askew_elastic();
        double most = 0;
        f.askew = 0.02 + 0.13 * k;
        make(&x, &f);
        find_matrix(&x, dt, M);
        for (int i = 0; i < ASKEW_UNKNOWNS; i++) most = larger(most, fabs(M[i][i]));
        for (int i = 0; i < ASKEW_UNKNOWNS; i++)
            for (int j = 0; j < i; j++) assert_true(fabs(M[i][j] - M[j][i]) < 1e-12 * most);
        for (int times = 0; times < 100; times++) {
            double v[ASKEW_UNKNOWNS], work = 0;
            for (int i = 0; i < ASKEW_UNKNOWNS; i++) v[i] = chance(&seed) - 0.5;
            for (int i = 0; i < ASKEW_UNKNOWNS; i++)
                for (int j = 0; j < ASKEW_UNKNOWNS; j++) work += v[i] * M[i][j] * v[j];
            assert_true(work < 0);
        }
        const double part = largest_rate(&x, M) / rate_bound(&x, dt);
        assert_true(part > 0.3 && part < 1);
        box_free(&x);
    }
}

/* Steps of more than 50 stages bring random velocities of elastic gas to rest. */
static void test_many_stages_are_stable_on_triangles(void **state) {
    (void)state;
    struct box x;
    const struct box_form f = askew_elastic();
    const double dt = 0.1, weightless[MAX_DIM] = {0};
    double u[ASKEW_UNKNOWNS], first = 0, last = 0;
    unsigned seed = 5;
    bool done;
    make(&x, &f);
    for (int i = 0; i < ASKEW_UNKNOWNS; i++) u[i] = 1e-3 * (chance(&seed) - 0.5);
    set_askew(&x, u);
    for (int n = 0; n < 60; n++) {
        ok(bed_rub_alone(&x.bed, dt, weightless, &done));
        assert_true(done);
        for (int i = 0; i < ASKEW_CELLS; i++) x.bed.set.pressure[i] = PRESSURE;
        if (n == 0) assert_true(1.2 * rate_bound(&x, dt) > 1663); /* 50 stages */
        last = 0;
        for (int i = 0; i < ASKEW_CELLS; i++)
            for (int k = 1; k < 3 && x.bed.lines->rho[i] > 0.5 * x.bed.limit; k++)
                last = larger(last, fabs(x.bed.set.U[k][i] / x.bed.set.U[0][i]));
        if (n == 0) first = last;
        assert_true(last <= 2 * first);
    }
    assert_true(last < 1e-6 * first);
    box_free(&x);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_operator_is_symmetric_on_triangles),
        cmocka_unit_test(test_many_stages_are_stable_on_triangles),
    };
    return cmocka_run_group_tests(tests, start, finish);
}
