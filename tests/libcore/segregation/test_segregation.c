/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Segregation on a line: the paper's tables, exact solutions with and without diffusion, bounds, mass, adaptive steps.
 */
#include "libcore/segregation/segregation_private.h"

#include "tests/checks.h" /* after what it would hide */
#include "tests/libcore/oracle.h"

enum { MOST = 1601 };
static const struct segregation_scheme newton = {.newton = true, .tolerance = 1e-8, .most = 60},
                                       picard = {.tolerance = 1e-8, .most = 60};

struct line { /* L = 1/2 */
    struct segregation_line as;
    double face[MOST + 1], node[MOST], speed[MOST], diffusivity[MOST + 1], phi[MOST], width[MOST];
    struct segregation *s;
};
static void line_finish(struct line *l, int n, double f, double D, const struct segregation_scheme *scheme) {
    l->as = (struct segregation_line){
        .n = n, .face = l->face, .node = l->node, .speed = l->speed, .diffusivity = l->diffusivity};
    for (int i = 0; i < n; i++) {
        l->speed[i] = f;
        l->width[i] = l->face[i + 1] - l->face[i];
    }
    for (int i = 0; i <= n; i++) l->diffusivity[i] = D;
    ok(segregation_make(&l->as, scheme, &l->s));
}
/* The paper's n nodes; the end cells are half as wide and have theirs on the wall. */
static void line_make(struct line *l, int n, double f, double D, const struct segregation_scheme *scheme) {
    for (int i = 0; i < n; i++) l->node[i] = -0.5 + i / (n - 1.);
    l->face[0] = -0.5;
    for (int i = 1; i < n; i++) l->face[i] = 0.5 * (l->node[i - 1] + l->node[i]);
    l->face[n] = 0.5;
    line_finish(l, n, f, D, scheme);
}
static void fill(struct line *l, double phi) {
    for (int i = 0; i < l->as.n; i++) l->phi[i] = phi;
}

static struct line the_line; /* too large for the stack */

static double kink(double y, double t) {
    const double f = -1, D = 0.01, y0 = 0.2, c = -0.25;
    return (c - f) / (2 * f) * (-1 + tanh((c - f) * (y - y0 - c * t) / (2 * D)));
}
static void kink_of_the_oracle(void **state) {
    (void)state;
    FILE *f = oracle_open("kink.csv");
    struct oracle_row r;
    int rows = 0;
    for (oracle_row(f, &r); oracle_row(f, &r); rows++)
        assert_near(kink(oracle_number(&r, 0), oracle_number(&r, 1)), oracle_number(&r, 2), 1e-14);
    fclose(f);
    assert_true(rows == 63);
}

struct errors {
    double max, l2, h1;
};
static double trapezium(int n, double h, const double *square) {
    double sum = 0;
    for (int i = 0; i < n; i++) sum += (i && i < n - 1 ? 1 : 0.5) * h * square[i];
    return sum;
}
static struct errors errors_of(int n, double h, const double *e) {
    static double square[MOST], slope[MOST];
    struct errors out = {0};
    for (int i = 0; i < n; i++) {
        double d = i == 0       ? -3 * e[0] + 4 * e[1] - e[2]
                   : i == n - 1 ? 3 * e[n - 1] - 4 * e[n - 2] + e[n - 3]
                                : e[i + 1] - e[i - 1];
        slope[i] = d * d / (4 * h * h);
        square[i] = e[i] * e[i];
        out.max = fmax(out.max, fabs(e[i]));
    }
    out.l2 = sqrt(trapezium(n, h, square));
    out.h1 = sqrt(out.l2 * out.l2 + trapezium(n, h, slope));
    return out;
}

/* The kink, an exact solution (docs/physics.md 11.3): the paper's scheme (4) with (7) from dt = dy = 0.02, halved four
 * times. */
