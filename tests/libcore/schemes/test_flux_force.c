/* SPDX-License-Identifier: GPL-3.0-or-later */
/* FORCE and MUSTA: their formula, their limits, what they keep monotone, and Godunov's flux. That they are consistent,
 * keep mirror images and do not depend on batches: test_flux.c. */
#include "tests/libcore/oracle.h"

#include "libcore/schemes/flux.h"

enum { CELLS = 40, LEFT = 20 }; /* LEFT: the cell to the left of the face that single jumps are at */

struct strip { /* cells in a row, as the fluxes see them */
    const struct eos *eos;
    struct material m;
    int dim;
    double U[MAX_VAR][CELLS], F[MAX_VAR][CELLS], u[MAX_DIM][CELLS], eps[CELLS], p[CELLS], c[CELLS], g[CELLS];
    double out[MAX_VAR][CELLS]; /* through the right face of each cell */
    double gravity;             /* times the cells' width; 0: no pressure of gas at rest is taken */
    double fastest;
};

/* Closes states of given rho, u and eps. */
static void close_strip(struct strip *s) {
    s->eos->state(&s->m, CELLS, s->U[0], s->eps, s->p, s->c, s->g);
    s->fastest = 0;
    for (int i = 0; i < CELLS; i++) {
        double square = 0;
        s->c[i] = sqrt(s->c[i]);
        for (int k = 0; k < s->dim; k++) {
            square += s->u[k][i] * s->u[k][i];
            s->U[k + 1][i] = s->U[0][i] * s->u[k][i];
        }
        s->U[s->dim + 1][i] = s->U[0][i] * (s->eps[i] + 0.5 * square);
        for (int v = 0; v < s->dim + 2; v++) s->F[v][i] = s->U[v][i] * s->u[0][i];
        s->F[1][i] += s->p[i];
        s->F[s->dim + 1][i] += s->p[i] * s->u[0][i];
        s->fastest = larger(s->fastest, fabs(s->u[0][i]) + s->c[i]);
    }
}

struct rest { /* what a lattice takes at the faces behind the cells (libcore/lattice/tiles_balance.c) */
    double base[2][CELLS], rise[CELLS], on[CELLS], P[CELLS];
};

static void take_rest(const struct strip *s, struct rest *r, struct faces *f, int first) {
    for (int i = 0; i + 1 < CELLS; i++) {
        const double low = 0.5 * s->gravity * s->U[0][i], high = 0.5 * s->gravity * s->U[0][i + 1];
        r->P[i] = 0.5 * ((s->p[i] + low) + (s->p[i + 1] - high));
        r->base[0][i] = r->P[i] - low;
        r->base[1][i] = r->P[i] + high;
        r->rise[i] = low + high;
        r->on[i] = 1;
    }
    for (int side = 0; side < 2; side++) f->base[side] = r->base[side] + first;
    f->rise = r->rise + first;
    f->on = r->on + first;
    f->rest = r->P + first;
}

/* The fluxes through the faces behind cells first .. first + n - 1, at a dt/dx. MUSTA: tolerance and stages. */
static void flux_at(struct strip *s, const char *name, const char *reconstruct, double pace, double tolerance,
                    int stages, int first, int n) {
    const struct flux *flux = flux_find(name);
    struct own_params own = own_defaults(&flux->model);
    double paces[CELLS];
    struct faces f = {.n = n, .dim = s->dim, .stride = 1, .pace = paces, .params = &own};
    f.eps = s->eps + first;
    f.c = s->c + first;
    f.gruneisen = s->g + first;
    for (int i = 0; i < CELLS; i++) paces[i] = pace;
    if (!strcmp(name, "MUSTA")) {
        model_put(&flux->model, &own, "tolerance", tolerance);
        model_put(&flux->model, &own, "stages", stages);
    }
    for (int v = 0; v < s->dim + 2; v++) {
        f.state[v] = s->U[v] + first;
        f.flux[v] = s->F[v] + first;
        f.out[v] = s->out[v] + first;
    }
    for (int k = 0; k < s->dim; k++) f.velocity[k] = s->u[k] + first;
    struct rest rest;
    if (s->gravity != 0) take_rest(s, &rest, &f, first);
    flux->through(&f, s->eos, &s->m, reconstruct_find(reconstruct));
    for (int i = first; i < first + n && s->gravity != 0; i++) s->out[1][i] += rest.P[i];
}

static double drawn(int i, int k) {
    const double x = sin(12.9898 * i + 78.233 * k) * 43758.5453;
    return x - floor(x);
}

