/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A family of models: a keyword of a dictionary names a row of a table (equation of state, transport, flux, ..). One
 * loop over a table of families reads, prints and lists them all.
 *
 * A row begins with struct model (libcore/models/param.h). Its parameters stand in the dictionary NAMECoeffs { } beside
 * the keyword; those of rows that are not chosen may stay in the file. Those of a flat family stand beside the keyword
 * itself; all are allowed beside a row that has none. */
#ifndef SOLVERS_FAMILY_H
#define SOLVERS_FAMILY_H

#include "libcore/models/param.h"
#include "solvers/dict/dict.h"
#include <stdio.h>

struct family {
    const char *file;            /* file of the keyword, relative to the case */
    const char *title;           /* title of the list of rows */
    const char *meaning, *usual; /* for the reference: of the keyword; the default in words, NULL: as below */
    const char *sub; /* dictionary that the keyword stands in, in which it must be given; NULL: the file itself */
    const char *key;
    const void *rows; /* [*count] of `stride` bytes */
    size_t stride;
    const int *count;
    const char *none;     /* what the word `none` means, which chooses no row; NULL: the word is not allowed */
    const char *standard; /* row that is chosen where the keyword is missing */
    bool must;            /* the keyword may not be missing; else, without a standard, no row is chosen */
    bool flat;            /* parameters stand in `sub` itself */
    bool tacit;           /* `none`, as a word or a row, is not printed */
    size_t chosen;        /* offset of the pointer to the row, NULL: none, in the struct that is filled */
    size_t params;        /* offset of the struct that the parameters of the row fill */
    /* The keyword holds a list (a b ..) of the rows that are `offered` (NULL: all), or is missing: none. Then chosen is
     * the offset of bool [*count], params of struct own_params [*count]. */
    bool list;
    bool (*offered)(const struct model *row);
    /* `suits` fails if the row just chosen does not fit the models that were read before, `holds` if the row's
     * parameters, which were read then, do not fit together. d: dictionary of the keyword. NULL: rows always fit. */
    status (*suits)(struct dict *d, void *base);
    status (*holds)(struct dict *d, void *base);
};
/* The members `rows`, `stride` and `count` of the table NAME_table with NAME_count rows. */
#define FAMILY_ROWS(name) .rows = name##_table, .stride = sizeof *name##_table, .count = &name##_count

/* Reads the keyword and the row's parameters from d, the file's dictionary, into the struct at base. */
status family_read(const struct family *k, struct dict *d, void *base);
/* Marks the keyword (or `sub`) and all NAMECoeffs as known, for programs that leave the family to others. */
status family_leave(const struct family *k, struct dict *d);

/* Returns row i of the table, NULL if it is not offered. */
const struct model *family_row(const struct family *k, int i);
void family_list(FILE *f, const struct family *k);                    /* prints title, rows, their parameters */
void family_print(FILE *f, const struct family *k, const void *base); /* prints the chosen row and its parameters */

#endif