static void table_of_the_kink(void **state) {
    static const double max[] = {1.265e-2, 4.822e-3, 1.191e-3, 3.061e-4, 7.650e-5};
    static const double order[3][4] = {{1.39, 2.02, 1.96, 2.00}, {2.0, 2.0, 2.0, 2.0}, {1.41, 1.82, 1.95, 1.99}};
    static double e[MOST];
    (void)state;
    for (int kind = 0; kind < 2; kind++) {
        struct errors before = {0};
        struct segregation_scheme scheme = kind ? newton : picard;
        scheme.closure = SEGREGATION_NEUMANN;
        for (int k = 0; k < 5; k++) {
            const double h = 0.02 / (1 << k);
            const int n = (int)lround(1 / h) + 1, steps = (int)lround(2 / h);
            struct line *l = &the_line;
            line_make(l, n, -1, 0.01, &scheme);
            for (int i = 0; i < n; i++) l->phi[i] = kink(l->node[i], 0);
            for (int i = 0; i < steps; i++) ok(segregation_step(l->s, h, false, l->phi));
            for (int i = 0; i < n; i++) e[i] = l->phi[i] - kink(l->node[i], 2);
            struct errors now = errors_of(n, h, e);
            assert_close(now.max, max[k], 5e-4, "largest error");
            if (k) {
                assert_near(log2(before.max / now.max), order[0][k - 1], 0.006);
                assert_near(log2(before.l2 / now.l2), order[1][k - 1], 0.04);
                assert_near(log2(before.h1 / now.h1), order[2][k - 1], 0.006);
            }
            before = now;
            double iterations = (double)segregation_counts(l->s).iterations / steps;
            assert_true(kind ? iterations <= 3 : iterations >= 4 && iterations <= 8);
            segregation_free(l->s);
        }
    }
}

/* Largest difference to the exact solution at t in the nodes that the oracle has. */
static double against_exact(const struct line *l, double D, double t) {
    FILE *f = oracle_open("gray_chugunov_exact.csv");
    struct oracle_row r;
    double most = 0;
    int rows = 0;
    for (oracle_row(f, &r); oracle_row(f, &r);) {
        double j = (oracle_number(&r, 2) + 0.5) * (l->as.n - 1);
        if (oracle_number(&r, 0) != D || oracle_number(&r, 1) != t || fabs(j - round(j)) > 1e-6) continue;
        most = fmax(most, fabs(l->phi[lround(j)] - oracle_number(&r, 3)));
        rows++;
    }
    fclose(f);
    assert_true(rows >= 81);
    return most;
}

struct result {
    double drift, worst, nodal; /* of the mass at the end, at worst, of the sum over nodes; relative */
    struct segregation_counts counts;
};
/* The well mixed start, M nodes, K - 1 steps to T. */
static struct result mixed(int M, int K, double T, double D, const struct segregation_scheme *scheme, int damped) {
    struct line *l = &the_line;
    struct result out = {0};
    line_make(l, M, -1, D, scheme);
    fill(l, 0.55);
    const double start = segregation_mass(l->s, l->phi);
    for (int i = 0; i < K - 1; i++) {
        ok(segregation_step(l->s, T / (K - 1), i < damped, l->phi));
        out.worst = fmax(out.worst, fabs(segregation_mass(l->s, l->phi) / start - 1));
    }
    for (int i = 0; i < M; i++) out.nodal += l->phi[i] / (0.55 * M);
    out.nodal -= 1;
    out.drift = segregation_mass(l->s, l->phi) / start - 1;
    out.counts = segregation_counts(l->s);
    segregation_free(l->s);
    return out;
}

static void gray_chugunov(void **state) {
    static const struct { double D, allowed; } of[] = {{0.5, 1e-6}, {0.1, 1e-6}, {0.02, 1e-5}};
    (void)state;
    for (int k = 0; k < 3; k++) {
        struct result r = mixed(1601, 1601, 0.5, of[k].D, &newton, 1);
        double error = against_exact(&the_line, of[k].D, 0.5);
        if (!(error <= of[k].allowed)) fail_msg("D_r = %g: error %.3g", of[k].D, error);
        assert_true(r.worst < 1e-13 && r.counts.corrected == 0);
        mixed(801, 801, 0.5, of[k].D, &newton, 1);
        assert_near(log2(against_exact(&the_line, of[k].D, 0.5) / error), 2, 0.05);
    }
}

/* docs/physics.md B1: neither the sum over the nodes nor the trapezium's stays, with what order they drift.
 * docs/physics.md B2: of first order in time from the well mixed start; a damped step at the start gives back the
 * second. */
