/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mesh/format/foamfile.h"
#include "solvers/dict/dict.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/checks.h" /* last */

static struct dict *parse(const char *text) {
    struct dict *d = NULL;
    ok(dict_from_text("T", text, &d));
    return d;
}

/* What dict_print says of a text: macros expanded, on one line. */
static void reads(const char *text, const char *expected) {
    struct dict *d = parse(text);
    char *printed = dict_print(d), line[2048];
    size_t n = 0;
    for (const char *p = printed; *p && n < sizeof line - 1; p++) {
        if (*p == ' ' && n && line[n - 1] == ' ') continue;
        line[n++] = *p == '\n' ? ' ' : *p;
        if (n > 1 && line[n - 1] == ' ' && line[n - 2] == ' ') n--;
    }
    line[n] = 0;
    assert_string_equal(line, expected);
    free(printed);
    dict_free(d);
}

static void refused(const char *text, const char *parts) {
    struct dict *d;
    says(dict_from_text("T", text, &d), parts);
    assert_null(d);
}

static void test_macros(void **state) {
    (void)state;
    reads("a 1; b $a; c ${a}; s { x 2; t { w $..x; z $:a; q $a; } }",
          "a 1; b 1; c 1; s { x 2; t { w 2; z 1; q 1; } } ");
    reads("a 1; b $a; a 2;", "a 2; b 1; "); /* expanded when read */
    reads("a (1 2); b uniform $a;", "a (1 2); b uniform (1 2); ");
    reads("s { x 1; } y $s.x; z $:s.x;", "s { x 1; } y 1; z 1; ");
    reads("base { x 1; y { p 1; } } d { $base; y { q 2; } z 3; }",
          "base { x 1; y { p 1; } } d { x 1; y { p 1; q 2; } z 3; } ");
    reads("base { x 1; } d $base; d { y 2; }", "base { x 1; } d { x 1; y 2; } ");
    refused("nested { x 1;\n y $:nested.x; }", "T:2:|:nested.x");
    refused("\na $b;", "T:2:|$b");
    refused("a 1;\n$a;", "T:2:|dictionary");
    refused("a { }\nb 1 $a;", "T:2:|'$a' is a dictionary");
    refused("a ${{ 2*3 }};", "T:1:|#eval");
    /* a pattern counts where no key is that word, in no dictionary around, and where it is read to its end */
    reads("\"(U|k)\" { x 1; } m { $U; } t $U.x;", "\"(U|k)\" { x 1; } m { x 1; } t 1; ");
    reads("\"(U|k)\" { x 1; } \"(U|k).*\" { $U; }", "\"(U|k)\" { x 1; } \"(U|k).*\" { x 1; } ");
    reads("i uniform 2; b { \".*\" { v $i; } o { v $i; } }",
          "i uniform 2; b { \".*\" { v uniform 2; } o { v uniform 2; } } ");
    reads("#inputSyntax slash; a 1; s { x 2; t { w $../x; z $!a; } } y $s/x;", "a 1; s { x 2; t { w 2; z 1; } } y 2; ");
    refused("a { $:a; }", "T:1:|:a");
}

/* What OpenFOAM's own function objects and folder etc would give is passed over, and noted if it is of the user's. */
static void test_passed(void **state) {
    (void)state;
    struct dict *d = parse("f {\n#includeFunc mag(U)\n#includeFunc probes\n#includeFunc w\n (\na, b (c)) x 1; }");
    assert_string_equal(dict_passed(d, 0), "T:2: #includeFunc mag(U)");
    assert_string_equal(dict_passed(d, 1), "T:3: #includeFunc probes");
    assert_non_null(strstr(dict_passed(d, 2), "T:4: #includeFunc w"));
    assert_null(dict_passed(d, 3));
    dict_free(d);
    reads("f { #includeFunc w\n(a\nb) x 1; }", "f { x 1; } ");
    refused("\n#includeFunc w(a\n", "T:2:|not closed");
    refused("\n#includeFunc ;", "T:2:|name");
    reads("#includeEtc \"caseDicts/x\"\na 1;", "a 1; ");
    d = parse("#includeEtc \"caseDicts/setConstraintTypes\"\n");
    assert_null(dict_unused(d));
    assert_true(dict_has(d, "empty") && dict_has(d, "symmetryPlane"));
    dict_free(d);
    refused("\n#inputSyntax both;", "T:2:|slash");
}

