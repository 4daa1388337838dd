/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A test that fails on the last rank while the others wait for it: CTest must see that end at once (CMakeLists.txt). */
#include "mesh/base/comm.h"

#include "tests/checks.h" /* last: cmocka.h defines fail() */

static struct comm *world;

static void the_last_rank_fails(void **state) {
    double sum = 1;
    (void)state;
    assert_true(comm_size(world) == 1 || comm_rank(world) < comm_size(world) - 1);
    comm_max(world, &sum, 1);
}

int main(int argc, char **argv) {
    ok(comm_start(&argc, &argv, &world));
    const struct CMUnitTest tests[] = {cmocka_unit_test(the_last_rank_fails)};
    const int failed = cmocka_run_group_tests(tests, NULL, NULL);
    comm_finish(world);
    return failed;
}
