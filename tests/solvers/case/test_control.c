/* SPDX-License-Identifier: GPL-3.0-or-later */
/* controlDict: time steps, write times, names, choices. */
#include "solvers/case/control.h"
#include "solvers/case/times.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h> /* last: it needs the standard headers, and its macro `fail` would hide ours */

static char folder[] = "/tmp/haff_control_XXXXXX";

static status read_text(const char *text, struct control **c) {
    char path[256];
    snprintf(path, sizeof path, "%s/system/controlDict", folder);
    FILE *f = fopen(path, "w");
    assert_non_null(f);
    fputs(text, f);
    fclose(f);
    return control_read(folder, "granularGas", c);
}

static struct control *good(const char *text) {
    struct control *c;
    status s = read_text(text, &c);
    if (s) print_message("%s\n", status_text(s));
    assert_null(s);
    return c;
}

static void expect_error(const char *text, const char *part) {
    struct control *c = NULL;
    status s = read_text(text, &c);
    assert_non_null(s);
    if (!strstr(status_text(s), part)) fail_msg("no '%s' in: %s", part, status_text(s));
    assert_int_equal(status_kind(s), ERR_INPUT);
    status_free(s);
}

static void test_keys(void **state) {
    (void)state;
    struct control *c = good("endTime 2; writeControl adjustable; writeInterval 0.5; writeFormat binary;\n"
                             "writeCompression on; purgeWrite 3; startFrom startTime; startTime 1; maxDeltaT 0.1;");
    assert_true(c->adjust && c->format.binary && c->format.compress && c->modifiable);
    assert_int_equal(c->purge, 3);
    assert_int_equal(c->write.control, WRITE_ADJUSTABLE);
    assert_int_equal(c->start_from, START_TIME);
    assert_true(c->max_co == 1 && c->max_delta_t == 0.1 && c->start_time == 1 && c->end_time == 2);
    control_free(c);
}

static void test_errors(void **state) {
    (void)state;
    expect_error("writeControl none;", "endTime");
    expect_error("endTime 1;", "writeControl");
    expect_error("endTime 1; writeControl none; maxCo 7;", "maxCo");
    expect_error("endTime 1; writeControl none; maxCo -1;", "maxCo");
    expect_error("endTime 1; writeControl none; adjustTimeStep no;", "deltaT");
    expect_error("endTime 1; writeControl none; startFrom lastTime;", "latestTime");
    expect_error("endTime 1; writeControl adjustableRunTime;", "writeInterval");
    expect_error("endTime 1; writeControl adjustableRunTime; writeInterval 0;", "greater than 0");
    expect_error("endTime 1; writeControl timeStep; writeInterval 1.5;", "whole number");
    expect_error("endTime 1; writeControl none; minDeltaT 1; maxDeltaT 0.1;", "maxDeltaT");
    expect_error("endTime 1; startFrom startTime; startTime 2; writeControl none;", "startTime");
}

/* Steps of any size end on every multiple of the interval and on endTime exactly, and none exceeds what is stable: far
 * from these they are just that. */
static void test_write_times_are_hit(void **state) {
    (void)state;
    struct control *c = good("endTime 1.05; writeControl adjustableRunTime; writeInterval 0.1;");
    double t = 0, smallest = 1;
    int hits = 0;
    for (long step = 0; !control_ended(c, t); step++) {
        double stable = 0.013 + 0.007 * sin((double)step), end;
        enum dt_limit limit;
        double next = trigger_next(&c->write, t);
        double dt = control_step(c, t, step, stable, next, &end, &limit);
        assert_true(dt > 0 && dt <= stable * (1 + 1e-9) && end <= next && step < 1000);
        if (fmin(next, 1.05) - t > 2 * stable) assert_true(dt == stable && limit == DT_COURANT);
        smallest = fmin(smallest, dt);
        struct moment before = {.t = t, .step = step}, now = {.t = end, .step = step + 1};
        if (trigger_due(&c->write, &before, &now)) {
            hits++;
            assert_true(end == hits * 0.1);
        }
        t = end;
    }
    assert_int_equal(hits, 10);
    assert_true(t == 1.05);
    assert_true(smallest > 0.001);
    control_free(c);
}

/* With adjustTimeStep no all steps are deltaT, and maxDeltaT does not count, as in OpenFOAM. */
static void test_fixed_steps(void **state) {
    (void)state;
    struct control *c =
        good("endTime 1; writeControl none; adjustTimeStep no; deltaT 0.1; maxDeltaT 1e-3; minDeltaT 1;");
    enum dt_limit limit;
    double end;
    assert_true(control_step(c, 0, 0, 1, HUGE_VAL, &end, &limit) == 0.1);
    assert_int_equal(limit, DT_FIXED);
    control_free(c);
}

/* A run taken up at a write time chooses the steps of the run that went through. */
static void test_restart_takes_the_same_steps(void **state) {
    (void)state;
    struct control *through = good("endTime 0.3; writeControl adjustableRunTime; writeInterval 0.1; deltaT 1e-3;");
    struct control *first = good("endTime 0.1; writeControl adjustableRunTime; writeInterval 0.1; deltaT 1e-3;");
    double a = 0, b = 0, end;
    enum dt_limit limit;
    for (long step = 0; !control_ended(through, a); step++) {
        double stable = 0.004 + 1e-3 * a;
        struct control *second = control_ended(first, b) ? through : first;
        (void)control_step(through, a, step, stable, trigger_next(&through->write, a), &end, &limit);
        a = end;
        (void)control_step(second, b, step, stable, trigger_next(&second->write, b), &end, &limit);
        b = end;
        assert_true(a == b);
    }
    control_free(through);
    control_free(first);
}

