/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Goes through the keywords of a program and prints them as text or as tables (keywords.h). */
#include "solvers/dict/keywords.h"

#include "solvers/dict/params.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the texts of a row ---- */

static void add_words(char *text, const char *const *words) {
    for (int i = 0; words[i]; i++) {
        const size_t used = strlen(text);
        snprintf(text + used, KEYWORD_TEXT - used, "%s%s", i ? ", " : ": ", words[i]);
    }
}

static void say_type(const struct param *p, char *text) {
    static const char *const names[] = {"number", "whole number", "switch", "vector", "word", "word", "word"};
    snprintf(text, KEYWORD_TEXT, "%s", p->type ? p->type : names[p->kind]);
    if (p->words && !p->type) add_words(text, p->words);
}

static void say_range(const struct param *p, char text[64]) {
    const bool below = isfinite(p->high), above = isfinite(p->low);
    text[0] = 0;
    if (p->kind > PARAM_VECTOR || p->kind == PARAM_SWITCH) return;
    if (above && below)
        snprintf(text, 64, p->open ? "%g < .. < %g" : "%g .. %g", p->low, p->high);
    else if (above)
        snprintf(text, 64, p->open ? "> %g" : ">= %g", p->low);
    else if (below)
        snprintf(text, 64, p->open ? "< %g" : "<= %g", p->high);
}

static void say_value(const struct param *p, double v, char *text, size_t size) {
    if (p->words)
        snprintf(text, size, "%s", v < 0 ? "none" : p->words[(int)v]);
    else if (p->kind == PARAM_SWITCH)
        snprintf(text, size, "%s", v != 0 ? "on" : "off");
    else if (p->kind == PARAM_VECTOR)
        snprintf(text, size, v == 0 ? "(0 0 0)" : "(%g 0 0)", v);
    else
        snprintf(text, size, isinf(v) ? "none" : "%g", v);
}

static void say_default(const struct param *p, char text[64]) {
    if (p->kind == PARAM_IGNORED)
        snprintf(text, 64, "ignored");
    else if (p->usual)
        snprintf(text, 64, "%s", p->usual);
    else if (p->kind == PARAM_NOTED || isnan(p->standard))
        snprintf(text, 64, "required");
    else
        say_value(p, p->standard, text, 64);
}

/* Returns a value for the example: the default or, without a finite one, one that is allowed. */
static double sample(const struct param *p) {
    if (p->words) return p->standard >= 0 ? p->standard : 0;
    if (isfinite(p->standard) && !p->usual) return p->standard;
    if (p->high - p->low < 1e6) return (p->low + p->high) / 2;
    return isfinite(p->low) ? p->low + 1 : 1;
}

static void say_example(const struct param *p, char *text) {
    char value[128];
    text[0] = 0;
    if (p->example) snprintf(text, KEYWORD_TEXT, "%s", p->example);
    if (p->example || p->kind == PARAM_NOTED || p->kind == PARAM_IGNORED) return;
    say_value(p, sample(p), value, sizeof value);
    snprintf(text, KEYWORD_TEXT, "%s %s;", p->name, value);
}

/* Does an entry that begins as `entry` want the row: is it required there, or is its default a value? */
static bool belongs(const struct param *p, const char *entry) {
    char standard[64];
    if (p->kind == PARAM_ONLY || p->kind == PARAM_IGNORED) return false;
    say_default(p, standard);
    if (!strncmp(standard, "required for ", 13)) return strstr(entry, standard + 13) != NULL; /* for a word before it */
    return strstr(standard, "required") || (!p->usual && p->kind != PARAM_NOTED && strcmp(standard, "none"));
}

void keywords_entries(char entry[KEYWORD_TEXT], const struct param *table, int n) {
    char example[KEYWORD_TEXT];
    for (int i = 0; i < n; i++) {
        if (!belongs(&table[i], entry)) continue;
        say_example(&table[i], example);
        const size_t used = strlen(entry);
        snprintf(entry + used, KEYWORD_TEXT - used, "%s%s", used ? " " : "", example);
    }
}

/* ---- the walk ---- */

static struct keyword keyword_at(const struct keywords *k) {
    return (struct keyword){.file = k->file, .only = k->only, .dict = k->dict, .when = k->when};
}

void keywords_at(struct keywords *k, const char *file, const char *dict, const char *when) {
    k->file = file;
    k->dict = dict;
    k->when = when;
}

