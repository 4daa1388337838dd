/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Segregation on lattices: orders, uniform states in any flow without divergence, bounds, mass, one to three axes. */
#include "libcore/segregation/segregation.h"
#include "libcore/segregation/segregation_lattice.h"

#include "tests/checks.h" /* after what it would hide */
#include "tests/libcore/oracle.h"

static const double PI = 3.14159265358979323846;

struct box { /* [-size/2, size/2]^dim, n cells a side */
    struct segregation_lattice as;
    double *u[3], *f[3], *D[3], *phi, size;
    long cells, faces[3];
    struct segregation_field *s;
};
static void box_make(struct box *b, int dim, int n, double size) {
    *b = (struct box){.as.dim = dim, .size = size, .cells = 1};
    for (int k = 0; k < 3; k++) {
        b->as.n[k] = k < dim ? n : 1;
        b->as.width[k] = size / n;
        b->cells *= b->as.n[k];
    }
    ok(allocate(&b->phi, b->cells, sizeof(double), "phi"));
    for (int k = 0; k < dim; k++) {
        b->faces[k] = b->cells / n * (n + 1);
        double **arrays[] = {&b->u[k], &b->f[k], &b->D[k]};
        for (int i = 0; i < 3; i++) ok(allocate(arrays[i], b->faces[k], sizeof(double), "faces"));
        b->as.u[k] = b->u[k];
        b->as.f[k] = b->f[k];
        b->as.D[k] = b->D[k];
    }
}
static void box_free(struct box *b) {
    segregation_field_free(b->s);
    for (int k = 0; k < 3; k++) {
        free(b->u[k]);
        free(b->f[k]);
        free(b->D[k]);
    }
    free(b->phi);
}
/* Place of a cell (k = -1), or of a face of axis k; is the face on the boundary? */
static bool place_of(const struct box *b, int k, long i, double x[3]) {
    bool boundary = false;
    for (int a = 0; a < 3; a++) {
        int n = b->as.n[a] + (a == k);
        long j = i % n;
        i /= n;
        x[a] = a < b->as.dim ? ((double)j + (a == k ? 0 : 0.5)) * b->as.width[a] - 0.5 * b->size : 0;
        boundary = boundary || (a == k && (j == 0 || j == n - 1));
    }
    return boundary;
}
static double mass_of(const struct box *b) {
    double sum = 0;
    for (long c = 0; c < b->cells; c++) sum += b->phi[c];
    return sum / (double)b->cells;
}
/* f along (fx, fy, fz) and D on inner faces. */
static void fill_faces(struct box *b, const double f[3], double D) {
    double x[3];
    for (int k = 0; k < b->as.dim; k++)
        for (long i = 0; i < b->faces[k]; i++)
            if (!place_of(b, k, i, x)) {
                b->f[k][i] = f[k];
                b->D[k][i] = D;
            }
}
/* Cells of a flow in x, y (curl of a stream function at the corners): no divergence to round-off, walls all around. */
static double stream(const struct box *b, double x, double y) {
    double a = PI * (x / b->size + 0.5), c = PI * (y / b->size + 0.5);
    return sin(a) * sin(c) * (1 + 0.5 * sin(3 * a) * cos(2 * c));
}
static void stir(struct box *b) {
    double x[3];
    const double h = b->as.width[0];
    for (int k = 0; k < 2; k++)
        for (long i = 0; i < b->faces[k]; i++)
            b->u[k][i] = place_of(b, k, i, x) ? 0
                         : k == 0             ? (stream(b, x[0], x[1] + h / 2) - stream(b, x[0], x[1] - h / 2)) / h
                                              : -(stream(b, x[0] + h / 2, x[1]) - stream(b, x[0] - h / 2, x[1])) / h;
}

