/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes a dictionary from text in OpenFOAM's grammar: entries and sub-dictionaries, macros ($name), #include, #eval,
 * #if, #inputMode, #remove, #default. It runs no code and bounds depth and memory: macros and #include that multiply
 * are refused. */
#include "solvers/dict/dict_reading.h"

#include "mesh/format/files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static status read_entries(struct reading *r, struct file *f, struct dict *d, const struct token *opening);

status reading_fail(const struct file *f, int line, const char *format, const char *what) {
    char text[512];
    snprintf(text, sizeof text, format, what);
    return source_fail(f->l.source, line, "%s", text);
}

status reading_charge(struct reading *r, const struct file *f, int line, size_t copies) {
    r->copied += copies < COPIES ? (long)copies : COPIES;
    if (r->copied < COPIES) return OK;
    return reading_fail(f, line, "%s make more than a million values of this dictionary", "macros and #include");
}

status reading_push(struct reading *r, struct entry *e, struct value v) {
    TRY(document_grow(r->document, &e->value, e->count, &e->room, sizeof v));
    e->value[e->count++] = v;
    return OK;
}

/* ---- values ---- */

struct brackets {
    int depth;
    char open[DEPTH];
    int line[DEPTH];
};

/* Fails if a ';' is missing: a word that starts a line, with more than ';' behind it, is the next keyword. */
static status check_semicolon(const struct file *f, const struct entry *e, const struct token *t) {
    if (!e->count || !t->first_on_line || (t->kind != TOKEN_WORD && t->kind != TOKEN_STRING)) return OK;
    if (t->length > 5 && !memcmp(t->text, "List<", 5)) return OK;
    struct token next;
    TRY(lexer_peek(&f->l, &next));
    if (token_is(&next, ";") || token_is(t, "#eval") || token_is(t, "#calc")) return OK;
    return source_fail(f->l.source, e->line, "missing ';' after the value of '%s'? Line %d goes on with '%.*s'", e->key,
                       t->line, t->length, t->text);
}

/* Does a ';' follow the '}' of the '{' that was read? A dictionary that ends an entry's value has one, as in
 * `div(phi,h) Gauss multivariate { .. };`, that of a keyword of its own has none. */
static bool closes_value(struct lexer l) {
    struct token t;
    for (int depth = 1; depth > 0; depth += token_is(&t, "{") - token_is(&t, "}")) {
        const status s = lexer_next(&l, &t);
        status_free(s);
        if (s || t.kind == TOKEN_END) return false;
    }
    const status s = lexer_next(&l, &t);
    status_free(s);
    return !s && token_is(&t, ";");
}

static status push_punctuation(struct reading *r, const struct file *f, struct entry *e, const struct token *t,
                               struct brackets *b) {
    static const char opens[] = "([{", closes[] = ")]}";
    char c = t->text[0];
    const char *closing = strchr(closes, c);
    if (strchr(opens, c)) {
        if (c == '{' && !b->depth && !closes_value(f->l) &&
            (!e->count || e->value[e->count - 1].kind != TOKEN_NUMBER || t->first_on_line))
            return source_fail(f->l.source, e->line, "missing ';' after the value of '%s'? Line %d goes on with '{'",
                               e->key, t->line);
        if (b->depth == DEPTH) return lexer_fail(&f->l, t, "brackets are nested deeper than %d", DEPTH);
        b->line[b->depth] = t->line;
        b->open[b->depth++] = c;
    } else if (closing) {
        if (!b->depth && c == '}')
            return source_fail(f->l.source, e->line, "missing ';' after the value of '%s'? Line %d goes on with '}'",
                               e->key, t->line);
        if (!b->depth) return lexer_fail(&f->l, t, "no bracket is open");
        if (b->open[--b->depth] != opens[closing - closes])
            return lexer_fail(&f->l, t, "the bracket '%c' of line %d is open", b->open[b->depth], b->line[b->depth]);
    } else if (c == '\'') {
        return lexer_fail(&f->l, t, "strings stand in \"double quotes\"");
    }
    struct value v = {.kind = t->kind, .line = t->line, .foreign = f->l.source->foreign};
    TRY(document_copy(r->document, t->text, t->length, &v.text));
    return reading_push(r, e, v);
}

