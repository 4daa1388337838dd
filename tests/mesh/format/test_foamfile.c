/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mesh/format/foamfile.h"
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tests/checks.h" /* last */

static struct source *text_source(const char *text) {
    struct source *s = NULL;
    ok(source_from_text("T", text, &s));
    return s;
}

/* "kind:text " of every token; kinds w s n p v, '!' before the first of a line. */
static void tokens(const char *text, const char *expected) {
    char got[1024] = "";
    struct source *s = text_source(text);
    struct lexer l = lexer_start(s);
    struct token t;
    for (;;) {
        ok(lexer_next(&l, &t));
        if (t.kind == TOKEN_END) break;
        size_t n = strlen(got);
        snprintf(got + n, sizeof got - n, "%s%c:%.*s ", t.first_on_line ? "!" : "", "ewsnpv"[t.kind], t.length, t.text);
    }
    assert_string_equal(got, expected);
    source_free(s);
}

static void test_tokens(void **state) {
    (void)state;
    tokens("a 1;", "!w:a n:1 p:; ");
    tokens("div(rho*U,T) Gauss linear;", "!w:div(rho*U,T) w:Gauss w:linear p:; ");
    tokens("4(0 5 6 1) 10{0.5}", "!n:4 p:( n:0 n:5 n:6 n:1 p:) n:10 p:{ n:0.5 p:} ");
    tokens("(aa bb \"c d\")", "!p:( w:aa w:bb s:c d p:) ");
    tokens("[0 2 -2 0]", "!p:[ n:0 n:2 n:-2 n:0 p:] ");
    tokens("a // b\n /* c\n d */ e\n$:x.y ${z} $..w;", "!w:a !w:e !w:$:x.y w:${z} w:$..w p:; ");
    tokens("#calc #{ a;\n } #} #eval{ 1 }", "!w:#calc v: a;\n }  w:#eval p:{ n:1 p:} ");
    tokens("0x10 1d3 nan inf 1e3 -.5 +2. 1e 2D -", "!w:0x10 w:1d3 w:nan w:inf n:1e3 n:-.5 n:+2. w:1e w:2D w:- ");
    tokens("\"a \\\" b\" 1//c\n2/*d*/3", "!s:a \\\" b n:1 !n:2 n:3 ");
    tokens("\xEF\xBB\xBFk 1;", "!w:k n:1 p:; ");
}