/* One axis: what the line's scheme gives with one iteration of Newton. */
static void the_line_again(void **state) {
    (void)state;
    enum { N = 200 };
    double face[N + 1], node[N], speed[N], D[N + 1], phi[N];
    struct segregation_scheme scheme = {.newton = true, .tolerance = 1e30, .most = 1};
    struct segregation_line line = {.n = N, .face = face, .node = node, .speed = speed, .diffusivity = D};
    struct segregation *s;
    struct box b;
    box_make(&b, 1, N, 1);
    fill_faces(&b, (double[3]){-1, 0, 0}, 0.02);
    ok(segregation_field_make(&b.as, &b.s));
    for (int i = 0; i <= N; i++) {
        face[i] = -0.5 + i / (double)N;
        D[i] = 0.02;
    }
    for (int i = 0; i < N; i++) {
        node[i] = 0.5 * (face[i] + face[i + 1]);
        speed[i] = -1;
        b.phi[i] = phi[i] = 0.5 + 0.3 * sin(3 * node[i]);
    }
    ok(segregation_make(&line, &scheme, &s));
    for (int i = 0; i < 200; i++) {
        ok(segregation_step(s, 1e-3, false, phi));
        ok(segregation_field_step(b.s, 1e-3, false, b.phi));
    }
    for (int i = 0; i < N; i++) assert_near(b.phi[i], phi[i], 1e-11);
    segregation_free(s);
    box_free(&b);
}

static void uniform_states(void **state) {
    (void)state;
    for (int dim = 2; dim <= 3; dim++)
        for (int mixed = 0; mixed < 2; mixed++) {
            struct box b;
            box_make(&b, dim, 40, 1);
            stir(&b);
            fill_faces(&b, (double[3]){0}, mixed ? 0.02 : 0);
            ok(segregation_field_make(&b.as, &b.s));
            for (long c = 0; c < b.cells; c++) b.phi[c] = 0.37;
            double dt = 0.9 / segregation_field_rate(b.s);
            for (int i = 0; i < 50; i++) ok(segregation_field_step(b.s, dt, false, b.phi));
            for (long c = 0; c < b.cells; c++) assert_near(b.phi[c], 0.37, 1e-13);
            box_free(&b);
        }
}

/* A kink of the paper that travels obliquely and is carried: exact away from the walls of a larger box. */
static double oblique(const double x[3], double t, const double d[3], const double u[3], int dim) {
    const double f = -1, D = 0.05, c = -0.25;
    double along = 0;
    for (int k = 0; k < dim; k++) along += d[k] * (x[k] - u[k] * t);
    return (c - f) / (2 * f) * (-1 + tanh((c - f) * (along - c * t) / (2 * D)));
}
static void order(void **state) {
    (void)state;
    const double d[3][3] = {{0.6, 0.8, 0}, {0.6, 0.8, 0}, {0.36, 0.48, 0.8}}, u[3] = {0.5, -0.3, 0.2};
    for (int dim = 2; dim <= 3; dim++) {
        double before = 0;
        for (int n = dim == 2 ? 64 : 24; n <= (dim == 2 ? 256 : 48); n *= 2) {
            struct box b;
            double x[3], most = 0, T = 0.4, *none[3] = {0};
            bool *edge[3] = {0};
            box_make(&b, dim, n, 3);
            fill_faces(&b, (double[3]){-d[dim - 1][0], -d[dim - 1][1], -d[dim - 1][2]}, 0.05);
            for (int k = 0; k < dim; k++) {
                ok(allocate(&edge[k], b.faces[k], sizeof(bool), "faces"));
                ok(allocate(&none[k], b.faces[k], sizeof(double), "faces"));
                for (long i = 0; i < b.faces[k]; i++) {
                    b.u[k][i] = u[k];
                    edge[k][i] = place_of(&b, k, i, x);
                }
                b.as.fixed[k] = edge[k];
                b.as.value[k] = none[k];
            }
            ok(segregation_field_make(&b.as, &b.s));
            for (long c = 0; c < b.cells; c++) {
                place_of(&b, -1, c, x);
                b.phi[c] = oblique(x, 0, d[dim - 1], u, dim);
            }
            int steps = n / 2;
            for (int i = 0; i < steps; i++) ok(segregation_field_step(b.s, T / steps, false, b.phi));
            for (long c = 0; c < b.cells; c++) {
                place_of(&b, -1, c, x);
                if (fabs(x[0]) < 0.5 && fabs(x[1]) < 0.5 && fabs(x[2]) < 0.5)
                    most = fmax(most, fabs(b.phi[c] - oblique(x, T, d[dim - 1], u, dim)));
            }
            if (before > 0) assert_near(log2(before / most), 2, dim == 2 ? 0.02 : 0.06);
            if (dim == 2) assert_true(segregation_field_counts(b.s).bounded == 0);
            before = most;
            for (int k = 0; k < 3; k++) {
                free(edge[k]);
                free(none[k]);
            }
            box_free(&b);
        }
    }
}

