/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flows made free of divergence: closed and open boxes, holes, what is already free, what cannot be. */
#include "libcore/segregation/solenoidal.h"

#include "tests/checks.h" /* after what it would hide */
#include "tests/libcore/oracle.h"

struct room { /* [0, 1]^dim, n cells a side */
    struct face_flow flow;
    long cells, faces[3];
    bool *open[3];
};
static bool on_boundary(const struct room *r, int k, long face, long *cell) {
    long at[3], n = face, stride = 1;
    for (int a = 0; a < r->flow.dim; a++) {
        long size = r->flow.n[a] + (a == k);
        at[a] = n % size;
        n /= size;
    }
    *cell = 0;
    for (int a = 0; a < r->flow.dim; a++) {
        *cell += at[a] * stride; /* above the face */
        stride *= r->flow.n[a];
    }
    return at[k] == 0 || at[k] == r->flow.n[k];
}
/* A corner of the box may be solid: a step. */
static bool solid(const struct room *r, long cell) {
    const int n = r->flow.n[0];
    return cell % n >= n / 2 && cell / n % n < n / 2;
}
static void room_make(struct room *r, int dim, int n, bool step) {
    *r = (struct room){.flow = {.dim = dim, .n = {1, 1, 1}}, .cells = 1};
    long stride[3];
    for (int k = 0; k < dim; k++) {
        stride[k] = r->cells;
        r->flow.n[k] = n;
        r->flow.width[k] = 1. / n;
        r->cells *= n;
    }
    for (int k = 0; k < dim; k++) {
        r->faces[k] = r->cells / n * (n + 1);
        ok(allocate(&r->flow.u[k], r->faces[k], sizeof(double), "u"));
        ok(allocate(&r->open[k], r->faces[k], sizeof(bool), "open"));
        r->flow.open[k] = r->open[k];
        for (long i = 0; i < r->faces[k]; i++) {
            long above;
            r->open[k][i] =
                !on_boundary(r, k, i, &above) && !(step && (solid(r, above) || solid(r, above - stride[k])));
            if (r->open[k][i]) r->flow.u[k][i] = sin(37. * (double)i * (k + 1)) + 0.3 * k;
        }
    }
}
static void room_free(struct room *r) {
    for (int k = 0; k < 3; k++) {
        free(r->flow.u[k]);
        free(r->open[k]);
    }
}

static void closed_rooms(void **state) {
    (void)state;
    for (int dim = 1; dim <= 3; dim++)
        for (int step = 0; step < (dim > 1 ? 2 : 1); step++) {
            struct room r;
            struct face_flow_change c;
            room_make(&r, dim, dim == 3 ? 16 : 48, step);
            ok(face_flow_project(&r.flow, &c));
            assert_true(c.before > 10 && c.after < 1e-12 * c.before && c.scaled == 1 && c.largest > 0.1);
            for (int k = 0; k < dim; k++)
                for (long i = 0; i < r.faces[k]; i++) assert_true(r.open[k][i] || r.flow.u[k][i] == 0);
            if (dim == 1)
                for (long i = 0; i < r.faces[0]; i++) assert_near(r.flow.u[0][i], 0, 1e-12); /* nothing else is free */
            struct face_flow_change again;
            ok(face_flow_project(&r.flow, &again));
            assert_true(again.largest < 1e-12);
            room_free(&r);
        }
}

/* In at the left, out at the top of the left half: the step's flow; more leaves at first than enters. */
static void through_a_step(void **state) {
    (void)state;
    struct room r;
    struct face_flow_change c;
    const int n = 40;
    double in = 0, out = 0;
    room_make(&r, 2, n, true);
    for (int j = 0; j < n; j++) {
        r.flow.u[0][(n + 1) * j] = 1;
        if (j < n / 2) r.flow.u[1][(long)n * n + j] = 3;
    }
    ok(face_flow_project(&r.flow, &c));
    for (int j = 0; j < n; j++) {
        in += r.flow.u[0][(n + 1) * j];
        out += r.flow.u[1][(long)n * n + j];
    }
    assert_near(out, in, 1e-11);
    assert_close(c.scaled, 2. / 3, 1e-14, "scaled");
    assert_true(c.after < 1e-10);
    for (int j = 0; j < n / 2; j++) r.flow.u[1][(long)n * n + j] = 0;
    says(face_flow_project(&r.flow, &c), "enters|never leaves");
    room_free(&r);
}

static void shut_off(void **state) {
    (void)state;
    struct room r;
    struct face_flow_change c;
    const int n = 10;
    room_make(&r, 2, n, false);
    for (int j = 0; j < n; j++) {
        r.open[0][(n + 1) * j + 5] = false;
        r.flow.u[0][(n + 1) * j + 5] = 0;
        r.flow.u[0][(n + 1) * j] = r.flow.u[0][(n + 1) * j + n] = 1;
    }
    says(face_flow_project(&r.flow, &c), "walls close off|inlet");
    room_free(&r);
}

/* A flow in x that repeats, past a step, between walls in y: as much goes round as did; moved, it gives the same. */
static void round_a_cyclic_axis(void **state) {
    (void)state;
    enum { N = 24, MOVED = 7 };
    struct room r[2];
    struct face_flow_change c;
    for (int m = 0; m < 2; m++) {
        room_make(&r[m], 2, N, false);
        r[m].flow.cyclic[0] = true;
        for (int j = 0; j < N; j++)
            for (int i = 0; i <= N; i++) {
                const int x = (i + N - m * MOVED) % N;
                const bool solid = j < N / 3 && x >= 5 && x <= 9, below = solid && x < 9;
                const long f = (long)(N + 1) * j + i, g = (long)N * j + i;
                r[m].open[0][f] = !solid;
                r[m].flow.u[0][f] = solid ? 0 : 1 + sin(3. * x + j);
                if (i < N && j < N / 3 + 1 && x >= 5 && x < 9 && (below || j == N / 3)) r[m].open[1][g] = false;
                if (i < N) r[m].flow.u[1][g] = r[m].open[1][g] ? cos(2. * x * j) : 0;
            }
        ok(face_flow_project(&r[m].flow, &c));
        assert_true(c.after < 1e-12 * c.before && c.scaled == 1);
    }
    for (int j = 0; j < N; j++)
        for (int i = 0; i <= N; i++)
            assert_near(r[1].flow.u[0][(N + 1) * j + (i + MOVED) % N], r[0].flow.u[0][(N + 1) * j + i], 1e-11);
    double through[2] = {0, 0};
    for (int j = 0; j < N; j++) {
        through[0] += r[0].flow.u[0][(N + 1) * j];
        through[1] += r[0].flow.u[0][(N + 1) * j + 7];
    }
    assert_near(through[0], through[1], 1e-11);
    assert_true(through[0] > 1);
    for (int m = 0; m < 2; m++) room_free(&r[m]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(closed_rooms),
        cmocka_unit_test(through_a_step),
        cmocka_unit_test(shut_off),
        cmocka_unit_test(round_a_cyclic_axis),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
