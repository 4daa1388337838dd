/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files that read dictionaries: the file in hand, the bounds of a reading, macros and #eval. */
#ifndef SOLVERS_DICT_READING_H
#define SOLVERS_DICT_READING_H

#include "solvers/dict/dict_parts.h"

enum { DEPTH = 64, INCLUDES = 16, KEYS = 10000, COPIES = 1000000 };
enum mode { MERGE, OVERWRITE, PROTECT, ERROR };

struct file { /* a file being read; `from` is the file that includes it */
    struct lexer l;
    struct foam_header header;
    const struct file *from;
    int case_length; /* characters of the path that name the folder of the case, with its '/' */
};
struct reading {
    struct document *document;
    enum mode mode;
    int depth;
    long copied; /* values that macros and #include have multiplied: bounded, since copies of copies double */
};

/* An error with file and line; `format` has one %s. */
status reading_fail(const struct file *f, int line, const char *format, const char *what);
/* Counts values that macros and #include multiply; an error beyond a million. */
status reading_charge(struct reading *r, const struct file *f, int line, size_t copies);
/* Appends a value to an entry. */
status reading_push(struct reading *r, struct entry *e, struct value v);

/* The entry that a macro names, whose text $name or ${name} is given; an error where there is none before it. */
status macro_find(const struct file *f, struct dict *d, const char *text, int length, int line, struct entry **out);
/* Appends the values of the entry that the macro t names. */
status macro_push(struct reading *r, struct file *f, struct dict *d, struct entry *e, const struct token *t);
/* Appends the number that the expression behind #eval gives. */
status eval_push(struct reading *r, struct file *f, struct dict *d, struct entry *e);

#endif