/* Layers stirred and unmixed without diffusion: 0 .. 1 and the mass stay; so they do with long steps. */
static void bounds_and_mass(void **state) {
    (void)state;
    for (int dim = 2; dim <= 3; dim++)
        for (double courant = 0.5; courant < 3; courant *= 4)
            for (double D = 0; D < 1e-3; D += 5e-4) {
                struct box b;
                double x[3];
                box_make(&b, dim, dim == 2 ? 64 : 20, 1);
                stir(&b);
                fill_faces(&b, (double[3]){-0.2, -0.7, 0.3}, D);
                ok(segregation_field_make(&b.as, &b.s));
                for (long c = 0; c < b.cells; c++) {
                    place_of(&b, -1, c, x);
                    b.phi[c] = x[1] > 0.1 ? 1 : x[0] > 0.2 ? 0.4 : 0;
                }
                double mass = mass_of(&b), dt = courant / segregation_field_rate(b.s);
                for (int i = 0; i < 100; i++) {
                    ok(segregation_field_step(b.s, dt, false, b.phi));
                    for (long c = 0; c < b.cells; c++) assert_true(b.phi[c] >= 0 && b.phi[c] <= 1);
                }
                assert_near(mass_of(&b), mass, 1e-13);
                box_free(&b);
            }
}

/* In at the left, out at the right, unmixed on the way: steady in the end, where what comes in goes out. */
static void through_flow(void **state) {
    (void)state;
    struct box b;
    double x[3], *inflow, in = 0, out = 0;
    bool *fixed;
    box_make(&b, 2, 32, 1);
    fill_faces(&b, (double[3]){0, -0.4, 0}, 0.02);
    ok(allocate(&inflow, b.faces[0], sizeof *inflow, "inflow"));
    ok(allocate(&fixed, b.faces[0], sizeof *fixed, "inflow"));
    for (long i = 0; i < b.faces[0]; i++) {
        b.u[0][i] = 1;
        fixed[i] = i % 33 == 0;
        inflow[i] = 0.6;
    }
    b.as.value[0] = inflow;
    b.as.fixed[0] = fixed;
    ok(segregation_field_make(&b.as, &b.s));
    for (int i = 0; i < 400; i++) ok(segregation_field_step(b.s, 0.02, false, b.phi));
    for (long c = 0; c < b.cells; c++) {
        place_of(&b, -1, c, x);
        assert_true(b.phi[c] >= 0 && b.phi[c] <= 1);
        if (c >= 32 && c % 32 == 31) assert_true(b.phi[c] < b.phi[c - 32]); /* the small ones below */
    }
    for (long row = 0; row < 32; row++) {
        in += 0.6 * b.as.width[1];
        out += b.phi[32 * row + 31] * b.as.width[1];
    }
    assert_near(out, in, 1e-9);
    free(inflow);
    free(fixed);
    box_free(&b);
}

/* A box whose boundary is open: u, f and D go through; phi is value(x) on the faces with x + y + z < most. */
struct open_box {
    struct box b;
    bool *fixed[3];
    double *value[3];
};
static double slope_value(const double x[3]) {
    return 0.5 + 0.25 * x[0] - 0.3 * x[1] + 0.2 * x[2];
}
static double half_value(const double x[3]) {
    (void)x;
    return 0.37;
}
static void open_make(struct open_box *o, int dim, int n, const double u[3], const double f[3], double D, double most,
                      double (*value)(const double[3]), bool turned) {
    struct box *b = &o->b;
    double x[3];
    *o = (struct open_box){0};
    box_make(b, dim, n, 1);
    for (int k = 0; k < dim; k++) {
        ok(allocate(&o->fixed[k], b->faces[k], sizeof(bool), "faces"));
        ok(allocate(&o->value[k], b->faces[k], sizeof(double), "faces"));
        for (long i = 0; i < b->faces[k]; i++) {
            o->fixed[k][i] = place_of(b, k, i, x) && x[0] + x[1] + x[2] < most;
            o->value[k][i] = turned ? 1 - value(x) : value(x);
            b->u[k][i] = u[k];
            b->f[k][i] = turned ? -f[k] : f[k];
            b->D[k][i] = D;
        }
        b->as.fixed[k] = o->fixed[k];
        b->as.value[k] = o->value[k];
    }
    ok(segregation_field_make(&b->as, &b->s));
    for (long c = 0; c < b->cells; c++) {
        place_of(b, -1, c, x);
        b->phi[c] = turned ? 1 - value(x) : value(x);
    }
}
static void open_free(struct open_box *o) {
    for (int k = 0; k < 3; k++) {
        free(o->fixed[k]);
        free(o->value[k]);
    }
    box_free(&o->b);
}

