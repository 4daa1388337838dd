/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solvers/dict/expr.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h> /* last: it needs the standard headers, and its macro `fail` would hide ours */

static void gives(const char *text, double expected) {
    struct expr *e;
    status s = expr_compile(text, &e);
    if (s) fail_msg("%s", status_text(s));
    double v = expr_value(e, 2, 3, 5, 7);
    if (!(v == expected)) fail_msg("%s = %.17g, not %.17g", text, v, expected);
    expr_free(e);
}

static void refused(const char *text, const char *column, const char *what) {
    struct expr *e;
    status s = expr_compile(text, &e);
    if (!s) fail_msg("'%s' was taken", text);
    if (!strstr(status_text(s), column) || !strstr(status_text(s), what)) fail_msg("%s", status_text(s));
    status_free(s);
}

static void test_values(void **state) {
    (void)state;
    volatile double two = 2, half = 0.5, one = 1; /* so that the library, not the compiler, takes the functions */
    gives("1 + 2*3 - 4/8", 6.5);
    gives("8/4/2", 1);
    gives("8-4-2", 2);
    gives("-2^2", -4);
    gives("2^3^2", 512);
    gives("2^-1", 0.5);
    gives("2--1", 3);
    gives("7 % 4", 3);
    gives("(1+2)*3", 9);
    gives("x + 10*y + 100*z + 1000*t", 7532);
    gives("1e-3*.5e+3+2.", 2.5);
    gives("x < y && y <= 3 || 0", 1);
    gives("!(x > y) + (x != y) + (x == 2) + (1 >= 2)", 3);
    gives("x > y ? 1 : y > x ? 2 : 3", 2);
    gives("x < 1 || x > 1 ? 4 : 5", 4);
    gives("pi", acos(-one));
    gives("e", exp(one));
    gives("min(x, y) + max(x, y) + abs(-1) + mod(7, 4)", 9);
    gives("floor(1.5) + ceil(1.5) + round(1.6) + sign(-3) + sign(0) + pos(2) + pos(0) + neg(-1)", 7);
    gives("sqrt(16) + cbrt(27) + hypot(3, 4) + log10(100)", 14);
    gives("degToRad(radToDeg(0.5)) + sin(degToRad(30))", 1);
    gives("sin(x)+cos(x)", sin(two) + cos(two));
    gives("tan(x)", tan(two));
    gives("asin(.5)", asin(half));
    gives("acos(.5)", acos(half));
    gives("atan(x)", atan(two));
    gives("atan2(x, y)", atan2(two, 3));
    gives("sinh(x)", sinh(two));
    gives("cosh(x)", cosh(two));
    gives("tanh(x)", tanh(two));
    gives("pow(x, y)", 8);
    gives("exp(log(1))", 1);
}

static void test_errors(void **state) {
    (void)state;
    refused("1 + foo", "column 5", "found 'foo'; known are x y z t");
    refused("1 +", "column 4", "expected a number");
    refused("(1", "column 3", "')'");
    refused("1)", "column 2", "')'");
    refused("1 2", "column 3", "operator");
    refused("sin 1", "column 5", "'('");
    refused("pow(1)", "column 6", "','");
    refused("sin(1,2)", "column 6", "')'");
    refused("1 ? 2", "column 6", "':'");
    refused("0x10", "", "0x10");
    refused("1d3", "", "1d3");
    refused("nan", "column 1", "nan");
    refused("1e999", "column 1", "no number");
    refused("", "column 1", "expected");
    refused("system(1)", "column 1", "system");
    char deep[6000];
    memset(deep, '(', sizeof deep);
    deep[1000] = 0;
    refused(deep, "", "too deeply");
    memset(deep, '-', 1000);
    refused(deep, "", "too deeply");
    memset(deep, '1', sizeof deep);
    deep[5000] = 0;
    refused(deep, "", "longer");
    for (int i = 0; i < 1000; i++) memcpy(deep + 2 * i, "1^", 2);
    deep[2000] = 0;
    refused(deep, "", "too deeply");
}

/* ---- OpenFOAM's grammar ---- */

static void foam_gives(const char *text, int component, double expected) {
    struct expr *e;
    status s = expr_compile_foam(text, component, &e);
    if (s) print_error("%s\n", status_text(s));
    assert_null(s);
    assert_true(expr_value(e, 2, 3, 5, 7) == expected);
    expr_free(e);
}

static void foam_refused(const char *text, int component, const char *says) {
    struct expr *e;
    status s = expr_compile_foam(text, component, &e);
    assert_non_null(s);
    assert_null(e);
    if (!strstr(status_text(s), says)) print_error("%s\n", status_text(s));
    assert_non_null(strstr(status_text(s), says));
    status_free(s);
}

