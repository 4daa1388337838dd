/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mesh/base/background.h"
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <time.h>

#include <cmocka.h> /* last: it needs the standard headers, and its macro `fail` would hide ours */

struct sum {
    int value;
    bool quiet; /* are signals left to the program? */
};

static void add_up(void *context) {
    struct sum *s = context;
    sigset_t blocked;
    pthread_sigmask(SIG_SETMASK, NULL, &blocked);
    s->quiet = sigismember(&blocked, SIGTERM) == 1;
    for (int i = 1; i <= 100; i++) s->value += i;
}

static void test_one(void **state) {
    (void)state;
    struct sum s = {0, false};
    struct background *b;
    assert_null(background_start(add_up, &s, &b));
    while (!background_ended(b)) continue;
    background_finish(b);
    assert_int_equal(s.value, 5050);
    assert_true(s.quiet);
    sigset_t blocked;
    pthread_sigmask(SIG_SETMASK, NULL, &blocked);
    assert_int_equal(sigismember(&blocked, SIGTERM), 0);
}

static void count(void *context, int i) {
    int *times = context;
    times[i]++;
}

static void test_each(void **state) {
    (void)state;
    static const int counts[] = {0, 1, 2, 5000};
    for (int k = 0; k < 4; k++) {
        int times[5001] = {0};
        background_each(counts[k], count, times);
        for (int i = 0; i <= 5000; i++) assert_int_equal(times[i], i < counts[k]);
    }
}

enum { TOGETHER = 4 };
struct meeting { /* pieces that wait for each other */
    atomic_int inside;
    atomic_bool met;
};

static void meet(void *context, int i) {
    struct meeting *m = context;
    (void)i;
    if (atomic_fetch_add(&m->inside, 1) + 1 == TOGETHER) atomic_store(&m->met, true);
    for (int ms = 0; ms < 10000 && !atomic_load(&m->met); ms++) nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
}

/* Pieces that wait are worked at together. */
static void test_together(void **state) {
    (void)state;
    struct meeting m;
    atomic_init(&m.inside, 0);
    atomic_init(&m.met, false);
    background_each(TOGETHER, meet, &m);
    assert_true(m.met);
    assert_int_equal(m.inside, TOGETHER);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_one), cmocka_unit_test(test_each),
                                       cmocka_unit_test(test_together)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