/* What is everywhere given stays, whatever u, f and D go through the boundary; where only some of it is, too. */
static void given_uniform(void **state) {
    (void)state;
    const double u[3] = {0.3, -0.2, 0.4}, f[3] = {0.1, 0.5, -0.3}, none[3] = {0};
    for (int dim = 1; dim <= 3; dim++)
        for (int i = 0; i < 8; i++) {
            struct open_box o;
            open_make(&o, dim, 12, i & 1 ? u : none, f, i & 2 ? 0.1 : 0, i & 4 ? 0 : 9, half_value, false);
            for (int j = 0; j < 50; j++) ok(segregation_field_step(o.b.s, 0.1, j < 1, o.b.phi));
            for (long c = 0; c < o.b.cells; c++) assert_near(o.b.phi[c], 0.37, 1e-13);
            open_free(&o);
        }
}

/* 0 .. 1 is kept on grids that resolve D and others, from a start far from the values, with steps far beyond a Courant
 * number of 1. Large grains are to -f what small ones are to f: 1 - phi of values 1 - phi is the same run, unless
 * round-off decides which cells limit their faces, as on grids that are too coarse for D. */
static void given_values_keep_bounds(void **state) {
    (void)state;
    const double u[3] = {0.3, -0.6, 0.4}, f[3] = {0.7, 0.5, -0.3};
    for (int dim = 1; dim <= 3; dim++)
        for (int i = 0; i < 8; i++) {
            struct open_box o[2];
            const double D = i & 1 ? 0.05 : i & 2 ? 1e-3 : 0;
            for (int k = 0; k < 2; k++) open_make(&o[k], dim, 16, u, f, D, i & 4 ? 0 : 9, slope_value, k);
            for (long c = 0; c < o[0].b.cells; c++) o[1].b.phi[c] = 1 - (o[0].b.phi[c] = (c * 7 % 13 < 5));
            const double dt = (i & 2 ? 3 : 0.7) / segregation_field_rate(o[0].b.s);
            for (int j = 0; j < 40; j++)
                for (int k = 0; k < 2; k++) {
                    ok(segregation_field_step(o[k].b.s, dt, j < 1, o[k].b.phi));
                    for (long c = 0; c < o[k].b.cells; c++) assert_true(o[k].b.phi[c] >= 0 && o[k].b.phi[c] <= 1);
                }
            for (long c = 0; c < o[0].b.cells && i & 1; c++) assert_near(o[1].b.phi[c], 1 - o[0].b.phi[c], 1e-11);
            for (int k = 0; k < 2; k++) open_free(&o[k]);
        }
}

/* Steps of half the length err a quarter with an open boundary, given or not, resolved or not: its derivatives stand in
 * the lines' systems. */
static void open_boundary_in_time(void **state) {
    (void)state;
    const double u[3] = {0.6, -0.5, 0.4}, f[3] = {0.3, 0.2, -0.3};
    for (int dim = 1; dim <= 3; dim++)
        for (int i = 0; i < 4; i++) {
            double *was = NULL, change[2] = {0};
            for (int k = 0; k < 3; k++) {
                struct open_box o;
                open_make(&o, dim, 10, u, f, i & 1 ? 0.1 : 0.02, i & 2 ? 0 : 9, slope_value, false);
                if (!was) ok(allocate(&was, o.b.cells, sizeof *was, "phi"));
                for (int j = 0; j < 10 << k; j++) ok(segregation_field_step(o.b.s, 0.02 / (1 << k), false, o.b.phi));
                for (long c = 0; c < o.b.cells && k; c++)
                    change[k - 1] = fmax(change[k - 1], fabs(o.b.phi[c] - was[c]));
                memcpy(was, o.b.phi, (size_t)o.b.cells * sizeof *was);
                assert_true(segregation_field_counts(o.b.s).bounded == 0 || !(i & 1));
                open_free(&o);
            }
            free(was);
            if (i & 1)
                assert_near(log2(change[0] / change[1]), 2, 0.13); /* 2.003 .. 2.10 */
            else
                assert_true(change[0] / change[1] > 2.5); /* bounds act */
        }
}