static void closure_of_the_paper(void **state) {
    (void)state;
    static const double nodal[] = {-4.8e-4, -2.4e-4, -1.2e-4}, trapezium_of[] = {-8e-6, -2e-6, -4e-7};
    struct segregation_scheme paper = newton;
    double error[2][2];
    paper.closure = SEGREGATION_PAPER;
    for (int k = 0; k < 3; k++) {
        int M = (100 << k) + 1;
        struct result r = mixed(M, M, 0.3, 0.1, &paper, 0);
        assert_close(r.nodal, nodal[k], 0.02, "drift of the sum over nodes");
        assert_close(r.drift, trapezium_of[k], 0.25, "drift of the trapezium's sum"); /* known to one digit */
    }
    for (int damped = 0; damped < 2; damped++)
        for (int k = 0; k < 2; k++) {
            int M = (400 << k) + 1;
            mixed(M, M, 0.5, 0.1, &paper, damped);
            error[damped][k] = against_exact(&the_line, 0.1, 0.5);
        }
    assert_near(log2(error[0][0] / error[0][1]), 1, 0.05);
    assert_near(log2(error[1][0] / error[1][1]), 2, 0.05);
    assert_true(error[1][1] < 0.02 * error[0][1]);
}

/* Cells of the mesh with their values in the middle: uniform, or growing towards the middle by 3. */
static void cells_make(struct line *l, int n, bool graded, double f, double D) {
    for (int i = 0; i <= n; i++) {
        double x = 2. * i / n - 1;
        l->face[i] = 0.5 * (graded ? 1.5 * x - 0.5 * x * x * x : x);
    }
    for (int i = 0; i < n; i++) l->node[i] = 0.5 * (l->face[i] + l->face[i + 1]);
    line_finish(l, n, f, D, &newton);
}
/* Steady: phi/(1 - phi) = C e^(f y / D); C by the mass. */
static double steady_error(const struct line *l, double f, double D) {
    double low = -60, high = 60, most = 0;
    for (int k = 0; k < 200; k++) {
        double c = 0.5 * (low + high), mass = 0;
        for (int i = 0; i < l->as.n; i++) mass += l->width[i] / (1 + exp(-c - f * l->node[i] / D));
        *(mass > segregation_mass(l->s, l->phi) ? &high : &low) = c;
    }
    for (int i = 0; i < l->as.n; i++) most = fmax(most, fabs(l->phi[i] - 1 / (1 + exp(-low - f * l->node[i] / D))));
    return most;
}
static void cells_of_a_mesh(void **state) {
    (void)state;
    struct line *l = &the_line;
    for (int graded = 0; graded < 2; graded++) {
        double before = 0;
        for (int n = 50; n <= 200; n *= 2) {
            cells_make(l, n, graded, -1, 0.1);
            fill(l, 0.55);
            double next, dt = 1e-4, t = 0;
            for (; t < 20; t += dt, dt = next) ok(segregation_advance(l->s, 1e-6, &dt, &next, l->phi));
            assert_close(segregation_mass(l->s, l->phi), 0.55, 1e-13, "mass");
            double error = steady_error(l, -1, 0.1);
            if (before > 0) assert_near(log2(before / error), 2, 0.02);
            before = error;
            segregation_free(l->s);
        }
    }
}

/* D = phi (1 - phi): the steady profile is the straight line of slope f. */
static void law_of_diffusion(const void *context, int n, const double *phi, double *D) {
    (void)context;
    for (int i = 0; i < n; i++) D[i] = phi[i] * (1 - phi[i]);
}
static void diffusivity_of_phi(void **state) {
    (void)state;
    struct line *l = &the_line;
    long iterations[2] = {0};
    for (int kind = 0; kind < 2; kind++) {
        double before = 0;
        for (int n = 26; n <= 101; n = 2 * n - 1) {
            line_make(l, n, -0.6, 0, kind ? &newton : &picard);
            segregation_free(l->s);
            l->as.law = law_of_diffusion;
            ok(segregation_make(&l->as, kind ? &newton : &picard, &l->s));
            fill(l, 0.55);
            for (int i = 0; i < 200; i++) ok(segregation_step(l->s, 0.05, i < 1, l->phi));
            double most = 0;
            for (int i = 0; i < n; i++) most = fmax(most, fabs(l->phi[i] - (0.55 - 0.6 * l->node[i])));
            if (before > 0) assert_near(log2(before / most), 2, 0.03);
            before = most;
            iterations[kind] = segregation_counts(l->s).iterations;
            assert_close(segregation_mass(l->s, l->phi), 0.55, 1e-13, "mass");
            segregation_free(l->s);
        }
    }
    assert_true(iterations[1] < 0.8 * (double)iterations[0]);
}

