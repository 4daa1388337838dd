/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dictionaries in memory: what they own, look-up of keys and regular expressions, keys that no read asked for,
 * suggestions, printing. dict_parse.c makes them from text, dict_typed.c has the typed reads. */
#include "solvers/dict/dict.h"
#include "solvers/dict/dict_parts.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- memory ---- */

status document_grow(struct document *d, void *items, int count, int *room, size_t size) {
    if (count < *room) return OK;
    void *old, *more = NULL;
    memcpy(&old, items, sizeof old);
    int wanted = *room ? 2 * *room : 8;
    TRY(document_take(d, (size_t)wanted * size, &more));
    if (count) memcpy(more, old, (size_t)count * size);
    memcpy(items, &more, sizeof more);
    *room = wanted;
    return OK;
}

status document_take(struct document *d, size_t bytes, void *out) {
    if (d->blocks == d->room) {
        long room = d->room ? 2 * d->room : 64;
        void **memory = realloc(d->memory, (size_t)room * sizeof *memory);
        if (!memory) return fail(ERR_SYSTEM, "no memory for a dictionary");
        d->memory = memory;
        d->room = room;
    }
    void *p = calloc(1, bytes ? bytes : 1);
    if (!p) return fail(ERR_SYSTEM, "no memory for a dictionary");
    d->memory[d->blocks++] = p;
    memcpy(out, &p, sizeof p);
    return OK;
}

status document_copy(struct document *d, const char *text, int length, const char **out) {
    char *copy = NULL;
    size_t n = length < 0 ? strlen(text) : (size_t)length;
    TRY(document_take(d, n + 1, &copy));
    memcpy(copy, text, n);
    *out = copy;
    return OK;
}

status document_note(struct document *d, const struct source *s, int line, const char *format, const char *name) {
    char what[512], text[4608];
    struct names *n = &d->passed;
    snprintf(what, sizeof what, format, s->foreign ? "" : name);
    snprintf(text, sizeof text, "%.4000s:%d: %s", s->path, line, what);
    TRY(document_grow(d, &n->name, n->count, &n->room, sizeof *n->name));
    TRY(document_copy(d, text, -1, &n->name[n->count]));
    n->count++;
    return OK;
}

status document_keep(struct document *d, struct source *s) {
    status e = document_grow(d, &d->source, d->sources, &d->source_room, sizeof(struct source *));
    if (e)
        source_free(s);
    else
        d->source[d->sources++] = s;
    return e;
}

/* Returns the end of the bracket expression that begins at c: where its ] stands, or the end of the text. */
static const char *bracket_end(const char *c) {
    c += c[1] == '^' ? 2 : 1;
    if (*c == ']') c++;
    for (; *c && *c != ']'; c++) {
        const char *end = *c == '[' && c[1] && strchr(":.=", c[1]) ? strchr(c + 2, ']') : NULL;
        if (end) c = end;
    }
    return *c ? c : c - 1;
}

/* Returns why a regular expression is too costly for the library; NULL: it is not. The library copies the part before
 * {n} and + in memory, tries back references one by one, and tries all ways through parts that can be empty: the number
 * of ways may double with each sign that makes a part empty, and with each anchor; a + behind a group doubles the signs
 * in it. */
static const char *costly(const char *key) {
    enum { SIGNS = 12 };
    int plus = 0, groups = 0, signs = 0;
    char before = '|';
    for (const char *c = key; *c; c++) {
        if (*c == '[') c = bracket_end(c);
        if (*c == '{') return "{ } is not taken; write the repetition out";
        if (*c == '+' && ++plus > 4) return "more than four +";
        if (*c == '+' && strchr(")*+?", before) && ++groups > 1) return "more than one + behind ) or another sign";
        if (strchr("*+?", *c) && ++signs > SIGNS) return "more than twelve of * + ?";
        if (strchr("(|", before) && strchr("|)", *c)) return "an alternative is empty";
        if ((*c == '^' && c > key) || (*c == '$' && c[1])) return "^ or $ inside; the whole word is compared";
        before = *c;
        if (before != '\\' || !c[1]) continue;
        if (*++c >= '0' && *c <= '9') return "back references are not taken";
        if (strchr("bB<>`'", *c)) return "bounds of words are not taken";
    }
    return *key && before == '|' ? "an alternative is empty" : NULL;
}

bool pattern_compile(regex_t *out, const char *key, char *why, size_t room) {
    char text[512];
    const char *bad = costly(key);
    if (!bad && snprintf(text, sizeof text, "^(%s)$", key) >= (int)sizeof text) bad = "it is too long";
    if (bad) {
        snprintf(why, room, "%s", bad);
        return false;
    }
    int code = regcomp(out, text, REG_EXTENDED | REG_NOSUB);
    if (code) regerror(code, out, why, room);
    return !code;
}