static int item_bytes(const struct token *t, const struct foam_header *h) {
    static const struct {
        const char *name;
        int scalars;
    } kinds[] = {{"List<scalar>", 1},          {"List<vector>", 3}, {"List<symmTensor>", 6},
                 {"List<sphericalTensor>", 1}, {"List<tensor>", 9}, {"List<label>", 0}};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (token_is(t, kinds[i].name)) return kinds[i].scalars ? kinds[i].scalars * h->scalar_bytes : h->label_bytes;
    return 0;
}

static status push_token(struct reading *r, struct file *f, struct dict *d, struct entry *e, const struct token *t) {
    if (t->kind == TOKEN_WORD && *t->text == '$') return macro_push(r, f, d, e, t);
    if (t->kind == TOKEN_WORD && (token_is(t, "#eval") || token_is(t, "#calc"))) return eval_push(r, f, d, e);
    if (t->kind == TOKEN_WORD && *t->text == '#')
        return lexer_fail(&f->l, t,
                          "in a value only #eval{ ... } and #calc \"...\" (arithmetic) are known; no code is run");
    if (t->kind == TOKEN_VERBATIM) return lexer_fail(&f->l, t, "no code is run from a dictionary");
    if (!strcmp(e->key, "type") && t->length > 5 && !memcmp(t->text, "coded", 5))
        return lexer_fail(&f->l, t, "no code is run from a dictionary; choose a type that is built in");
    struct value v = {.kind = t->kind, .number = t->number, .line = t->line, .foreign = f->l.source->foreign};
    TRY(document_copy(r->document, t->text, t->length, &v.text));
    TRY(reading_push(r, e, v));
    int bytes = t->kind == TOKEN_WORD ? item_bytes(t, &f->header) : 0;
    if (bytes) {
        e->raw = true;
        e->header = f->header;
        TRY(foam_list_skip(&f->l, &f->header, bytes));
    }
    return OK;
}

static status read_value(struct reading *r, struct file *f, struct dict *d, struct entry *e) {
    struct brackets b = {0};
    struct lexer start = f->l;
    for (;;) {
        struct token t;
        TRY(lexer_next(&f->l, &t));
        if (t.kind == TOKEN_END && b.depth)
            return lexer_fail(&f->l, &t, "the bracket '%c' of line %d is open", b.open[b.depth - 1],
                              b.line[b.depth - 1]);
        if (t.kind == TOKEN_END)
            return reading_fail(f, e->line, "missing ';' after the value of '%s'? The file ends", e->key);
        if (!b.depth && token_is(&t, ";") && t.kind == TOKEN_PUNCTUATION) break;
        if (!b.depth) TRY(check_semicolon(f, e, &t));
        if (f->from) TRY(reading_charge(r, f, t.line, 1));
        if (t.kind == TOKEN_PUNCTUATION && *t.text == ';' && b.open[b.depth - 1] != '{')
            return lexer_fail(&f->l, &t, "the bracket '%c' of line %d is open", b.open[b.depth - 1],
                              b.line[b.depth - 1]);
        bool own = !e->raw;
        if (t.kind == TOKEN_PUNCTUATION)
            TRY(push_punctuation(r, f, e, &t, &b));
        else
            TRY(push_token(r, f, d, e, &t));
        if (own && e->raw && *t.text != '$') e->start = start;
    }
    return OK;
}

/* ---- entries ---- */

static bool is_pattern(const struct token *key) {
    for (int i = 0; i < key->length; i++)
        if (strchr(".*+?()[]{}|^$\\", key->text[i])) return key->kind == TOKEN_STRING;
    return false;
}

static status compile_pattern(struct reading *r, const struct file *f, struct entry *e) {
    char why[128];
    TRY(document_pattern(r->document, e->key, &e->pattern, why, sizeof why));
    if (e->pattern) return OK;
    return source_fail(f->l.source, e->line, "\"%.80s\" is no regular expression: %s", e->key, why);
}

