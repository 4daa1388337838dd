/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The multigrid: solutions, their bits on any ranks, iterations on growing grids, what is special. */
#include "libcore/multigrid/multigrid_private.h"
#include "tests/libcore/multigrid/multigrid_grid.h"

#include "tests/checks.h" /* last: cmocka.h defines fail() */

static struct comm *world;

static const struct mg_case cases[] = {
    {.dim = 1, .n = {40, 1, 1}, .block = {7, 1, 1}, .contrast = 20, .shift = 1e-3},
    {.dim = 1, .n = {700, 1, 1}, .block = {60, 1, 1}, .contrast = 20, .shift = 1e-6, .periodic = true},
    {.dim = 2, .n = {12, 9, 1}, .block = {5, 4, 1}, .contrast = 1e4, .shift = 1e-4, .holes = 0.3},
    {.dim = 2, .n = {2, 300, 1}, .block = {2, 60, 1}, .contrast = 3, .shift = 1e-6, .periodic = true},
    {.dim = 2, .n = {70, 50, 1}, .block = {20, 20, 1}, .contrast = 20, .shift = 1e-6, .holes = 0.2},
    {.dim = 2, .n = {50, 50, 1}, .block = {1, 1, 1}, .contrast = 20, .shift = 1e-2},
    {.dim = 2, .n = {70, 50, 1}, .block = {20, 20, 1}, .contrast = 1e4, .shift = 1e-10, .periodic = true},
    {.dim = 2, .n = {160, 140, 1}, .block = {60, 60, 1}, .contrast = 20, .shift = 1e-6, .holes = 0.5},
    {.dim = 2, .n = {420, 380, 1}, .block = {60, 60, 1}, .contrast = 20, .shift = 1e-10},
    {.dim = 3, .n = {20, 19, 18}, .block = {8, 8, 8}, .contrast = 20, .shift = 1e-8},
};
enum { CASES = sizeof cases / sizeof *cases };

/* sqrt of a sum over all ranks of what each has. */
static double root_of_all(const struct comm *c, double mine) {
    double all[64] = {0}, sum = 0;
    all[comm_rank(c)] = mine;
    comm_max(c, all, 64);
    for (int r = 0; r < 64; r++) sum += all[r];
    return sqrt(sum);
}

/* Has sqrt(r' r/d) of r = b - A x fallen by `reduction`, but for the round-off of A x? */
static void assert_fallen(const struct mg_grid *g, double *x, double reduction) {
    double left = 0, start = 0, size = 0;
    if (comm_size(world) > 1) {
        g->rows.send(g->rows.context, x);
        g->rows.receive(g->rows.context, x);
    }
    for (int i = 0; i < g->rows.rows; i++) {
        double r = g->b[i] - g->diagonal[i] * x[i];
        for (int k = g->link_first[i]; k < g->link_first[i + 1]; k++) r += g->weight[k] * x[g->link[k]];
        left += r * r / g->diagonal[i];
        start += g->b[i] * g->b[i] / g->diagonal[i];
        size += x[i] * x[i] * g->diagonal[i];
    }
    assert_true(root_of_all(world, left) <=
                1.0001 * reduction * root_of_all(world, start) + 1e-15 * root_of_all(world, size));
}

/* Solves a case; returns the iterations. x belongs to *g. */
static int solve(struct multigrid *m, const struct comm *c, const struct mg_case *o, double reduction,
                 struct mg_grid *g) {
    int n;
    mg_open(g, o, c);
    ok(multigrid_setup(m, &g->rows, false));
    ok(multigrid_solve(m, &g->rows, g->b, reduction, 300, g->x, &n));
    return n;
}

static struct multigrid *make(const struct comm *c) {
    struct multigrid *m;
    ok(multigrid_make(c, &m));
    return m;
}

/* One multigrid for all of them: its memory grows and stays. */
static void remainders_fall_as_told(void **state) {
    (void)state;
    struct multigrid *m = make(world);
    for (int k = 0; k < CASES; k++)
        for (int tight = 0; tight < 2; tight++) {
            const double reduction = tight ? 1e-9 : 1e-3;
            struct mg_grid g;
            const int n = solve(m, world, &cases[k], reduction, &g);
            assert_fallen(&g, g.x, reduction);
            assert_true(n > 0 && n < (tight ? 60 : 25));
            if (cases[k].dim == 1) assert_int_equal(n, 1); /* directly */
            mg_close(&g);
        }
    multigrid_free(m);
}