static struct strip strip_of(const char *eos, int dim) {
    const struct eos *e = eos_find(eos);
    return (struct strip){.eos = e, .m = grains_of(e, 0.9, 0.1), .dim = dim};
}

static struct strip random_strip(const char *eos, int dim, int round) {
    struct strip s = strip_of(eos, dim);
    for (int i = 0; i < CELLS; i++) {
        s.U[0][i] = (0.05 + 0.4 * drawn(round, i)) / packing_per_density(&s.m);
        s.eps[i] = 1 + 2 * drawn(round, 100 + i);
        for (int k = 0; k < dim; k++) s.u[k][i] = 6 * drawn(round, 200 + 50 * k + i) - 3;
    }
    close_strip(&s);
    return s;
}

/* out <- f(U) */
static void flux_of_state(const struct strip *s, const double *U, double *out) {
    double square = 0, rho = U[0], u = U[1] / U[0], eps, p, c, g;
    for (int k = 1; k <= s->dim; k++) square += U[k] * U[k] / (rho * rho);
    eps = U[s->dim + 1] / rho - 0.5 * square;
    s->eos->state(&s->m, 1, &rho, &eps, &p, &c, &g);
    for (int v = 0; v < s->dim + 2; v++) out[v] = U[v] * u;
    out[1] += p;
    out[s->dim + 1] += p * u;
}

/* out <- the mean of the fluxes of Lax & Friedrichs and of Lax & Wendroff between two states */
static void mean_of_two(const struct strip *s, double pace, int left, double *out) {
    const int nvar = s->dim + 2;
    double middle[MAX_VAR] = {0}, wendroff[MAX_VAR];
    for (int v = 0; v < nvar; v++)
        middle[v] = (s->U[v][left] + s->U[v][left + 1]) / 2 - pace / 2 * (s->F[v][left + 1] - s->F[v][left]);
    flux_of_state(s, middle, wendroff);
    for (int v = 0; v < nvar; v++) {
        const double friedrichs =
            (s->F[v][left] + s->F[v][left + 1]) / 2 - (s->U[v][left + 1] - s->U[v][left]) / (2 * pace);
        out[v] = (friedrichs + wendroff[v]) / 2;
    }
}

/* With the states of the cells FORCE is the mean of two fluxes that are computed here in another way. */
static void force_is_the_mean_of_two(void **state) {
    (void)state;
    static const char *const eos[] = {"perfectGas", "TorquatoSpheres", "GoldshteinShapiro"};
    for (int round = 0; round < 60; round++) {
        const int dim = 1 + round % 3;
        struct strip s = random_strip(eos[round / 3 % 3], dim, round);
        const double pace = 0.9 * drawn(round, 999) / s.fastest;
        flux_at(&s, "FORCE", "firstOrder", pace, 0, 0, 2, CELLS - 5);
        for (int i = 2; i < CELLS - 3; i++) {
            double known[MAX_VAR];
            mean_of_two(&s, pace, i, known);
            for (int v = 0; v < dim + 2; v++) {
                const double scale = larger(fabs(s.F[v][i]), fabs(s.F[v][i + 1])) + fabs(known[v]);
                assert_near(s.out[v][i], known[v], 1e-12 * (scale + fabs(s.U[v][i]) / pace));
            }
        }
    }
}

/* No stage of MUSTA is FORCE, to the bit. */
static void musta_begins_with_force(void **state) {
    (void)state;
    struct strip s = random_strip("TorquatoSpheres", 3, 5), t = s;
    flux_at(&s, "FORCE", "WENO5", 0.7 / s.fastest, 0, 0, 2, CELLS - 5);
    flux_at(&t, "MUSTA", "WENO5", 0.7 / s.fastest, 0.01, 0, 2, CELLS - 5);
    assert_memory_equal(s.out, t.out, sizeof s.out);
}

/* However long the step, dt/dx counts as no more than the time in which the faster sound crosses the cell. */
static void long_steps_count_as_sound(void **state) {
    (void)state;
    for (int round = 0; round < 20; round++) {
        struct strip s = random_strip("TorquatoSpheres", 2, round);
        for (int side = 0; side < 2; side++) {
            const double c = fabs(s.u[0][LEFT + side]) + s.c[LEFT + side];
            s.fastest = side ? larger(s.fastest, c) : c;
        }
        struct strip t = s;
        flux_at(&s, "FORCE", "firstOrder", 1 / s.fastest, 0, 0, LEFT, 1);
        flux_at(&t, "FORCE", "firstOrder", 7 / s.fastest, 0, 0, LEFT, 1);
        for (int v = 0; v < 4; v++) assert_true(s.out[v][LEFT] == t.out[v][LEFT]);
    }
}

