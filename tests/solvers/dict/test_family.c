/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One loop reads every family of models: which row a keyword chooses, whose NAMECoeffs are read, and what is refused.
 */
#include "solvers/dict/family.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h> /* last: it needs the standard headers, and its macro `fail` would hide ours */

struct spring { /* rows need not be as large as struct model */
    struct model model;
    int order;
};
struct linear {
    double stiffness;
};
struct cubic {
    double stiffness, growth;
};
#define PARAM_STRUCT struct linear
static const struct param linear_param[] = {NUMBER("stiffness", stiffness, 2, POSITIVE, NO_UNIT, "of the spring")};
#undef PARAM_STRUCT
#define PARAM_STRUCT struct cubic
static const struct param cubic_param[] = {
    NUMBER("stiffness", stiffness, 3, POSITIVE, NO_UNIT, "of the spring"),
    NUMBER("growth", growth, REQUIRED, ANY_NUMBER, NO_UNIT, "of its stiffness"),
};
OWN_PARAMS_FIT(struct cubic);
static const struct spring spring_table[] = {{MODEL_WITH("linear", "Hooke's", linear_param), 1},
                                             {MODEL("rigid", "does not give"), 0},
                                             {MODEL_WITH("cubic", "stiffens", cubic_param), 3}};
static const int spring_count = sizeof spring_table / sizeof *spring_table;

struct chosen {
    int before;
    const struct spring *spring;
    struct own_params params;
};
static status not_rigid(struct dict *d, void *base) {
    const struct chosen *c = base;
    return c->spring && c->spring->order == 0 ? dict_fail(d, "spring", "nothing may be rigid") : OK;
}
static status not_soft(struct dict *d, void *base) {
    const struct chosen *c = base;
    struct linear own;
    memcpy(&own, &c->params, sizeof own);
    return c->spring && own.stiffness < 1 ? dict_fail(d, "spring", "too soft") : OK;
}
#define SPRINGS                                                                                                        \
    .file = "springs", .title = "spring", .key = "spring", FAMILY_ROWS(spring),                                        \
    .chosen = offsetof(struct chosen, spring), .params = offsetof(struct chosen, params)
static const struct family must = {SPRINGS, .must = true}, optional = {SPRINGS},
                           checked = {SPRINGS, .suits = not_rigid, .holds = not_soft},
                           none = {SPRINGS, .none = "falls", .tacit = true}, standard = {SPRINGS, .standard = "linear"},
                           within = {SPRINGS, .sub = "inner", .standard = "rigid"},
                           tacit = {SPRINGS, .sub = "inner", .standard = "linear"};

static status read_text(const struct family *k, const char *text, struct chosen *c, struct dict **d) {
    *c = (struct chosen){.before = 7};
    status s = dict_from_text("T", text, d);
    if (!s) s = family_read(k, *d, c);
    return s ? s : dict_check_used(*d);
}

/* The name of the row that is chosen; its first parameter is *stiffness */
static const char *taken(const struct family *k, const char *text, double *stiffness) {
    struct chosen c;
    struct dict *d = NULL;
    status s = read_text(k, text, &c, &d);
    if (s) fail_msg("%s", status_text(s));
    dict_free(d);
    assert_int_equal(c.before, 7);
    memcpy(stiffness, &c.params, sizeof *stiffness);
    return c.spring ? c.spring->model.name : "";
}

static void refused(const struct family *k, const char *text, const char *where, const char *what) {
    struct chosen c;
    struct dict *d = NULL;
    status s = read_text(k, text, &c, &d);
    if (!s) fail_msg("'%s' was taken", text);
    if (!strstr(status_text(s), where) || !strstr(status_text(s), what)) fail_msg("%s", status_text(s));
    status_free(s);
    dict_free(d);
}

static void rows_are_chosen(void **state) {
    (void)state;
    double v;
    assert_string_equal(taken(&must, "spring linear;", &v), "linear");
    assert_true(v == 2);
    assert_string_equal(taken(&must, "spring cubic; cubicCoeffs { stiffness 5; growth 1; }", &v), "cubic");
    assert_true(v == 5);
    assert_string_equal(taken(&must, "spring rigid;", &v), "rigid");
    assert_string_equal(taken(&standard, "", &v), "linear");
    assert_true(v == 2);
    assert_string_equal(taken(&standard, "spring rigid;", &v), "rigid");
    assert_string_equal(taken(&optional, "", &v), "");
    assert_string_equal(taken(&none, "", &v), "");
    assert_string_equal(taken(&none, "spring none;", &v), "");
    assert_string_equal(taken(&none, "spring linear; linearCoeffs { stiffness 4; }", &v), "linear");
    assert_true(v == 4);
    assert_string_equal(taken(&within, "", &v), "rigid");
    assert_string_equal(taken(&within, "inner { spring linear; }", &v), "linear");
    assert_string_equal(taken(&tacit, "", &v), "linear");
    assert_true(v == 2);
    assert_string_equal(taken(&tacit, "inner { spring linear; linearCoeffs { stiffness 4; } }", &v), "linear");
    assert_true(v == 4);
}

