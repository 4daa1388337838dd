/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The queue of events against a search through all, with times that come in bursts, far off, equal, or never. */
#include "libcore/grains/calendar.h"

#include <math.h>

#include "tests/checks.h" /* after what it would hide */

static double uniform(uint64_t *seed) {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    return (double)(*seed >> 11) * 0x1p-53;
}

static void earliest_first(void **state) {
    (void)state;
    enum { ITEMS = 300 };
    struct calendar *c;
    double t[ITEMS], now = 3;
    uint64_t seed = 12;
    ok(calendar_make(ITEMS, &c));
    assert_true(calendar_time(c, calendar_first(c)) == HUGE_VAL);
    for (int i = 0; i < ITEMS; i++) calendar_set(c, i, t[i] = now + uniform(&seed));
    calendar_start(c, now);
    for (int step = 0; step < 200000; step++) {
        if (step % 20000 == 10000) { /* half of them at one time, the others at two scales */
            for (int i = 0; i < ITEMS; i++)
                calendar_set(c, i, t[i] = now + (i % 2 ? 0.5 : uniform(&seed) * (i % 4 ? 1 : 1e5)));
            calendar_start(c, now);
        }
        int first = calendar_first(c);
        for (int i = 0; i < ITEMS; i++) assert_true(t[first] < t[i] || (t[first] == t[i] && first <= i));
        assert_true(calendar_time(c, first) == t[first]);
        for (int k = 1, last = first, item; k < 5 && (item = calendar_next(c, k)) >= 0; k++, last = item)
            assert_true(t[last] < t[item] || (t[last] == t[item] && last < item));
        now = t[first];
        double scale = pow(10, (double)((step / 5000) % 7) - 3), dice = uniform(&seed);
        double next = now + (dice < 0.05 ? 100 * scale : dice < 0.1 ? 0 : -scale * log(1 - uniform(&seed)));
        calendar_move(c, first, t[first] = dice > 0.999 && step < 190000 ? now + 1e6 : next);
        int other = (int)(ITEMS * uniform(&seed));
        if (dice < 0.4) calendar_move(c, other, t[other] = now + scale * uniform(&seed));
    }
    calendar_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(earliest_first)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