/* Gas of one pressure and velocity, in which rho is carried as a scalar: q_t + u q_x = 0. */
static struct strip carrying(int round) {
    struct strip s = strip_of("perfectGas", 1);
    const double u = 4 * drawn(round, 300) - 2, p = 0.2 + drawn(round, 301);
    for (int i = 0; i < CELLS; i++) {
        s.U[0][i] = 0.1 + drawn(round, i) * drawn(round, i + 50);
        s.eps[i] = p / ((s.m.gamma - 1) * s.U[0][i]);
        s.u[0][i] = u;
    }
    close_strip(&s);
    return s;
}

/* On a scalar the flux is F = u (q_l + q_r)/2 - w/2 dx/dt (q_r - q_l): FORCE with w = (1 + nu^2)/2 = w_0, nu = u dt/dx.
 * In each stage of MUSTA the jump falls by 1 - w_0, and the mean moves by half of nu times the jump, so that after n
 * stages w = nu^2 (1 - (1 - w_0)^n)/w_0 + w_0 (1 - w_0)^n. */
static void damping_of_a_scalar(void **state) {
    (void)state;
    for (int round = 0; round < 100; round++) {
        struct strip s = carrying(round);
        const double pace = 0.99 * drawn(round, 302) / s.fastest, u = s.u[0][0], nu = u * pace, *q = s.U[0];
        const double w0 = 0.5 * (1 + nu * nu);
        for (int stages = 0; stages < 12; stages++) {
            const double left = pow(1 - w0, stages), w = nu * nu * (1 - left) / w0 + w0 * left;
            flux_at(&s, "MUSTA", "firstOrder", pace, 0, stages, 2, CELLS - 5);
            for (int i = 3; i < CELLS - 3; i++) {
                const double known = 0.5 * u * (q[i] + q[i + 1]) - 0.5 * w / pace * (q[i + 1] - q[i]);
                assert_near(s.out[0][i], known, 1e-13 / pace);
            }
        }
    }
}

/* An Euler step of FORCE makes no cell denser or thinner than it and its neighbours were; nor does MUSTA of one stage
 * where nu is at most sqrt 2 - 1: then its w is no less than nu. With more stages w tends to 2 nu^2/(1 + nu^2) < nu,
 * and some cell overshoots. */
static void scalar_stays_monotone(void **state) {
    (void)state;
    int over[3] = {0, 0, 0};
    for (int round = 0; round < 400; round++)
        for (int stages = 0; stages < 3; stages++) {
            struct strip s = carrying(round);
            const double pace = 0.99 * drawn(round, 302) / s.fastest, *q = s.U[0];
            if (stages == 1 && fabs(s.u[0][0]) * pace > sqrt(2) - 1) continue;
            flux_at(&s, "MUSTA", "firstOrder", pace, 0, stages * stages, 2, CELLS - 5);
            for (int i = 3; i < CELLS - 3; i++) {
                const double next = q[i] - pace * (s.out[0][i] - s.out[0][i - 1]);
                const double low = smaller(smaller(q[i - 1], q[i]), q[i + 1]);
                const double high = larger(larger(q[i - 1], q[i]), q[i + 1]);
                over[stages] += next < low - 1e-14 || next > high + 1e-14;
            }
        }
    assert_int_equal(over[0], 0);
    assert_int_equal(over[1], 0);
    assert_true(over[2] > 100);
}

/* ---- Godunov's flux of a perfect gas ------------------------------------------------------------------------------
 */

struct side { /* of Riemann's problem */
    double rho, u, p;
};

/* The change of u over the wave from a side to pressure p (Toro, Riemann Solvers, 4.2). */
static double over_wave(const struct side *s, double gamma, double p) {
    const double c = sqrt(gamma * s->p / s->rho);
    if (p > s->p) return (p - s->p) * sqrt(2 / (s->rho * ((gamma + 1) * p + (gamma - 1) * s->p)));
    return 2 * c / (gamma - 1) * (pow(p / s->p, (gamma - 1) / (2 * gamma)) - 1);
}

