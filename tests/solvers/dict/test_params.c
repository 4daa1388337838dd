/* SPDX-License-Identifier: GPL-3.0-or-later */
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
    int count, shape, lies;
    bool rough;
};
static const char *const shapes[] = {"disk", "sphere", "cube", NULL};
#define PARAM_STRUCT struct grain
static const struct param table[] = {
    NUMBER("restitution", restitution, 0.9, FROM_TO(0, 1), NO_UNIT, "of grains"),
    NUMBER("diameter", diameter, REQUIRED, BETWEEN(0, 1), UNIT(0, 1, 0), "of a grain"),
    VECTOR("axis", axis, 0, FROM_TO(-10, 10), NO_UNIT, "of rotation"),
    WHOLE("count", count, 3, FROM_TO(1, 8), "of stages"),
    SWITCH("rough", rough, true, "walls"),
    CHOICE("shape", shape, 1, shapes, "of a grain"),
    CHOICE("lies", lies, -1, shapes, "what lies beside it"),
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
                g.rough && g.shape == 1 && g.lies == -1);
    g = taken("diameter [0 1 0 0 0 0 0] 0.25; restitution 1; axis (1 2 3); count 8; rough off; shape cube; lies disk;");
    assert_true(g.restitution == 1 && g.diameter == 0.25 && g.axis[1] == 2 && g.count == 8 && !g.rough &&
                g.shape == 2 && g.lies == 0);
}

static void test_errors(void **state) {
    (void)state;
    refused("diameter 1e-3;\nrestitution 1.2;", "T:2:", "restitution is 1.2; allowed is 0 .. 1");
    refused("diameter 0;", "T:1:", "excluded");
    refused("\nrough on;", "T:1:", "'diameter' is missing (of a grain)");
    refused("\n\ndiameterOfGrains 0.5;", "T:3:", "this line has 'diameterOfGrains': did you mean 'diameter'?");
    refused("rough on;\ndiam 0.5;", "T:2:", "this line has 'diam': did you mean 'diameter'?");
    refused("diameter [0 2 0 0 0 0 0] 0.5;", "T:1:", "[0 1 0 0 0 0 0]");
    refused("diameter 0.5; axis (1 2 11);", "T:1:", "axis is 11");
    refused("diameter 0.5;\ncount 2.5;", "T:2:", "whole");
    refused("diameter 0.5; count 9;", "T:1:", "1 .. 8");
    refused("diameter 0.5; rough perhaps;", "T:1:", "on yes true");
    refused("diameter 0.5;\nshape spehre;", "T:2:", "allowed are: disk, sphere, cube; did you mean 'sphere'?");
    refused("diameter 0.5;\nlies 2;", "T:2:", "one of: disk, sphere, cube");
    refused("diameter 0.5;\nshaep cube;", "T:2:", "did you mean 'shape'?");
    refused("diameter 0.5;\nrestitutoin 1;", "T:2:", "did you mean 'restitution'?");
}

/* A word that must be given: the message says where, which words there are and what they mean. */
static void test_required_word(void **state) {
    (void)state;
    static const struct param required[] = {CHOICE("shape", shape, REQUIRED, shapes, "of a grain")};
    struct dict *d = parse("\nshpae disk;");
    struct grain g;
    char text[200] = "";
    status s = params_read(d, required, 1, &g);
    if (!s) fail_msg("a missing word was taken");
    const char *const parts[] = {"T:2:", "'shape' is missing", "disk, sphere, cube", "(of a grain)"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (!strstr(status_text(s), parts[i])) fail_msg("'%s' is not in: %s", parts[i], status_text(s));
    status_free(s);
    dict_free(d);
    FILE *f = tmpfile();
    assert_non_null(f);
    params_print(f, required, 1);
    rewind(f);
    text[fread(text, 1, sizeof text - 1, f)] = 0;
    fclose(f);
    assert_string_equal(text, "    shape                required   disk, sphere, cube -          of a grain\n");
}

/* Rows that fill a switch from words, or fill nothing. */
static void test_other_rows(void **state) {
    (void)state;
    static const char *const formats[] = {"ascii", "binary", "text", "raw", NULL}, *const cells[] = {"cell", NULL};
    static const struct param rows[] = {
        EITHER("format", rough, false, formats, "of files"),
        ONLY("scheme", 0, cells, "of points"),
        NOTED("points", "list", NULL, "read elsewhere", "points ();"),
        IGNORED("libs", "for others"),
    };
    enum { ROWS = sizeof rows / sizeof *rows };
    static const struct {
        const char *text;
        bool on;
        const char *error;
    } cases[] = {
        {"", false, NULL},
        {"format raw; scheme cell; libs (a b);", true, NULL},
        {"format text; libs { a { b 1; } }", false, NULL},
        {"format bin;", false, "allowed are: ascii, binary, text, raw"},
        {"scheme point;", false, "allowed are: cell"},
        {"points (1 2);", false, "'points' is not used"}, /* its own reader would ask for it */
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct dict *d = parse(cases[i].text);
        struct grain g = {.rough = true};
        status s = params_read(d, rows, ROWS, &g);
        if (!s) s = dict_check_used(d);
        if (!s && cases[i].error) fail_msg("'%s' was taken", cases[i].text);
        if (s && (!cases[i].error || !strstr(status_text(s), cases[i].error))) fail_msg("%s", status_text(s));
        if (!s) assert_int_equal(g.rough, cases[i].on);
        status_free(s);
        dict_free(d);
    }
    char line[100] = "";
    FILE *f = tmpfile();
    assert_non_null(f);
    params_print_values(f, rows, ROWS, &(struct grain){.rough = true});
    rewind(f);
    assert_non_null(fgets(line, sizeof line, f));
    assert_string_equal(line, "    format                 binary\n");
    assert_null(fgets(line, sizeof line, f)); /* the others have no value */
    fclose(f);
}

static void test_print_values(void **state) {
    (void)state;
    const struct grain g = {
        .restitution = 0.75, .diameter = 1e-3, .axis = {1, 2, 3}, .count = 4, .shape = 2, .lies = -1};
    char text[1000] = "", line[100];
    static const char *const expected[] = {"0.75", "0.001", "(1 2 3)", "4", "no", "cube", "-"};
    FILE *f = tmpfile();
    assert_non_null(f);
    params_print_values(f, table, N, &g);
    rewind(f);
    for (int i = 0; i < N; i++) {
        snprintf(text, sizeof text, "    %-22s %s\n", table[i].name, expected[i]);
        assert_non_null(fgets(line, sizeof line, f));
        assert_string_equal(line, text);
    }
    assert_null(fgets(line, sizeof line, f));
    fclose(f);
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
    static const char *const parts[] = {"restitution",
                                        "0.9",
                                        "0 .. 1",
                                        "required",
                                        "0 < .. < 1",
                                        "of a grain",
                                        "on, off",
                                        "sphere     or disk, cube",
                                        "-          disk, sphere, cube"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (!strstr(text, parts[i])) fail_msg("'%s' is not in:\n%s", parts[i], text);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_read),          cmocka_unit_test(test_errors),
                                       cmocka_unit_test(test_required_word), cmocka_unit_test(test_print),
                                       cmocka_unit_test(test_print_values),  cmocka_unit_test(test_other_rows)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
