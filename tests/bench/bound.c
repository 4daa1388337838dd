/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bench_bound [cells a side [steps]]

   What one core can do on characteristic WENO5: the Euler equations of a perfect gas in two dimensions, finite
   differences with local Lax-Friedrichs splitting (Jiang & Shu 1996), weights of WENO-Z, SSPRK3, as one loop in vectors
   of eight, without equation of state, boundaries, sources or checks, and with -ffast-math. The isentropic vortex
   crosses a periodic box of 10 x 10 once. Prints million cell-stages per second and the errors of the density. Other
   speeds are given as a share of this one. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "clock.h"

enum { VARS = 4, LANES = 8, LEFT = 8, GHOSTS = 3 };
static const double PI = 3.14159265358979323846, GAMMA = 1.4, TINY = 4e-6; /* four times the usual epsilon of WENO */

typedef double vec __attribute__((vector_size(64)));
typedef double any __attribute__((vector_size(64), aligned(8), may_alias));
typedef double *const *fields; /* one array for each variable */

struct box {
    int n;
    long row; /* numbers from one row to the next */
    double h, *u[VARS], *start[VARS], *next[VARS], *f[VARS], *g[VARS], *across[VARS], *below[VARS], *above[VARS];
};

static inline vec load(const double *p) {
    return *(const any *)p;
}
static inline void store(double *p, vec a) {
    *(any *)p = a;
}
static inline vec root(vec a) {
    for (int i = 0; i < LANES; i++) a[i] = sqrt(a[i]);
    return a;
}
static inline vec larger(vec a, vec b) {
    for (int i = 0; i < LANES; i++) a[i] = a[i] > b[i] ? a[i] : b[i];
    return a;
}
static inline vec size(vec a) {
    for (int i = 0; i < LANES; i++) a[i] = fabs(a[i]);
    return a;
}

static inline vec weno(const vec a[5]) { /* one division */
    vec t0 = a[0] - 2 * a[1] + a[2], s0 = a[0] - 4 * a[1] + 3 * a[2], t1 = a[1] - 2 * a[2] + a[3], s1 = a[1] - a[3];
    vec t2 = a[2] - 2 * a[3] + a[4], s2 = 3 * a[2] - 4 * a[3] + a[4];
    const double k = 13. / 3;
    vec b0 = k * t0 * t0 + s0 * s0 + TINY, b1 = k * t1 * t1 + s1 * s1 + TINY, b2 = k * t2 * t2 + s2 * s2 + TINY;
    vec tau = (b0 - b2) * (b0 - b2), q0 = b0 * b0, q1 = b1 * b1, q2 = b2 * b2;
    vec w0 = (q0 + tau) * q1 * q2, w1 = 6 * (q1 + tau) * q0 * q2, w2 = 3 * (q2 + tau) * q0 * q1;
    vec sum =
        w0 * (2 * a[0] - 7 * a[1] + 11 * a[2]) + w1 * (-a[1] + 5 * a[2] + 2 * a[3]) + w2 * (2 * a[2] + 5 * a[3] - a[4]);
    return sum / (6 * (w0 + w1 + w2));
}

/* Roe's mean state of faces, and the fastest waves of both sides. */
struct mean {
    vec u, w, h, q, c, speed[VARS], left[VARS][VARS];
};

static inline __attribute__((always_inline)) struct mean mean_of(const double *const u[VARS], long i, long s) {
    vec rl = load(u[0] + i), rr = load(u[0] + i + s), il = 1 / rl, ir = 1 / rr;
    vec ul = load(u[1] + i) * il, ur = load(u[1] + i + s) * ir, wl = load(u[2] + i) * il, wr = load(u[2] + i + s) * ir;
    vec pl = (GAMMA - 1) * (load(u[3] + i) - .5 * rl * (ul * ul + wl * wl));
    vec pr = (GAMMA - 1) * (load(u[3] + i + s) - .5 * rr * (ur * ur + wr * wr));
    vec sl = root(rl), sr = root(rr), is = 1 / (sl + sr);
    struct mean m = {.u = (sl * ul + sr * ur) * is, .w = (sl * wl + sr * wr) * is};
    m.h = (sl * (load(u[3] + i) + pl) * il + sr * (load(u[3] + i + s) + pr) * ir) * is;
    m.q = .5 * (m.u * m.u + m.w * m.w);
    m.c = root((GAMMA - 1) * (m.h - m.q));
    vec ic = 1 / m.c, b1 = (GAMMA - 1) * ic * ic, b2 = b1 * m.q, cl = root(GAMMA * pl * il), cr = root(GAMMA * pr * ir);
    m.speed[0] = larger(size(ul - cl), size(ur - cr)), m.speed[3] = larger(size(ul + cl), size(ur + cr));
    m.speed[1] = m.speed[2] = larger(size(ul), size(ur));
    vec rows[VARS][VARS] = {{.5 * (b2 + m.u * ic), .5 * (-b1 * m.u - ic), -.5 * b1 * m.w, .5 * b1},
                            {1 - b2, b1 * m.u, b1 * m.w, -b1},
                            {-m.w, 0 * m.u, 0 * m.u + 1, 0 * m.u},
                            {.5 * (b2 - m.u * ic), .5 * (-b1 * m.u + ic), -.5 * b1 * m.w, .5 * b1}};
    memcpy(m.left, rows, sizeof rows);
    return m;
}