static void test_triggers(void **state) {
    (void)state;
    const struct trigger steps = {WRITE_TIME_STEP, 3, false}, run = {WRITE_RUN_TIME, 0.5, false},
                         cpu = {WRITE_CPU_TIME, 10, false}, fields = {WRITE_NONE, 0, true};
    struct moment a = {.t = 0.4, .step = 2, .cpu = 9}, b = {.t = 0.6, .step = 3, .cpu = 9.5};
    assert_true(trigger_due(&steps, &a, &b));
    assert_true(trigger_due(&run, &a, &b));
    assert_false(trigger_due(&cpu, &a, &b));
    assert_false(trigger_due(&fields, &a, &b));
    b.fields = true;
    b.cpu = 10;
    assert_true(trigger_due(&cpu, &a, &b) && trigger_due(&fields, &a, &b));
    assert_true(trigger_next(&run, 0.4) == HUGE_VAL);
    const struct trigger exact = {WRITE_ADJUSTABLE, 0.1, false};
    for (int k = 0; k < 1000; k++) assert_true(trigger_next(&exact, k * 0.1) == (k + 1) * 0.1);
}

static void test_names(void **state) {
    (void)state;
    char name[TIME_NAME];
    time_name(TIME_GENERAL, 6, 0.3, name);
    assert_string_equal(name, "0.3");
    time_name(TIME_FIXED, 3, 0.3, name);
    assert_string_equal(name, "0.300");
    time_name(TIME_GENERAL, 6, -0.0, name);
    assert_string_equal(name, "0");
    assert_int_equal(time_name_apart(TIME_GENERAL, 6, 1.0000001, 1, name), 8);
    assert_string_equal(name, "1.0000001");
    assert_int_equal(time_name_apart(TIME_GENERAL, 6, 1.1, 1, name), 6);
}

static void test_folders_appear_whole(void **state) {
    (void)state;
    char tmp[TIME_PATH], path[512];
    struct instant *list, at = {.t = 0.1 + 1e-17, .step = 7, .delta_t = 0.01, .digits = 6, .name = "0.1"};
    int n;
    assert_null(time_begin(folder, "0.1", tmp));
    assert_null(time_stamp_write(tmp, &at, NULL));
    assert_null(times_list(folder, &n, &list));
    assert_int_equal(n, 0);
    free(list);
    for (int twice = 0; twice < 2; twice++) { /* the second replaces the first */
        if (twice) {
            at.step = 8;
            assert_null(time_begin(folder, "0.1", tmp));
            assert_null(time_stamp_write(tmp, &at, NULL));
        }
        assert_null(time_commit(folder, "0.1"));
        assert_null(times_list(folder, &n, &list));
        assert_int_equal(n, 1);
        assert_int_equal(list[0].step, 7 + twice);
        assert_true(list[0].t == at.t && list[0].delta_t == 0.01);
        free(list);
    }
    assert_null(time_begin(folder, "0.2", tmp)); /* a killed run */
    assert_null(times_clean(folder));
    assert_int_equal(access(tmp, F_OK), -1);
    snprintf(path, sizeof path, "%s/0.1/uniform/time", folder);
    assert_int_equal(access(path, F_OK), 0);
}

/* What a restart takes for the time of a folder must be what the name was rounded from: within half a unit of its last
 * digit, however that is written. */
static void test_times_round_to_their_names(void **state) {
    (void)state;
    static const struct {
        const char *name;
        double value, unit;
    } cases[] = {{"3", 3, 1},           {"0.7", 0.7, 0.1},         {"0.70", 0.7, 0.01},         {"-12.5", -12.5, 0.1},
                 {"2e-05", 2e-5, 1e-5}, {"1.25e+06", 1.25e6, 1e4}, {"1.250e-3", 1.25e-3, 1e-6}, {"100000", 1e5, 1}};
    for (int i = 0; i < (int)(sizeof cases / sizeof *cases); i++)
        for (int k = -3; k <= 3; k++) {
            const double share = (const double[]){0, 0.2, 0.49, 0.6}[abs(k)] * (k < 0 ? -1 : 1);
            struct instant at = {.t = cases[i].value + share * cases[i].unit, .digits = 6};
            char tmp[TIME_PATH];
            snprintf(at.name, sizeof at.name, "%s", cases[i].name);
            assert_null(time_begin(folder, at.name, tmp));
            assert_null(time_stamp_write(tmp, &at, NULL));
            assert_null(time_commit(folder, at.name));
            status s = time_verify(folder, &at);
            if ((s != OK) != (abs(k) == 3)) fail_msg("time %s of value %.17g: %s", at.name, at.t, status_text(s));
            if (s) assert_non_null(strstr(status_text(s), "the folder is that of time"));
            status_free(s);
            assert_null(time_remove(folder, at.name));
        }
}

static int set_up(void **state) {
    (void)state;
    char path[256];
    if (!mkdtemp(folder)) return -1;
    snprintf(path, sizeof path, "%s/system", folder);
    return mkdir(path, 0777);
}
static int tear_down(void **state) {
    (void)state;
    return remove_folder(folder) ? -1 : 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_keys),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_triggers),
        cmocka_unit_test(test_write_times_are_hit),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_fixed_steps),
        cmocka_unit_test(test_restart_takes_the_same_steps),
        cmocka_unit_test(test_folders_appear_whole),
        cmocka_unit_test(test_times_round_to_their_names),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