static void test_merge(void **state) {
    (void)state;
    reads("k 1; k 2; m{x 1;} m{y 2;}", "k 2; m { x 1; y 2; } ");
    reads("k 1; k { x 1; }", "k { x 1; } ");
    reads("k { x 1; } k 1;", "k 1; ");
    reads("m{x 1;} #inputMode overwrite m{y 2;}", "m { y 2; } ");
    reads("k 1; m{x 1;} #inputMode protect k 2; m{x 2;} j 3;", "k 1; m { x 1; } j 3; ");
    reads("#inputMode merge k 1; k 2;", "k 2; ");
    reads("x 1; #default x 3; #default y 4;", "x 1; y 4; ");
    reads("x 1; y 2; z 3; #remove x z 4; #remove (z w)", "y 2; ");
    reads("ab 1; ac 2; b 3; #remove \"a.*\"", "b 3; ");
    refused("k 1;\n#inputMode error\nk 2;", "T:3:|'k'|line 1");
    refused("\n#inputMode mix", "T:2:|mix|merge");
}

static void test_conditions(void **state) {
    (void)state;
    reads("#if true\na 1;\n#else\na 2;\n#endif\n", "a 1; ");
    reads("f off;\n#if $f\na 1;\n#else\na 2;\n#endif\nb 3;", "f off; a 2; b 3; ");
    reads("#if 0\n#if 1\na 1;\n#else\na 2;\n#endif\n#endif\nb 1;", "b 1; ");
    reads("n 3;\n#ifeq $n 3\na 1;\n#endif\n#ifeq x y\nb 1;\n#endif", "n 3; a 1; ");
    reads("#if #eval{ 2 > 1 }\na 1;\n#endif", "a 1; ");
    refused("\n#if true\na 1;", "#endif");
    refused("\n#if false\na 1;", "T:2:|#endif");
    refused("\n#else\n#endif", "T:2:|#if");
    refused("\n#if maybe\n#endif", "T:2:|maybe");
}

static void test_eval(void **state) {
    (void)state;
    reads("a 3; b #eval{ 2*$a }; c #eval \"2*$a + 1\"; d #calc \"$a^2\"; e (1 #eval{ sqrt(16) });",
          "a 3; b 6; c 7; d 9; e (1 4); ");
    reads("a -2; b #eval{ ${a}^2 }; c #eval #{ 0.1*3 #};", "a -2; b 4; c 0.30000000000000004; ");
    reads("a #eval{\n1 +\n1 };\nb 1;", "a 2; b 1; ");
    refused("\na #eval{ 2*x };", "T:2:|constant");
    refused("\na #eval{ 2*foo };", "T:2:|foo|column");
    refused("\na #eval{ 1/0 };", "T:2:|inf");
    refused("\na #codeStream { };", "T:2:|no code");
    refused("#codeStream;", "T:1:|no code");
    refused("p { type\n codedFixedValue; }", "T:2:|no code");
}

/* Windows editors put a mark of byte order first, and files that were joined have it inside. */
static void test_byte_order(void **state) {
    (void)state;
    reads("\xEF\xBB\xBF a 1;", "a 1; ");
    refused("a 1;\n\xEF\xBB\xBF"
            "b 1;",
            "T:2:|mark of byte order");
}

