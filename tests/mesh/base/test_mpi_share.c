/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mesh/base/share.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h> /* last: it needs the standard headers */

enum { CELLS = 200003, STEP = 77777 }; /* several rounds on every number of ranks; STEP has no divisor of CELLS */

static struct comm *world;

static double value(long cell, int component) {
    return 3. * (double)cell + component + 0.25;
}

static void slices_follow_one_another(void **state) {
    (void)state;
    const int size = comm_size(world);
    for (long n = 0; n < 10; n++) {
        const struct share s = share_make(world, n);
        long sum = s.end - s.first, last = comm_rank(world) == size - 1 ? s.end : 0;
        assert_true(s.first <= s.end && sum <= n / size + 1);
        comm_sum_long(world, &sum, 1);
        comm_sum_long(world, &last, 1);
        assert_true(sum == n && last == n);
    }
}

/* Each rank lists cells from all slices, the ranks unlike numbers of them: those with STEP i % CELLS for every i in its
 * part of 0 .. CELLS - 1, where rank 0 has half. */
static void values_move_to_lists_and_back(void **state) {
    (void)state;
    const int rank = comm_rank(world), size = comm_size(world);
    const struct share s = share_make(world, CELLS);
    const long rest = size > 1 ? CELLS / 2 / (size - 1) : 0, half = CELLS - rest * (size - 1);
    const long from = rank ? half + (rank - 1) * rest : 0, n = rank ? rest : half, own = s.end - s.first;
    for (int m = 1; m <= 3; m += 2) {
        int *cell;
        double *list, *slice;
        assert_null(allocate(&cell, n, sizeof *cell, "cells"));
        assert_null(allocate(&list, n * m, sizeof *list, "values"));
        assert_null(allocate(&slice, own * m, sizeof *slice, "values"));
        for (long i = 0; i < n; i++) cell[i] = (int)((from + i) * STEP % CELLS);
        for (long i = 0; i < own * m; i++) slice[i] = value(s.first + i / m, (int)(i % m));
        assert_null(share_fetch(&s, m, slice, n, cell, list));
        for (long i = 0; i < n * m; i++) assert_true(list[i] == value(cell[i / m], (int)(i % m)));
        for (long i = 0; i < own * m; i++) slice[i] = -1;
        assert_null(share_store(&s, m, n, cell, list, slice));
        for (long i = 0; i < own * m; i++) assert_true(slice[i] == value(s.first + i / m, (int)(i % m)));
        free(cell);
        free(list);
        free(slice);
    }
}

/* The root asks for a cell of each slice twice, the others for none. */
static void the_root_alone_asks(void **state) {
    (void)state;
    enum { MOST = 64 };
    const struct share s = share_make(world, 1000);
    double slice[1000], out[2 * MOST];
    int cell[2 * MOST], n = 0;
    for (long i = s.first; i < s.end; i++) slice[i - s.first] = value(i, 0);
    assert_true(comm_size(world) <= MOST);
    for (int i = 0; comm_root(world) && i < 2 * comm_size(world); i++)
        cell[n++] = 999 - i / 2 * 1000 / comm_size(world);
    assert_null(share_fetch(&s, 1, slice, n, cell, out));
    for (int i = 0; i < n; i++) assert_true(out[i] == value(cell[i], 0));
}

/* Each rank sends r + 1 records to rank r, round about; they arrive rank by rank, in their order. */
static void records_are_delivered(void **state) {
    (void)state;
    const int rank = comm_rank(world), size = comm_size(world), each = rank + 1;
    struct delivery d;
    assert_null(delivery_begin(world, (long)size * (size + 1) / 2, 2, "records", &d));
    for (int k = 0, i = 0; k < size; k++)
        for (int r = size - 1; r >= k; r--, i++) {
            d.rank[i] = r;
            d.record[2 * i] = rank;
            d.record[2 * i + 1] = k;
        }
    assert_null(delivery_send(&d));
    assert_int_equal(d.arrived, (long)size * each);
    for (int i = 0; i < size * each; i++) {
        assert_int_equal(d.in[2 * i], i / each);
        assert_int_equal(d.in[2 * i + 1], i % each);
    }
    for (int r = 0; r < size; r++) {
        assert_int_equal(d.count[r], 2 * (r + 1));
        assert_int_equal(d.arriving[r], 2 * each);
    }
    assert_int_equal(d.order[0], size - 1); /* the one record for rank 0 */
    delivery_free(&d);
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return status_print(s, true);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slices_follow_one_another),
        cmocka_unit_test(values_move_to_lists_and_back),
        cmocka_unit_test(the_root_alone_asks),
        cmocka_unit_test(records_are_delivered),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