/* Gray & Thornton, f = -1, D = 0. Mixed: shocks from both walls, which meet at t = 1. Layers, phi = 1 above y = 0 and 0
 * below: a fan, which reaches the walls at t = 1/2; then shocks from them, which meet at t = 2. */
static double exact_mixed(double y, double t) {
    double low = -0.5 + 0.55 * t, high = 0.5 - 0.45 * t;
    if (low >= high) low = high = 0.05;
    return y < low ? 1 : y > high ? 0 : 0.55;
}
static double exact_layers(double y, double t) {
    if (t == 0) return y > 0 ? 1 : y < 0 ? 0 : 0.5;
    double fan = fmin(fmax(0.5 + 0.5 * y / t, 0), 1), shock = fmax(2 * sqrt(0.5 * t) - t, 0);
    if (t <= 0.5) return fan;
    return y < -shock ? 1 : y > shock ? 0 : fan;
}
struct sharp {
    double mean, variation; /* mean |error|; total variation */
    struct segregation_counts counts;
};
static struct sharp sharp_run(double exact(double, double), int n, double courant, double T,
                              const struct segregation_scheme *scheme) {
    struct line *l = &the_line;
    struct sharp out = {0};
    const int steps = (int)ceil(T * (n - 1) / courant);
    line_make(l, n, -1, 0, scheme);
    for (int i = 0; i < n; i++) l->phi[i] = exact(l->node[i], 0);
    const double mass = segregation_mass(l->s, l->phi);
    for (int k = 0; k < steps; k++) {
        ok(segregation_step(l->s, T / steps, false, l->phi));
        for (int i = 0; i < n; i++) assert_true(l->phi[i] >= 0 && l->phi[i] <= 1);
        assert_close(segregation_mass(l->s, l->phi), mass, 1e-12, "mass");
    }
    for (int i = 0; i < n; i++) {
        out.mean += l->width[i] * fabs(l->phi[i] - exact(l->node[i], T));
        if (i) out.variation += fabs(l->phi[i] - l->phi[i - 1]);
    }
    out.counts = segregation_counts(l->s);
    segregation_free(l->s);
    return out;
}
static void gray_thornton(void **state) {
    static const struct {
        double (*exact)(double, double);
        double T, variation;
    } of[] = {{exact_mixed, 0.3, 1},
              {exact_mixed, 1.2, 1},
              {exact_layers, 0.3, 1},
              {exact_layers, 1.1, 1.697},
              {exact_layers, 2.3, 1}};
    (void)state;
    for (int k = 0; k < 5; k++)
        for (double courant = 0.25; courant <= 4; courant *= 4) {
            struct sharp coarse = sharp_run(of[k].exact, 101, courant, of[k].T, &newton),
                         fine = sharp_run(of[k].exact, 401, courant, of[k].T, &newton);
            const double cells = courant > 2 ? 3.5 : 0.55; /* that the error amounts to, at every size: first order */
            if (!(coarse.mean < cells / 100 && fine.mean < cells / 400))
                fail_msg("%d, Courant number %g: %g, %g", k, courant, coarse.mean, fine.mean);
            assert_near(fine.variation, of[k].variation, courant > 2 ? 0.05 : 0.01);
        }
    struct sharp a = sharp_run(exact_layers, 101, 1, 1.1, &newton), b = sharp_run(exact_layers, 101, 1, 1.1, &picard);
    assert_close(b.mean, a.mean, 1e-4, "error with Picard");
    assert_true(a.counts.iterations < 0.4 * (double)b.counts.iterations && a.counts.unsolved == 0);
}

/* D_r = 0.002 on meshes that resolve its fronts and that do not; without bounds the latter overshoot. */
static void sharp_fronts(void **state) {
    (void)state;
    struct segregation_scheme unbounded = newton;
    unbounded.unbounded = true;
    double most = 0, least = 1, allowed[2] = {0.02, 1e-3};
    struct line *l = &the_line;
    for (int k = 0; k < 2; k++) {
        struct result r = mixed(k ? 801 : 81, k ? 1601 : 161, 1, 0.002, &newton, 1);
        for (int i = 0; i < l->as.n; i++) {
            assert_true(l->phi[i] >= 0 && l->phi[i] <= 1);
            if (i) assert_true(l->phi[i] <= l->phi[i - 1] + 1e-3);
        }
        assert_true(r.worst < 1e-12 && against_exact(l, 0.002, 1) < allowed[k]);
    }
    mixed(81, 161, 1, 0.002, &unbounded, 1);
    for (int i = 0; i < 81; i++) {
        most = fmax(most, l->phi[i]);
        least = fmin(least, l->phi[i]);
    }
    assert_true(most > 1.05 && least < -0.05);
}