/* Short texts that ask for much memory or time. */
static void test_bombs(void **state) {
    (void)state;
    char text[2000] = "a 1 1 1 1;\n";
    for (int i = 0; i < 20; i++)
        sprintf(text + strlen(text), "b%d $%c%d $%c%d $%c%d;\n", i + 1, 'b', i, 'b', i, 'b', i);
    memcpy(strstr(text, "$b0 $b0 $b0"), "$:a $:a $:a", 11);
    refused(text, "|macros|more than a million values");
    refused("\n\"a{9}{9}\" 1;", "T:2:|regular expression|{ }");
    refused("\"a+b+c+d+e+\" 1;", "T:1:|regular expression|four +");
    refused("\"((a+)+)+\" 1;", "T:1:|regular expression|more than one + behind )");
    refused("\"a*************\" 1;", "T:1:|regular expression|more than twelve");
    refused("\"(a*||b)*\" 1;", "T:1:|regular expression|an alternative is empty");
    refused("\"(^|a)b\" 1;", "T:1:|regular expression|^ or $ inside");
    refused("\"(a|\\b)*\" 1;", "T:1:|regular expression|bounds of words");
    refused("\"a|\" 1;", "T:1:|regular expression|an alternative is empty");
    reads("\"[*+?)|][[:alpha:]|)]+(a|b)+.*c+\" 1; \"a[*+?^$*+?*+?*+?*+?]\\|\" 2;",
          "\"[*+?)|][[:alpha:]|)]+(a|b)+.*c+\" 1; \"a[*+?^$*+?*+?*+?*+?]\\|\" 2; ");
    refused("\"(a)\\1\" 1;", "T:1:|regular expression|back references");
    struct dict *d;
    const double *v;
    int n;
    ok(dict_from_text("T", "\na 1000000{(0 0 0)};", &d));
    says(dict_vectors(d, "a", &n, &v), "T:2:|1000000|at most 10000");
    dict_free(d);
}

static void test_missing_semicolon(void **state) {
    (void)state;
    refused("\nk 5\nend 1;", "T:2:|missing ';'|'k'|Line 3|'end'");
    refused("\nk 5\nsub { a 1; }", "T:2:|missing ';'|'k'");
    reads("k Gauss multi\n{\n a b;\n c d;\n};\nl 1;", "k Gauss multi { a b; c d; }; l 1; ");
    refused("\nk 5\n\"re.*\" 1;", "T:2:|missing ';'|'k'");
    refused("d\n{\n  x 1\n}", "T:3:|missing ';'|'x'|'}'");
    refused("a 1;\nk 5", "T:2:|missing ';'|'k'|ends");
    refused("k 5\n#include \"f\"", "T:1:|missing ';'");
    reads("k\n(\n a\n b\n);\nj Gauss\n  linear;\n", "k (a b); j Gauss linear; ");
    reads("nu [0 2 -1 0 0 0 0]\n 1e-5;", "nu [0 2 -1 0 0 0 0] 1e-5; ");
}

static void test_brackets(void **state) {
    (void)state;
    refused("a 1;\nd\n{\n b 1;\n", "T:3:|'{' of 'd'|not closed");
    refused("a 1;\n}", "T:2:|'}'");
    refused("a\n(1 2\n;\nb 1;", "T:3:|'('|line 2");
    refused("a\n(1 2;", "T:2:|'('|line 2");
    refused("a (1 [2);", "T:1:|'['");
    refused("a 1);", "T:1:|')'");
    refused("a (", "T:1:|ends|'('");
    refused("1 2;", "T:1:|'1'|keyword");
    refused("a 'x';", "T:1:|double quotes");
    reads("sets ( a { type uniform; } b { n 3; } );", "sets { a { type uniform; } b { n 3; } } ");
    char deep[1000] = "";
    for (int i = 0; i < 100; i++) strcat(deep, "a {");
    refused(deep, "T:1:|deeper");
    memset(deep, '(', 200);
    memcpy(deep, "a ", 2);
    refused(deep, "deeper");
}

static void test_patterns(void **state) {
    (void)state;
    struct dict *d = parse("\"(bottom|top)\" 1; \"t.*\" 2; top 3; \"re.*\" 4; \"re.x\" 5; plain 6;");
    static const struct {
        const char *key;
        double value;
    } found[] = {{"bottom", 1}, {"top", 3}, {"tip", 2}, {"rest", 4}, {"rexx", 5}, {"rexy", 4}, {"plain", 6}};
    for (size_t i = 0; i < sizeof found / sizeof *found; i++) {
        double v;
        ok(dict_number(d, found[i].key, NULL, &v));
        assert_true(v == found[i].value);
    }
    assert_false(dict_has(d, "at")); /* the whole key must match */
    dict_free(d);
    refused("\n\"(a\" 1;", "T:2:|regular expression");
}