/* Finds the entry of a key, or adds it, and empties it; *out is NULL if the mode protects the old entry. */
static status place(struct reading *r, const struct file *f, struct dict *d, const char *key, bool pattern, int line,
                    bool is_sub, struct entry **out) {
    struct entry *e = dict_find_exact(d, key);
    *out = NULL;
    if (e && r->mode == ERROR)
        return source_fail(f->l.source, line, "'%s' was set in line %d already, and #inputMode is error", key, e->line);
    if (e && r->mode == PROTECT) return OK;
    bool fresh = !e;
    if (fresh) {
        if (d->count == KEYS)
            return reading_fail(f, line, "%s has more than 10000 keywords", *d->name ? d->name : "the file");
        TRY(document_grow(r->document, &d->entry, d->count, &d->room, sizeof *e));
        e = &d->entry[d->count];
        *e = (struct entry){.key = key};
    }
    e->path = f->l.source->path;
    e->foreign = f->l.source->foreign;
    e->line = line;
    e->count = e->room = 0;
    e->value = NULL;
    e->raw = false;
    if (!is_sub || r->mode == OVERWRITE) e->sub = NULL;
    if (fresh && pattern) TRY(compile_pattern(r, f, e));
    d->count += fresh;
    *out = e;
    return OK;
}

static status new_sub(struct reading *r, struct dict *d, struct entry *e) {
    char name[512];
    snprintf(name, sizeof name, "%s%s%s", d->name, *d->name ? "." : "", e->key);
    struct dict *sub = NULL;
    TRY(document_take(r->document, sizeof *sub, &sub));
    *sub = (struct dict){.document = r->document, .parent = d, .path = e->path, .line = e->line};
    TRY(document_copy(r->document, name, -1, &sub->name));
    TRY(document_take(r->document, sizeof *sub->asked, &sub->asked));
    e->sub = sub;
    return OK;
}

static status insert(struct reading *r, const struct file *f, struct dict *to, const struct dict *from, int line,
                     int depth) {
    int count = from->count; /* `to` may hold `from`, which then may grow */
    for (int i = 0; i < count; i++) {
        const struct entry *old = &from->entry[i];
        if (old->open || (old->sub && (old->sub == to || depth > DEPTH))) continue;
        TRY(reading_charge(r, f, line, 10)); /* an entry weighs more than a value */
        struct entry *e = NULL, copy = *old;
        TRY(place(r, f, to, copy.key, false, copy.line, copy.sub != NULL, &e));
        if (!e) continue;
        struct dict *sub = e->sub;
        *e = copy;
        e->used = false;
        e->sub = sub;
        if (!copy.sub) continue;
        if (!sub) TRY(new_sub(r, to, e));
        TRY(insert(r, f, e->sub, copy.sub, line, depth + 1));
    }
    return OK;
}

static status expect_end(struct file *f, const struct entry *e) {
    struct token t;
    TRY(lexer_next(&f->l, &t));
    if (token_is(&t, ";")) return OK;
    return source_fail(f->l.source, e->line, "missing ';' after '%s'?", e->key);
}

/* Reads `$base;`, which inserts a dictionary into this one. */
static status read_insertion(struct reading *r, struct file *f, struct dict *d, const struct token *key) {
    struct entry *from = NULL;
    TRY(macro_find(f, d, key->text, key->length, key->line, &from));
    if (!from->sub) return lexer_fail(&f->l, key, "only a dictionary can be inserted; is a keyword missing before it?");
    TRY(insert(r, f, d, from->sub, key->line, 0));
    struct token t;
    TRY(lexer_peek(&f->l, &t));
    return token_is(&t, ";") ? lexer_next(&f->l, &t) : OK;
}

static status read_sub(struct reading *r, struct file *f, struct dict *d, const char *key, bool pattern, int line) {
    struct token brace;
    struct entry *e = NULL, away = {.key = key, .path = f->l.source->path, .line = line};
    TRY(lexer_next(&f->l, &brace));
    TRY(place(r, f, d, key, pattern, line, true, &e));
    if (!e) e = &away; /* the old one is protected: the new one is read and dropped */
    bool fresh = !e->sub;
    if (fresh) TRY(new_sub(r, d, e));
    e->open = fresh;
    struct dict *sub = e->sub;
    TRY(read_entries(r, f, sub, &brace));
    for (int i = 0; i < d->count; i++) /* the entries may have moved */
        if (d->entry[i].sub == sub) d->entry[i].open = false;
    return OK;
}

/* Does a list of dictionaries follow, `( name { ... } ... )`? It is read as a dictionary. */
static bool is_named_list(struct lexer l) {
    struct token t[3];
    for (int i = 0; i < 3; i++) {
        status s = lexer_next(&l, &t[i]);
        status_free(s);
        if (s) return false;
    }
    return token_is(&t[0], "(") && t[1].kind == TOKEN_WORD && token_is(&t[2], "{");
}