static void test_token_errors(void **state) {
    (void)state;
    static const char *const cases[][2] = {
        {"a\n/* b", "T:2:|not closed"}, {"\n\n\"abc\nd\"", "T:3:|string"},
        {"\na(b c", "T:2:|open '('"},   {"\n${a\n}", "T:2:|${"},
        {"x #{ y", "T:1:|#}"},          {"\n1e999", "T:2:|1e999|out of range"},
        {"a \x01", "T:1:|0x01"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct source *s = text_source(cases[i][0]);
        struct lexer l = lexer_start(s);
        struct token t = {.kind = TOKEN_WORD};
        status e = OK;
        while (!e && t.kind != TOKEN_END) e = lexer_next(&l, &t);
        says(e, cases[i][1]);
        source_free(s);
    }
}

static void test_numbers_are_strtod(void **state) {
    (void)state;
    static const char *const hard[] = {"9007199254740993",
                                       "1e22",
                                       "1e23",
                                       "4.9e-324",
                                       "2.2250738585072011e-308",
                                       "0.1",
                                       "123456789012345678901234567890",
                                       "1.7976931348623157e308",
                                       "-0",
                                       "0.000000000000000000000000000000000000001",
                                       "1e-400"};
    for (size_t i = 0; i < sizeof hard / sizeof *hard; i++) {
        double v = 0, reference = strtod(hard[i], NULL);
        assert_non_null(foam_number(hard[i], &v));
        assert_memory_equal(&v, &reference, sizeof v);
    }
    uint64_t seed = 1;
    for (int i = 0; i < 20000; i++) {
        char text[64];
        double v = 0, reference;
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        memcpy(&reference, &seed, sizeof v);
        if (!isfinite(reference)) continue;
        snprintf(text, sizeof text, "%.*g", 3 + i % 15, reference);
        reference = strtod(text, NULL);
        assert_non_null(foam_number(text, &v));
        assert_memory_equal(&v, &reference, sizeof v);
    }
}

static void test_header(void **state) {
    (void)state;
    struct source *s =
        text_source("/* banner */ FoamFile\n{ version 2; format binary; arch \"LSB;label=64;scalar=32\";\n"
                    "class faceList; note \"n: 1\"; location \"a/b\"; object faces; }\n k");
    struct lexer l = lexer_start(s);
    struct foam_header h;
    ok(foam_header_read(&l, &h));
    assert_true(h.present && h.binary);
    assert_int_equal(h.label_bytes, 8);
    assert_int_equal(h.scalar_bytes, 4);
    assert_string_equal(h.class_name, "faceList");
    assert_string_equal(h.note, "n: 1");
    assert_string_equal(h.location, "a/b");
    assert_string_equal(h.object, "faces");
    struct token t;
    ok(lexer_next(&l, &t));
    assert_true(token_is(&t, "k") && t.line == 4);
    source_free(s);

    s = text_source("k 1;");
    l = lexer_start(s);
    ok(foam_header_read(&l, &h));
    assert_true(!h.present && !h.binary && h.label_bytes == 4 && h.scalar_bytes == 8 && l.position == 0);
    source_free(s);

    static const char *const bad[][2] = {{"FoamFile {\n format text; }", "T:2:|text|ascii or binary"},
                                         {"FoamFile {\n arch \"MSB;\"; }", "T:2:|little-endian"},
                                         {"FoamFile {\n class a b; }", "T:2:|'b'|';'"},
                                         {"FoamFile {\n class a;", "T:2:|ends"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        s = text_source(bad[i][0]);
        l = lexer_start(s);
        says(foam_header_read(&l, &h), bad[i][1]);
        source_free(s);
    }
}

static const struct foam_header ascii = {.label_bytes = 4, .scalar_bytes = 8};

static void reads_as_strtod(const char *text) {
    double v = 0, reference = strtod(text, NULL);
    assert_non_null(foam_number(text, &v));
    assert_memory_equal(&v, &reference, sizeof v);
}

/* Numbers of any length as meshes hold them, and such that lie half way between two doubles or next to that. */
static void test_mesh_numbers_are_strtod(void **state) {
    (void)state;
    uint64_t seed = 7;
    for (int i = 0; i < 200000; i++) {
        char text[64];
        seed = seed * 6364136223846793005u + 1442695040888963407u;
        const uint64_t m = seed >> (i % 60), half = (seed >> 11 | UINT64_C(1) << 52) << 1 | 1;
        const int exponent = (int)(seed % 67) - 33;
        snprintf(text, sizeof text, "%llue%d", (unsigned long long)m, exponent);
        reads_as_strtod(text);
        snprintf(text, sizeof text, "-%llu.%016llue%d", (unsigned long long)(m % 1000), (unsigned long long)half,
                 exponent);
        reads_as_strtod(text);
        for (int off = -1; off <= 1; off++) {
            snprintf(text, sizeof text, "%llu", (unsigned long long)((half << i % 10) + (uint64_t)off));
            reads_as_strtod(text);
            snprintf(text, sizeof text, "%llue-1", (unsigned long long)(half * 5 + (uint64_t)off));
            reads_as_strtod(text);
        }
        snprintf(text, sizeof text, "%.17g", (double)half * (i % 2 ? 0x1p-60 : 0x1p-90));
        reads_as_strtod(text);
    }
}

static void doubles(const char *text, int components, long expected, double first, double last) {
    struct source *s = text_source(text);
    struct lexer l = lexer_start(s);
    long n;
    double *v;
    ok(foam_list_read_doubles(&l, &ascii, components, 1000, &n, &v));
    assert_int_equal(n, expected);
    if (n) assert_true(v[0] == first && v[n * components - 1] == last);
    struct token t;
    ok(lexer_next(&l, &t));
    assert_true(token_is(&t, ";"));
    struct lexer skipped = lexer_start(s);
    ok(foam_list_skip(&skipped, &ascii, 8 * components));
    ok(lexer_next(&skipped, &t));
    assert_true(token_is(&t, ";"));
    assert_int_equal(skipped.line, l.line);
    free(v);
    source_free(s);
}

static void test_ascii_lists(void **state) {
    (void)state;
    doubles("3(4 5 6);", 1, 3, 4, 6);
    doubles("10{0.5};", 1, 10, 0.5, 0.5);
    doubles("2{(1 2 3)};", 3, 2, 1, 3);
    doubles("(1 2 3 4) ;", 1, 4, 1, 4);
    doubles("0();", 1, 0, 0, 0);
    doubles("2 // two\n(\n(1 2 3) // )\n/* )\n */ (4 5 6)\n)\n;", 3, 2, 1, 6);
    doubles("1((1 2 3 4 5 6));", 6, 1, 1, 6);
}

/* Entries that are read in one pass stand beside others, which the lexer reads. */
static void test_mixed_lists(void **state) {
    (void)state;
    doubles("6\n(\n1 2 // two\n3e0 +4\n5\t6)\n;", 1, 6, 1, 6);
    doubles("3((1 2 3)\n(4 5  6)(7 8 /* 9 */ 9));", 3, 3, 1, 9);
    struct source *s = text_source("6(0 1 /* */ -2 3.0\n4 1234567890)\n4(3(0 1 2) 4(3 4 5 6)\n3( 7 8 9)3(1 2 3));");
    struct lexer l = lexer_start(s);
    static const int expected[] = {0, 1, -2, 3, 4, 1234567890}, corners[] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2, 3};
    int *v, *start;
    long n;
    ok(foam_list_read_labels(&l, &ascii, 0, &n, &v));
    assert_int_equal(n, 6);
    assert_memory_equal(v, expected, sizeof expected);
    free(v);
    ok(foam_list_read_faces(&l, &ascii, &n, &start, &v));
    assert_int_equal(n, 4);
    assert_int_equal(start[2], 7);
    assert_int_equal(start[4], 13);
    assert_memory_equal(v, corners, sizeof corners);
    assert_int_equal(l.line, 4);
    free(start);
    free(v);
    source_free(s);
}

static void test_list_errors(void **state) {
    (void)state;
    static const struct {
        int components;
        const char *text, *error;
    } bad[] = {{1, "\n3(1 2)", "T:2:|3 entries|has 2"},
               {1, "2\n(\n1\n2\n3)", "T:5:|line 1|2 entries|more"},
               {1, "2(\n1\nnan)", "T:3:|nan|number"},
               {1, "2(1\ninf)", "T:2:|inf"},
               {1, "2(1\n1e999)", "T:2:|1e999|range"},
               {1, "2(1\n0x10)", "T:2:|0x10"},
               {1, "2(1,2)", "T:1:|','"},
               {1, "1000000000000(1)", "T:1:|count"},
               {1, "\n1001{1}", "T:2:|1001 equal entries|at most 1000"},
               {1, "2000000000(1)", "T:1:|2000000000 entries|has 1"},
               {1, "-1(1)", "T:1:|negative"},
               {1, "1.5(1)", "T:1:|count"},
               {1, "\n(1 2", "T:2:|ends|line 2"},
               {1, "word", "T:1:|word|list"},
               {3, "1(\n(1 2))", "T:2:|')'"},
               {3, "1(\n(1 2 3 4))", "T:2:|4|')'"}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        struct source *s = text_source(bad[i].text);
        struct lexer l = lexer_start(s);
        long n;
        double *v;
        says(foam_list_read_doubles(&l, &ascii, bad[i].components, 1000, &n, &v), bad[i].error);
        assert_null(v);
        source_free(s);
    }
    struct source *s = text_source("3(1\n2.5 3)");
    struct lexer l = lexer_start(s);
    long n;
    int *v;
    says(foam_list_read_labels(&l, &ascii, 1000, &n, &v), "T:2:|2.5|whole");
    source_free(s);
    s = text_source("1(3000000000)");
    l = lexer_start(s);
    says(foam_list_read_labels(&l, &ascii, 1000, &n, &v), "T:1:|3000000000|at most");
    source_free(s);
}

struct folder {
    char path[64], file[80];
};
static int set_up(void **state) {
    struct folder *f = calloc(1, sizeof *f);
    strcpy(f->path, "/tmp/haff_foamfile_XXXXXX");
    if (!mkdtemp(f->path)) return -1;
    snprintf(f->file, sizeof f->file, "%s/list", f->path);
    *state = f;
    return 0;
}
static int tear_down(void **state) {
    struct folder *f = *state;
    char name[100];
    static const char *const endings[] = {"", ".gz", ".tmp", ".gz.tmp"};
    for (int i = 0; i < 4; i++) {
        snprintf(name, sizeof name, "%s%s", f->file, endings[i]);
        unlink(name);
    }
    int left = rmdir(f->path);
    free(f);
    return left;
}

struct lists {
    long n;
    double *v;            /* [3n] */
    int *labels;          /* [n] */
    int *start, *corners; /* [n + 1], [start[n]] */
};

/* Values that show a lost digit, a lost sign of zero, bytes that look like text. */
static struct lists lists_make(long n) {
    struct lists a = {n, calloc((size_t)(3 * n + 1), sizeof(double)), calloc((size_t)(n + 1), sizeof(int)),
                      calloc((size_t)n + 1, sizeof(int)), calloc((size_t)(5 * n + 1), sizeof(int))};
    for (long i = 0; i < 3 * n; i++) a.v[i] = (i % 2 ? -1.0 : 1.0) / (double)(i + 3) * pow(10, (double)(i % 40) - 20);
    if (n) a.v[0] = -0.0;
    for (long i = 0; i < n; i++) a.labels[i] = (int)(i * 7919 % 100003) - 10;
    for (long i = 0; i < n; i++) a.start[i + 1] = a.start[i] + 3 + (int)(i % 3);
    for (long i = 0; i < a.start[n]; i++) a.corners[i] = (int)(i * 31 % 1009);
    return a;
}

static void lists_write(const char *path, struct foam_format format, const struct lists *a) {
    struct sink *s;
    ok(sink_open(path, format.compress, &s));
    foam_header_write(s, &format, format.binary ? "faceCompactList" : "faceList", "constant/polyMesh", "x", "n:1");
    foam_list_write_doubles(s, &format, 1, a->n, a->v);
    foam_list_write_doubles(s, &format, 3, a->n, a->v);
    foam_list_write_labels(s, &format, a->n, a->labels);
    foam_list_write_faces(s, &format, a->n, a->start, a->corners);
    sink_printf(s, "end\n");
    ok(sink_close(s));
}

static void doubles_equal(struct lexer *l, const struct foam_header *h, int components, const struct lists *a) {
    long n;
    double *v;
    ok(foam_list_read_doubles(l, h, components, 1000, &n, &v));
    assert_int_equal(n, a->n);
    assert_memory_equal(v, a->v, sizeof *v * (size_t)(n * components));
    free(v);
}

static void lists_compare(const char *path, struct foam_format format, const struct lists *a) {
    struct source *s;
    struct foam_header h;
    struct token t;
    long n;
    int *labels, *start, *corners;
    ok(source_open(path, &s));
    struct lexer l = lexer_start(s), skip;
    ok(foam_header_read(&l, &h));
    assert_int_equal(h.binary, format.binary);
    assert_string_equal(h.location, "constant/polyMesh");
    skip = l;
    doubles_equal(&l, &h, 1, a);
    doubles_equal(&l, &h, 3, a);
    ok(foam_list_read_labels(&l, &h, 1000, &n, &labels));
    assert_int_equal(n, a->n);
    assert_memory_equal(labels, a->labels, sizeof(int) * (size_t)n);
    ok(foam_list_skip(&skip, &h, 8));
    ok(foam_list_skip(&skip, &h, 24));
    ok(foam_list_skip(&skip, &h, 4));
    assert_int_equal(skip.position, l.position);
    assert_int_equal(skip.line, l.line);
    ok(foam_list_read_faces(&l, &h, &n, &start, &corners));
    assert_int_equal(n, a->n);
    assert_memory_equal(start, a->start, sizeof(int) * (size_t)(n + 1));
    assert_memory_equal(corners, a->corners, sizeof(int) * (size_t)start[n]);
    ok(lexer_next(&l, &t));
    assert_true(token_is(&t, "end"));
    free(labels), free(start), free(corners);
    source_free(s);
}

static void test_round_trips(void **state) {
    struct folder *f = *state;
    static const long sizes[] = {0, 1, 2, 5000};
    for (int i = 0; i < 4; i++) {
        struct lists a = lists_make(sizes[i]);
        for (int way = 0; way < 4; way++) {
            struct foam_format format = {.binary = way & 1, .compress = way & 2, .precision = 17};
            lists_write(f->file, format, &a);
            lists_compare(f->file, format, &a);
        }
        free(a.v), free(a.labels), free(a.start), free(a.corners);
    }
}

static void test_compression_replaces(void **state) {
    struct folder *f = *state;
    char zipped[100];
    struct stat info;
    struct sink *s;
    snprintf(zipped, sizeof zipped, "%s.gz", f->file);
    ok(sink_open(f->file, false, &s));
    ok(sink_close(s));
    ok(sink_open(f->file, true, &s));
    sink_printf(s, "new");
    ok(sink_close(s));
    assert_int_equal(stat(f->file, &info), -1);
    struct source *in;
    ok(source_open(f->file, &in));
    assert_string_equal(in->text, "new");
    assert_string_equal(in->path, zipped);
    source_free(in);
    /* a gzip file that was cut */
    ok(sink_open(f->file, true, &s));
    for (int i = 0; i < 20000; i++) sink_printf(s, "%d ", i * 7919 % 10007);
    ok(sink_close(s));
    assert_int_equal(stat(zipped, &info), 0);
    assert_int_equal(truncate(zipped, info.st_size / 2), 0);
    says(source_open(f->file, &in), zipped);
}

static void test_write_failures(void **state) {
    struct folder *f = *state;
    struct sink *s;
    struct stat info;
    char name[100];
    says(sink_open("/nowhere/at/all", false, &s), "/nowhere/at/all|No such file");
    snprintf(name, sizeof name, "%s.tmp", f->file);
    ok(sink_open(f->file, false, &s));
    sink_printf(s, "old");
    ok(sink_close(s));

    struct rlimit was, small;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &was), 0);
    small = (struct rlimit){1000, was.rlim_max};
    signal(SIGXFSZ, SIG_IGN);
    for (int compress = 0; compress < 2; compress++) { /* no room; the old file stays */
        snprintf(name, sizeof name, "%s%s.tmp", f->file, compress ? ".gz" : "");
        ok(sink_open(f->file, compress, &s));
        for (int i = 0; i < 100000; i++) sink_printf(s, "%d\n", i * 7919 % 10007);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
        status e = sink_close(s);
        assert_int_equal(setrlimit(RLIMIT_FSIZE, &was), 0);
        assert_true(e && status_kind(e) == ERR_SYSTEM);
        says(e, "File too large");
        assert_int_equal(lstat(name, &info), -1);
    }
    struct source *in;
    ok(source_open(f->file, &in));
    assert_string_equal(in->text, "old");
    source_free(in);
}