status document_pattern(struct document *d, const char *key, regex_t **out, char *why, size_t room) {
    *out = NULL;
    regex_t *pattern = NULL;
    TRY(document_take(d, sizeof *pattern, &pattern));
    TRY(document_grow(d, &d->pattern, d->patterns, &d->pattern_room, sizeof(regex_t *)));
    if (!pattern_compile(pattern, key, why, room)) return OK;
    d->pattern[d->patterns++] = pattern;
    *out = pattern;
    return OK;
}

static void document_free(struct document *d) {
    for (int i = 0; i < d->sources; i++) source_free(d->source[i]);
    for (int i = 0; i < d->patterns; i++) regfree(d->pattern[i]);
    for (long i = 0; i < d->blocks; i++) free(d->memory[i]);
    free(d->memory);
    free(d);
}

void dict_free(struct dict *d) {
    if (d) document_free(d->document);
}

/* Makes a dictionary from a source, which it then owns. */
static status dict_make(struct source *s, struct dict **out) {
    *out = NULL;
    struct document *d = calloc(1, sizeof *d);
    if (!d) {
        source_free(s);
        return fail(ERR_SYSTEM, "no memory for a dictionary");
    }
    status e = document_keep(d, s);
    if (!e) e = document_take(d, sizeof *d->top, &d->top);
    if (!e) e = document_take(d, sizeof *d->top->asked, &d->top->asked);
    if (!e) {
        d->top->document = d;
        d->top->name = "";
        d->top->path = s->path;
        d->top->line = 1;
        e = dict_parse(d, s);
    }
    if (e)
        document_free(d);
    else
        *out = d->top;
    return e;
}

status dict_read(const char *path, struct dict **out) {
    struct source *s = NULL;
    *out = NULL;
    TRY(source_open(path, &s));
    return dict_make(s, out);
}

status dict_read_shared(const char *path, const struct share *share, struct dict **out) {
    struct source *s = NULL;
    *out = NULL;
    TRY(source_open_shared(path, share, &s));
    return dict_make(s, out);
}

status dict_from_text(const char *name, const char *text, struct dict **out) {
    struct source *s = NULL;
    *out = NULL;
    TRY(source_from_text(name, text, &s));
    return dict_make(s, out);
}

/* ---- look-up ---- */

struct entry *dict_find_exact(const struct dict *d, const char *key) {
    for (int i = d->count - 1; i >= 0; i--)
        if (!strcmp(d->entry[i].key, key)) return &d->entry[i];
    return NULL;
}

struct entry *dict_find_pattern(const struct dict *d, const char *key) {
    for (int i = d->count - 1; i >= 0; i--)
        if (d->entry[i].pattern && !d->entry[i].open && !regexec(d->entry[i].pattern, key, 0, NULL, 0))
            return &d->entry[i];
    return NULL;
}

struct entry *dict_find(const struct dict *d, const char *key) {
    struct entry *e = dict_find_exact(d, key);
    return e ? e : dict_find_pattern(d, key);
}

/* Adds a name to a list. Without memory for the name only a suggestion is lost. */
static void remember(struct document *d, struct names *list, const char *name) {
    const char *copy = NULL;
    status e = document_copy(d, name, -1, &copy);
    if (!e) e = document_grow(d, &list->name, list->count, &list->room, sizeof *list->name);
    if (!e) list->name[list->count++] = copy;
    status_free(e);
}

/* Remembers that the program knows this key. */
static void ask(const struct dict *d, const char *key) {
    struct names *a = d->asked;
    for (int i = 0; i < a->count; i++)
        if (!strcmp(a->name[i], key)) return;
    remember(d->document, a, key);
}

void dict_belongs(const struct dict *d, const char *key, const char *where) {
    remember(d->document, &d->document->places, key);
    remember(d->document, &d->document->places, where);
}

void dict_know(const struct dict *d, const char *key) {
    ask(d, key);
}

struct entry *dict_ask(const struct dict *d, const char *key) {
    ask(d, key);
    struct entry *e = dict_find(d, key);
    if (e) e->used = true;
    return e;
}

bool dict_has(const struct dict *d, const char *key) {
    return dict_ask(d, key) != NULL;
}

void dict_rename(struct dict *d, const char *key, const char *to) {
    struct entry *e = dict_find_exact(d, key);
    if (e && !dict_find(d, to)) e->key = to;
}

const char *dict_path(const struct dict *d) {
    return d->path;
}

int dict_line(const struct dict *d, const char *key) {
    const struct entry *e = dict_find(d, key);
    return e ? e->line : d->line;
}

bool dict_is_foreign(const struct dict *d, const char *key) {
    const struct entry *e = dict_find(d, key);
    return e && entry_is_foreign(e);
}