static void test_numbers(void **state) {
    (void)state;
    static const signed char viscosity[3] = {0, 2, -1};
    struct dict *d = parse("a 1.5; b [0 2 -1 0 0 0 0] 2; c c [0 2 -1 0 0 0 0] 3; d\n[0 2 -2 0 0 0 0] 4;\n"
                           "e 0x10; f 1d3; g nan; h inf; i 1 2; j -5; k 2.5; l { } m [0 2 -1] 1; n;");
    double v;
    long n;
    ok(dict_number(d, "a", viscosity, &v));
    assert_true(v == 1.5);
    ok(dict_number(d, "b", viscosity, &v));
    assert_true(v == 2);
    ok(dict_number(d, "c", viscosity, &v));
    assert_true(v == 3);
    says(dict_number(d, "d", viscosity, &v), "T:1:|'d' is [0 2 -2 0 0 0 0] 4|[0 2 -1 0 0 0 0]");
    ok(dict_number(d, "d", NULL, &v));
    says(dict_number(d, "e", NULL, &v), "T:3:|0x10|number");
    says(dict_number(d, "f", NULL, &v), "T:3:|1d3|number");
    says(dict_number(d, "g", NULL, &v), "T:3:|nan|number");
    says(dict_number(d, "h", NULL, &v), "T:3:|inf|number");
    says(dict_number(d, "i", NULL, &v), "T:3:|1 2|one number");
    says(dict_number(d, "l", NULL, &v), "T:3:|'l'|not a dictionary");
    says(dict_number(d, "m", NULL, &v), "T:3:|5 or 7");
    says(dict_number(d, "n", NULL, &v), "T:3:|empty|number");
    says(dict_number(d, "zz", NULL, &v), "T:1:|'zz' is missing");
    ok(dict_count_or(d, "j", 0, &n));
    assert_int_equal(n, -5);
    ok(dict_count_or(d, "absent", 7, &n));
    assert_int_equal(n, 7);
    says(dict_count_or(d, "k", 0, &n), "T:3:|2.5|whole");
    ok(dict_number_or(d, "absent", NULL, 0.25, &v));
    assert_true(v == 0.25);
    dict_free(d);
}

static void test_words_and_lists(void **state) {
    (void)state;
    struct dict *d = parse("a on; b f; c maybe; d word; e \"a string\"; f (aa bb \"c d\"); g 3(4 5 6); h 10{0.5};\n"
                           "i 3(1 2); j ((1 2 3)(4 5 6)); k (1 2 3); l [1 -3 0 0 0 0 0]; m (1, 2); n 2{(1 2 3)};\n"
                           "div(rho*U,T) Gauss linear; o a b; p (a (b)); q [0 1 -1 0 0 0 0] (1 0 0); r 2(x y);");
    bool s;
    const char *w;
    int n;
    const double *v;
    const char *const *words;
    double vector[3];
    signed char dimensions[7];
    ok(dict_switch_or(d, "a", false, &s));
    assert_true(s);
    ok(dict_switch_or(d, "b", true, &s));
    assert_false(s);
    ok(dict_switch_or(d, "absent", true, &s));
    assert_true(s);
    says(dict_switch_or(d, "c", true, &s), "T:1:|maybe|on yes true");
    ok(dict_word(d, "d", &w));
    assert_string_equal(w, "word");
    ok(dict_word(d, "e", &w));
    assert_string_equal(w, "a string");
    ok(dict_words(d, "f", &n, &words));
    assert_int_equal(n, 3);
    assert_string_equal(words[2], "c d");
    ok(dict_words(d, "d", &n, &words));
    assert_int_equal(n, 1);
    ok(dict_words(d, "r", &n, &words));
    assert_int_equal(n, 2);
    ok(dict_numbers(d, "g", &n, &v));
    assert_true(n == 3 && v[0] == 4 && v[2] == 6);
    ok(dict_numbers(d, "h", &n, &v));
    assert_true(n == 10 && v[0] == 0.5 && v[9] == 0.5);
    says(dict_numbers(d, "i", &n, &v), "T:2:|3 entries|has 2");
    ok(dict_vectors(d, "j", &n, &v));
    assert_true(n == 2 && v[0] == 1 && v[5] == 6);
    ok(dict_vectors(d, "n", &n, &v));
    assert_true(n == 2 && v[5] == 3);
    ok(dict_vector(d, "k", NULL, vector));
    assert_true(vector[0] == 1 && vector[2] == 3);
    ok(dict_vector(d, "q", (const signed char[]){0, 1, -1}, vector));
    says(dict_vector(d, "q", (const signed char[]){0, 1, -2}, vector), "T:3:|dimensions");
    ok(dict_dimensions(d, "l", dimensions));
    assert_true(dimensions[0] == 1 && dimensions[1] == -3 && dimensions[6] == 0);
    says(dict_numbers(d, "m", &n, &v), "T:2:|list of numbers");
    assert_true(dict_has(d, "div(rho*U,T)"));
    says(dict_word(d, "o", &w), "T:3:|a b|missing ';'");
    says(dict_words(d, "p", &n, &words), "T:3:|words");
    static const char *const names[] = {"word", "work", "wall"};
    int index;
    ok(dict_choice(d, "d", names, 3, &index));
    assert_int_equal(index, 0);
    says(dict_choice(d, "c", names, 3, &index), "T:1:|maybe|word, work, wall");
    says(dict_choice(d, "absent", names, 3, &index), "'absent' is missing|word, work, wall");
    static const char *const near[] = {"strong", "words"};
    says(dict_choice(d, "d", near, 2, &index), "did you mean 'words'");
    assert_int_equal(name_distance("SSPRK34", "SSPRK43"), 1);
    assert_int_equal(name_distance("endTmie", "endTime"), 1);
    assert_int_equal(name_distance("ca", "abc"), 3);
    static const char *const two[] = {"SSPRK2", "SSPRK3", "SSPRK43"};
    char meant[MEANT];
    assert_string_equal(name_question("SSPRK34", two, 3, meant), "; did you mean 'SSPRK3' or 'SSPRK43'?");
    assert_string_equal(name_question("SSPRK", two, 3, meant), "; did you mean 'SSPRK2' or 'SSPRK3'?");
    assert_string_equal(name_question("nothing", two, 3, meant), "");
    dict_free(d);
}