static void test_long_text(void **state) {
    struct folder *f = *state;
    char *text = malloc(200001);
    memset(text, 'x', 200000);
    text[200000] = 0;
    struct sink *s;
    ok(sink_open(f->file, false, &s));
    sink_printf(s, "a%sb", text);
    sink_write(s, text, 200000);
    ok(sink_close(s));
    struct source *in;
    ok(source_open(f->file, &in));
    assert_int_equal(in->size, 400002);
    assert_true(in->text[0] == 'a' && in->text[200001] == 'b');
    source_free(in);
    free(text);
}

static status binary_labels(const char *text, size_t size, const struct foam_header *h, long *n, int **v) {
    struct source s = {.path = "T", .text = (char *)(uintptr_t)text, .size = size};
    struct lexer l = lexer_start(&s);
    return foam_list_read_labels(&l, h, 1000, n, v);
}

static void test_binary_variants(void **state) {
    (void)state;
    struct foam_header wide = {.binary = true, .label_bytes = 8, .scalar_bytes = 4};
    struct foam_header narrow = {.binary = true, .label_bytes = 4, .scalar_bytes = 8};
    long n;
    int *v;
    static const char two[] = "2\n(\x05\0\0\0\0\0\0\0\xff\xff\xff\xff\xff\xff\xff\xff)";
    ok(binary_labels(two, sizeof two - 1, &wide, &n, &v));
    assert_true(n == 2 && v[0] == 5 && v[1] == -1);
    free(v);
    says(binary_labels(two, sizeof two - 1, &narrow, &n, &v), "T:1:|arch");
    static const char large[] = "\n1\n(\0\0\0\0\1\0\0\0)";
    says(binary_labels(large, sizeof large - 1, &wide, &n, &v), "T:2:|4294967296|at most");
    says(binary_labels("2000000000(abc)", 15, &narrow, &n, &v), "T:1:|cut");
    ok(binary_labels("0();", 4, &narrow, &n, &v));
    assert_int_equal(n, 0);
    free(v);

    float f[3] = {1, 0.5f, -2};
    char text[32] = "1\n(";
    memcpy(text + 3, f, sizeof f);
    text[15] = ')';
    struct source s = {.path = "T", .text = text, .size = 16};
    struct lexer l = lexer_start(&s);
    double *d;
    ok(foam_list_read_doubles(&l, &wide, 3, 1000, &n, &d));
    assert_true(n == 1 && d[0] == 1 && d[1] == 0.5 && d[2] == -2);
    free(d);
    f[1] = NAN;
    memcpy(text + 3, f, sizeof f);
    l = lexer_start(&s);
    says(foam_list_read_doubles(&l, &wide, 3, 1000, &n, &d), "T:1:|entry 0|nan|finite");
}

