/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Typed and ranged reads of dictionary values (dict.h): numbers with dimensions, words, vectors, lists, tables. Every
 * error names file, line, key and value, and says what is expected. */
#include "solvers/dict/dict.h"
#include "solvers/dict/dict_parts.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- errors ---- */

status dict_fail(const struct dict *d, const char *key, const char *format, ...) {
    char text[1024], value[64] = "";
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    const struct entry *e = dict_find(d, key);
    if (!e) return fail(ERR_INPUT, "%s:%d: key '%s': %s", d->path, d->line, key, text);
    if (entry_is_foreign(e)) return entry_fail_hidden(e);
    entry_print(e, value, sizeof value);
    return fail(ERR_INPUT, "%s:%d: key '%s' is %s; %s", e->path, e->line, key, *value ? value : "empty", text);
}

/* Fails for a key that is missing, with the cure, or with the key that may be it, misspelt. */
static status missing(const struct dict *d, const char *key, const char *what, const char *cure) {
    const char **keys = calloc((size_t)d->count + 1, sizeof *keys);
    const char *near = NULL;
    int n = 0;
    for (int i = 0; keys && i < d->count; i++)
        if (!d->entry[i].used && !d->entry[i].foreign) keys[n++] = d->entry[i].key;
    if (keys) near = dict_meant(key, keys, n);
    char hint[200] = "", where[200] = "";
    if (*cure) snprintf(hint, sizeof hint, "; %s", cure);
    if (near) snprintf(hint, sizeof hint, "; this line has '%.100s': did you mean '%s'?", near, key);
    if (*d->name) snprintf(where, sizeof where, " in '%s'", d->name);
    free(keys);
    const struct entry *e = near ? dict_find(d, near) : NULL;
    return fail(ERR_INPUT, "%s:%d: %s '%s' is missing%s%s", e ? e->path : d->path, e ? e->line : d->line, what, key,
                where, hint);
}

status dict_missing(const struct dict *d, const char *key, const char *cure) {
    return missing(d, key, "key", cure);
}

/* Finds the entry of a key that must be there and have a value of its own. */
static status need(struct dict *d, const char *key, const char *what, struct entry **out) {
    *out = dict_ask(d, key);
    if (!*out) return missing(d, key, "key", "");
    if ((*out)->sub) return dict_fail(d, key, "expected %s, not a dictionary", what);
    if ((*out)->raw) return dict_fail(d, key, "expected %s, not a large list", what);
    return OK;
}

/* ---- dictionaries and raw values ---- */

status dict_sub_optional(struct dict *d, const char *key, struct dict **out) {
    struct entry *e = dict_ask(d, key);
    *out = e ? e->sub : NULL;
    if (e && !e->sub) return dict_fail(d, key, "expected a dictionary: %s { ... }", key);
    return OK;
}

status dict_sub(struct dict *d, const char *key, struct dict **out) {
    TRY(dict_sub_optional(d, key, out));
    return *out ? OK : missing(d, key, "dictionary", "");
}

status dict_raw(struct dict *d, const char *key, struct lexer *out) {
    struct entry *e = dict_ask(d, key);
    if (!e) return missing(d, key, "key", "");
    if (e->sub) return dict_fail(d, key, "expected a value, not a dictionary");
    if (e->raw) {
        const struct foam_header *a = &e->header, *b = dict_header(d);
        if (a->binary != b->binary || a->scalar_bytes != b->scalar_bytes || a->label_bytes != b->label_bytes)
            return dict_fail(d, key, "the list stands in an included file whose 'format' differs from %s", d->path);
        *out = e->start;
        return OK;
    }
    char *text = entry_lines(e);
    if (!text) return fail(ERR_SYSTEM, "no memory for key '%s'", key);
    struct source *s = NULL;
    status bad = source_from_text(e->path, text, &s);
    free(text);
    TRY(bad);
    s->foreign = entry_is_foreign(e);
    TRY(document_keep(d->document, s));
    *out = lexer_start(s);
    out->line = e->line;
    return OK;
}

/* ---- dimensions ---- */

static bool is_mark(const struct entry *e, int i, char c) {
    return i < e->count && e->value[i].kind == TOKEN_PUNCTUATION && *e->value[i].text == c;
}

static bool is_number(const struct entry *e, int i) {
    return i < e->count && e->value[i].kind == TOKEN_NUMBER;
}