/* Reads `key $base;`, which copies base if it is a dictionary (*done). */
static status copy_sub(struct reading *r, struct file *f, struct dict *d, const char *key, bool pattern,
                       const struct token *t, bool *done) {
    struct entry *from = NULL, *e = NULL;
    *done = false;
    if (t->kind != TOKEN_WORD || *t->text != '$') return OK;
    TRY(macro_find(f, d, t->text, t->length, t->line, &from));
    if (!from->sub) return OK;
    struct dict *source = from->sub;
    struct token skip;
    TRY(lexer_next(&f->l, &skip));
    TRY(place(r, f, d, key, pattern, t->line, true, &e));
    if (e) {
        if (!e->sub) TRY(new_sub(r, d, e));
        if (e->sub != source) TRY(insert(r, f, e->sub, source, t->line, 0));
    }
    struct entry name = {.key = key, .line = t->line};
    *done = true;
    return expect_end(f, &name);
}

static status read_entry(struct reading *r, struct file *f, struct dict *d, const struct token *key) {
    if (key->kind == TOKEN_WORD && *key->text == '$') return read_insertion(r, f, d, key);
    if (key->kind != TOKEN_WORD && key->kind != TOKEN_STRING)
        return lexer_fail(&f->l, key, "expected a keyword%s", token_is(key, "}") ? ": no '{' is open" : "");
    if (key->length >= 3 && !memcmp(key->text, "\xEF\xBB\xBF", 3)) /* it would be lost where the key comes first */
        return lexer_fail(&f->l, key, "a mark of byte order stands inside the file: take it out");
    struct token t;
    const char *name = NULL;
    if (f->from) TRY(reading_charge(r, f, key->line, 10));
    bool pattern = is_pattern(key), done;
    TRY(document_copy(r->document, key->text, key->length, &name));
    TRY(lexer_peek(&f->l, &t));
    if (t.kind == TOKEN_PUNCTUATION && *t.text == '{') return read_sub(r, f, d, name, pattern, key->line);
    if (is_named_list(f->l)) {
        struct entry list = {.key = name, .line = key->line};
        TRY(read_sub(r, f, d, name, pattern, key->line));
        return expect_end(f, &list);
    }
    TRY(copy_sub(r, f, d, name, pattern, &t, &done));
    if (done) return OK;
    /* The old value stays in place while the new one is read: `a #eval{ 2*$a };` */
    struct entry fresh = {.key = name, .path = f->l.source->path, .line = key->line}, *e = NULL;
    fresh.foreign = f->l.source->foreign;
    TRY(read_value(r, f, d, &fresh));
    TRY(place(r, f, d, name, pattern, key->line, false, &e));
    if (!e) return OK;
    fresh.key = e->key;
    fresh.pattern = e->pattern;
    *e = fresh;
    return OK;
}

/* ---- directives ---- */

/* Opens a file to include; a file that is included again is not read again. */
static status open_once(struct reading *r, const struct file *f, const char *path, int line, struct source **out) {
    for (int i = 0; i < r->document->sources; i++) {
        *out = r->document->source[i];
        if (!strcmp((*out)->path, path)) return reading_charge(r, f, line, 100 + (*out)->size / 100);
    }
    TRY(source_open(path, out));
    (*out)->foreign = file_is_foreign(path, f->case_length);
    return document_keep(r->document, *out);
}

/* Reads the entries of another file of the case; t: its name, where it is asked for. */
static status read_file(struct reading *r, struct file *f, struct dict *d, const char *path, const struct token *t) {
    int depth = 0;
    for (const struct file *up = f; up; up = up->from, depth++) {
        size_t length = strlen(path);
        if (!strncmp(up->l.source->path, path, length) &&
            (!up->l.source->path[length] || !strcmp(up->l.source->path + length, ".gz")))
            return lexer_fail(&f->l, t, "the file includes itself");
    }
    if (depth > INCLUDES) return lexer_fail(&f->l, t, "#include is nested deeper than %d", INCLUDES);
    struct source *s = NULL;
    TRY(open_once(r, f, path, t->line, &s));
    struct file in = {.l = lexer_start(s), .from = f, .case_length = f->case_length};
    TRY(foam_header_read(&in.l, &in.header));
    return read_entries(r, &in, d, NULL);
}

