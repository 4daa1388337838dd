/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The CRC of pieces of any length, at any place, after any CRC, is that of zlib. */
#include "mesh/base/crc.h"

#include <stdlib.h>
#include <zlib.h>

#include "tests/checks.h" /* last */

enum { BYTES = 1 << 12 };

static void test_zlib(void **state) {
    (void)state;
    unsigned char data[BYTES];
    srand(1);
    for (int i = 0; i < BYTES; i++) data[i] = (unsigned char)rand();
    assert_int_equal(crc_add(0, "123456789", 9), 0xcbf43926); /* the check value of CRC-32 */
    for (size_t n = 0; n < BYTES - 64; n += n < 400 ? 1 : 61)
        for (size_t from = 0; from < 64; from += 7) {
            const unsigned long before = (unsigned long)rand();
            assert_int_equal(crc_add(before, data + from, n), crc32_z(before, data + from, n));
        }
}

static void test_pieces(void **state) {
    (void)state;
    unsigned char data[BYTES] = {1};
    const unsigned long first = crc_add(0, data, 1000);
    assert_int_equal(crc_add(first, data + 1000, BYTES - 1000), crc32_z(0, data, BYTES));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_zlib), cmocka_unit_test(test_pieces)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