void keywords_params(struct keywords *k, const struct param *table, int n) {
    for (int i = 0; i < n; i++) {
        const struct param *p = &table[i];
        struct keyword row = keyword_at(k);
        row.name = p->name;
        row.row = p;
        row.meaning = p->meaning;
        say_type(p, row.type);
        if (p->unit[0] || p->unit[1] || p->unit[2]) param_unit(row.unit, p->unit);
        say_range(p, row.range);
        say_default(p, row.standard);
        say_example(p, row.example);
        k->take(k->context, &row);
    }
}

void keywords_word(struct keywords *k, const char *name, const char *word, const char *meaning, const char *entry) {
    struct keyword row = keyword_at(k);
    row.name = name;
    row.word = word;
    row.meaning = meaning;
    snprintf(row.type, sizeof row.type, "word of %s", name);
    if (entry)
        snprintf(row.example, sizeof row.example, "%s", entry);
    else
        snprintf(row.example, sizeof row.example, "%s %s;", name, word);
    k->take(k->context, &row);
}

void keywords_words(struct keywords *k, const char *name, const char *const *words, const char *const *meanings) {
    for (int i = 0; words[i]; i++) keywords_word(k, name, words[i], meanings[i], NULL);
}

/* The word of a row of a family, with its dictionary of parameters. */
static void family_word(struct keywords *k, const struct family *f, const struct model *m) {
    char inside[KEYWORD_TEXT] = "", entry[KEYWORD_ENTRY];
    keywords_entries(inside, m->param, m->nparam);
    const size_t used = (size_t)snprintf(entry, sizeof entry, f->list ? "%s (%s);" : "%s %s;", f->key, m->name);
    if (*inside && f->flat)
        snprintf(entry + used, sizeof entry - used, " %s", inside);
    else if (*inside)
        snprintf(entry + used, sizeof entry - used, " %sCoeffs { %s }", m->name, inside);
    keywords_word(k, f->key, m->name, m->about, entry);
}

void keywords_family(struct keywords *k, const struct family *f) {
    const struct model *first = NULL;
    keywords_at(k, f->file, f->sub ? f->sub : "", NULL);
    struct keyword row = keyword_at(k);
    row.name = f->key;
    row.meaning = f->meaning;
    snprintf(row.type, sizeof row.type, f->list ? "list of words" : "word");
    for (int i = 0; i < *f->count; i++) {
        const struct model *m = family_row(f, i);
        if (!m) continue;
        if (!first) first = m;
        const size_t used = strlen(row.type);
        snprintf(row.type + used, sizeof row.type - used, "%s%s", m == first ? ": " : ", ", m->name);
    }
    const char *shown = f->standard ? f->standard : first->name;
    snprintf(row.standard, sizeof row.standard, "%s",
             f->must       ? "required"
             : f->usual    ? f->usual
             : f->standard ? f->standard
                           : "none");
    snprintf(row.example, sizeof row.example, f->list ? "%s (%s);" : "%s %s;", f->key, shown);
    k->take(k->context, &row);
    if (f->none) keywords_word(k, f->key, "none", f->none, NULL);
    for (int i = 0; i < *f->count; i++) {
        const struct model *m = family_row(f, i);
        if (m) family_word(k, f, m);
    }
}

void keywords_coeffs(struct keywords *k, const struct family *f) {
    char dict[128];
    for (int i = 0; i < *f->count; i++) {
        const struct model *m = family_row(f, i);
        if (!m || m->nparam == 0) continue;
        snprintf(dict, sizeof dict, "%s%s%sCoeffs", f->sub ? f->sub : "", f->sub ? "/" : "", m->name);
        keywords_at(k, f->file, f->flat ? f->sub : dict, f->flat ? m->name : NULL);
        keywords_params(k, m->param, m->nparam);
    }
}

/* ---- printing ---- */

struct page { /* what is printed so far */
    FILE *f;
    const char *name;         /* what is looked for; NULL: everything */
    char place[KEYWORD_TEXT]; /* where the last row stands */
    const char *near;         /* the name that is nearest to it so far */
    int found;
};

/* Writes "FILE: DICT, type WORD". */
static void say_place(const struct keyword *k, const char *file, char text[KEYWORD_TEXT]) {
    snprintf(text, KEYWORD_TEXT, "%s%s%s%s%s", file, *k->dict ? ": " : "", k->dict, k->when ? ", type " : "",
             k->when ? k->when : "");
}