/* Reads [a b c d e f g] at value *i, which is moved behind it. */
static status read_dimensions(const struct dict *d, const char *key, const struct entry *e, int *i,
                              signed char out[7]) {
    int n = 0;
    memset(out, 0, 7);
    for (++*i; !is_mark(e, *i, ']'); ++*i, n++) {
        if (!is_number(e, *i) || n == 7) return dict_fail(d, key, "dimensions are [kg m s K mol A cd], 5 or 7 numbers");
        double v = e->value[*i].number;
        if (v != floor(v) || fabs(v) > 99) return dict_fail(d, key, "dimensions are small whole numbers");
        out[n] = (signed char)v;
    }
    if (n != 5 && n != 7) return dict_fail(d, key, "dimensions are [kg m s K mol A cd], 5 or 7 numbers");
    ++*i;
    return OK;
}

/* Passes over `[...]` or `name [...]` and checks the unit; *first is where the number or vector stands. */
static status skip_dimensions(const struct dict *d, const char *key, const struct entry *e, const signed char unit[3],
                              int *first) {
    signed char found[7];
    *first = 0;
    if (e->count > 1 && e->value[0].kind == TOKEN_WORD && is_mark(e, 1, '[')) *first = 1;
    if (!is_mark(e, *first, '[')) return OK;
    TRY(read_dimensions(d, key, e, first, found));
    for (int k = 0; unit && k < 7; k++)
        if (found[k] != (k < 3 ? unit[k] : 0))
            return dict_fail(d, key, "its dimensions must be [%d %d %d 0 0 0 0]", unit[0], unit[1], unit[2]);
    return OK;
}

status dict_dimensions(struct dict *d, const char *key, signed char out[7]) {
    struct entry *e;
    int i = 0;
    TRY(need(d, key, "dimensions", &e));
    if (!is_mark(e, 0, '[')) return dict_fail(d, key, "expected dimensions such as [1 -3 0 0 0 0 0]");
    TRY(read_dimensions(d, key, e, &i, out));
    return i == e->count ? OK : dict_fail(d, key, "expected nothing behind the dimensions; missing ';' ?");
}

/* ---- one value ---- */

status dict_number(struct dict *d, const char *key, const signed char unit[3], double *out) {
    struct entry *e;
    int i;
    TRY(need(d, key, "a number", &e));
    TRY(skip_dimensions(d, key, e, unit, &i));
    if (!is_number(e, i)) return dict_fail(d, key, "expected a number");
    if (i + 1 != e->count) return dict_fail(d, key, "expected one number; missing ';' ?");
    *out = e->value[i].number;
    return OK;
}

status dict_number_or(struct dict *d, const char *key, const signed char unit[3], double standard, double *out) {
    *out = standard;
    return dict_has(d, key) ? dict_number(d, key, unit, out) : OK;
}

status dict_count_or(struct dict *d, const char *key, long standard, long *out) {
    double v = 0;
    *out = standard;
    if (!dict_has(d, key)) return OK;
    TRY(dict_number(d, key, NULL, &v));
    if (v != floor(v) || fabs(v) > 9007199254740992.0) return dict_fail(d, key, "expected a whole number");
    *out = (long)v;
    return OK;
}

static status one_word(struct dict *d, const char *key, const char *what, const char **out) {
    struct entry *e;
    TRY(need(d, key, what, &e));
    if (!e->count || (e->value[0].kind != TOKEN_WORD && e->value[0].kind != TOKEN_STRING))
        return dict_fail(d, key, "expected %s", what);
    if (e->count > 1) return dict_fail(d, key, "expected %s; missing ';' ?", what);
    *out = e->value[0].text;
    return OK;
}

status dict_switch_or(struct dict *d, const char *key, bool standard, bool *out) {
    static const char *const names[] = {"on", "yes", "true", "y", "t", "off", "no", "false", "n", "f"};
    const char *word, *what = "one of on yes true y t, off no false n f";
    *out = standard;
    if (!dict_has(d, key)) return OK;
    TRY(one_word(d, key, what, &word));
    for (int i = 0; i < 10; i++)
        if (!strcmp(word, names[i])) {
            *out = i < 5;
            return OK;
        }
    return dict_fail(d, key, "expected %s", what);
}

status dict_word(struct dict *d, const char *key, const char **out) {
    return one_word(d, key, "one word", out);
}

status dict_word_or(struct dict *d, const char *key, const char *standard, const char **out) {
    *out = standard;
    return dict_has(d, key) ? dict_word(d, key, out) : OK;
}

static void list_names(const char *const *names, int count, char list[900]) {
    *list = 0;
    for (int i = 0; i < count; i++) {
        size_t n = strlen(list);
        snprintf(list + n, 900 - n, "%s%s", i ? ", " : "", names[i]);
    }
}

status dict_unknown(const struct dict *d, const char *key, const char *word, const char *const *names, int count) {
    char list[900], meant[MEANT];
    list_names(names, count, list);
    return dict_fail(d, key, "there is no '%s'; allowed are: %s%s", word, list,
                     name_question(word, names, count, meant));
}

