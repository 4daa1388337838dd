/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors where there is no memory for them. */
#include "mesh/base/status.h"

#include <limits.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "tests/checks.h" /* last: cmocka.h defines fail() */

static bool full;

/* Stands before calloc of the C library in this program. */
void *calloc(size_t count, size_t size) {
    const size_t bytes = (count * size + 15) / 16 * 16;
    void *p = full || (size && count > SIZE_MAX / size - 16) ? NULL : aligned_alloc(16, bytes ? bytes : 16);
    if (p) memset(p, 0, bytes);
    return p;
}

static status fail_without_memory(void) {
    full = true;
    const status s = status_up((fail)(ERR_SYSTEM, "a long story"), __FILE__, __LINE__);
    full = false;
    return s;
}

/* Notes do not change it, so that it can be told again, and freeing it is no fault. */
static void no_memory_for_an_error(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        const status s = status_note(fail_without_memory(), "while writing time %d", i);
        assert_string_equal(status_text(s), "out of memory");
        assert_int_equal(status_kind(s), ERR_SYSTEM);
        status_free(s);
    }
}

/* Memory starts with a line of the cache; that of allocate is zero. */
static void memory(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) { /* the second time it is where 7s were */
        double *zero, *unset;
        assert_null(allocate(&zero, 100001, sizeof *zero, "numbers"));
        assert_null(allocate_unset(&unset, 100001, sizeof *unset, "numbers"));
        assert_int_equal((uintptr_t)zero % 64 + (uintptr_t)unset % 64, 0);
        for (int k = 0; k < 100001; k++) assert_true(zero[k] == 0);
        for (int k = 0; k < 100001; k++) zero[k] = unset[k] = 7;
        free(zero);
        free(unset);
    }
}

/* The error names what there is no memory for. */
static void too_much_memory(void **state) {
    (void)state;
    char *p;
    const status s = allocate_unset(&p, LONG_MAX / 2, 1, "grains");
    assert_non_null(strstr(status_text(s), "no memory for grains"));
    status_free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_memory_for_an_error), cmocka_unit_test(memory),
                                       cmocka_unit_test(too_much_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
