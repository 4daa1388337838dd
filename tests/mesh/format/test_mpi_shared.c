/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Lists whose entries are spread over the ranks: written with the bytes and the checksum of one rank, and read again.
 */
#define _GNU_SOURCE
#include "mesh/format/foamfile.h"

#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h> /* last: it needs the standard headers */

#include "tests/mesh/shared_folder.h"
#undef fail /* its macro; here fail makes a status */

enum { MOST = 40000 }; /* entries: more than the root gets or reads at a time */

static double value(long entry, int component) {
    return 1 / (1 + 3. * (double)entry + component);
}

static void path_of(const char *name, char path[128]) {
    snprintf(path, 128, "%s/%s", folder, name);
}

static void make_slice(const struct share *s, int components, double **out) {
    assert_null(allocate(out, (s->end - s->first) * components, sizeof **out, "values"));
    for (long i = s->first; i < s->end; i++)
        for (int c = 0; c < components; c++) (*out)[(i - s->first) * components + c] = value(i, c);
}

static void open_file(const char *path, const struct foam_format *f, int components, struct sink **out) {
    assert_null(sink_open(path, f->compress, out));
    foam_header_write(*out, f, components == 3 ? "volVectorField" : "volScalarField", "0", "f", NULL);
    sink_printf(*out, "internalField nonuniform List<%s>\n", components == 3 ? "vector" : "scalar");
}

static void close_file(struct sink *s, struct file_sum *sum) {
    sink_printf(s, ";\n\nboundaryField\n{\n    wall { type slip; }\n}\n");
    assert_null(sink_close_sum(s, sum));
}

/* Writes a file by all ranks and, on the root, another one as one rank does, and compares them. */
static void write_both(const struct foam_format *f, int components, long n) {
    const struct share s = share_make(world, n);
    const struct share whole = {world, n, 0, n};
    char path[128], alone[128];
    double *slice, *all;
    struct sink *sink = NULL;
    struct file_sum one, other, read;
    path_of("f", path);
    path_of("g", alone);
    make_slice(&s, components, &slice);
    if (comm_root(world)) open_file(path, f, components, &sink);
    assert_null(foam_list_write_shared(sink, path, f, components, &s, slice));
    free(slice);
    if (sink) close_file(sink, &one);
    assert_null(comm_agree(world, OK)); /* now the others see the file */
    if (!sink) return;
    make_slice(&whole, components, &all);
    open_file(alone, f, components, &sink);
    foam_list_write_doubles(sink, f, components, n, all);
    close_file(sink, &other);
    free(all);
    assert_null(file_sum_read(path, &read));
    assert_true(one.bytes == other.bytes && one.crc == other.crc && one.bytes == read.bytes && one.crc == read.crc);
}

/* Goes to the list of a source, and reads its part. */
static void read_part(const struct source *source, int components, const struct share *s) {
    struct lexer l = lexer_start(source), again;
    struct foam_header h;
    struct token t;
    double *v;
    long n;
    assert_null(foam_header_read(&l, &h));
    for (int i = 0; i < 3; i++) assert_null(lexer_next(&l, &t));
    again = l;
    assert_null(foam_list_skip(&again, &h, components * 8));
    assert_null(foam_list_read_part(&l, &h, components, s->n, s->first, s->end, &n, &v));
    assert_int_equal(n, s->n);
    assert_true(l.position == again.position && l.line == again.line);
    for (long i = s->first; i < s->end; i++)
        for (int c = 0; c < components; c++) assert_true(v[(i - s->first) * components + c] == value(i, c));
    free(v);
    assert_null(lexer_expect(&l, ';'));
    assert_null(lexer_next(&l, &t));
    assert_true(token_is(&t, "boundaryField"));
}

static void lists_of_all_kinds(void **state) {
    (void)state;
    char path[128];
    path_of("f", path);
    for (int kind = 0; kind < 4; kind++)
        for (int components = 1; components <= 3; components += 2)
            for (long n = 0; n <= MOST; n = n ? 200 * n : 1) {
                const struct foam_format f = {.binary = kind % 2, .compress = kind / 2, .precision = 17};
                const struct share s = share_make(world, n);
                struct source *source;
                write_both(&f, components, n);
                assert_null(source_open_shared(path, &s, &source));
                if (n * components * 8 > 4096) assert_true(source->size < 1000); /* the text lacks the entries */
                read_part(source, components, &s);
                source_free(source);
                assert_null(comm_agree(world, OK)); /* all have read it before the next one takes its place */
            }
}

/* The root writes a text to the file. */
static void put(const char *path, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void put(const char *path, const char *format, ...) {
    va_list args;
    va_start(args, format);
    FILE *f = comm_root(world) ? fopen(path, "w") : NULL;
    if (f) {
        vfprintf(f, format, args);
        assert_int_equal(fclose(f), 0);
    }
    va_end(args);
    assert_null(comm_agree(world, OK));
}

/* Text that no writer writes is read as source_open reads it, and so is what is wrong. */
static void other_texts(void **state) {
    (void)state;
    enum { N = 600 };
    static const char *const changes[] = {" ", " // a comment\n", " 1e9x ", ""};
    char path[128], list[20 * N] = "";
    path_of("t", path);
    const struct share s = share_make(world, N);
    for (int k = 0; k < 4; k++) {
        char *to = list;
        for (int i = 0; i < N - (k == 3); i++) to += sprintf(to, "%d%s", i, i == 400 && k ? changes[k] : "\n");
        put(path, "FoamFile { format ascii; }\nf nonuniform List<scalar>\n%d\n(\n%s)\n;", N, list);
        struct source *source;
        assert_null(source_open_shared(path, &s, &source));
        struct lexer l = lexer_start(source);
        struct foam_header h;
        struct token t;
        double *v;
        long n;
        assert_null(foam_header_read(&l, &h));
        for (int i = 0; i < 3; i++) assert_null(lexer_next(&l, &t));
        status e = foam_list_read_part(&l, &h, 1, N, s.first, s.end, &n, &v);
        assert_true((e != NULL) == (k >= 2));
        if (e) assert_non_null(strstr(status_text(e), k == 2 ? ":405: found '1e9x'" : "says 600 entries, but has 59"));
        status_free(e);
        for (long i = s.first; !e && i < s.end; i++) assert_true(v[i - s.first] == (double)i);
        if (!e) free(v);
        source_free(source);
        assert_null(comm_agree(world, OK));
    }
}

int main(int argc, char **argv) {
    status s = comm_start(&argc, &argv, &world);
    if (s) return status_print(s, true);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_of_all_kinds),
        cmocka_unit_test(other_texts),
    };
    int failed = cmocka_run_group_tests(tests, make_folder, remove_folder);
    comm_finish(world);
    return failed;
}