/* Where the mesh resolves the diffusion, the bounds change no bit. */
static void bounds_that_rest(void **state) {
    (void)state;
    static double kept[401];
    struct segregation_scheme unbounded = newton;
    unbounded.unbounded = true;
    struct result r = mixed(401, 401, 0.5, 0.1, &newton, 1);
    memcpy(kept, the_line.phi, sizeof kept);
    mixed(401, 401, 0.5, 0.1, &unbounded, 1);
    assert_memory_equal(kept, the_line.phi, sizeof kept);
    assert_true(r.counts.bounded == 0 && r.counts.corrected == 0);
}

/* Fan & Hill: f = (q A B/rho) sgn(y) e^(B|y|), f(0) = 0. Steady: ln(phi/(1 - phi)) = c + (q A/(rho D)) e^(B|y|). */
static void exponential_stress(void **state) {
    (void)state;
    const double A = 8.21e-4, B = 280, rho = 2500, q = 2.5e-3, D = 5e-8, L = 0.022;
    struct line *l = &the_line;
    const double power = q * A / (rho * D);
    double before = 0;
    for (int n = 100; n <= 400; n *= 2) {
        cells_make(l, n, false, 0, D);
        segregation_free(l->s);
        for (int i = 0; i <= n; i++) l->face[i] *= 2 * L;
        for (int i = 0; i < n; i++) l->node[i] *= 2 * L;
        line_finish(l, n, 0, D, &newton);
        for (int i = 0; i < n; i++) l->speed[i] = copysign(q / rho * A * B * exp(B * fabs(l->node[i])), l->node[i]);
        fill(l, 0.5);
        const double mass = segregation_mass(l->s, l->phi);
        double t = 0, dt = 0.5, next, most = 0;
        for (; t < 2e5; t += dt, dt = next) ok(segregation_advance(l->s, 1e-7, &dt, &next, l->phi));
        assert_close(segregation_mass(l->s, l->phi), mass, 1e-13, "mass");
        const double c = log(l->phi[n / 2] / (1 - l->phi[n / 2])) - power * exp(B * l->node[n / 2]);
        for (int i = 0; i < n; i++) {
            double steady = 1 / (1 + exp(-c - power * exp(B * fabs(l->node[i]))));
            most = fmax(most, fabs(l->phi[i] - steady));
            assert_near(l->phi[i], l->phi[n - 1 - i], 1e-9);
        }
        if (before > 0) assert_near(log2(before / most), 2, 0.1);
        before = most;
        segregation_free(l->s);
    }
}

static double adaptive_run(struct line *l, double allowed, double from, double to, double *dt, int *steps) {
    double next, longest = 0;
    for (double t = from; t < to; t += *dt, *dt = next, ++*steps) {
        ok(segregation_advance(l->s, allowed, dt, &next, l->phi));
        longest = fmax(longest, *dt);
        if (t + *dt + next > to && t + *dt < to) next = to - (t + *dt);
    }
    return longest;
}
/* Errors fall as allowed^(2/3), steps grow as the fast part dies, and a restart repeats the bits. */
static void adaptive_steps(void **state) {
    (void)state;
    static double kept[401];
    struct line *l = &the_line;
    double error[2];
    for (int k = 0; k < 2; k++) {
        const double allowed = k ? 1e-7 : 1e-4;
        double dt = 1e-5;
        int steps = 0;
        line_make(l, 401, -1, 0.1, &newton);
        fill(l, 0.55);
        double longest = adaptive_run(l, allowed, 0, 1, &dt, &steps);
        error[k] = against_exact(l, 0.1, 1);
        assert_true(steps < (k ? 300 : 40) && longest > (k ? 0.01 : 0.1));
        segregation_free(l->s);
    }
    assert_close(error[0] / error[1], 100, 0.15, "errors at 1e-4 and 1e-7");
    for (int again = 0; again < 2; again++) {
        double dt = 1e-3, next;
        line_make(l, 401, -1, 0.02, &newton);
        fill(l, 0.55);
        for (int k = 0; k < 40; k++, dt = next) {
            if (again && k == 17) {
                segregation_free(l->s);
                ok(segregation_make(&l->as, &newton, &l->s));
            }
            ok(segregation_advance(l->s, 1e-5, &dt, &next, l->phi));
        }
        if (!again) memcpy(kept, l->phi, sizeof kept);
        segregation_free(l->s);
    }
    assert_memory_equal(kept, l->phi, sizeof kept);
}