/* What a plane between mirror images holds, three axes repeat. */
static void axes_are_alike(void **state) {
    (void)state;
    struct box b[3];
    double x[3];
    const int axes[3][2] = {{0, 1}, {1, 2}, {2, 0}};
    for (int k = 0; k < 3; k++) {
        double f[3] = {0};
        const int a = axes[k][0], c = axes[k][1];
        box_make(&b[k], 3, 12, 1);
        f[a] = 0.3;
        f[c] = -0.5;
        fill_faces(&b[k], f, 0.01);
        ok(segregation_field_make(&b[k].as, &b[k].s));
        for (long i = 0; i < b[k].cells; i++) {
            place_of(&b[k], -1, i, x);
            b[k].phi[i] = 0.5 + 0.4 * sin(5 * x[a]) * cos(3 * x[c] + 1);
        }
        for (int i = 0; i < 40; i++) ok(segregation_field_step(b[k].s, 2e-3, false, b[k].phi));
    }
    for (long i = 0; i < 12; i++)
        for (long j = 0; j < 12; j++) /* splitting errors differ by the order of the axes */
            for (int k = 0; k < 3; k++) {
                const long s[3] = {1, 12, 144};
                assert_near(b[k].phi[i * s[axes[k][0]] + j * s[axes[k][1]]], b[0].phi[i + 12 * j], 1e-5);
            }
    for (int k = 0; k < 3; k++) box_free(&b[k]);
}

/* A capacity slows the change, keeps uniform states and the sum of capacity phi. */
static void capacity(void **state) {
    (void)state;
    struct box b, twice;
    double most = 0, *weight, *half, was = 0, is = 0;
    box_make(&b, 2, 32, 1);
    stir(&b);
    fill_faces(&b, (double[3]){0}, 0.01);
    ok(allocate(&weight, b.cells, sizeof *weight, "capacity"));
    for (long c = 0; c < b.cells; c++) weight[c] = 1.5 + sin(0.37 * (double)c);
    b.as.capacity = weight;
    ok(segregation_field_make(&b.as, &b.s));
    for (long c = 0; c < b.cells; c++) b.phi[c] = 0.37;
    double dt = 0.9 / segregation_field_rate(b.s);
    for (int i = 0; i < 20; i++) ok(segregation_field_step(b.s, dt, false, b.phi));
    for (long c = 0; c < b.cells; c++) most = fmax(most, fabs(b.phi[c] - 0.37));
    assert_true(most < 1e-13);
    for (long c = 0; c < b.cells; c++) was += weight[c] * (b.phi[c] = c % 32 < 9 ? 1 : 0.1);
    for (int i = 0; i < 50; i++) ok(segregation_field_step(b.s, dt, false, b.phi));
    for (long c = 0; c < b.cells; c++) is += weight[c] * b.phi[c];
    assert_close(is, was, 1e-13, "mass");
    box_make(&twice, 2, 32, 1);
    stir(&twice);
    fill_faces(&twice, (double[3]){0}, 0.01);
    ok(allocate(&half, b.cells, sizeof *half, "capacity"));
    for (long c = 0; c < b.cells; c++) half[c] = 2;
    twice.as.capacity = half;
    ok(segregation_field_make(&twice.as, &twice.s));
    segregation_field_free(b.s);
    b.as.capacity = NULL;
    ok(segregation_field_make(&b.as, &b.s));
    memcpy(twice.phi, b.phi, (size_t)b.cells * sizeof *b.phi);
    for (int i = 0; i < 20; i++) {
        ok(segregation_field_step(b.s, 0.5 * dt, false, b.phi));
        ok(segregation_field_step(twice.s, dt, false, twice.phi));
    }
    for (long c = 0; c < b.cells; c++) assert_near(twice.phi[c], b.phi[c], 1e-14);
    free(weight);
    free(half);
    box_free(&b);
    box_free(&twice);
}