/* Is the row in another dictionary than the last one? */
static bool moves(struct page *p, const struct keyword *k) {
    char place[KEYWORD_TEXT];
    say_place(k, k->file, place);
    const bool moved = strcmp(place, p->place) != 0;
    memcpy(p->place, place, sizeof place);
    return moved;
}

static bool is_default(const char *text) {
    return strncmp(text, "required", 8) && strcmp(text, "ignored");
}

static void print_line(void *context, const struct keyword *k) {
    struct page *p = context;
    if (moves(p, k)) fprintf(p->f, "%s%s\n", p->found ? "\n" : "", p->place);
    p->found++;
    if (k->word) {
        fprintf(p->f, "        %-20s %s\n", k->word, k->meaning);
        return;
    }
    fprintf(p->f, "    %-24s %s%s%s%s%s; %s%s\n    %-24s %s\n", k->name, k->type, *k->range ? ", " : "", k->range,
            *k->unit ? ", in " : "", k->unit, is_default(k->standard) ? "default " : "", k->standard, "", k->meaning);
    if (*k->example) fprintf(p->f, "    %-24s %s\n", "", k->example);
}

static void print_field(FILE *f, const char *title, const char *text) {
    if (*text) fprintf(f, "    %-10s %s\n", title, text);
}

/* Is the row looked for, by its keyword, its word, or the last part of its dictionary? */
static bool is_named(const struct keyword *k, const char *name) {
    const char *slash = strrchr(k->dict, '/');
    return !strcmp(name, k->name) || (k->word && !strcmp(name, k->word)) || !strcmp(name, slash ? slash + 1 : k->dict);
}

static void print_named(void *context, const struct keyword *k) {
    struct page *p = context;
    char place[KEYWORD_TEXT];
    if (!is_named(k, p->name)) return;
    say_place(k, k->only ? k->only : k->file, place);
    fprintf(p->f, "%s%s%s%s\n", p->found++ ? "\n" : "", k->name, k->word ? " " : "", k->word ? k->word : "");
    print_field(p->f, "in", place);
    print_field(p->f, "type", k->type);
    print_field(p->f, "unit", k->unit);
    print_field(p->f, "range", k->range);
    print_field(p->f, "default", k->standard);
    print_field(p->f, "means", k->meaning);
    print_field(p->f, "example", k->example);
}

/* Keeps the name that is nearest to the one looked for. */
static void compare(void *context, const struct keyword *k) {
    struct page *p = context;
    const char *const names[3] = {p->near ? p->near : k->name, k->name, k->word ? k->word : k->name};
    const char *near = nearest_name(p->name, names, 3);
    if (near) p->near = near;
}

status keywords_print(FILE *f, keywords_walk *walk, const void *of, const char *name) {
    struct page p = {.f = f, .name = name};
    struct keywords k = {.take = name ? print_named : print_line, .context = &p};
    walk(&k, of);
    if (p.found) return OK;
    k.take = compare;
    walk(&k, of);
    return fail(ERR_INPUT, "there is no keyword '%s'%s%s%s; -keywords lists all", name,
                p.near ? "; did you mean '" : "", p.near ? p.near : "", p.near ? "'?" : "");
}

/* Prints a cell of a table, in which a bar would end it. */
static void print_cell(FILE *f, const char *text, bool code) {
    fprintf(f, " %s", code && *text ? "`" : "");
    for (const char *c = text; *c; c++) fprintf(f, *c == '|' ? "\\|" : "%c", *c);
    fprintf(f, "%s |", code && *text ? "`" : "");
}

static void print_row(void *context, const struct keyword *k) {
    struct page *p = context;
    if (moves(p, k))
        fprintf(p->f,
                "\n### %s\n\n| keyword | type | unit | range | default | meaning | example |\n|---|---|---|---|---|---|"
                "---|\n",
                p->place);
    fprintf(p->f, "|%s", k->word ? " &nbsp;&nbsp;" : "");
    print_cell(p->f, k->word ? k->word : k->name, true);
    print_cell(p->f, k->type, false);
    print_cell(p->f, k->unit, false);
    print_cell(p->f, k->range, false);
    print_cell(p->f, k->standard, false);
    print_cell(p->f, k->meaning, false);
    print_cell(p->f, k->example, true);
    fprintf(p->f, "\n");
}

void keywords_print_tables(FILE *f, keywords_walk *walk, const void *of) {
    struct page p = {.f = f};
    struct keywords k = {.take = print_row, .context = &p};
    walk(&k, of);
}
