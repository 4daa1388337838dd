/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors where there is no memory for them. */
#include "mesh/base/status.h"

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

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(no_memory_for_an_error)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