/* Towards the steady layers of a closed box, steps grow far beyond a Courant number of 1; errors as allowed^(2/3). */
static double settled(double allowed, int *steps, double *longest, double *phi) {
    struct box b;
    double dt = 1e-4, next, t = 0;
    box_make(&b, 2, 32, 1);
    fill_faces(&b, (double[3]){0, -1, 0}, 0.1);
    ok(segregation_field_make(&b.as, &b.s));
    for (long c = 0; c < b.cells; c++) b.phi[c] = 0.55 + 0.2 * sin(3. * (double)(c % 32) / 32);
    const double mass = mass_of(&b);
    for (*steps = 0, *longest = 0; t < 0.5; t += dt, dt = fmin(next, 0.5 - t), ++*steps) {
        ok(segregation_field_advance(b.s, allowed, &dt, &next, b.phi));
        *longest = fmax(*longest, dt * segregation_field_rate(b.s));
        if (0.5 - t - dt < 1e-12) break;
    }
    assert_near(mass_of(&b), mass, 1e-13);
    double most = 0;
    for (long c = 0; c < b.cells; c++) most = fmax(most, fabs(b.phi[c] - phi[c]));
    memcpy(phi, b.phi, (size_t)b.cells * sizeof *phi);
    box_free(&b);
    return most;
}
static void adaptive_steps(void **state) {
    (void)state;
    static double fine[32 * 32], coarse[32 * 32];
    int steps;
    double longest, error[2];
    settled(1e-9, &steps, &longest, fine);
    for (int k = 0; k < 2; k++) {
        memcpy(coarse, fine, sizeof fine);
        error[k] = settled(k ? 1e-6 : 1e-4, &steps, &longest, coarse);
        assert_true(steps < (k ? 100 : 30) && longest > (k ? 0.5 : 2));
    }
    assert_close(error[0] / error[1], pow(100, 2. / 3), 0.3, "errors at 1e-4 and 1e-6");
}

/* All axes cyclic: what is on both ends is the same face. */
static void fill_cyclic(struct box *b, const double u[3], const double f[3], double D) {
    for (int k = 0; k < b->as.dim; k++) {
        b->as.cyclic[k] = true;
        for (long i = 0; i < b->faces[k]; i++) {
            b->u[k][i] = u[k];
            b->f[k][i] = f[k];
            b->D[k][i] = D;
        }
    }
}

/* A wave that is carried round and spreads, exactly known; order 2, nothing lost. */
static void cyclic_wave(void **state) {
    (void)state;
    const double u[3] = {0.6, -0.3, 0.4}, none[3] = {0}, D = 0.02, T = 0.5;
    for (int dim = 1; dim <= 3; dim++) {
        double before = 0;
        for (int n = 16; n <= 32; n *= 2) {
            struct box b;
            double x[3], most = 0;
            box_make(&b, dim, n, 1);
            fill_cyclic(&b, u, none, D);
            ok(segregation_field_make(&b.as, &b.s));
            for (int end = 0; end < 2; end++) {
                for (long c = 0; c < b.cells; c++) {
                    place_of(&b, -1, c, x);
                    double phase = 0, t = end ? T : 0;
                    for (int k = 0; k < dim; k++) phase += 2 * PI * (x[k] - u[k] * t);
                    double exact = 0.5 + 0.4 * exp(-4 * PI * PI * dim * D * t) * sin(phase);
                    if (!end) b.phi[c] = exact;
                    most = fmax(most, fabs(b.phi[c] - exact));
                }
                double mass = mass_of(&b);
                for (int i = 0; i < 2 * n && !end; i++) ok(segregation_field_step(b.s, T / (2 * n), false, b.phi));
                assert_near(mass_of(&b), mass, 1e-14);
            }
            if (before > 0) assert_near(log2(before / most), 2, 0.1);
            before = most;
            box_free(&b);
        }
    }
}