/* OpenFOAM's etc/caseDicts/setConstraintTypes gives patches of these types, by their group, entries of the type. Who
 * reads the dictionary may have no use for them. All other files of caseDicts are for OpenFOAM's own programs. */
static status read_etc(struct reading *r, struct file *f, struct dict *d, const struct token *t) {
    static const char *const types[] = {"empty", "cyclic", "symmetry", "symmetryPlane"};
    static const char text[] = "empty { type empty; } cyclic { type cyclic; } symmetry { type symmetry; } "
                               "symmetryPlane { type symmetryPlane; }";
    struct source *s = NULL;
    if (!token_is(t, "caseDicts/setConstraintTypes")) return OK;
    TRY(source_from_text("caseDicts/setConstraintTypes", text, &s));
    TRY(document_keep(r->document, s));
    struct file in = {.l = lexer_start(s), .from = f, .case_length = f->case_length};
    TRY(read_entries(r, &in, d, NULL));
    for (int i = 0; i < 4; i++) {
        struct entry *e = dict_find_exact(d, types[i]);
        if (!e || e->path != s->path) continue;
        e->used = true;
        dict_mark_used(e->sub);
    }
    return OK;
}

static status read_include(struct reading *r, struct file *f, struct dict *d, const struct token *directive) {
    struct token t;
    char path[INCLUDE_PATH];
    bool present;
    TRY(lexer_next(&f->l, &t));
    if (t.kind != TOKEN_STRING && t.kind != TOKEN_WORD) return lexer_fail(&f->l, &t, "expected a \"file\" to include");
    TRY(include_find(&f->l, &t, f->case_length, path, &present));
    const bool etc = token_is(directive, "#includeEtc");
    if (!present && etc && t.length > 10 && !memcmp(t.text, "caseDicts/", 10)) return read_etc(r, f, d, &t);
    if (!present && token_is(directive, "#includeIfPresent")) return OK;
    if (!present)
        return lexer_fail(&f->l, &t, "there is no file %s%s", path,
                          etc ? " (there is no etc folder: give a path in the case)" : "");
    return read_file(r, f, d, path, &t);
}

/* Reads the word behind #includeFunc, NAME or NAME(arguments), which may go on over lines, and hold blanks. */
static status read_function_name(struct file *f, const struct token *directive, struct token *t) {
    static const char blanks[] = " \t\r\n";
    const char *text = f->l.source->text, *start = text + f->l.position, *p;
    int depth = 0;
    start += strspn(start, " \t");
    for (p = start; *p && !strchr("(;{}", *p) && !strchr(blanks, *p); p++) continue;
    *t = (struct token){.kind = TOKEN_WORD, .text = start, .length = (int)(p - start), .line = directive->line};
    if (!t->length) return lexer_fail(&f->l, directive, "the name of a function object follows");
    if (p[strspn(p, blanks)] == '(') do {
            depth += (*p == '(') - (*p == ')');
            f->l.line += *p == '\n';
        } while (*++p && (depth > 0 || p[-1] != ')'));
    if (depth > 0) return reading_fail(f, t->line, "the '(' behind %s is not closed", "#includeFunc");
    if (p[-1] == ')') t->length = (int)(p - start);
    f->l.position = (size_t)(p - text);
    f->l.last_line = f->l.line;
    return OK;
}

/* Reads `#includeFunc NAME`: a function object whose dictionary is the file NAME of this folder. One that OpenFOAM
 * itself has, or that gets arguments, is none of haff's: it is noted and passed over. */
static status read_function(struct reading *r, struct file *f, struct dict *d, const struct token *directive) {
    char path[INCLUDE_PATH];
    const char *key;
    struct entry *e = NULL;
    bool present = false;
    struct token t;
    TRY(read_function_name(f, directive, &t));
    TRY(document_copy(r->document, t.text, t.length, &key));
    if (!strpbrk(key, "($\"")) TRY(include_find(&f->l, &t, f->case_length, path, &present));
    if (!present) return document_note(r->document, f->l.source, t.line, "#includeFunc %s", key);
    TRY(place(r, f, d, key, false, t.line, true, &e));
    if (!e) return OK;
    if (!e->sub) TRY(new_sub(r, d, e));
    return read_file(r, f, e->sub, path, &t);
}

