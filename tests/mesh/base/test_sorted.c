/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sorted lists of names: each once, found again, dense or sparse, on both sides of 16 bits. */
#include "mesh/base/sorted.h"

#include <limits.h>
#include <stdlib.h>

#include "tests/checks.h" /* last */

static void lists_are_sorted_and_found(void **state) {
    (void)state;
    const int stretch[] = {1, 3, 70000, 1000003}; /* between names: tables and searches */
    for (int k = 0; k < 4; k++) {
        int v[3000], w[3000];
        long n = 3000;
        for (int i = 0; i < n; i++) v[i] = w[i] = (i * 7919 % 2000) * stretch[k];
        ok(sorted_make(v, &n));
        assert_int_equal(n, 2000);
        for (int i = 0; i < n; i++) assert_int_equal(v[i], i * stretch[k]);
        ok(sorted_places(v, n, w, 3000));
        for (int i = 0; i < 3000; i++) assert_int_equal(w[i], i * 7919 % 2000);
        assert_int_equal(sorted_find(v, n, 1999 * stretch[k]), 1999);
        assert_int_equal(sorted_find(v, n, 1999 * stretch[k] + 1), -1);
        assert_int_equal(sorted_find(v, n, -1), -1);
    }
}

static void ends_of_lists(void **state) {
    (void)state;
    int few[] = {INT_MAX, 0, INT_MAX, 65536, 65535}, names[] = {65536, INT_MAX, 0};
    long n = 5, none = 0;
    ok(sorted_make(few, &n));
    const int sorted[] = {0, 65535, 65536, INT_MAX}, places[] = {2, 3, 0};
    assert_int_equal(n, 4);
    assert_memory_equal(few, sorted, sizeof sorted);
    ok(sorted_places(few, n, names, 3));
    assert_memory_equal(names, places, sizeof places);
    ok(sorted_make(few, &none));
    ok(sorted_places(few, none, names, 0));
    assert_int_equal(none, 0);
    assert_int_equal(sorted_find(few, 0, 0), -1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_are_sorted_and_found),
        cmocka_unit_test(ends_of_lists),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
