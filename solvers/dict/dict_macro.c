/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Macros of dictionaries, $name and ${name}, and the expressions of #eval. */
#include "solvers/dict/dict_reading.h"
#include "solvers/dict/expr.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { EXPANSION = 4096 }; /* characters of the text of #eval, macros expanded */

/* Counts the dictionaries on the way from `top` down to `d` as used: a macro named them. */
static void use_path(const struct dict *top, const struct dict *d) {
    for (; d != top && d->parent; d = d->parent)
        for (int i = 0; i < d->parent->count; i++)
            if (d->parent->entry[i].sub == d) d->parent->entry[i].used = true;
}

typedef struct entry *finder(const struct dict *d, const char *key);

/* Finds an entry by its path of names, a or a.b, in d. */
static struct entry *find_path(struct dict *d, const char *name, finder *find) {
    struct entry *e = find(d, name);
    if (e) return e;
    const struct dict *in = d;
    char part[256];
    const char *rest = name;
    for (const char *dot; (dot = strchr(rest, '.')); rest = dot + 1) {
        snprintf(part, sizeof part, "%.*s", (int)(dot - rest), rest);
        e = find(in, part);
        if (!e || !e->sub || e->open) return NULL;
        in = e->sub;
    }
    e = rest == name ? NULL : find(in, rest);
    if (e) use_path(d, in);
    return e;
}

/* Finds the entry that a macro names. `name` is what follows '$', without braces: a, a.b, :a.b, ..a. Returns NULL if
 * there is none. As in OpenFOAM, a dictionary that is still being read has no entries for a path that comes from
 * above. */
static struct entry *find_entry(struct dict *d, const char *name, finder *find) {
    const bool upwards = *name != ':' && *name != '.';
    struct entry *e = NULL;
    if (*name == ':') {
        while (d->parent) d = d->parent;
        name++;
    } else if (*name == '.') {
        for (name++; *name == '.'; name++) {
            if (!d->parent) return NULL;
            d = d->parent;
        }
    }
    for (; d && !e; d = upwards ? d->parent : NULL) e = find_path(d, name, find);
    return e;
}

/* Writes a macro's name with dots: OpenFOAM 8 and later also write  !a/b  for  :a.b,  ../a  for  ..a,  a/b  for  a.b */
static void write_dotted(const char *text, int length, char out[256]) {
    int n = 0;
    if (length && *text == '!') out[n++] = ':';
    for (int i = n; i < length && n < 255; i++) {
        const bool up = length - i > 2 && !memcmp(text + i, "../", 3);
        if (up && !n) out[n++] = '.';
        out[n++] = text[i] == '/' || up ? '.' : text[i];
        if (up) i += 2;
    }
    out[n] = 0;
}

status macro_find(const struct file *f, struct dict *d, const char *text, int length, int line, struct entry **out) {
    char name[256];
    if (length > 2 && text[1] == '{') {
        if (text[2] == '{') return reading_fail(f, line, "%s is not known; write #eval{ ... }", "${{ ... }}");
        text++;
        length -= 2;
    }
    write_dotted(text + 1, length - 1, name);
    *out = find_entry(d, name, dict_find_exact);
    if (!*out) *out = find_entry(d, name, dict_find); /* a pattern may fit more than was meant: it comes last */
    if (!*out || (*out)->open)
        return reading_fail(
            f, line, "macro '$%s' names no entry that stands before it (environment variables are not read)", name);
    (*out)->used = true; /* the key may be a variable of the user's own */
    if ((*out)->sub) dict_mark_used((*out)->sub);
    return OK;
}

status macro_push(struct reading *r, struct file *f, struct dict *d, struct entry *e, const struct token *t) {
    struct entry *from = NULL;
    TRY(macro_find(f, d, t->text, t->length, t->line, &from));
    if (from->sub)
        return reading_fail(f, t->line, "'$%s' is a dictionary; it cannot be part of a value (missing ';' before it?)",
                            from->key);
    TRY(reading_charge(r, f, t->line, (size_t)from->count));
    for (int i = 0; i < from->count; i++) {
        struct value v = from->value[i];
        v.line = 0; /* that of the macro counts */
        TRY(reading_push(r, e, v));
    }
    if (from->raw) {
        e->raw = true;
        e->start = from->start;
        e->header = from->header;
    }
    return OK;
}

/* Expands the macros in the text of #eval. Their values are put in brackets, so that $a^2 is the square also of a
 * negative a. */
static status expand_text(const struct file *f, struct dict *d, const char *text, int length, int line,
                          char out[EXPANSION], bool *foreign) {
    size_t n = 0;
    *foreign = false;
    for (int i = 0; i < length; i++) {
        int end = i + 1;
        if (text[i] == '$' && end < length && text[end] == '{') {
            while (end < length && text[end] != '}') end++;
            end += end < length;
        } else if (text[i] == '$') {
            while (end < length && (isalnum((unsigned char)text[end]) || strchr("_.:", text[end]))) end++;
        }
        if (text[i] == '$') {
            struct entry *e = NULL;
            char value[512];
            TRY(macro_find(f, d, text + i, end - i, line, &e));
            entry_print(e, value, sizeof value);
            *foreign |= entry_is_foreign(e);
            if (strlen(value) == sizeof value - 1) return reading_fail(f, line, "the text of %s is too long", "#eval");
            n += (size_t)snprintf(out + n, EXPANSION - n, "(%s)", value);
            i = end - 1;
        } else {
            out[n++] = text[i];
        }
        if (n >= EXPANSION - 2) return reading_fail(f, line, "the text of %s is too long", "#eval");
    }
    out[n] = 0;
    return OK;
}

status eval_push(struct reading *r, struct file *f, struct dict *d, struct entry *e) {
    struct token t;
    char text[EXPANSION];
    TRY(lexer_next(&f->l, &t));
    if (token_is(&t, "{")) {
        int braces = 1, line = f->l.line;
        const char *start = f->l.source->text + f->l.position, *p = start;
        for (; *p && braces; p++) {
            braces += (*p == '{') - (*p == '}');
            line += *p == '\n';
        }
        if (braces) return reading_fail(f, t.line, "the '{' of %s is not closed", "#eval");
        t.text = start;
        t.length = (int)(p - 1 - start);
        f->l.position += (size_t)(p - start);
        f->l.line = f->l.last_line = line;
    } else if (t.kind != TOKEN_STRING && t.kind != TOKEN_VERBATIM) {
        return lexer_fail(&f->l, &t, "expected #eval{ ... } or #eval \"...\"");
    }
    struct value v = {.kind = TOKEN_NUMBER, .foreign = f->l.source->foreign};
    bool foreign;
    TRY(expand_text(f, d, t.text, t.length, t.line, text, &foreign));
    v.foreign |= foreign;
    status bad = expr_constant(text, &v.number);
    if (bad) {
        const struct source at = {.path = f->l.source->path, .foreign = v.foreign};
        status e2 = source_fail(&at, t.line, "%s", status_text(bad));
        status_free(bad);
        return e2;
    }
    char number[32];
    snprintf(number, sizeof number, "%.15g", v.number);
    if (strtod(number, NULL) != v.number) snprintf(number, sizeof number, "%.17g", v.number);
    TRY(document_copy(r->document, number, -1, &v.text));
    return reading_push(r, e, v);
}
