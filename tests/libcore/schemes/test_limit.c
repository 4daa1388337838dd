/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The limiter at single faces (libcore/schemes/limit.h): between any two admissible states of every equation of state,
 * whatever the high-order flux. */
#include "libcore/schemes/limit.h"

#include <stdio.h>

#include "tests/libcore/oracle.h" /* last: cmocka.h defines fail() */

static uint64_t seed = 1;
static double uniform(double low, double high) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(seed >> 11) * 0x1p-53;
}

struct pairs { /* faces between cell 0 (left) and cell 1 */
    int dim;
    double limit;
    double state[MAX_VAR][2][BATCH], flux[MAX_VAR][2][BATCH], velocity[MAX_DIM][2][BATCH];
    double eps[2][BATCH], p[2][BATCH], c[2][BATCH], gruneisen[2][BATCH], out[MAX_VAR][BATCH];
    const struct eos *eos;
    struct material material;
};

/* What follows from the states, nodal fluxes too. */
static struct faces close_pairs(struct pairs *q) {
    const int dim = q->dim;
    struct faces f = {.n = BATCH, .dim = dim, .stride = BATCH, .eps = q->eps[0], .c = q->c[0]};
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < BATCH; i++) {
            double square = 0, rho = q->state[0][side][i];
            for (int k = dim; k >= 1; k--) {
                q->velocity[k - 1][side][i] = q->state[k][side][i] / rho;
                square += q->state[k][side][i] * q->state[k][side][i];
            }
            q->eps[side][i] = (q->state[dim + 1][side][i] - 0.5 * square / rho) / rho;
        }
        q->eos->state(&q->material, BATCH, q->state[0][side], q->eps[side], q->p[side], q->c[side], q->gruneisen[side]);
        for (int i = 0; i < BATCH; i++) {
            double u = q->velocity[0][side][i], p = q->p[side][i];
            q->c[side][i] = sqrt(q->c[side][i]);
            for (int v = 0; v < dim + 2; v++)
                q->flux[v][side][i] = q->state[v][side][i] * u + (v == 1 ? p : v == dim + 1 ? p * u : 0);
            q->flux[0][side][i] = q->state[1][side][i];
        }
    }
    for (int v = 0; v < dim + 2; v++) {
        f.state[v] = q->state[v][0];
        f.flux[v] = q->flux[v][0];
        f.out[v] = q->out[v];
        if (v < dim) f.velocity[v] = q->velocity[v][0];
    }
    return f;
}

static double some_density(double limit) {
    switch ((int)uniform(0, 4)) {
    case 0:
        return limit * pow(10, uniform(-10, 0)) * 0.9;
    case 1:
        return limit * (1 - pow(10, uniform(-4, -1)));
    case 2:
        return limit * 1e-10;
    default:
        return limit * uniform(0.01, 0.99);
    }
}

/* A high-order flux near F, or wild. */
static double some_flux(double F, double wild) {
    if (wild < 1) return NAN;
    if (wild < 2) return uniform(-1, 1) > 0 ? INFINITY : -INFINITY;
    if (wild < 3) return 1e300 * uniform(-1, 1);
    if (wild < 4) return F * pow(10, uniform(-3, 12));
    return F * uniform(0.5, 1.5);
}

static struct pairs some_pairs(int dim) {
    struct pairs q = {.dim = dim, .eos = &eos_table[(int)uniform(0, eos_count)]};
    q.material = grains_of(q.eos, uniform(0, 1), 0.1);
    q.material.printed_sound = uniform(0, 1) < 0.2; /* of Goldshtein & Shapiro alone */
    q.limit = density_limit(q.eos, &q.material);
    for (int side = 0; side < 2; side++)
        for (int i = 0; i < BATCH; i++) {
            double rho = some_density(isfinite(q.limit) ? q.limit : 1 / packing_per_density(&q.material)),
                   T = pow(10, uniform(-5, 5)), square = 0;
            double mach = pow(10, uniform(-3, 3));
            q.state[0][side][i] = rho;
            for (int k = 1; k <= dim; k++) {
                double u = mach * sqrt(T) * uniform(-1, 1);
                q.state[k][side][i] = rho * u;
                square += u * u;
            }
            q.state[dim + 1][side][i] = rho * (1.5 * T + 0.5 * square);
        }
    (void)close_pairs(&q);
    for (int i = 0; i < BATCH; i++) {
        const double wild = uniform(0, 6);
        for (int v = 0; v < dim + 2; v++) q.out[v][i] = some_flux(q.flux[v][i % 2][i], wild + uniform(0, 2));
    }
    return q;
}