/* Coefficients of rows that are not chosen may stay, whatever they hold; those of the chosen one are checked. */
static void coefficients(void **state) {
    (void)state;
    double v;
    assert_string_equal(taken(&must, "spring linear; cubicCoeffs { stiffness -5; colour red; }", &v), "linear");
    assert_true(v == 2);
    assert_string_equal(taken(&none, "linearCoeffs { } cubicCoeffs { growth 3; }", &v), "");
    refused(&must, "spring linear;\nlinearCoeffs { stifness 3; }", "T:2:", "did you mean 'stiffness'?");
    refused(&must, "spring linear;\nlinearCoeffs { stiffness -3; }", "T:2:", "must be greater than 0");
    refused(&must, "spring linear;\nlinearCoefs { stiffness 3; }", "T:2:", "did you mean 'linearCoeffs'?");
    refused(&must, "spring cubic;\ncubicCoeffs { stiffness 3; }", "T:2:", "'growth' is missing");
    refused(&must, "spring cubic;", "", "'growth' is missing");
    refused(&must, "spring linear;\nlinearCoeffs 3;", "T:2:", "linearCoeffs { ... }");
    refused(&must, "spring rigid;\nrigidCoeffs { }", "T:2:", "'rigidCoeffs' is not used"); /* it has no parameters */
}

static void names(void **state) {
    (void)state;
    refused(&must, "\nspring liner;", "T:2:", "allowed are: linear, rigid, cubic; did you mean 'linear'?");
    refused(&none, "\nspring liner;", "T:2:", "allowed are: none, linear, rigid, cubic; did you mean 'linear'?");
    refused(&must, "spring none;", "T:1:", "allowed are: linear, rigid, cubic");
    refused(&standard, "spring 3;", "T:1:", "one of: linear, rigid, cubic");
    refused(&must, "", "T:", "'spring' is one of: linear, rigid, cubic");
    refused(&must, "\nsprign linear;", "T:2:", "'spring' is missing");
    refused(&standard, "\nsprign linear;", "T:2:", "did you mean 'spring'?");
    refused(&within, "\ninner { }", "T:2:", "'spring' is one of: linear, rigid, cubic");
    refused(&within, "\ninner 3;", "T:2:", "inner { ... }");
}

/* A row is asked before its parameters are read, and these after. */
static void objections(void **state) {
    (void)state;
    double v;
    assert_string_equal(taken(&checked, "spring linear;", &v), "linear");
    assert_string_equal(taken(&checked, "", &v), "");
    refused(&checked, "\nspring rigid;", "T:2:", "nothing may be rigid");
    refused(&checked, "\nspring linear; linearCoeffs { stiffness 0.5; }", "T:2:", "too soft");
}

struct several {
    int before;
    bool on[3];
    struct own_params params[3];
    int behind;
};
static bool gives(const struct model *row) {
    return ((const struct spring *)(const void *)row)->order > 0;
}
static const struct family several = {.file = "springs",
                                      .title = "springs",
                                      .key = "springs",
                                      FAMILY_ROWS(spring),
                                      .list = true,
                                      .offered = gives,
                                      .chosen = offsetof(struct several, on),
                                      .params = offsetof(struct several, params)};

static status read_several(const char *text, struct several *c) {
    struct dict *d = NULL;
    *c = (struct several){.before = 7, .behind = 8};
    status s = dict_from_text("T", text, &d);
    if (!s) s = family_read(&several, d, c);
    if (!s) s = dict_check_used(d);
    dict_free(d);
    assert_true(c->before == 7 && c->behind == 8);
    return s;
}

static void refused_list(const char *text, const char *what) {
    struct several c;
    status s = read_several(text, &c);
    if (!s) fail_msg("'%s' was taken", text);
    if (!strstr(status_text(s), "T:2:") || !strstr(status_text(s), what)) fail_msg("%s", status_text(s));
    status_free(s);
}