status dict_choice(struct dict *d, const char *key, const char *const *names, int count, int *index) {
    const char *word;
    char list[900];
    list_names(names, count, list);
    struct entry *e = dict_ask(d, key);
    if (!e) {
        TRY(status_note(missing(d, key, "key", ""), "'%s' is one of: %s", key, list));
    }
    char what[1000];
    snprintf(what, sizeof what, "one of: %s", list);
    TRY(one_word(d, key, what, &word));
    for (int i = 0; i < count; i++)
        if (!strcmp(word, names[i])) {
            *index = i;
            return OK;
        }
    char meant[MEANT];
    return dict_fail(d, key, "allowed are: %s%s", list, name_question(word, names, count, meant));
}

/* Reads `(x y z)`, a tuple of `width` numbers, at value *i, which is moved behind it. */
static bool read_tuple(const struct entry *e, int *i, int width, double *out) {
    if (!is_mark(e, *i, '(') || !is_mark(e, *i + width + 1, ')')) return false;
    for (int k = 0; k < width; k++) {
        if (!is_number(e, *i + 1 + k)) return false;
        out[k] = e->value[*i + 1 + k].number;
    }
    *i += width + 2;
    return true;
}

status dict_vector(struct dict *d, const char *key, const signed char unit[3], double out[3]) {
    struct entry *e;
    int i;
    TRY(need(d, key, "a vector", &e));
    TRY(skip_dimensions(d, key, e, unit, &i));
    if (!read_tuple(e, &i, 3, out)) return dict_fail(d, key, "expected a vector (x y z)");
    return i == e->count ? OK : dict_fail(d, key, "expected one vector; missing ';' ?");
}

/* ---- lists ---- */

/* Opens `(`, `N (` or `N {` at *i, which is moved behind the bracket; *wanted: N or -1. */
static status open_list(const struct dict *d, const char *key, const struct entry *e, const char *what, int *i,
                        int *wanted, bool *uniform) {
    *wanted = -1;
    if (is_number(e, *i)) {
        double n = e->value[*i].number;
        if (n != floor(n) || n < 0 || n > 1e6) return dict_fail(d, key, "expected %s", what);
        *wanted = (int)n;
        ++*i;
    }
    *uniform = *wanted >= 0 && is_mark(e, *i, '{');
    if (*uniform && *wanted > 10000) return dict_fail(d, key, "at most 10000 equal entries can stand here");
    if (!*uniform && !is_mark(e, *i, '(')) return dict_fail(d, key, "expected %s", what);
    ++*i;
    return OK;
}

/* Reads a list of tuples of `width` numbers that begins at value `first`. */
static status numbers(struct dict *d, const char *key, const char *what, int first, int width, int *count,
                      const double **out) {
    struct entry *e;
    int i = first, n = 0, wanted;
    bool uniform;
    double *v = NULL;
    TRY(need(d, key, what, &e));
    TRY(open_list(d, key, e, what, &i, &wanted, &uniform));
    size_t most = (size_t)(uniform && wanted > e->count ? wanted : e->count);
    TRY(document_take(d->document, (most + 1) * (size_t)width * sizeof *v, &v));
    for (; i < e->count && !is_mark(e, i, uniform ? '}' : ')'); n++) {
        double *item = v + (long)n * width;
        if (width == 1 && is_number(e, i))
            *item = e->value[i++].number;
        else if (width == 1 || !read_tuple(e, &i, width, item))
            return dict_fail(d, key, "expected %s", what);
    }
    if (uniform && n != 1) return dict_fail(d, key, "expected one value in '{ }'");
    for (; uniform && n < wanted; n++) memcpy(v + (long)n * width, v, (size_t)width * sizeof *v);
    if (uniform) n = wanted;
    if (i + 1 != e->count) return dict_fail(d, key, "expected %s and nothing behind it; missing ';' ?", what);
    if (wanted >= 0 && n != wanted) return dict_fail(d, key, "the list says %d entries, but has %d", wanted, n);
    *count = n;
    *out = v;
    return OK;
}

status dict_numbers(struct dict *d, const char *key, int *count, const double **out) {
    return numbers(d, key, "a list of numbers (1 2 3)", 0, 1, count, out);
}

status dict_vectors(struct dict *d, const char *key, int *count, const double **out) {
    return numbers(d, key, "a list of vectors ((x y z) ...)", 0, 3, count, out);
}