/* Solves a system whose rows from `pivot` on want to be interchanged with the next ones, and returns the largest
 * residual, as a share of the largest unknown. */
static double residual_of(struct segregation *s, int pivot) {
    enum { N = 40 };
    struct tridiagonal *m = &s->matrix;
    double below[N], diagonal[N], above[N], right[N], worst = 0, largest = 0;
    for (int i = 0; i < N; i++) {
        m->below[i] = below[i] = -1 + 0.3 * cos(i);
        m->above[i] = above[i] = -1.2 + 0.2 * sin(5 * i);
        m->diagonal[i] = diagonal[i] = (i >= pivot ? 0.01 : 1) * (2.7 + 0.1 * cos(2 * i));
        m->right[i] = right[i] = sin(3.7 * i) + 0.1 * i;
    }
    assert_true(segregation_solve(s));
    const double *x = m->right;
    for (int i = 0; i < N; i++) {
        const double left = (i > 0 ? below[i - 1] * x[i - 1] : 0) + (i < N - 1 ? above[i] * x[i + 1] : 0);
        worst = fmax(worst, fabs(diagonal[i] * x[i] + left - right[i]));
        largest = fmax(largest, fabs(x[i]));
    }
    return worst / largest;
}
static void interchanged_rows(void **state) {
    (void)state;
    struct line *l = &the_line;
    line_make(l, 40, -1, 0.1, &newton);
    for (int pivot = 0; pivot <= 40; pivot++) assert_near(residual_of(l->s, pivot), 0, 1e-14);
    for (int i = 0; i < 40; i++) /* the first two rows are the same */
        l->s->matrix.below[i] = l->s->matrix.diagonal[i] = l->s->matrix.above[i] = i < 2;
    assert_false(segregation_solve(l->s));
    segregation_free(l->s);
}

static void bad_lines(void **state) {
    (void)state;
    struct line *l = &the_line;
    struct segregation_scheme paper = picard;
    struct segregation *s;
    line_make(l, 11, -1, 0, &picard);
    segregation_free(l->s);
    l->as.n = 2;
    says(segregation_make(&l->as, &picard, &s), "2 cells|3");
    l->as.n = 11;
    l->node[4] = l->node[6];
    says(segregation_make(&l->as, &picard, &s), "cell 4|ascend");
    line_make(l, 11, -1, 0, &picard);
    segregation_free(l->s);
    l->node[0] = -0.49;
    paper.closure = SEGREGATION_PAPER;
    says(segregation_make(&l->as, &paper, &s), "on the walls");
    paper.closure = SEGREGATION_CONSERVATIVE;
    paper.unbounded = true;
    line_make(l, 101, -1, 0, &paper);
    for (int i = 0; i < 101; i++) l->phi[i] = i > 50 ? 0.9 : 0.2;
    double kept = l->phi[51];
    says(segregation_step(l->s, 3, false, l->phi), "settled|60|smaller deltaT");
    assert_true(l->phi[51] == kept);
    segregation_free(l->s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(kink_of_the_oracle), cmocka_unit_test(table_of_the_kink),
        cmocka_unit_test(gray_chugunov),      cmocka_unit_test(closure_of_the_paper),
        cmocka_unit_test(cells_of_a_mesh),    cmocka_unit_test(diffusivity_of_phi),
        cmocka_unit_test(gray_thornton),      cmocka_unit_test(sharp_fronts),
        cmocka_unit_test(bounds_that_rest),   cmocka_unit_test(exponential_stress),
        cmocka_unit_test(adaptive_steps),     cmocka_unit_test(interchanged_rows),
        cmocka_unit_test(bad_lines),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