/* The guaranteed speed, as limit.h says. */
static double speed_of(const struct pairs *q, int i) {
    double s = fmax(fabs(q->velocity[0][0][i]) + q->c[0][i], fabs(q->velocity[0][1][i]) + q->c[1][i]);
    double most = fmax(q->state[0][0][i], q->state[0][1][i]);
    return fmax(s, (q->state[1][0][i] - q->state[1][1][i]) / (q->limit - most));
}

static void must_be_admissible(const struct pairs *q, const long double U[MAX_VAR], const char *what) {
    long double square = 0;
    for (int k = 1; k <= q->dim; k++) square += U[k] * U[k];
    if (!(U[0] > 0 && U[0] < (long double)q->limit && U[q->dim + 1] * U[0] > square / 2))
        fail_msg("%s: rho %Lg of %g, rho e %Lg", what, U[0], q->limit, U[q->dim + 1] - square / 2 / U[0]);
}

/* Both halves of a face, u_l - (F - f_l)/s and u_r + (F - f_r)/s, are admissible: so is what they are averaged to. */
static void halves_are_admissible(void **state) {
    (void)state;
    long kept = 0, some = 0;
    for (int trial = 0; trial < 3000; trial++) {
        struct pairs q = some_pairs(1 + trial % 3);
        const struct faces f = close_pairs(&q);
        double theta[BATCH], high[MAX_VAR][BATCH];
        memcpy(high, q.out, sizeof high);
        limit_faces(&f, 0, q.limit, theta);
        for (int i = 0; i < BATCH; i++) {
            long double half[2][MAX_VAR];
            const long double s = speed_of(&q, i);
            for (int v = 0; v < q.dim + 2; v++)
                for (int side = 0; side < 2; side++)
                    half[side][v] =
                        q.state[v][side][i] + (side ? 1 : -1) * ((long double)q.out[v][i] - q.flux[v][side][i]) / s;
            must_be_admissible(&q, half[0], "left");
            must_be_admissible(&q, half[1], "right");
            assert_true(theta[i] >= 0 && theta[i] <= 1);
            kept += theta[i] == 1;
            some += theta[i] > 0 && theta[i] < 1;
            for (int v = 0; v < q.dim + 2 && theta[i] == 1; v++) assert_true(q.out[v][i] == high[v][i]);
        }
    }
    assert_true(kept > 1000 && some > 1000);
}

/* Limited, a crowded cell parts from packing (limit.h, 3), whatever the high-order flux. */
static void crowded_cells_part(void **state) {
    (void)state;
    for (int trial = 0; trial < 1000; trial++) {
        struct pairs q = some_pairs(1 + trial % 3);
        if (!isfinite(q.limit)) continue;
        for (int i = 0; i < BATCH; i++) {
            const double gap[2] = {pow(10, uniform(-14, -8)), pow(10, uniform(-6, -0.1))};
            for (int side = 0; side < 2; side++) {
                const double factor = q.limit * (1 - gap[side != i % 2]) / q.state[0][side][i];
                for (int v = 0; v < q.dim + 2; v++) q.state[v][side][i] *= factor;
            }
        }
        const struct faces f = close_pairs(&q);
        double theta[BATCH];
        limit_faces(&f, 0, q.limit, theta);
        for (int i = 0; i < BATCH; i++) {
            const int side = i % 2; /* of the crowded cell */
            const long double s = speed_of(&q, i), far = q.limit - q.state[0][1 - side][i];
            const long double half =
                q.state[0][side][i] + (side ? 1 : -1) * ((long double)q.out[0][i] - q.flux[0][side][i]) / s;
            if (!(q.limit - half > 0.999 * KEPT / 2 * far))
                fail_msg("distance %Lg, that of the neighbour %Lg", q.limit - half, far);
        }
    }
}

/* Only densities that rise next to the limit are crowded. */
static void crowded(void **state) {
    (void)state;
    const double limit = 3, near = limit * (1 - 0.5 * CROWDED), off = limit * (1 - 2 * CROWDED);
    const double from[] = {off, off / 2, near, limit, NAN, near}, to[] = {near, off, near, near, near, limit * 2};
    const double marks[] = {1, 0, 0, 0, 0, 2}; /* the last was marked before */
    double bad[] = {0, 0, 0, 0, 0, 1};
    assert_true(find_crowded(6, limit, from, to, bad));
    for (int i = 0; i < 6; i++) assert_true(bad[i] == marks[i]);
    assert_false(find_crowded(3, limit, from + 1, to + 1, bad + 1));
    assert_false(find_crowded(6, HUGE_VAL, from, to, bad));
}

