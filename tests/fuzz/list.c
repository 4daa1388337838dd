/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Header, tokens and lists of OpenFOAM's files, from memory. */
#include "tests/fuzz/target.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LIMIT = 1000 };

static void try_doubles(struct lexer l, const struct foam_header *h, int components) {
    struct lexer skipped = l;
    long n = 0;
    double *v = NULL;
    if (accepted(foam_list_read_doubles(&l, h, components, LIMIT, &n, &v))) {
        PROMISE(n >= 0, "a list has a length");
        for (long i = 0; i < n * components; i++) PROMISE(isfinite(v[i]), "numbers are finite");
        PROMISE(accepted(foam_list_skip(&skipped, h, h->scalar_bytes * components)), "what is read can be skipped");
        PROMISE(skipped.position == l.position && skipped.line == l.line, "skipping ends where reading does");
        free(v);
    } else {
        PROMISE(!v, "a list that was refused is not there");
    }
}

static void try_labels(struct lexer l, const struct foam_header *h) {
    struct lexer faces = l;
    long n = 0;
    int *v = NULL, *start = NULL, *points = NULL;
    if (accepted(foam_list_read_labels(&l, h, LIMIT, &n, &v))) free(v);
    if (!accepted(foam_list_read_faces(&faces, h, &n, &start, &points))) return;
    PROMISE(start[0] == 0, "faces start with the first point");
    for (long i = 0; i < n; i++) PROMISE(start[i] <= start[i + 1], "faces follow each other");
    for (int i = 0; i < start[n]; i++) v = points + i; /* as long as it says: the sanitizer sees to it */
    free(start);
    free(points);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    struct foam_header h;
    char name[] = "list";
    struct source s = {.path = name, .text = malloc(size + 1), .size = size};
    if (!s.text) return 0;
    memcpy(s.text, data, size);
    s.text[size] = 0;
    struct lexer l = lexer_start(&s), all = l;
    if (accepted(foam_header_read(&l, &h))) {
        try_doubles(l, &h, 1);
        try_doubles(l, &h, 3);
        try_labels(l, &h);
    }
    for (struct token t = {.kind = TOKEN_WORD}; t.kind != TOKEN_END && accepted(lexer_next(&all, &t));)
        PROMISE(t.length >= 0 && t.text >= s.text && t.text + t.length <= s.text + size, "tokens lie in the file");
    free(s.text);
    return 0;
}
