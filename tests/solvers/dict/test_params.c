#include "solvers/dict/params.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h> /* last: it needs the standard headers, and its macro `fail` would hide ours */

struct grain {
    double restitution, diameter, axis[3];
    int count;
    bool rough;
};
static const struct param table[] = {
    {"restitution", PARAM_NUMBER, offsetof(struct grain, restitution), 0.9, 0, 1, false, {0, 0, 0}, "of grains"},
    {"diameter", PARAM_NUMBER, offsetof(struct grain, diameter), NAN, 0, 1, true, {0, 1, 0}, "of a grain"},
    {"axis", PARAM_VECTOR, offsetof(struct grain, axis), 0, -10, 10, false, {0, 0, 0}, "of rotation"},
    {"count", PARAM_COUNT, offsetof(struct grain, count), 3, 1, 8, false, {0, 0, 0}, "of stages"},
    {"rough", PARAM_SWITCH, offsetof(struct grain, rough), 1, 0, 1, false, {0, 0, 0}, "walls"},
};
enum { N = sizeof table / sizeof *table };

static struct dict *parse(const char *text) {
    struct dict *d = NULL;
    status s = dict_from_text("T", text, &d);
    if (s) fail_msg("%s", status_text(s));
    return d;
}

static struct grain taken(const char *text) {
    struct dict *d = parse(text);
    struct grain g;
    memset(&g, 0x55, sizeof g);
    status s = params_read(d, table, N, &g);
    if (!s) s = dict_check_used(d);
    if (s) fail_msg("%s", status_text(s));
    dict_free(d);
    return g;
}

static void refused(const char *text, const char *where, const char *what) {
    struct dict *d = parse(text);
    struct grain g;
    status s = params_read(d, table, N, &g);
    if (!s) s = dict_check_used(d);
    if (!s) fail_msg("'%s' was taken", text);
    if (!strstr(status_text(s), where) || !strstr(status_text(s), what)) fail_msg("%s", status_text(s));
    status_free(s);
    dict_free(d);
}

static void test_read(void **state) {
    (void)state;
    struct grain g = taken("diameter 0.5;");
    assert_true(g.restitution == 0.9 && g.diameter == 0.5 && g.axis[0] == 0 && g.axis[2] == 0 && g.count == 3 &&
                g.rough);
    g = taken("diameter [0 1 0 0 0 0 0] 0.25; restitution 1; axis (1 2 3); count 8; rough off;");
    assert_true(g.restitution == 1 && g.diameter == 0.25 && g.axis[1] == 2 && g.count == 8 && !g.rough);
}

static void test_errors(void **state) {
    (void)state;
    refused("diameter 1e-3;\nrestitution 1.2;", "T:2:", "restitution is 1.2; allowed is 0 .. 1");
    refused("diameter 0;", "T:1:", "excluded");
    refused("\nrough on;", "T:1:", "'diameter' is missing (of a grain)");
    refused("diameter [0 2 0 0 0 0 0] 0.5;", "T:1:", "[0 1 0 0 0 0 0]");
    refused("diameter 0.5; axis (1 2 11);", "T:1:", "axis is 11");
    refused("diameter 0.5;\ncount 2.5;", "T:2:", "whole");
    refused("diameter 0.5; count 9;", "T:1:", "1 .. 8");
    refused("diameter 0.5; rough perhaps;", "T:1:", "on yes true");
    refused("diameter 0.5;\nrestitutoin 1;", "T:2:", "did you mean 'restitution'?");
}

static void test_print(void **state) {
    (void)state;
    char text[2000] = "";
    FILE *f = tmpfile();
    assert_non_null(f);
    params_print(f, table, N);
    rewind(f);
    text[fread(text, 1, sizeof text - 1, f)] = 0;
    fclose(f);
    static const char *const parts[] = {"restitution", "0.9",        "0 .. 1", "required",
                                        "0 < .. < 1",  "of a grain", "on, off"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (!strstr(text, parts[i])) fail_msg("'%s' is not in:\n%s", parts[i], text);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_read), cmocka_unit_test(test_errors),
                                       cmocka_unit_test(test_print)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
