/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mesh/base/comm.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h> /* last: it needs the standard headers */
#undef fail         /* its macro; here fail makes a status */

static struct comm *world;

static void reductions(void **state) {
    (void)state;
    int rank = comm_rank(world), size = comm_size(world);
    double low[2] = {rank + 1.5, -rank}, high[2] = {rank + 1.5, -rank};
    long sum[2] = {1, rank};
    comm_min(world, low, 2);
    comm_max(world, high, 2);
    comm_sum_long(world, sum, 2);
    assert_true(low[0] == 1.5 && low[1] == 1 - size);
    assert_true(high[0] == size + 0.5 && high[1] == 0);
    assert_int_equal(sum[0], size);
    assert_int_equal(sum[1], size * (size - 1) / 2);
    assert_int_equal(comm_root(world), rank == 0);
}

/* Rank r gives r values (rank 0 none) that tell whose they are. */
static void gathers(void **state) {
    (void)state;
    int rank = comm_rank(world), size = comm_size(world), mine_int[64], *all_int;
    double mine[64], *all;
    for (int i = 0; i < rank; i++) {
        mine[i] = 100 * rank + i + 0.25;
        mine_int[i] = 100 * rank + i;
    }
    long total = -1, total_int = -1, next = 0;
    assert_null(comm_gather(world, mine, rank, &all, &total));
    assert_null(comm_gather_int(world, mine_int, rank, &all_int, &total_int));
    if (rank > 0) {
        assert_true(!all && !all_int && total == 0 && total_int == 0);
        return;
    }
    assert_int_equal(total, size * (size - 1) / 2);
    assert_int_equal(total_int, total);
    for (int r = 0; r < size; r++)
        for (int i = 0; i < r; i++, next++) {
            assert_true(all[next] == 100 * r + i + 0.25);
            assert_int_equal(all_int[next], 100 * r + i);
        }
    free(all);
    free(all_int);
}

/* More bytes than one message takes. */
static void gathers_many(void **state) {
    (void)state;
    const long n = comm_rank(world) == comm_size(world) - 1 ? (1L << 24) + 3 : 2;
    int *mine, *all;
    long total;
    assert_null(allocate(&mine, n, sizeof *mine, "values"));
    for (long i = 0; i < n; i++) mine[i] = (int)(n - i);
    assert_null(comm_gather_int(world, mine, n, &all, &total));
    for (long i = 0; all && i < (1L << 24) + 3; i++) assert_int_equal(all[total - 1 - i], i + 1);
    for (long i = 0; all && i < 2L * (comm_size(world) - 1); i++) assert_int_equal(all[i], 2 - i % 2);
    free(mine);
    free(all);
}

/* Rank a sends b + 1 numbers to rank b. */
static void trades(void **state) {
    (void)state;
    int rank = comm_rank(world), size = comm_size(world), count[16], count_in[16], out_int[136], in_int[256], n = 0;
    double out[136], in[256];
    assert_true(size <= 16);
    for (int b = 0; b < size; b++) {
        count[b] = b + 1;
        for (int i = 0; i <= b; i++, n++) out[n] = out_int[n] = 1000 * rank + 10 * b + i;
    }
    comm_trade_counts(world, count, count_in);
    comm_trade(world, out, count, in, count_in);
    comm_trade_int(world, out_int, count, in_int, count_in);
    for (int a = 0, k = 0; a < size; a++) {
        assert_int_equal(count_in[a], rank + 1);
        for (int i = 0; i <= rank; i++, k++) {
            assert_true(in[k] == 1000 * a + 10 * rank + i);
            assert_int_equal(in_int[k], 1000 * a + 10 * rank + i);
        }
    }
}

/* Rank r shares r values, which tell whose they are, with all ranks. */
static void shares(void **state) {
    (void)state;
    int rank = comm_rank(world), size = comm_size(world), count[64], first[65], mine_int[64], all_int[64];
    double mine[64], all[64];
    assert_true(size <= 8);
    for (int i = 0; i < rank; i++) {
        mine[i] = 100 * rank + i + 0.25;
        mine_int[i] = 100 * rank + i;
    }
    assert_null(comm_share_count(world, rank, count, first));
    assert_int_equal(first[size], size * (size - 1) / 2);
    comm_share(world, mine, count, first, all);
    comm_share_int(world, mine_int, count, first, all_int);
    for (int r = 0; r < size; r++) {
        assert_int_equal(count[r], r);
        for (int i = 0; i < r; i++) {
            assert_true(all[first[r] + i] == 100 * r + i + 0.25);
            assert_int_equal(all_int[first[r] + i], 100 * r + i);
        }
    }
    status s = comm_share_count(world, 1L << 31, count, first);
    assert_non_null(s);
    status_free(s);
}

/* Numbers of which each sum is rounded: the order tells. */
static void broadcasts(void **state) {
    (void)state;
    char text[16] = "";
    if (comm_root(world)) strcpy(text, "from the root");
    comm_broadcast(world, text, sizeof text);
    assert_string_equal(text, "from the root");
}

/* A ring: each rank sends to the next one, and gets from the one before. */
static void puts_and_gets(void **state) {
    (void)state;
    const int rank = comm_rank(world), size = comm_size(world);
    const double mine[2] = {rank, 0.5};
    double got[2] = {rank, 0.5};
    if (size > 1) comm_put(world, (rank + 1) % size, mine, 2);
    if (size > 1) comm_get(world, (rank + size - 1) % size, got, 2);
    assert_true(got[0] == (rank + size - 1) % size && got[1] == 0.5);
}

/* A sum whose bits depend on the order of its terms. */
static void sums_in_turn(void **state) {
    (void)state;
    const int rank = comm_rank(world), size = comm_size(world);
    double sum[2] = {0, 0}, expected = 0;
    for (int i = 0; i < 3 * size; i++) expected += 1. / (1 + i);
    comm_take_turn(world, sum, 2);
    for (int i = 0; i < 3; i++) sum[0] += 1. / (1 + 3 * rank + i);
    sum[1] += 1;
    comm_end_turn(world, sum, 2);
    assert_true(sum[0] == expected && sum[1] == size);
}

static void all_ranks_learn_of_a_failure(void **state) {
    (void)state;
    int rank = comm_rank(world), last = comm_size(world) - 1;
    char text[32];
    snprintf(text, sizeof text, "rank %d: T = -1", last);
    assert_null(comm_agree(world, OK));
    status s = comm_agree(world, rank == last ? fail(ERR_STATE, "rank %d: T = -1", rank) : OK);
    assert_non_null(s);
    assert_int_equal(status_kind(s), ERR_STATE);
    assert_string_equal(status_text(s), text);
    status_free(s);
    s = comm_agree(world, fail(rank ? ERR_SYSTEM : ERR_INPUT, "100%% of rank %d", rank));
    assert_non_null(s);
    assert_int_equal(status_kind(s), ERR_INPUT);
    assert_string_equal(status_text(s), "100% of rank 0");
    status_free(s);
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return status_print(s, true);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reductions),    cmocka_unit_test(gathers),      cmocka_unit_test(gathers_many),
        cmocka_unit_test(trades),        cmocka_unit_test(shares),       cmocka_unit_test(broadcasts),
        cmocka_unit_test(puts_and_gets), cmocka_unit_test(sums_in_turn), cmocka_unit_test(all_ranks_learn_of_a_failure),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
