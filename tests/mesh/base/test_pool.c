/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pools: what is taken is aligned, zeroed and apart from the rest; what there is no memory for leaves all as it was. */
#include "mesh/base/pool.h"

#include "tests/checks.h" /* last */

static void pieces_are_apart(void **state) {
    enum { MOST = 200 };
    struct pool pool = {0};
    unsigned char *piece[MOST];
    (void)state;
    for (int round = 0; round < 2; round++, pool_free(&pool)) {
        for (int n = 0; n < MOST; n++) {
            ok(pool_take(&pool, &piece[n], n, 1, "bytes"));
            assert_int_equal((uintptr_t)piece[n] % 64, 0);
            for (int i = 0; i < n; i++) assert_int_equal(piece[n][i], 0);
            memset(piece[n], n, (size_t)n);
        }
        for (int n = 0; n < MOST; n++)
            for (int i = 0; i < n; i++) assert_int_equal(piece[n][i], n);
    }
    assert_null(pool.last);
    pool_free(&pool);
}

static void no_memory(void **state) {
    struct pool pool = {0};
    double *x, *y = (double *)&pool;
    (void)state;
    ok(pool_take(&pool, &x, 3, sizeof *x, "numbers"));
    says(pool_take(&pool, &y, -1, sizeof *y, "faces"), "no memory for faces: -1 x 8 bytes");
    assert_ptr_equal(y, &pool);
    x[2] = 1;
    pool_free(&pool);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(pieces_are_apart), cmocka_unit_test(no_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