/* Each rank solves the whole system alone, too, and finds its rows of the common solution in it, to the bit. */
static void ranks_do_not_show(void **state) {
    (void)state;
    struct comm *alone;
    ok(comm_alone(&alone));
    struct multigrid *m = make(world), *own = make(alone);
    for (int k = 0; k < 2 * CASES; k++) {
        struct mg_case o = cases[k / 2];
        o.dealt = k % 2;
        struct mg_grid g, whole;
        const int n = solve(m, world, &o, 1e-5, &g);
        assert_int_equal(n, solve(own, alone, &o, 1e-5, &whole));
        for (int i = 0; i < g.rows.rows; i++) {
            const double *x = &whole.x[whole.place[g.cell[i]]];
            assert_true(isfinite(*x));
            assert_memory_equal(&g.x[i], x, sizeof *x);
        }
        mg_close(&g);
        mg_close(&whole);
    }
    multigrid_free(m);
    multigrid_free(own);
    comm_alone_free(alone);
}

/* Other weights with the aggregates of before: the same bits if they are the same, a solution if they are not. */
static void aggregates_may_stay(void **state) {
    (void)state;
    struct multigrid *m = make(world);
    for (int k = 0; k < CASES; k++) {
        struct mg_grid g;
        int n = solve(m, world, &cases[k], 1e-5, &g), again;
        double *x = malloc(((size_t)g.rows.rows + 1) * sizeof *x);
        memcpy(x, g.x, (size_t)g.rows.rows * sizeof *x);
        ok(multigrid_setup(m, &g.rows, true));
        ok(multigrid_solve(m, &g.rows, g.b, 1e-5, 300, g.x, &again));
        assert_int_equal(n, again);
        assert_memory_equal(x, g.x, (size_t)g.rows.rows * sizeof *x);
        for (int i = 0; i < g.rows.rows; i++)
            for (int l = g.link_first[i]; l < g.link_first[i + 1]; l++) {
                const double more = 1 + mg_random((uint64_t)g.cell[i]) + mg_random((uint64_t)g.cell[g.link[l]]);
                g.diagonal[i] += (more - 1) * g.weight[l];
                g.weight[l] *= more;
            }
        ok(multigrid_setup(m, &g.rows, true));
        ok(multigrid_solve(m, &g.rows, g.b, 1e-5, 300, g.x, &again));
        assert_true(again <= 1 + 1.5 * n);
        assert_fallen(&g, g.x, 1e-5);
        free(x);
        mg_close(&g);
    }
    multigrid_free(m);
}

/* From 64 x 80 to 512 x 640 cells (on one rank; else to 256 x 320) iterations grow by no more than three in ten,
 * however the weights jump. */
static void iterations_are_flat(void **state) {
    (void)state;
    struct multigrid *m = make(world);
    for (int k = 0; k < 8; k++) {
        static const double contrasts[] = {1, 20, 1e4, 1e4};
        int n[2];
        for (int large = 0; large < 2; large++) {
            const int scale = !large ? 1 : comm_size(world) == 1 ? 8 : 4;
            struct mg_case o = {.dim = 2, .n = {64 * scale, 80 * scale, 1}, .block = {60, 60, 1}};
            o.contrast = contrasts[k / 2];
            o.shift = k % 2 ? 1e-10 : 1e-4;
            o.holes = k / 2 == 3 ? 0.2 : 0;
            struct mg_grid g;
            n[large] = solve(m, world, &o, 1e-3, &g);
            mg_close(&g);
        }
        assert_true(n[0] <= 10);
        assert_true(n[1] <= 1.3 * n[0]);
    }
    multigrid_free(m);
}

/* Whatever share of its links a row's sum is, each level has at most two thirds of the rows of the one before. */
static void every_level_is_much_smaller(void **state) {
    static const double shifts[] = {1e-6, 0.03, 0.1, 0.2, 0.25, 0.3, 0.5, 1, 2, 3.9, 10};
    (void)state;
    struct multigrid *m = make(world);
    for (int k = 0; k < 44; k++) {
        const bool solid = k % 2;
        struct mg_case o = {
            .dim = 2 + solid, .n = {100, 80, 1}, .block = {60, 60, 1}, .holes = k / 2 % 2 * 0.2}; /* 8000 cells */
        if (solid) o.n[0] = o.n[1] = o.n[2] = o.block[0] = o.block[1] = o.block[2] = 20;
        o.contrast = 20;
        o.shift = shifts[k / 4];
        struct mg_grid g;
        solve(m, world, &o, 1e-3, &g);
        for (int l = 1; l < m->levels; l++) {
            const int finer = l == m->spread ? 8000 : m->level[l - 1].rows; /* of all ranks */
            assert_true(3 * m->level[l].rows <= 2 * finer);
        }
        mg_close(&g);
    }
    multigrid_free(m);
}