/* Functions of time: constants are one row; rows of a table are a time and the components of a value. */
static void test_functions(void **state) {
    (void)state;
    struct dict *d =
        parse("a 5; b constant 5; c table ((0 1) (2 -3e1)); d (1 2 3); e constant (1 2 3);\n"
              "f table 2((0 (1 2 3)) (1 (4 5 6))); g table ((0 1) (0 2)); h sine; i constant; j table ((0 (1 2)));\n"
              "k table (0 1); l table 3((0 1)); m { x 1; } n 5 6; o table ((0 1)); p table;");
    int n;
    const double *v;
    for (int i = 0; i < 2; i++) {
        ok(dict_function(d, i ? "b" : "a", 1, &n, &v));
        assert_true(n == 1 && v[0] == 0 && v[1] == 5);
        ok(dict_function(d, i ? "e" : "d", 3, &n, &v));
        assert_true(n == 1 && v[0] == 0 && v[1] == 1 && v[3] == 3);
    }
    ok(dict_function(d, "c", 1, &n, &v));
    assert_true(n == 2 && v[0] == 0 && v[1] == 1 && v[2] == 2 && v[3] == -30);
    ok(dict_function(d, "f", 3, &n, &v));
    assert_true(n == 2 && v[3] == 3 && v[4] == 1 && v[7] == 6);
    ok(dict_function(d, "o", 1, &n, &v));
    assert_true(n == 1 && v[1] == 1);
    says(dict_function(d, "g", 1, &n, &v), "T:2:|its times must rise: 0 follows 0");
    static const char *const wrong[] = {"d", "h", "i", "j", "k", "m", "n", "p"};
    for (int i = 0; i < 8; i++) says(dict_function(d, wrong[i], 1, &n, &v), "T:|table ((t v) (t v) ...)");
    says(dict_function(d, "l", 1, &n, &v), "T:3:|says 3 entries, but has 1");
    says(dict_function(d, "a", 3, &n, &v), "T:1:|(x y z)");
    says(dict_function(d, "c", 3, &n, &v), "T:1:|table ((t (x y z)) (t (x y z)) ...)");
    says(dict_function(d, "q", 1, &n, &v), "'q' is missing");
    dict_free(d);
}