static inline __attribute__((always_inline)) vec project(const vec l[VARS], const double *const a[VARS], long at,
                                                         int shear) {
    if (shear) /* this row of the matrix is (-w, 0, 1, 0) */
        return l[0] * load(a[0] + at) + load(a[2] + at);
    return l[0] * load(a[0] + at) + l[1] * load(a[1] + at) + l[2] * load(a[2] + at) + l[3] * load(a[3] + at);
}

/* Fluxes of n faces; u and f start at the cells before the faces, s leads to the cells behind them. */
static inline __attribute__((always_inline)) void faces(int n, const double *const u[VARS], const double *const f[VARS],
                                                        long s, fields out) {
    for (int i = 0; i < n; i += LANES) {
        struct mean m = mean_of(u, i, s);
        vec h[VARS];
        for (int k = 0; k < VARS; k++) {
            vec plus[6], minus[6], back[5];
            for (int j = 0; j < 6; j++) {
                vec x = project(m.left[k], u, i + (j - 2) * s, k == 2),
                    y = project(m.left[k], f, i + (j - 2) * s, k == 2);
                plus[j] = y + m.speed[k] * x, minus[j] = y - m.speed[k] * x;
            }
            for (int j = 0; j < 5; j++) back[j] = minus[5 - j];
            h[k] = .5 * (weno(plus) + weno(back));
        }
        store(out[0] + i, h[0] + h[1] + h[3]);
        store(out[1] + i, (m.u - m.c) * h[0] + m.u * h[1] + (m.u + m.c) * h[3]);
        store(out[2] + i, m.w * (h[0] + h[1] + h[3]) + h[2]);
        store(out[3] + i, (m.h - m.u * m.c) * h[0] + m.q * h[1] + m.w * h[2] + (m.h + m.u * m.c) * h[3]);
    }
}

static long place(const struct box *b, int j, int i) {
    return (j + GHOSTS) * b->row + i + LEFT;
}

static void fill_ghosts(const struct box *b, double *a) {
    int n = b->n;
    for (int j = 0; j < n; j++)
        for (int i = 1; i <= GHOSTS; i++)
            a[place(b, j, -i)] = a[place(b, j, n - i)], a[place(b, j, n - 1 + i)] = a[place(b, j, i - 1)];
    for (int j = 1; j <= GHOSTS; j++) {
        memcpy(a + place(b, -j, -LEFT), a + place(b, n - j, -LEFT), (size_t)b->row * sizeof *a);
        memcpy(a + place(b, n - 1 + j, -LEFT), a + place(b, j - 1, -LEFT), (size_t)b->row * sizeof *a);
    }
}

static void nodal_fluxes(struct box *b) {
    for (int j = -GHOSTS; j < b->n + GHOSTS; j++)
        for (int i = -LEFT; i < b->n + LEFT; i += LANES) {
            long k = place(b, j, i);
            vec d = load(b->u[0] + k), m = load(b->u[1] + k), w = load(b->u[2] + k), e = load(b->u[3] + k);
            vec id = 1 / d, p = (GAMMA - 1) * (e - .5 * (m * m + w * w) * id), x = m * id, y = w * id;
            store(b->f[0] + k, m), store(b->f[1] + k, m * x + p), store(b->f[2] + k, w * x),
                store(b->f[3] + k, (e + p) * x);
            store(b->g[0] + k, w), store(b->g[1] + k, m * y), store(b->g[2] + k, w * y + p),
                store(b->g[3] + k, (e + p) * y);
        }
}

static void swap_fields(double *a[VARS], double *b[VARS]) {
    for (int v = 0; v < VARS; v++) {
        double *t = a[v];
        a[v] = b[v], b[v] = t;
    }
}