static void test_missing_file(void **state) {
    struct folder *f = *state;
    struct source *s;
    says(source_open(f->file, &s), "list|list.gz|No such file");
    says(source_open(f->path, &s), "is no file");
}

/* A long binary list is left out of the text, which ends with a 0 behind the rest, however long that is. */
static void test_rest_of_a_long_list(void **state) {
    const struct folder *f = *state;
    enum { N = 512, TAILS = 130 };
    for (int tail = 0; tail < TAILS; tail++) {
        double values[N] = {0};
        struct source *s = NULL;
        FILE *file = fopen(f->file, "wb");
        assert_non_null(file);
        fprintf(file, "FoamFile { version 2.0; format binary; class volScalarField; object a; }\n"
                      "internalField nonuniform List<scalar> 512(");
        assert_true(fwrite(values, sizeof *values, N, file) == N);
        fprintf(file, ");%*s", tail, "");
        assert_int_equal(fclose(file), 0);
        ok(source_open(f->file, &s));
        assert_true(s->gap_bytes == sizeof values);
        assert_string_equal(s->text + s->gap + 2 + tail, "");
        assert_true(s->size == s->gap + 2 + (size_t)tail);
        source_free(s);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tokens),
        cmocka_unit_test(test_token_errors),
        cmocka_unit_test(test_numbers_are_strtod),
        cmocka_unit_test(test_mesh_numbers_are_strtod),
        cmocka_unit_test(test_header),
        cmocka_unit_test(test_ascii_lists),
        cmocka_unit_test(test_mixed_lists),
        cmocka_unit_test(test_list_errors),
        cmocka_unit_test(test_binary_variants),
        cmocka_unit_test_setup_teardown(test_missing_file, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_round_trips, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_compression_replaces, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_write_failures, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_long_text, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_rest_of_a_long_list, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