/* Seen from the other side, a face has the same flux, to the bit. */
static void mirror_images(void **state) {
    (void)state;
    for (int trial = 0; trial < 300; trial++) {
        struct pairs q = some_pairs(1 + trial % 3), back = q;
        double theta[2][BATCH];
        for (int v = 0; v < q.dim + 2; v++)
            for (int i = 0; i < BATCH; i++) {
                for (int side = 0; side < 2; side++)
                    back.state[v][side][i] = (v == 1 ? -1 : 1) * q.state[v][1 - side][i];
                back.out[v][i] = (v == 1 ? 1 : -1) * q.out[v][i];
            }
        const struct faces f = close_pairs(&q), g = close_pairs(&back);
        limit_faces(&f, 0, q.limit, theta[0]);
        limit_faces(&g, 0, q.limit, theta[1]);
        for (int i = 0; i < BATCH; i++) {
            assert_true(theta[0][i] == theta[1][i]);
            for (int v = 0; v < q.dim + 2; v++) assert_true((v == 1 ? 1 : -1) * back.out[v][i] == q.out[v][i]);
        }
    }
}

/* A low-order flux is not moved, nor is any between states that differ little. */
static void smooth_data(void **state) {
    (void)state;
    for (int trial = 0; trial < 300; trial++) {
        struct pairs q = some_pairs(1 + trial % 3);
        double theta[BATCH];
        const bool equal = trial % 2;
        for (int v = 0; v < q.dim + 2; v++)
            for (int i = 0; i < BATCH; i++) q.state[v][1][i] = q.state[v][0][i];
        for (int i = 0; i < BATCH && !equal; i++) { /* a thousandth in density and temperature at the same velocity */
            double factor = 1 + 1e-3 * fmin(1, q.limit / q.state[0][0][i] - 1) * uniform(-1, 1);
            for (int v = 0; v < q.dim + 2; v++) q.state[v][1][i] *= factor;
        }
        const struct faces f = close_pairs(&q);
        for (int v = 0; v < q.dim + 2; v++)
            for (int i = 0; i < BATCH; i++)
                q.out[v][i] = equal ? q.flux[v][0][i] : 0.5 * (q.flux[v][0][i] + q.flux[v][1][i]);
        limit_faces(&f, 0, q.limit, theta);
        for (int i = 0; i < BATCH; i++) {
            assert_true(theta[i] == 1);
            for (int v = 0; v < q.dim + 2 && equal; v++) assert_true(q.out[v][i] == q.flux[v][0][i]);
        }
    }
}

/* The floor moves what misses it by round-off, and nothing else. */
static void round_off_floor(void **state) {
    (void)state;
    const double kinetic = 0.5 * 2e5 * 2e5, limit = 10;
    const struct {
        double rho, E;
        bool bad, raised;
    } cases[] = {
        {1, kinetic * (1 + 3e-13), false, false},
        {1, kinetic * (1 + 5e-14), true, true},
        {1, kinetic, true, true},
        {1, kinetic * (1 - 5e-13), true, true},
        {1, kinetic * (1 - 3e-12), true, false},
        {1, NAN, true, false},
        {-1, -kinetic, true, false},
        {11, kinetic / 11, true, false},
    };
    for (int i = 0; i < (int)(sizeof cases / sizeof *cases); i++) {
        double U[3] = {cases[i].rho, 2e5, cases[i].E}, bad, raised;
        assert_true(find_bad(1, 1, 1, 0, limit, U, &bad) == cases[i].bad);
        assert_int_equal(raise_energy(1, 1, 1, 0, limit, U, &bad, &raised), cases[i].raised);
        assert_true(U[0] == cases[i].rho && U[1] == 2e5);
        if (cases[i].raised) {
            assert_true(raised > 0 && U[2] == cases[i].E + raised);
            assert_true(bad == 0 && !find_bad(1, 1, 1, 0, limit, U, &bad));
        } else {
            assert_true(raised == 0 && (U[2] == cases[i].E || isnan(cases[i].E)));
            assert_true((bad > 0) == cases[i].bad);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(halves_are_admissible),
        cmocka_unit_test(crowded_cells_part),
        cmocka_unit_test(crowded),
        cmocka_unit_test(mirror_images),
        cmocka_unit_test(smooth_data),
        cmocka_unit_test(round_off_floor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