/* next = old start + new (u - dt/h times the differences of fluxes) */
static void stage(struct box *b, double old, double new, double dt) {
    for (int v = 0; v < VARS; v++) fill_ghosts(b, b->u[v]);
    nodal_fluxes(b);
    for (int j = -1; j < b->n; j++) { /* the row -1 has the fluxes below the first row alone */
        long k = place(b, j, 0), kx = k - 1;
        swap_fields(b->below, b->above);
        const double *uy[VARS] = {b->u[0] + k, b->u[2] + k, b->u[1] + k, b->u[3] + k};
        const double *gy[VARS] = {b->g[0] + k, b->g[2] + k, b->g[1] + k, b->g[3] + k};
        faces(b->n, uy, gy, b->row, (double *const[VARS]){b->above[0], b->above[2], b->above[1], b->above[3]});
        if (j < 0) continue;
        const double *ux[VARS] = {b->u[0] + kx, b->u[1] + kx, b->u[2] + kx, b->u[3] + kx};
        const double *fx[VARS] = {b->f[0] + kx, b->f[1] + kx, b->f[2] + kx, b->f[3] + kx};
        faces(b->n + 1, ux, fx, 1, b->across);
        for (int v = 0; v < VARS; v++)
            for (int i = 0; i < b->n; i++)
                b->next[v][k + i] =
                    old * b->start[v][k + i] + new * b->u[v][k + i] -
                    new *dt / b->h *(b->across[v][i + 1] - b->across[v][i] + b->above[v][i] - b->below[v][i]);
    }
    swap_fields(b->u, b->next);
}

/* The vortex of strength 5 in the stream (1, 1), at the start and after one period. */
static void vortex(double x, double y, double u[VARS]) {
    double r2 = x * x + y * y, s = 5 / (2 * PI) * exp(.5 * (1 - r2));
    double t = 1 - (GAMMA - 1) * 25 / (8 * GAMMA * PI * PI) * exp(1 - r2), d = pow(t, 1 / (GAMMA - 1)), a = 1 - s * y,
           c = 1 + s * x;
    u[0] = d, u[1] = d * a, u[2] = d * c, u[3] = d * t / (GAMMA - 1) + .5 * d * (a * a + c * c);
}

static int box_make(struct box *b, int n) {
    *b = (struct box){.n = n, .row = n + 2 * LEFT + LANES, .h = 10. / n};
    size_t numbers = ((size_t)b->row * (size_t)(n + 2 * GHOSTS) + 2 * LANES + LANES - 1) / LANES * LANES;
    double **all[] = {b->u, b->start, b->next, b->f, b->g, b->across, b->below, b->above};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        for (int v = 0; v < VARS; v++) {
            double *a = all[k][v] = aligned_alloc(64, numbers * sizeof *a);
            if (!a) return 0;
            for (size_t i = 0; i < numbers; i++) a[i] = v == 0 || v == 3; /* gas at rest where no cell is */
        }
    return 1;
}

static void box_free(struct box *b) {
    double **all[] = {b->u, b->start, b->next, b->f, b->g, b->across, b->below, b->above};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++)
        for (int v = 0; v < VARS; v++) free(all[k][v]);
}

/* Sets the vortex, or compares with it: the mean and the largest error of the density. */
static void visit(struct box *b, int set, double error[2]) {
    error[0] = error[1] = 0;
    for (int j = 0; j < b->n; j++)
        for (int i = 0; i < b->n; i++) {
            double u[VARS];
            long k = place(b, j, i);
            vortex((i + .5) * b->h - 5, (j + .5) * b->h - 5, u);
            for (int v = 0; v < VARS && set; v++) b->u[v][k] = u[v];
            double e = fabs(b->u[0][k] - u[0]);
            error[0] += e / b->n / b->n, error[1] = fmax(error[1], e);
        }
}

int main(int argc, char **argv) {
    int n = argc > 1 ? atoi(argv[1]) : 160, steps = argc > 2 ? atoi(argv[2]) : 6 * n;
    struct box b = {0};
    double error[2], dt = 10. / (6. * n);
    if (n < LANES || n > 20000 || steps < 1 || !box_make(&b, n)) {
        fprintf(stderr, "bench_bound [cells a side, 8 to 20000 [steps]]\n");
        return 1;
    }
    visit(&b, 1, error);
    double t = cpu_seconds();
    for (int s = 0; s < steps; s++) {
        for (int v = 0; v < VARS; v++)
            memcpy(b.start[v], b.u[v], (size_t)b.row * (size_t)(n + 2 * GHOSTS) * sizeof(double));
        stage(&b, 0, 1, dt), stage(&b, .75, .25, dt), stage(&b, 1. / 3, 2. / 3, dt);
    }
    t = cpu_seconds() - t;
    visit(&b, 0, error);
    printf("%d x %d cells, %d steps: %.2f s, %.2f million cell-stages/s, L1 %.3e, largest error %.3e\n", n, n, steps, t,
           3e-6 * n * n * steps / t, error[0], error[1]);
    box_free(&b);
}