static void test_unused(void **state) {
    (void)state;
    struct dict *d = parse("maxC0 0.2;\nsub { a 1;\n b 2; }\nother { x 1; }"), *sub;
    double v;
    says(dict_number(d, "maxCo", NULL, &v), "'maxCo' is missing|this line has 'maxC0'");
    says(dict_check_used(d), "T:1:|'maxC0' is not used; did you mean 'maxCo'?");
    assert_true(dict_has(d, "maxC0"));
    says(dict_check_used(d), "T:2:|'sub' is not used");
    ok(dict_sub(d, "sub", &sub));
    ok(dict_number(sub, "a", NULL, &v));
    says(dict_check_used(d), "T:3:|'b' is not used|known here: a");
    says(dict_sub(sub, "zz", &sub), "dictionary 'zz' is missing in 'sub'");
    ok(dict_sub_optional(d, "none", &sub));
    assert_null(sub);
    dict_mark_used(d);
    ok(dict_check_used(d));
    says(dict_sub(d, "maxC0", &sub), "T:1:|expected a dictionary");
    assert_int_equal(dict_count(d), 3);
    assert_string_equal(dict_key(d, 1), "sub");
    assert_int_equal(dict_line(d, "other"), 4);
    dict_free(d);
}

/* A key that the program does not ask for may be a variable of the user's own: it counts as used if a macro behind it
 * names it, also inside #eval and by its way through dictionaries; else, or with a value that comes too late, not. */
static void test_own_variables(void **state) {
    (void)state;
    static const char *const fine[] = {
        "cfl 0.5; a $cfl;",
        "cfl 0.5; a #eval{ 2*$cfl };",
        "cfl 0.5; b ${cfl}; a $b;",
        "my { cfl 0.5; } a $my.cfl;",
        "my { deep { cfl 0.5; } } a $:my.deep.cfl;",
        "cfl 0.5; s { x $cfl; } a 1;",
        "my { x 1; } s { $my; } a 1;",
        "my { x 1; } s $my; a 1;",
    };
    static const char *const wrong[][2] = {
        {"cfl 0.5; a 1;", "T:1:|'cfl' is not used"},
        {"cfl 0.5;\na $cfl;\ncfl 0.7;", "T:3:|'cfl' is not used"},
        {"my { cfl 0.5;\nother 1; } a $my.cfl;", "T:2:|'other' is not used"},
        {"my { cfl 0.5; } s { x 1; cfl 1; } a $my.cfl;", "'cfl' is not used"},
        {"my { x 1; y 2; } s { $my; } a 1;", "'y' is not used"},
        {"cfl $cfl0; a 1;", "names no entry"},
    };
    struct dict *d, *s;
    double v;
    for (size_t i = 0; i < sizeof fine / sizeof *fine + sizeof wrong / sizeof *wrong; i++) {
        const size_t w = i - sizeof fine / sizeof *fine;
        const char *text = i < sizeof fine / sizeof *fine ? fine[i] : wrong[w][0];
        status e = dict_from_text("T", text, &d);
        if (!e) e = dict_number(d, "a", NULL, &v);
        if (!e) e = dict_sub_optional(d, "s", &s);
        if (!e && s) e = dict_number(s, "x", NULL, &v);
        if (!e || i < sizeof fine / sizeof *fine) ok(e);
        if (!e) e = dict_check_used(d);
        if (i < sizeof fine / sizeof *fine)
            ok(e);
        else
            says(e, wrong[w][1]);
        dict_free(d);
    }
}

/* ---- files ---- */