/* x'(M + M' - A) x - x' D x of a level that is on one rank, M = D + L and what the smoother adds to D at edges: by this
 * the error falls in a sweep. Inside the blocks M + M' - A is D. */
static double gain_of_sweep(const struct level *l, const double *x) {
    double sum = 0;
    for (int i = 0; i < l->rows; i++) {
        if (!(l->diagonal[i] > 0)) continue;
        sum += 2 * (1 / l->inverse[i] - l->diagonal[i]) * x[i] * x[i];
        for (int k = l->first[3 * i + 2]; k < l->first[3 * i + 3]; k++) sum += l->weight[k] * x[l->link[k]] * x[i];
    }
    return sum;
}

/* Sweeps converge with any blocks, as M + M' - A is positive, D at least, on every level: also for errors that change
 * their sign from block to block, which other blocks' old values would amplify. */
static void sweeps_lessen_every_error(void **state) {
    (void)state;
    struct comm *alone;
    ok(comm_alone(&alone));
    struct multigrid *m = make(alone);
    int edges = 0;
    for (int k = 0; k < CASES; k++) {
        struct mg_grid g;
        mg_open(&g, &cases[k], alone);
        ok(multigrid_setup(m, &g.rows, false));
        for (int level = 0; level < m->levels && !multigrid_is_direct(m); level++) {
            const struct level *l = &m->level[level];
            double *x = calloc((size_t)l->rows + 1, sizeof *x), size = 0;
            for (int round = 0; round < 20; round++) {
                for (int b = 0; b < l->blocks; b++)
                    for (int i = l->block[b]; i < l->block[b + 1]; i++)
                        x[i] = round == 0 ? (b % 2 ? -1 : 1) : mg_random((uint64_t)(1000 * round + b)) - 0.5;
                for (int i = size = 0; i < l->rows; i++) size += l->diagonal[i] * x[i] * x[i];
                assert_true(gain_of_sweep(l, x) >= -1e-13 * size);
            }
            edges += l->edges;
            free(x);
        }
        mg_close(&g);
    }
    assert_true(edges > 1000);
    multigrid_free(m);
    comm_alone_free(alone);
}

/* Rows without links have x = b/d; nothing has none; without rows there is nothing to do. */
static void rows_alone(void **state) {
    (void)state;
    struct multigrid *m = make(world);
    for (int size = 3; size <= 60; size += 57) {
        struct mg_case o = {
            .dim = 2, .n = {size, size, 1}, .block = {4, 4, 1}, .contrast = 1, .shift = 1, .holes = 0.8};
        struct mg_grid g;
        const int n = solve(m, world, &o, 1e-12, &g);
        int alone = 0, again;
        for (int i = 0; i < g.rows.rows; i++) {
            if (g.link_first[i + 1] > g.link_first[i]) continue;
            assert_true(fabs(g.x[i] - g.b[i] / g.diagonal[i]) < 1e-11);
            alone++;
        }
        assert_true(size == 3 || alone > 0);
        assert_true(n <= 30);
        memset(g.b, 0, (size_t)g.rows.rows * sizeof *g.b);
        ok(multigrid_solve(m, &g.rows, g.b, 1e-3, 300, g.x, &again));
        assert_int_equal(again, 0);
        for (int i = 0; i < g.rows.rows; i++) assert_true(g.x[i] == 0);
        mg_close(&g);
    }
    struct mg_case none = {.dim = 1, .n = {20, 1, 1}, .block = {4, 1, 1}, .contrast = 1, .holes = 2};
    struct mg_grid g;
    assert_int_equal(solve(m, world, &none, 1e-3, &g), 0);
    mg_close(&g);
    multigrid_free(m);
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return status_print(s, true);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(remainders_fall_as_told),     cmocka_unit_test(ranks_do_not_show),
        cmocka_unit_test(aggregates_may_stay),         cmocka_unit_test(iterations_are_flat),
        cmocka_unit_test(every_level_is_much_smaller), cmocka_unit_test(rows_alone),
        cmocka_unit_test(sweeps_lessen_every_error),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