static void test_foam_scalars(void **state) {
    (void)state;
    foam_gives("pos().x()", -1, 2);
    foam_gives("pos ( ) . z ( ) * time()", -1, 35);
    foam_gives("pos(pos().y()) + neg(-1)", -1, 2);
    foam_gives("sqr(mag(-3)) - pow(2, 3)", -1, 1);
    foam_gives("time() > 6 ? pi() : 0", -1, acos(-1));
    foam_gives("max(1e0, !0 && 1)", -1, 1);
    foam_refused("x", -1, "pos().x()");
    foam_refused("2*t", -1, "column 3");
    foam_refused("pi", -1, "pi()");
    foam_refused("2^3", -1, "pow(a, b)");
    foam_refused("pos()", -1, "the field is a scalar");
    foam_refused("vector(1, 2, 3)", -1, "the field is a scalar");
    foam_refused("internalField(T)", -1, "known are pos().x()");
    foam_refused("tiem()", -1, "known are");
    foam_refused("sinn(1)", -1, "did you mean 'sin' or 'sinh'?");
    foam_refused("pos().w()", -1, "the field is a scalar");
}

/* Component by component; types as OpenFOAM has them. */
static void test_foam_vectors(void **state) {
    (void)state;
    for (int i = 0; i < 3; i++) {
        foam_gives("vector(2, 3, 5)", i, (const double[]){2, 3, 5}[i]);
        foam_gives("pos()", i, (const double[]){2, 3, 5}[i]);
        foam_gives("2*pos() - vector(time(), 1, pos().x())/2", i, (const double[]){0.5, 5.5, 9}[i]);
        foam_gives("-vector(1, 2, 3)*(1 + time())", i, -8 * (i + 1));
        foam_gives("time() < 1 ? pos() : (vector(1, 2, 3))", i, i + 1);
        foam_refused("1", i, "vector(a, b, c)");
        foam_refused("1 + vector(1, 2, 3)", i, "vectors are added to vectors");
        foam_refused("pos()*pos()", i, "vectors are added to vectors");
        foam_refused("2/pos()", i, "divided by scalars");
        foam_refused("pos() == pos()", i, "vectors are added to vectors");
        foam_refused("sin(pos())", i, "a scalar is wanted");
        foam_refused("vector(pos(), 1, 1)", i, "a scalar is wanted");
        foam_refused("vector(1, 2)", i, "expected vector(a, b, c)");
        foam_refused("pos() ? pos() : pos()", i, "is a vector");
        foam_refused("time() ? pos() : 1", i, "the other a scalar");
        foam_refused("!pos()", i, "is a vector");
        foam_refused("vector(1, 2, 3).x()", i, "expected an operator");
    }
}

static void test_constant(void **state) {
    (void)state;
    double v = 0;
    assert_null(expr_constant("2*3", &v));
    assert_true(v == 6);
    status s = expr_constant("2*t", &v);
    assert_non_null(s);
    assert_non_null(strstr(status_text(s), "constant"));
    status_free(s);
    s = expr_constant("sqrt(-1)", &v);
    assert_non_null(s);
    status_free(s);
}

/* At many points: the bits of each point alone, whatever their number, with values that recur and that are none. */
static void test_many(void **state) {
    (void)state;
    enum { MOST = 3000 };
    static const char *const texts[] = {
        "1",
        "t",
        "pi*cos(1 + t)",
        "z",
        "1 + .1*cos(pi*(2*x - y)/8 + .3) + .2*sin(pi*(x + z)/8)*exp(-t*y)",
        "x > y ? sqrt(x - y) : t < 8 ? -z : 1/0",
        "log(x) + sqrt(y) + x^3 + atan2(y, z) % 2",
        "x < 3 && !(y > 4) || z == 5",
        "min(x, 1) - max(y, t)*abs(-z) + floor(x) + sqr(y)/mod(z, 2) + sign(x) + pos(y) + neg(z)",
        "(x <= y) + (x >= y) + (x != y) + degToRad(x) + radToDeg(t) + hypot(x, 2) + mag(y) + cbrt(z) + -tanh(0*x)"};
    static double x[3 * MOST], v[MOST];
    unsigned seed = 1;
    for (int i = 0; i < 3 * MOST; i++) x[i] = (double)((seed = seed * 1103515245 + 12345) >> 20 & 63) * .25 - 5;
    for (int k = 0; k < 3; k++) x[k] = (const double[]){0. / -1., NAN, INFINITY}[k];
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct expr *e;
        assert_null(expr_compile(texts[i], &e));
        for (int n = 1; n <= MOST; n = 5 * n + 2) {
            expr_values(e, n, x, 7, v);
            for (int k = 0; k < n; k++) {
                const double one = expr_value(e, x[3 * k], x[3 * k + 1], x[3 * k + 2], 7);
                if (memcmp(&one, &v[k], sizeof one) && !(isnan(one) && isnan(v[k])))
                    fail_msg("%s at point %d of %d: %.17g, not %.17g", texts[i], k, n, v[k], one);
            }
        }
        expr_free(e);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_values),       cmocka_unit_test(test_errors),
                                       cmocka_unit_test(test_foam_scalars), cmocka_unit_test(test_foam_vectors),
                                       cmocka_unit_test(test_constant),     cmocka_unit_test(test_many)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
