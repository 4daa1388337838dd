/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solvers/dict/dict.h"
#include "mesh/format/foamfile.h"
#include "tests/fuzz/target.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { KEYS = 10 };
static const char SECRET[] = "qzvSecret";

/* What lies outside the case, and ways to it. */
static void lay_traps(void) {
    static bool done;
    if (done) return;
    done = true;
    scratch_write("secret", "qzvSecret qzvSecret;", 20); /* it may be read, but not shown in messages */
    scratch_write("case/system/plain", "plain 1;", 8);
    char link[256];
    snprintf(link, sizeof link, "%s/case/system/link", scratch());
    PROMISE(!symlink("../../secret", link), "a link can be made");
    snprintf(link, sizeof link, "%s/case/out", scratch());
    PROMISE(!symlink("..", link), "a link can be made");
}

static bool has_secret(const char *text, size_t size) {
    for (size_t i = 0; i + sizeof SECRET <= size + 1; i++)
        if (!memcmp(text + i, SECRET, sizeof SECRET - 1)) return true;
    return false;
}

/* As accepted(), of an error that may not show what lies outside the case. */
static bool told; /* the input holds the secret itself: libFuzzer sees what is compared, and tries it */
static bool hidden(status s) {
    PROMISE(!s || told || !strstr(status_text(s), SECRET), "messages do not show files from outside the case");
    return accepted(s);
}

static void try_raw(struct dict *d, const char *key) {
    struct lexer l;
    struct token t = {.kind = TOKEN_WORD};
    if (!hidden(dict_raw(d, key, &l))) return;
    while (t.kind != TOKEN_END && !token_is(&t, ";") && hidden(lexer_next(&l, &t))) continue;
}

static void try_key(struct dict *d, const char *key) {
    static const char *const names[] = {"ascii", "binary", "latestTime"};
    static const signed char unit[3] = {0, 1, -1};
    double v, x[3];
    long whole;
    bool on;
    int n;
    signed char dimensions[7];
    const char *word;
    const char *const *words;
    const double *numbers;
    (void)dict_line(d, key);
    if (hidden(dict_number(d, key, unit, &v))) PROMISE(isfinite(v), "numbers are finite");
    (void)hidden(dict_count_or(d, key, 3, &whole));
    (void)hidden(dict_switch_or(d, key, true, &on));
    (void)hidden(dict_word(d, key, &word));
    (void)hidden(dict_vector(d, key, NULL, x));
    (void)hidden(dict_choice(d, key, names, 3, &n));
    (void)hidden(dict_words(d, key, &n, &words));
    if (hidden(dict_numbers(d, key, &n, &numbers)))
        for (int i = 0; i < n; i++) PROMISE(isfinite(numbers[i]), "numbers are finite");
    (void)hidden(dict_vectors(d, key, &n, &numbers));
    (void)hidden(dict_dimensions(d, key, dimensions));
    try_raw(d, key);
}

static void try_dict(struct dict *d, int *left) {
    for (int i = 0; i < dict_count(d) && --*left > 0; i++) {
        struct dict *sub = NULL;
        const char *key = dict_key(d, i);
        if (hidden(dict_sub_optional(d, key, &sub)) && sub)
            try_dict(sub, left);
        else
            try_key(d, key);
    }
    (void)accepted(dict_check_used(d));
}

/* Restarts read what was printed: it must be the same dictionary. */
static void try_print(const char *text) {
    struct dict *d = NULL;
    if (!text || strstr(text, "/* not shown */")) return;
    PROMISE(accepted(dict_from_text("printed", text, &d)), "what was printed can be read");
    char *again = dict_print(d);
    PROMISE(again && !strcmp(text, again), "what was printed is the same dictionary");
    free(again);
    dict_free(d);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[256];
    struct dict *d = NULL;
    int left = KEYS;
    lay_traps();
    scratch_unpack("case", "system/d", data, size);
    snprintf(path, sizeof path, "%s/case/system/d", scratch());
    status s = dict_read(path, &d);
    told = has_secret((const char *)data, size);
    bool good = hidden(s);
    PROMISE(good == (d != NULL), "there is a dictionary if there is no error");
    if (good) {
        (void)accepted(dict_check_used(d));
        try_dict(d, &left);
        dict_mark_used(d);
        PROMISE(accepted(dict_check_used(d)), "what is marked as used is used");
        char *text = dict_print(d);
        try_print(text);
        PROMISE(text, "a dictionary can be printed");
        for (const char *c = text; text && *c; c++)
            PROMISE((unsigned char)*c >= ' ' || strchr("\t\r\n", *c), "a dictionary is text");
        free(text);
    }
    dict_free(d);
    scratch_clear();
    return 0;
}
