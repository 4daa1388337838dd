/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The reference of all keywords that a program reads: -keywords and docs/reference.md. The rows come from the tables
 * that drive the reading (params.h, family.h), so that a new row is in the reference by itself. */
#ifndef SOLVERS_KEYWORDS_H
#define SOLVERS_KEYWORDS_H

#include "solvers/dict/family.h"

enum { KEYWORD_TEXT = 600, KEYWORD_ENTRY = 2 * KEYWORD_TEXT + 16 };
struct keyword {
    const char *file;        /* relative to the case: "system/controlDict"; of files alike, ", " between them */
    const char *only;        /* those of the files that take the row; NULL: all */
    const char *dict;        /* dictionary in the file, with '/' between the levels; "": the file itself */
    const char *when;        /* word of the `type` of that dictionary that the row belongs to; NULL: any */
    const char *name, *word; /* word: what the row is about is that word as a value of the keyword; NULL: the keyword */
    const struct param *row; /* the row of the table that says so; NULL: a family's keyword or word */
    const char *meaning;
    char type[KEYWORD_TEXT]; /* as a user writes it, with the words of a choice: "word: ascii, binary" */
    char unit[64], range[64], standard[64], example[KEYWORD_ENTRY];
};

/* A walk through the rows of a program: `take` is called for each row; file, dict and when are the place that the walk
 * has come to. */
struct keywords {
    void (*take)(void *context, const struct keyword *k);
    void *context;
    const char *file, *dict, *when, *only; /* only is set, and set back, around the rows that it is of */
};
typedef void keywords_walk(struct keywords *k, const void *of);

/* Goes to a place; the rows that follow stand there. when may be NULL. */
void keywords_at(struct keywords *k, const char *file, const char *dict, const char *when);
void keywords_params(struct keywords *k, const struct param *table, int n);
/* The keyword of a family and its words; keywords_coeffs: the dictionaries NAMECoeffs of its rows. Both stand in the
 * file (or `sub`) that the family names. */
void keywords_family(struct keywords *k, const struct family *f);
void keywords_coeffs(struct keywords *k, const struct family *f);
/* A word that the keyword `name` takes; entry: the whole entry as a user writes it, NULL: "NAME WORD;". */
void keywords_word(struct keywords *k, const char *name, const char *word, const char *meaning, const char *entry);
/* Adds to an entry the examples of the rows that it needs, and those of the rows whose default is a value. */
void keywords_entries(char entry[KEYWORD_TEXT], const struct param *table, int n);
/* All of a list that ends with NULL. */
void keywords_words(struct keywords *k, const char *name, const char *const *words, const char *const *meanings);

/* Prints all rows by file or, if `name` is not NULL, those of that keyword, word or dictionary. Fails with a suggestion
 * if there is none. */
status keywords_print(FILE *f, keywords_walk *walk, const void *of, const char *name);
/* Prints all rows as tables of Markdown, a heading for each dictionary. */
void keywords_print_tables(FILE *f, keywords_walk *walk, const void *of);

#endif