static status read_mode(struct reading *r, struct file *f) {
    static const struct {
        const char *name;
        enum mode mode;
    } modes[] = {{"merge", MERGE},     {"default", MERGE}, {"overwrite", OVERWRITE},
                 {"protect", PROTECT}, {"warn", PROTECT},  {"error", ERROR}};
    struct token t;
    TRY(lexer_next(&f->l, &t));
    for (size_t i = 0; i < sizeof modes / sizeof *modes; i++)
        if (token_is(&t, modes[i].name)) {
            r->mode = modes[i].mode;
            return OK;
        }
    return lexer_fail(&f->l, &t, "#inputMode is merge, overwrite, protect, warn or error");
}

/* Reads `#inputSyntax slash;` or dot, OpenFOAM's ways to write macros: both are known anyway. */
static status read_syntax(struct file *f) {
    struct token t;
    TRY(lexer_next(&f->l, &t));
    return token_is(&t, "slash") || token_is(&t, "dot") ? OK : lexer_fail(&f->l, &t, "#inputSyntax is slash or dot");
}

static void remove_key(struct dict *d, const struct token *t) {
    regex_t pattern;
    char key[512], why[128];
    snprintf(key, sizeof key, "%.*s", t->length, t->text);
    bool compiled = is_pattern(t) && pattern_compile(&pattern, key, why, sizeof why);
    int kept = 0;
    for (int i = 0; i < d->count; i++) {
        struct entry *e = &d->entry[i];
        bool hit = !strcmp(e->key, key) || (compiled && !regexec(&pattern, e->key, 0, NULL, 0));
        if (!hit) d->entry[kept++] = *e;
    }
    d->count = kept;
    if (compiled) regfree(&pattern);
}

static status read_remove(struct file *f, struct dict *d) {
    struct token t;
    TRY(lexer_next(&f->l, &t));
    if (!token_is(&t, "(")) {
        if (t.kind != TOKEN_WORD && t.kind != TOKEN_STRING) return lexer_fail(&f->l, &t, "expected a key to remove");
        remove_key(d, &t);
        return OK;
    }
    for (;;) {
        TRY(lexer_next(&f->l, &t));
        if (token_is(&t, ")")) return OK;
        if (t.kind != TOKEN_WORD && t.kind != TOKEN_STRING) return lexer_fail(&f->l, &t, "expected a key to remove");
        remove_key(d, &t);
    }
}

/* Reads `#default key value;`, which sets a key that is not set. */
static status read_default(struct reading *r, struct file *f, struct dict *d) {
    enum mode before = r->mode;
    struct token t;
    r->mode = PROTECT;
    TRY(lexer_next(&f->l, &t));
    TRY(read_entry(r, f, d, &t));
    r->mode = before;
    return OK;
}

/* ---- conditions ---- */

/* Reads one value after #if or #ifeq, with macros and #eval done. */
static status read_operand(struct reading *r, struct file *f, struct dict *d, const struct token *directive,
                           struct entry *e) {
    struct token t;
    *e = (struct entry){.key = "#if", .path = f->l.source->path, .line = directive->line};
    TRY(lexer_next(&f->l, &t));
    if (t.first_on_line || t.kind == TOKEN_PUNCTUATION || t.kind == TOKEN_END)
        return lexer_fail(&f->l, &t, "expected a value on the line of %.*s", directive->length, directive->text);
    return push_token(r, f, d, e, &t);
}

/* Moves behind the #else or #endif that belongs to the #if at `line`. */
static status skip_branch(struct file *f, int line, bool stop_at_else, bool *at_else) {
    int depth = 1;
    for (;;) {
        struct token t;
        TRY(lexer_next(&f->l, &t));
        if (t.kind == TOKEN_END) return reading_fail(f, line, "%s has no #endif", "#if");
        if (t.kind != TOKEN_WORD) continue;
        depth += token_is(&t, "#if") || token_is(&t, "#ifeq");
        if (token_is(&t, "#endif")) depth--;
        *at_else = token_is(&t, "#else");
        if (!depth || (depth == 1 && stop_at_else && *at_else)) return OK;
    }
}