static status check_rising(struct dict *d, const char *key, int width, int count, const double *rows) {
    for (int i = 1; i < count; i++)
        if (!(rows[width * i] > rows[width * (i - 1)]))
            return dict_fail(d, key, "its times must rise: %g follows %g", rows[width * i], rows[width * (i - 1)]);
    return OK;
}

status dict_table(struct dict *d, const char *key, int *count, const double **out) {
    static const char what[] = "table ((t v) (t v) ...)";
    struct entry *e;
    *count = 0;
    TRY(need(d, key, what, &e));
    if (!e->count || e->value[0].kind != TOKEN_WORD || strcmp(e->value[0].text, "table")) return OK;
    TRY(numbers(d, key, what, 1, 2, count, out));
    if (!*count) return dict_fail(d, key, "expected %s with one pair at least", what);
    return check_rising(d, key, 2, *count, *out);
}

/* Reads a value of `components` numbers at value *i, which is moved behind it. */
static bool read_item(const struct entry *e, int *i, int components, double *out) {
    if (components > 1) return read_tuple(e, i, components, out);
    if (!is_number(e, *i)) return false;
    *out = e->value[(*i)++].number;
    return true;
}

/* Reads the rows `(t v)` of a table whose list is open, from value *i on; returns their number, or -1. */
static int read_rows(const struct entry *e, int *i, int components, double *out) {
    int n = 0;
    for (; !is_mark(e, *i, ')'); n++) {
        double *row = out + (long)n * (1 + components);
        if (!is_mark(e, *i, '(') || !is_number(e, *i + 1)) return -1;
        *row = e->value[*i + 1].number;
        *i += 2;
        if (!read_item(e, i, components, row + 1) || !is_mark(e, *i, ')')) return -1;
        ++*i;
    }
    ++*i;
    return n;
}

static status read_table(struct dict *d, const char *key, const struct entry *e, const char *what, int components,
                         int *count, double *out) {
    int i = 1, wanted;
    bool uniform;
    TRY(open_list(d, key, e, what, &i, &wanted, &uniform));
    *count = uniform ? -1 : read_rows(e, &i, components, out);
    if (*count < 1 || i != e->count) return dict_fail(d, key, "expected %s, and nothing behind it", what);
    if (wanted >= 0 && *count != wanted)
        return dict_fail(d, key, "the list says %d entries, but has %d", wanted, *count);
    return check_rising(d, key, 1 + components, *count, out);
}

status dict_function(struct dict *d, const char *key, int components, int *count, const double **out) {
    const char *what = components > 1 ? "(x y z),  constant (x y z)  or  table ((t (x y z)) (t (x y z)) ...)"
                                      : "a number,  constant NUMBER  or  table ((t v) (t v) ...)";
    struct entry *e;
    double *v = NULL;
    TRY(need(d, key, what, &e));
    TRY(document_take(d->document, (size_t)(e->count + 1 + components) * sizeof *v, &v));
    *out = v;
    const bool word = e->count > 0 && e->value[0].kind == TOKEN_WORD;
    if (word && !strcmp(e->value[0].text, "table")) return read_table(d, key, e, what, components, count, v);
    int i = word && !strcmp(e->value[0].text, "constant");
    *count = 1;
    v[0] = 0;
    if (read_item(e, &i, components, v + 1) && i == e->count) return OK;
    return dict_fail(d, key, "expected %s", what);
}

status dict_words(struct dict *d, const char *key, int *count, const char *const **out) {
    struct entry *e;
    const char **words = NULL, *what = "a word, or a list of words (a b c)";
    int i = 0, n = 0, wanted = -1;
    bool uniform = false, single;
    TRY(need(d, key, what, &e));
    single = e->count == 1;
    if (!single) TRY(open_list(d, key, e, what, &i, &wanted, &uniform));
    TRY(document_take(d->document, (size_t)(e->count + 1) * sizeof *words, &words));
    for (; i < e->count && !is_mark(e, i, ')'); i++) {
        if (uniform || (e->value[i].kind != TOKEN_WORD && e->value[i].kind != TOKEN_STRING))
            return dict_fail(d, key, "expected %s, separated by blanks", what);
        words[n++] = e->value[i].text;
    }
    if (i + !single != e->count) return dict_fail(d, key, "expected %s and nothing behind it; missing ';' ?", what);
    if (wanted >= 0 && n != wanted) return dict_fail(d, key, "the list says %d entries, but has %d", wanted, n);
    *count = n;
    *out = words;
    return OK;
}

status dict_note_expression(const struct dict *d, const char *key, const char *text, status s) {
    if (!s || !dict_is_foreign(d, key))
        return status_note(s, "%s:%d: %s \"%s\"", dict_path(d), dict_line(d, key), key, text);
    status_free(s);
    return dict_fail(d, key, "it cannot be read");
}