/* The state at x/t = 0 on the side on which the contact leaves it: sign +1 for the left side. */
static struct side on_the_face(const struct side *s, double sign, double gamma, double p, double u) {
    const double c = sqrt(gamma * s->p / s->rho), at = sign * s->u, g1 = gamma - 1, g2 = gamma + 1;
    if (p > s->p) { /* a shock */
        const double speed = at - c * sqrt(g2 / (2 * gamma) * p / s->p + g1 / (2 * gamma)), r = p / s->p;
        return speed > 0 ? *s : (struct side){s->rho * (r + g1 / g2) / (g1 / g2 * r + 1), u, p};
    }
    const double rho = s->rho * pow(p / s->p, 1 / gamma);
    if (at - c > 0) return *s;
    if (sign * u - sqrt(gamma * p / rho) < 0) return (struct side){rho, u, p};
    const double f = 2 / g2 + g1 / (g2 * c) * at; /* within the rarefaction */
    return (struct side){s->rho * pow(f, 2 / g1), sign * f * c, s->p * pow(f, 2 * gamma / g1)};
}

static void godunov(const struct side side[2], double gamma, double flux[3]) {
    double low = 1e-12, high = 1e6;
    for (int i = 0; i < 200; i++) { /* bisection: the sum rises with p */
        const double p = sqrt(low * high);
        const bool above = over_wave(&side[0], gamma, p) + over_wave(&side[1], gamma, p) + side[1].u - side[0].u > 0;
        *(above ? &high : &low) = p;
    }
    const double p = sqrt(low * high);
    const double u = 0.5 * (side[0].u + side[1].u + over_wave(&side[1], gamma, p) - over_wave(&side[0], gamma, p));
    const struct side s = u > 0 ? on_the_face(&side[0], 1, gamma, p, u) : on_the_face(&side[1], -1, gamma, p, u);
    flux[0] = s.rho * s.u;
    flux[1] = s.rho * s.u * s.u + s.p;
    flux[2] = s.u * (gamma * s.p / (gamma - 1) + 0.5 * s.rho * s.u * s.u);
}

static struct strip tube(const struct side side[2]) {
    struct strip s = strip_of("perfectGas", 1);
    s.m.gamma = 1.4;
    for (int i = 0; i < CELLS; i++) {
        const struct side *from = &side[i > LEFT];
        s.U[0][i] = from->rho;
        s.u[0][i] = from->u;
        s.eps[i] = from->p / (0.4 * from->rho);
    }
    close_strip(&s);
    return s;
}

/* Toro's five tests (Riemann Solvers, table 4.1) and a stationary contact. */
static const struct side TUBE[][2] = {
    {{1, 0, 1}, {0.125, 0, 0.1}},
    {{1, -2, 0.4}, {1, 2, 0.4}},
    {{1, 0, 1000}, {1, 0, 0.01}},
    {{1, 0, 0.01}, {1, 0, 100}},
    {{5.99924, 19.5975, 460.894}, {5.99242, -6.19633, 46.095}},
    {{1, 0, 1}, {0.125, 0, 1}},
};
enum { TUBES = sizeof TUBE / sizeof *TUBE };

/* The largest error of the flux through the jump, in the units of MUSTA's stop. */
static double error_of(int k, double courant, double tolerance, int stages) {
    double known[3], error = 0, size = 0;
    struct strip s = tube(TUBE[k]);
    godunov(TUBE[k], 1.4, known);
    flux_at(&s, "MUSTA", "firstOrder", courant / s.fastest, tolerance, stages, LEFT, 1);
    for (int v = 0; v < 3; v++) {
        const double unit = v == 0 ? s.fastest * s.fastest : v == 1 ? s.fastest : 1;
        error = larger(error, fabs(s.out[v][LEFT] - known[v]) * unit);
        size = larger(size, fabs(known[v]) * unit);
    }
    return error / size;
}

/* One stage takes MUSTA a third of the way from FORCE to Godunov's flux, or more. Further ones lead it to a limit of
 * its own, as waves that have left two cells come back: still nearer than FORCE, and Godunov's flux where a contact
 * stands.
 */
static void musta_comes_towards_godunov(void **state) {
    (void)state;
    for (int k = 0; k < TUBES; k++) {
        double error[5];
        const int stages[5] = {0, 1, 4, 64, 256};
        for (int i = 0; i < 5; i++) error[i] = error_of(k, 0.9, 0, stages[i]);
        print_message("tube %d: errors with 0, 1, 4, 64, 256 stages %.2e %.2e %.2e %.2e %.2e\n", k + 1, error[0],
                      error[1], error[2], error[3], error[4]);
        assert_true(error[1] < 2. / 3 * error[0]);
        assert_true(error[4] < error[0]);
        assert_near(error[4], error[3], 1e-6 * error[0]);
        if (k == TUBES - 1) assert_true(error[4] < 1e-14);
    }
}