/* Moved by some cells, the same start gives the same end, moved, wherever the seam is: with and without bounds. */
static void cyclic_shift(void **state) {
    (void)state;
    enum { N = 18 };
    const double u[3] = {0.6, -0.3, 0.4}, f[3] = {-0.3, 0.5, 0.2};
    for (int dim = 1; dim <= 3; dim++)
        for (int sharp = 0; sharp < 2; sharp++) {
            struct box b[2];
            double mass = 0;
            for (int i = 0; i < 2; i++) {
                box_make(&b[i], dim, N, 1);
                fill_cyclic(&b[i], u, f, sharp ? 0 : 0.05);
                ok(segregation_field_make(&b[i].as, &b[i].s));
            }
            for (long c = 0; c < b[0].cells; c++) {
                long moved = 0, stride = 1;
                for (int k = 0; k < dim; k++, stride *= N) moved += (c / stride + 5 * (k + 1)) % N * stride;
                b[0].phi[c] = sharp ? (c * 7 % 13 < 5) : 0.5 + 0.4 * sin(0.37 * (double)(c % 101));
                b[1].phi[moved] = b[0].phi[c];
                mass += b[0].phi[c];
            }
            for (int i = 0; i < 2; i++)
                for (int j = 0; j < 30; j++)
                    ok(segregation_field_step(b[i].s, 1 / segregation_field_rate(b[i].s), j < 2, b[i].phi));
            assert_close(mass_of(&b[0]), mass / (double)b[0].cells, 1e-13, "mass");
            for (long c = 0; c < b[0].cells; c++) {
                long moved = 0, stride = 1;
                for (int k = 0; k < dim; k++, stride *= N) moved += (c / stride + 5 * (k + 1)) % N * stride;
                assert_true(b[0].phi[c] >= 0 && b[0].phi[c] <= 1);
                assert_near(b[1].phi[moved], b[0].phi[c], 1e-11);
            }
            assert_true((segregation_field_counts(b[0].s).corrected > 0) == (sharp > 0));
            for (int i = 0; i < 2; i++) box_free(&b[i]);
        }
}

/* D = D0 (1 - phi): f phi (1 - phi) = D phi_y at rest, phi = c exp(f y / D0). Steps of half the length err a quarter.
 */
struct law {
    const struct box *b;
    double D0;
};
static void thinning(const void *context, int k, const double *phi, double *D) {
    const struct law *l = context;
    double x[3];
    for (long i = 0; i < l->b->faces[k]; i++) D[i] = place_of(l->b, k, i, x) ? 0 : l->D0 * (1 - phi[i]);
}
static void run_law(int n, double T, int steps, double *phi) {
    struct box b;
    const struct law law = {&b, 0.4};
    box_make(&b, 2, n, 1);
    fill_faces(&b, (double[3]){0, -1, 0}, 0);
    b.as.law = thinning;
    b.as.context = &law;
    ok(segregation_field_make(&b.as, &b.s));
    for (long c = 0; c < b.cells; c++) b.phi[c] = 0.3 + 0.1 * cos(PI * ((double)(c / n) + 0.5) / n);
    const double mass = mass_of(&b);
    for (int i = 0; i < steps; i++) ok(segregation_field_step(b.s, T / steps, i < 2 && T > 1, b.phi));
    assert_near(mass_of(&b), mass, 1e-14);
    for (long c = 0; c < n; c++) phi[c] = b.phi[c * n];
    box_free(&b);
}
static void law_of_phi(void **state) {
    (void)state;
    double phi[64], finer[64], finest[64], change = 0, last = 0, error[2];
    for (int k = 0; k < 2; k++) {
        const int n = 16 << k;
        const double c = 0.3 / 0.4 / (1 - exp(-1 / 0.4)); /* mean 0.3 on a length of 1 */
        run_law(n, 8, 400, phi);
        error[k] = 0;
        for (int i = 0; i < n; i++) error[k] += fabs(phi[i] - c * exp(-(i + 0.5) / n / 0.4)) / n;
    }
    assert_near(log2(error[0] / error[1]), 2, 0.1);
    run_law(16, 0.2, 8, phi);
    run_law(16, 0.2, 16, finer);
    run_law(16, 0.2, 32, finest);
    for (int i = 0; i < 16; i++) {
        change = fmax(change, fabs(finer[i] - phi[i]));
        last = fmax(last, fabs(finest[i] - finer[i]));
    }
    assert_near(log2(change / last), 2, 0.2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_line_again),
        cmocka_unit_test(uniform_states),
        cmocka_unit_test(order),
        cmocka_unit_test(bounds_and_mass),
        cmocka_unit_test(through_flow),
        cmocka_unit_test(axes_are_alike),
        cmocka_unit_test(capacity),
        cmocka_unit_test(adaptive_steps),
        cmocka_unit_test(cyclic_wave),
        cmocka_unit_test(cyclic_shift),
        cmocka_unit_test(law_of_phi),
        cmocka_unit_test(given_uniform),
        cmocka_unit_test(given_values_keep_bounds),
        cmocka_unit_test(open_boundary_in_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