bool dict_is_outside(const struct dict *d) {
    const struct document *all = d->document;
    return all->sources && all->source[0]->foreign;
}

const struct foam_header *dict_header(const struct dict *d) {
    return &d->document->header;
}

const char *dict_passed(const struct dict *d, int i) {
    return i < d->document->passed.count ? d->document->passed.name[i] : NULL;
}

int dict_count(const struct dict *d) {
    return d->count;
}
const char *dict_key(const struct dict *d, int i) {
    return d->entry[i].key;
}

/* ---- names ---- */

static int least(int a, int b) {
    return a < b ? a : b;
}

int name_distance(const char *a, const char *b) {
    int rows[3][64], n = (int)strlen(a), m = (int)strlen(b);
    if (n > 63 || m > 63) return 64;
    for (int i = 0; i <= n; i++) {
        int *row = rows[i % 3], *before = rows[(i + 2) % 3], *second = rows[(i + 1) % 3];
        row[0] = i;
        for (int j = 1; j <= m; j++) {
            if (!i) {
                row[j] = j;
                continue;
            }
            row[j] = least(before[j - 1] + (a[i - 1] != b[j - 1]), least(before[j], row[j - 1]) + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = least(row[j], second[j - 2] + 1);
        }
    }
    return rows[n % 3][m];
}

/* Returns the nearest of some names but one, NULL: none is within the distance that nearest_name allows. */
static const char *nearest_but(const char *word, const char *const *names, int count, const char *but) {
    const char *best = NULL;
    int nearest = 4;
    for (int i = 0; i < count; i++) {
        const int d = name_distance(word, names[i]), shorter = least((int)strlen(word), (int)strlen(names[i]));
        if (d >= nearest || 2 * d > shorter || (but && !strcmp(names[i], but))) continue;
        nearest = d;
        best = names[i];
    }
    return best;
}

const char *nearest_name(const char *word, const char *const *names, int count) {
    return nearest_but(word, names, count, NULL);
}

/* Writes "did you mean 'NEAR'?", or 'NEAR' or 'OTHER' where the other is less than twice as far. */
static const char *question(const char *word, const char *near, const char *const *names, int count, char out[MEANT]) {
    const char *other = nearest_but(word, names, count, near);
    if (other && name_distance(word, other) >= 2 * name_distance(word, near)) other = NULL;
    snprintf(out, MEANT, "; did you mean '%.80s'%s%.80s%s?", near, other ? " or '" : "", other ? other : "",
             other ? "'" : "");
    return out;
}

const char *name_question(const char *word, const char *const *names, int count, char out[MEANT]) {
    const char *near = nearest_name(word, names, count);
    *out = 0;
    return near ? question(word, near, names, count, out) : out;
}

/* ---- unused keys ---- */

/* Does a word begin with another one that is no mere letter or two? */
static bool begins(const char *word, const char *with) {
    return strlen(with) > 3 && !strncmp(word, with, strlen(with));
}

const char *dict_meant(const char *word, const char *const *names, int count) {
    const char *near = nearest_name(word, names, count);
    for (int i = 0; !near && i < count; i++)
        if (begins(word, names[i]) || begins(names[i], word)) near = names[i];
    return near;
}

static status unused(const struct dict *d, const struct entry *e) {
    const struct names *a = d->asked, *places = &d->document->places;
    if (e->foreign) return entry_fail_hidden(e);
    for (int i = 0; i + 1 < places->count; i += 2)
        if (!strcmp(e->key, places->name[i]))
            return fail(ERR_INPUT, "%s:%d: keyword '%s' is not used here; it belongs in  %s { %s ..; }", e->path,
                        e->line, e->key, places->name[i + 1], e->key);
    const char *near = dict_meant(e->key, a->name, a->count);
    char meant[MEANT];
    if (near)
        return fail(ERR_INPUT, "%s:%d: keyword '%s' is not used%s", e->path, e->line, e->key,
                    question(e->key, near, a->name, a->count, meant));
    char known[1024] = "";
    for (int i = 0; i < a->count; i++) {
        size_t n = strlen(known);
        snprintf(known + n, sizeof known - n, " %s", a->name[i]);
    }
    return fail(ERR_INPUT, "%s:%d: keyword '%s' is not used; remove it%s%s%s", e->path, e->line, e->key,
                a->count ? "; known here:" : "", known, a->count ? " (option -keywords explains them)" : "");
}

status dict_check_used(const struct dict *d) {
    for (int i = 0; i < d->count; i++) {
        const struct entry *e = &d->entry[i];
        if (!e->used) return unused(d, e);
        if (e->sub) TRY(dict_check_used(e->sub));
    }
    return OK;
}

const char *dict_unused(const struct dict *d) {
    for (int i = 0; i < d->count; i++)
        if (!d->entry[i].used && !d->entry[i].foreign) return d->entry[i].key;
    return NULL;
}

bool dict_is_used(const struct dict *d, int i) {
    return d->entry[i].used;
}

bool dict_key_fits(const struct dict *d, int i, const char *name) {
    const struct entry *e = &d->entry[i];
    return !strcmp(e->key, name) || (e->pattern && !regexec(e->pattern, name, 0, NULL, 0));
}

void dict_pass(struct dict *d, int i) {
    d->entry[i].used = true;
    if (d->entry[i].sub) dict_mark_used(d->entry[i].sub);
}

void dict_mark_used(struct dict *d) {
    for (int i = 0; i < d->count; i++) {
        d->entry[i].used = true;
        if (d->entry[i].sub) dict_mark_used(d->entry[i].sub);
    }
}

/* Lets the lists of d and below end where they begin. */
static void drop_lists(struct dict *d) {
    for (int i = 0; i < d->count; i++) {
        d->entry[i].start.position = 0;
        if (d->entry[i].sub) drop_lists(d->entry[i].sub);
    }
}

void dict_drop_text(struct dict *d) {
    struct document *all = d->document;
    drop_lists(all->top);
    for (int i = 0; i < all->sources; i++) source_drop_text(all->source[i]);
}

/* ---- text ---- */

struct text {
    char *text;
    size_t size, room;
};

static void add(struct text *t, const char *s) {
    size_t n = strlen(s);
    if (t->size + n + 1 > t->room) {
        size_t room = 2 * (t->size + n) + 256;
        char *more = realloc(t->text, room);
        if (!more) return;
        t->text = more;
        t->room = room;
    }
    memcpy(t->text + t->size, s, n + 1);
    t->size += n;
}

static void add_value(struct text *t, const struct entry *e, bool lines) {
    const char *before = "(";
    int line = e->line;
    for (int i = 0; i < e->count; i++) {
        const struct value *v = &e->value[i];
        for (; lines && line < v->line; line++) add(t, "\n");
        if (*before != '(' && *before != '[' && !(v->kind == TOKEN_PUNCTUATION && strchr(")];", *v->text))) add(t, " ");
        if (v->kind == TOKEN_STRING) add(t, "\"");
        add(t, v->text);
        for (const char *c = v->text; *c; c++) line += *c == '\n';
        if (v->kind == TOKEN_STRING) add(t, "\"");
        before = v->kind == TOKEN_PUNCTUATION ? v->text : "x";
    }
}

bool entry_is_foreign(const struct entry *e) {
    bool foreign = e->foreign;
    for (int i = 0; i < e->count; i++) foreign |= e->value[i].foreign;
    return foreign;
}

status entry_fail_hidden(const struct entry *e) {
    const struct source hidden = {.path = (char *)(uintptr_t)e->path, .foreign = true};
    return source_fail(&hidden, e->line, "%s", "");
}

char *entry_lines(const struct entry *e) {
    struct text t = {0};
    add_value(&t, e, true);
    add(&t, ";");
    return t.text;
}

void entry_print(const struct entry *e, char *text, size_t room) {
    struct text t = {0};
    add_value(&t, e, false);
    if (e->sub) add(&t, "{...}");
    if (e->raw) add(&t, " ...");
    snprintf(text, room, "%s", t.text ? t.text : "");
    free(t.text);
}

/* Is the key a word that can be read again without quotes? */
static bool is_word(const char *key) {
    struct source *s = NULL;
    struct token t = {0};
    status bad = source_from_text("", key, &s);
    struct lexer l = {0};
    if (!bad) l = lexer_start(s);
    if (!bad) bad = lexer_next(&l, &t);
    bool word = !bad && t.kind == TOKEN_WORD && !key[t.length] && t.text == s->text && !strchr("$#", *key) &&
                strcmp(key, "FoamFile") != 0;
    status_free(bad);
    source_free(s);
    return word;
}

static void add_dict(struct text *t, const struct dict *d, int depth) {
    for (int i = 0; i < d->count; i++) {
        const struct entry *e = &d->entry[i];
        for (int k = 0; k < depth; k++) add(t, "    ");
        const char *quote = e->pattern || !is_word(e->key) ? "\"" : "";
        add(t, quote);
        add(t, e->key);
        add(t, quote);
        if (e->sub) {
            add(t, " {\n");
            add_dict(t, e->sub, depth + 1);
            for (int k = 0; k < depth; k++) add(t, "    ");
            add(t, "}\n");
            continue;
        }
        if (e->count) add(t, " ");
        add_value(t, e, false);
        add(t, e->raw ? " /* not shown */;\n" : ";\n");
    }
}

char *dict_print(const struct dict *d) {
    struct text t = {0};
    add(&t, "");
    add_dict(&t, d, 0);
    return t.text;
}