/* It stops at the first stage that changes the flux by less than the tolerance, or at the last. */
static void musta_stops(void **state) {
    (void)state;
    const double tolerance[] = {0.1, 0.01, 1e-6};
    for (int k = 0; k < 3 * TUBES; k++) {
        struct strip s = tube(TUBE[k / 3]), last = s, all = s;
        const double pace = 0.9 / s.fastest;
        double change = HUGE_VAL, size = 0;
        int stages = 0;
        flux_at(&last, "MUSTA", "firstOrder", pace, 0, 0, LEFT, 1);
        for (; change >= tolerance[k % 3] * size && stages < 40; stages++) {
            change = size = 0;
            flux_at(&s, "MUSTA", "firstOrder", pace, 0, stages + 1, LEFT, 1);
            for (int v = 0; v < 3; v++) {
                const double unit = v == 0 ? s.fastest * s.fastest : v == 1 ? s.fastest : 1;
                change = larger(change, fabs(s.out[v][LEFT] - last.out[v][LEFT]) * unit);
                size = larger(size, fabs(s.out[v][LEFT]) * unit);
            }
            last = s;
        }
        flux_at(&all, "MUSTA", "firstOrder", pace, tolerance[k % 3], 40, LEFT, 1);
        for (int v = 0; v < 3; v++) assert_true(all.out[v][LEFT] == s.out[v][LEFT]);
        if (k / 3 == 0) assert_true(stages < 40); /* Sod's tube */
    }
}

/* ---- smooth flow of a lattice -------------------------------------------------------------------------------------
 */

/* The largest error of the difference of two faces' fluxes over dx, where values at the centres of cells of width dx
 * are given, beside df/dx. */
static double slope_error(const char *flux, double gravity, double dx) {
    struct strip s = strip_of("TorquatoSpheres", 2), ahead[2];
    double error = 0;
    for (int side = -1; side <= 1; side++) { /* ahead: the same a little to both sides, for df/dx */
        struct strip *t = side == 0 ? &s : &ahead[side > 0];
        *t = strip_of("TorquatoSpheres", 2);
        for (int i = 0; i < CELLS; i++) {
            const double x = dx * (i - LEFT) + 1e-4 * side;
            t->U[0][i] = (0.2 + 0.05 * sin(x)) / packing_per_density(&s.m);
            t->eps[i] = 2 + 0.4 * cos(1.3 * x + 0.2);
            t->u[0][i] = 0.7 + 0.5 * sin(x + 1);
            t->u[1][i] = cos(0.9 * x);
        }
        close_strip(t);
    }
    s.gravity = gravity * dx;
    flux_at(&s, flux, "WENO5", 0.5 / s.fastest, 0, 4, 2, CELLS - 5);
    for (int i = LEFT - 3; i < LEFT + 3; i++)
        for (int v = 0; v < 4; v++) {
            const double known = (ahead[1].F[v][i] - ahead[0].F[v][i]) / 2e-4;
            error = larger(error, fabs((s.out[v][i] - s.out[v][i - 1]) / dx - known) / s.F[1][LEFT]);
        }
    return error;
}

/* The difference of two faces' fluxes is df/dx at the centre to the order of the reconstruction. Where a lattice takes
 * the pressure of gas at rest, its own trapezoidal rule leaves second order. */
static void high_order_at_centres(void **state) {
    (void)state;
    for (int k = 0; k < 4; k++) {
        const char *name = k % 2 ? "MUSTA" : "FORCE";
        const double gravity = k < 2 ? 0 : -20, dx = k < 2 ? 0.1 : 0.05;
        const double error[2] = {slope_error(name, gravity, dx), slope_error(name, gravity, dx / 2)};
        print_message("%s, gravity %g: %.2e, %.2e\n", name, gravity, error[0], error[1]);
        assert_true(log2(error[0] / error[1]) > (k < 2 ? 4.7 : 1.9));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(force_is_the_mean_of_two),
        cmocka_unit_test(musta_begins_with_force),
        cmocka_unit_test(long_steps_count_as_sound),
        cmocka_unit_test(damping_of_a_scalar),
        cmocka_unit_test(scalar_stays_monotone),
        cmocka_unit_test(musta_comes_towards_godunov),
        cmocka_unit_test(musta_stops),
        cmocka_unit_test(high_order_at_centres),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