static status read_condition(struct reading *r, struct file *f, struct dict *d, const struct token *t, bool *holds) {
    struct entry a, b;
    char left[256], right[256];
    TRY(read_operand(r, f, d, t, &a));
    entry_print(&a, left, sizeof left);
    if (strlen(left) == sizeof left - 1) return reading_fail(f, t->line, "the value behind %s is too long", "#if");
    if (token_is(t, "#ifeq")) {
        TRY(read_operand(r, f, d, t, &b));
        entry_print(&b, right, sizeof right);
        bool numbers = a.count == 1 && b.count == 1 && a.value->kind == TOKEN_NUMBER && b.value->kind == TOKEN_NUMBER;
        *holds = numbers ? a.value->number == b.value->number : !strcmp(left, right);
        return OK;
    }
    static const char *const yes[] = {"on", "yes", "true", "y", "t"}, *const no[] = {"off", "no", "false", "n", "f"};
    if (a.count == 1 && a.value->kind == TOKEN_NUMBER) {
        *holds = a.value->number != 0;
        return OK;
    }
    for (int i = 0; i < 5; i++) {
        *holds = !strcmp(left, yes[i]);
        if (*holds || !strcmp(left, no[i])) return OK;
    }
    if (entry_is_foreign(&a)) return entry_fail_hidden(&a);
    return source_fail(f->l.source, t->line, "#if is '%s'; expected a number, or on, off, yes, no, true, false", left);
}

/* Reads #if, #ifeq, #else or #endif; *ifs counts the #if that are open among the entries being read. */
static status read_branch(struct reading *r, struct file *f, struct dict *d, const struct token *t, int *ifs) {
    bool holds = false, at_else = false;
    if (token_is(t, "#if") || token_is(t, "#ifeq")) {
        TRY(read_condition(r, f, d, t, &holds));
        if (!holds) TRY(skip_branch(f, t->line, true, &at_else));
        *ifs += holds || at_else;
        return OK;
    }
    if (!*ifs) return lexer_fail(&f->l, t, "there is no #if before it in this dictionary");
    --*ifs;
    return token_is(t, "#else") ? skip_branch(f, t->line, false, &at_else) : OK;
}

static status read_directive(struct reading *r, struct file *f, struct dict *d, const struct token *t, int *ifs) {
    if (token_is(t, "#include") || token_is(t, "#includeIfPresent") || token_is(t, "#includeEtc"))
        return read_include(r, f, d, t);
    if (token_is(t, "#if") || token_is(t, "#ifeq") || token_is(t, "#else") || token_is(t, "#endif"))
        return read_branch(r, f, d, t, ifs);
    if (token_is(t, "#includeFunc")) return read_function(r, f, d, t);
    if (token_is(t, "#inputMode")) return read_mode(r, f);
    if (token_is(t, "#inputSyntax")) return read_syntax(f);
    if (token_is(t, "#remove")) return read_remove(f, d);
    if (token_is(t, "#default")) return read_default(r, f, d);
    return lexer_fail(
        &f->l, t,
        "known are #include #includeIfPresent #includeEtc #includeFunc #remove #default #inputMode #if #ifeq #else "
        "#endif, and #eval #calc in values; no code is run");
}

/* Reads entries up to the '}' or ')' of `opening`, or to the end of the file if that is NULL. */
static status read_entries(struct reading *r, struct file *f, struct dict *d, const struct token *opening) {
    int ifs = 0;
    char closing = opening && *opening->text == '(' ? ')' : '}';
    if (++r->depth > DEPTH) return lexer_fail(&f->l, opening, "dictionaries are nested deeper than %d", DEPTH);
    for (;;) {
        struct token t;
        TRY(lexer_next(&f->l, &t));
        bool ends = t.kind == TOKEN_END || (opening && t.kind == TOKEN_PUNCTUATION && *t.text == closing);
        if (ends && t.kind == TOKEN_END && opening)
            return reading_fail(f, opening->line,
                                closing == ')' ? "the '(' of '%s' is not closed" : "the '{' of '%s' is not closed",
                                d->name);
        if (ends && ifs) return reading_fail(f, t.line, "an %s has no #endif", "#if");
        if (ends) break;
        if (t.kind == TOKEN_PUNCTUATION && *t.text == ';') continue;
        if (t.kind == TOKEN_WORD && *t.text == '#')
            TRY(read_directive(r, f, d, &t, &ifs));
        else
            TRY(read_entry(r, f, d, &t));
    }
    r->depth--;
    return OK;
}

status dict_parse(struct document *d, struct source *s) {
    struct reading r = {.document = d};
    struct file f = {.l = lexer_start(s), .case_length = path_case(s->path)};
    TRY(foam_header_read(&f.l, &f.header));
    d->header = f.header;
    return read_entries(&r, &f, d->top, NULL);
}