/* A list chooses any number of the rows that are offered, each with parameters of its own. */
static void lists(void **state) {
    (void)state;
    static const struct {
        const char *text;
        bool on[3];
        double stiffness[3];
    } good[] = {{"", {0}, {0}},
                {"springs (); linearCoeffs { stiffness -1; }", {0}, {0}},
                {"springs linear;", {true}, {2}},
                {"springs (cubic linear); cubicCoeffs { growth 1; } linearCoeffs { stiffness 5; }",
                 {true, false, true},
                 {5, 0, 3}}};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        struct several c;
        status s = read_several(good[i].text, &c);
        if (s) fail_msg("%s", status_text(s));
        for (int k = 0; k < 3; k++) {
            assert_int_equal(c.on[k], good[i].on[k]);
            assert_true(c.params[k].room[0] == good[i].stiffness[k]);
        }
    }
    refused_list("\nsprings (liner);", "there is no 'liner'; allowed are: linear, cubic; did you mean 'linear'?");
    refused_list("\nsprings (rigid);", "there is no 'rigid'; allowed are: linear, cubic");
    refused_list("\nsprings (linear linear);", "linear stands there twice");
    refused_list("\nsprings (cubic);", "cubic needs the dictionary  cubicCoeffs { growth ..; }");
    refused_list("\nsprings (linear); linearCoeffs { stiffness -1; }", "must be greater than 0");
    refused_list("\nspring (linear);", "did you mean 'springs'?");
}

/* Programs without a use for the family leave its keyword, whatever it says, and the coefficients of all rows. */
static void left_to_others(void **state) {
    (void)state;
    struct dict *d = NULL;
    status s = dict_from_text("T", "spring steel; cubicCoeffs { colour red; } linearCoeffs { }", &d);
    if (!s) s = family_leave(&must, d);
    if (!s) s = dict_check_used(d);
    if (s) fail_msg("%s", status_text(s));
    dict_free(d);
}

static void text_of(FILE *f, char *text, size_t size) {
    rewind(f);
    text[fread(text, 1, size - 1, f)] = 0;
    fclose(f);
}

static void listed_and_printed(void **state) {
    (void)state;
    char text[1000];
    struct chosen c = {.spring = &spring_table[2]};
    const struct cubic own = {1.5, -2};
    memcpy(&c.params, &own, sizeof own);
    FILE *f = tmpfile();
    assert_non_null(f);
    family_print(f, &standard, &c);
    family_print(f, &within, &c);
    c.spring = NULL;
    family_print(f, &none, &c);
    family_print(f, &optional, &c);
    text_of(f, text, sizeof text);
    assert_string_equal(text, "    spring                 cubic\n"
                              "    stiffness              1.5\n    growth                 -2\n"
                              "    inner                  cubic\n"
                              "    stiffness              1.5\n    growth                 -2\n"
                              "    spring                 none\n");
    f = tmpfile();
    assert_non_null(f);
    family_print(f, &several, &(struct several){.on = {true, false, true}, .params = {{{4}}, {{0}}, {{1.5, -2}}}});
    family_print(f, &several, &(struct several){.on = {false}});
    family_list(f, &several);
    text_of(f, text, sizeof text);
    static const char begins[] = "    springs                linear\n    stiffness              4\n"
                                 "    springs                cubic\n    stiffness              1.5\n"
                                 "    growth                 -2\n\nsprings\n  linear ";
    if (strncmp(text, begins, strlen(begins))) fail_msg("it does not begin with '%s':\n%s", begins, text);
    assert_null(strstr(text, "rigid"));
    f = tmpfile();
    assert_non_null(f);
    family_list(f, &none);
    family_list(f, &(struct family){SPRINGS, .standard = "rigid"});
    text_of(f, text, sizeof text);
    static const char *const parts[] = {
        "\nspring\n  none                 falls\n  linear               Hooke's; linearCoeffs { }\n    stiffness",
        "  rigid                does not give\n  cubic                stiffens; cubicCoeffs { }\n",
        "\nspring\n  linear               Hooke's; linearCoeffs { }\n",
        "  rigid                does not give (default)\n",
    };
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        if (!strstr(text, parts[i])) fail_msg("'%s' is not in:\n%s", parts[i], text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_chosen), cmocka_unit_test(coefficients),   cmocka_unit_test(names),
        cmocka_unit_test(objections),      cmocka_unit_test(left_to_others), cmocka_unit_test(listed_and_printed),
        cmocka_unit_test(lists),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