struct folder {
    char path[64], *files[32];
    int count;
};
static const char *const folders[] = {"system", "0.orig"};
static int set_up(void **state) {
    struct folder *f = calloc(1, sizeof *f);
    char name[128];
    strcpy(f->path, "/tmp/haff_dict_XXXXXX");
    if (!mkdtemp(f->path)) return -1;
    snprintf(name, sizeof name, "%s/case", f->path);
    mkdir(name, 0777);
    for (int i = 0; i < 2; i++) {
        snprintf(name, sizeof name, "%s/case/%s", f->path, folders[i]);
        mkdir(name, 0777);
    }
    *state = f;
    return 0;
}
static int tear_down(void **state) {
    struct folder *f = *state;
    char name[128];
    for (int i = 0; i < f->count; i++) unlink(f->files[i]), free(f->files[i]);
    for (int i = 0; i < 2; i++) {
        snprintf(name, sizeof name, "%s/case/%s", f->path, folders[i]);
        rmdir(name);
    }
    snprintf(name, sizeof name, "%s/case", f->path);
    rmdir(name);
    int left = rmdir(f->path);
    free(f);
    return left;
}
static const char *put(struct folder *f, const char *name, const char *text) {
    char path[256];
    snprintf(path, sizeof path, "%s/case/%s", f->path, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    fclose(file);
    return f->files[f->count++] = strdup(path);
}
static void refused_file(const char *path, const char *parts) {
    struct dict *d;
    says(dict_read(path, &d), parts);
    assert_null(d);
}

/* An error that shows none of what stands in a file outside of the case. */
static void hidden(status s, const char *parts) {
    assert_non_null(s);
    assert_null(strstr(status_text(s), "password"));
    assert_null(strstr(status_text(s), "hunter2"));
    says(s, parts);
}
static void try_hidden(struct dict *d) {
    const char *const names[] = {"one", "two"};
    double v[3];
    int i;
    assert_true(dict_is_foreign(d, "password") && dict_is_foreign(d, "c"));
    hidden(dict_vector(d, "c", NULL, v), "system/i:3:|outside of the case|replace the link by a copy");
    hidden(dict_choice(d, "c", names, 2, &i), "system/i:3:");
}

static void test_include(void **state) {
    struct folder *f = *state;
    put(f, "shared", "FoamFile { version 2; format ascii; class dictionary; object shared; }\nb 2;\nc\n 3 4;\n");
    const char *path = put(f, "system/controlDict",
                           "FoamFile { version 2.0; format ascii; class dictionary; object controlDict; }\na 1;\n"
                           "#include \"../shared\"\n#includeIfPresent \"absent\"\ns { #include \"more\" }\n");
    put(f, "system/more", "x $b;\n");
    struct dict *d, *s;
    double v;
    ok(dict_read(path, &d));
    assert_string_equal(dict_header(d)->object, "controlDict");
    ok(dict_number(d, "b", NULL, &v));
    says(dict_number(d, "c", NULL, &v), "case/shared:3:|3 4");
    ok(dict_sub(d, "s", &s));
    ok(dict_number(s, "x", NULL, &v));
    assert_true(v == 2);
    dict_free(d);
    refused_file(put(f, "system/a", "\n#include \"none\""), "system/a:2:|none|there is no file");
    refused_file(put(f, "system/b", "#includeEtc \"none\""), "system/b:1:|etc");
    refused_file(put(f, "system/c", "#include \"c\""), "system/c:1:|itself");
    put(f, "system/e", "#include \"d\"");
    refused_file(put(f, "system/d", "#include \"e\""), "system/e:1:|itself");
    refused_file(put(f, "system/f", "#include \"/etc/passwd\""), "system/f:1:|relative");
    refused_file(put(f, "system/g", "#include \"../../x\""), "system/g:1:|leads out of the case");
    refused_file(put(f, "system/h", "#include \"$HOME/x\""), "system/h:1:|$FOAM_CASE");
    path =
        put(f, "0.orig/U", "#include \"../shared\"\n#include \"$FOAM_CASE/system/more\"\n#include \"<case>/shared\"");
    ok(dict_read(path, &d));
    dict_free(d);
    put(f, "system/points", "type probes;");
    ok(dict_read(put(f, "system/q", "f { #includeFunc points\n y 1; }"), &d));
    assert_null(dict_passed(d, 0));
    char *printed = dict_print(d);
    assert_non_null(strstr(printed, "points {\n        type probes;"));
    free(printed);
    dict_free(d);
    refused_file(put(f, "top", "#include \"../x\""), "top:1:|leads out of the case");
    put(f, "../secret", "password 1;");
    char link[128];
    snprintf(link, sizeof link, "%s/case/system/link", f->path);
    assert_int_equal(symlink("../../secret", link), 0);
    f->files[f->count++] = strdup(link);
    path = put(f, "system/i", "\n#include \"link\"\nc $password;");
    ok(dict_read(path, &d)); /* reading through links is allowed */
    ok(dict_number(d, "password", NULL, &v));
    assert_true(v == 1);
    try_hidden(d);
    dict_free(d);
    put(f, "../secret", "password hunter2");
    hidden(dict_read(path, &d), "system/link:1:");
    put(f, "../secret", "password hunter2;");
    hidden(dict_read(put(f, "system/j", "#include \"link\"\n#if $password\n#endif"), &d), "system/j:2:");
    hidden(dict_read(put(f, "system/k", "#include \"link\"\na #eval{ $password };"), &d), "system/k:2:");
}

static void test_raw(void **state) {
    struct folder *f = *state;
    char path[128];
    snprintf(path, sizeof path, "%s/case/T", f->path);
    double values[6] = {1, 2, 3, 4, 5, 6};
    for (int way = 0; way < 4; way++) {
        struct foam_format format = {.binary = way & 1, .compress = way & 2, .precision = 17};
        struct sink *sink;
        ok(sink_open(path, format.compress, &sink));
        foam_header_write(sink, &format, "volVectorField", "0", "U", NULL);
        sink_printf(sink, "dimensions [0 1 -1 0 0 0 0];\ninternalField nonuniform List<vector>\n");
        foam_list_write_doubles(sink, &format, 3, 2, values);
        sink_printf(sink, ";\nboundaryField { a { type x; value uniform (1 2\n3); b $internalField; } }\n");
        sink_printf(sink, "e nonuniform List<scalar> ");
        foam_list_write_doubles(sink, &format, 1, 0, values);
        sink_printf(sink, ";\n");
        ok(sink_close(sink));
        struct dict *d, *patches, *a;
        struct lexer l;
        struct token t;
        long n;
        double *v, x;
        ok(dict_read(path, &d));
        ok(dict_sub(d, "boundaryField", &patches));
        ok(dict_sub(patches, "a", &a));
        for (int again = 0; again < 2; again++) { /* the list itself, and through a macro */
            if (again)
                ok(dict_raw(a, "b", &l));
            else
                ok(dict_raw(d, "internalField", &l));
            ok(lexer_next(&l, &t));
            assert_true(token_is(&t, "nonuniform"));
            ok(lexer_next(&l, &t));
            assert_true(token_is(&t, "List<vector>"));
            ok(foam_list_read_doubles(&l, dict_header(d), 3, 1000, &n, &v));
            assert_int_equal(n, 2);
            assert_memory_equal(v, values, sizeof values);
            free(v);
            ok(lexer_expect(&l, ';'));
        }
        says(dict_number(d, "internalField", NULL, &x), "large list");
        ok(dict_raw(a, "value", &l));
        ok(lexer_next(&l, &t));
        assert_true(token_is(&t, "uniform") && t.line == dict_line(a, "value"));
        ok(foam_list_read_doubles(&l, &(struct foam_header){0}, 1, 1000, &n, &v));
        assert_int_equal(n, 3);
        free(v);
        ok(lexer_expect(&l, ';'));
        dict_free(d);
    }
    f->files[f->count++] = strdup(path);
    strcat(path, ".gz");
    f->files[f->count++] = strdup(path);
}

static void test_missing_file(void **state) {
    (void)state;
    refused_file("/nowhere/controlDict", "/nowhere/controlDict|No such file");
}

/* OpenFOAM's lists of dictionaries are read as dictionaries. */
static void test_named_lists(void **state) {
    (void)state;
    reads("sets ( a { x 1; } b { x 2; } ); y 3;", "sets { a { x 1; } b { x 2; } } y 3; ");
    reads("v ( a b ); w ( { } );", "v (a b); w ({ }); ");
    refused("sets ( a { x 1; } b { x 2; }\ny 3;", "T:1|'(' of 'sets' is not closed");
    refused("sets ( a { x 1; } )\ny 3;", "T:1|missing ';'");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_macros),
        cmocka_unit_test(test_passed),
        cmocka_unit_test(test_merge),
        cmocka_unit_test(test_conditions),
        cmocka_unit_test(test_eval),
        cmocka_unit_test(test_byte_order),
        cmocka_unit_test(test_bombs),
        cmocka_unit_test(test_missing_semicolon),
        cmocka_unit_test(test_brackets),
        cmocka_unit_test(test_patterns),
        cmocka_unit_test(test_numbers),
        cmocka_unit_test(test_words_and_lists),
        cmocka_unit_test(test_functions),
        cmocka_unit_test(test_unused),
        cmocka_unit_test(test_own_variables),
        cmocka_unit_test(test_named_lists),
        cmocka_unit_test_setup_teardown(test_include, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_raw, set_up, tear_down),
        cmocka_unit_test(test_missing_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
