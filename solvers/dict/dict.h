/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dictionaries in OpenFOAM's grammar (macros, #include, #eval, regular-expression keys, dimensioned entries, lists).
 * Every read is typed and ranged; every key that was never read is an error with a suggestion (dict_check_used). */
#ifndef SOLVERS_DICT_H
#define SOLVERS_DICT_H

#include "mesh/base/status.h"

struct dict;
struct foam_header;

status dict_read(const char *path, struct dict **out); /* the FoamFile header is skipped; path or path.gz */
/* The same by all ranks together, each of which gets its slice of a long list (source_open_shared). Collective. */
struct share;
status dict_read_shared(const char *path, const struct share *share, struct dict **out);
status dict_from_text(const char *name, const char *text, struct dict **out);
void dict_free(struct dict *d); /* the top level only */

/* Frees the text of the files, which dict_raw of nonuniform lists reads: those cannot be read again. */
void dict_drop_text(struct dict *d);

bool dict_has(const struct dict *d, const char *key);  /* the key then counts as read */
void dict_know(const struct dict *d, const char *key); /* the key is one that may stand here */
/* Gives the entry of a key, if it was written so, another key; one that has an entry already keeps it. */
void dict_rename(struct dict *d, const char *key, const char *to);
/* Find a sub-dictionary. A missing key is an error, but dict_sub_optional then gives NULL; any other value is an
 * error. */
status dict_sub(struct dict *d, const char *key, struct dict **out);
status dict_sub_optional(struct dict *d, const char *key, struct dict **out);
/* Returns the FoamFile header of the file (present = false if it has none). */
const struct foam_header *dict_header(const struct dict *d);
const char *dict_path(const struct dict *d); /* the dictionary's file, for messages */
int dict_line(const struct dict *d, const char *key);
/* Does the value come, by a link, from a file outside of the case? Then messages do not show it; dict_fail heeds that.
 */
bool dict_is_foreign(const struct dict *d, const char *key);
bool dict_is_outside(const struct dict *d); /* does the file itself? */

/* Returns an error for a value: "FILE:LINE: key 'x' is VALUE; <format...>". */
status dict_fail(const struct dict *d, const char *key, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Return errors: for a key that must be there ("FILE:LINE: key 'x' is missing; CURE", or with the key that may be a
 * misspelt x), and for a word of the key's value that is none of the `count` names. */
status dict_missing(const struct dict *d, const char *key, const char *cure);
status dict_unknown(const struct dict *d, const char *key, const char *word, const char *const *names, int count);

/* Typed reads. A missing key is an error, unless *_or gives a default. unit: exponents of kg, m, s; a dimensioned entry
 * must match it (NULL: any), a bare number is taken as it is. Strings are owned by the dictionary. */
status dict_number(struct dict *d, const char *key, const signed char unit[3], double *out);
status dict_number_or(struct dict *d, const char *key, const signed char unit[3], double standard, double *out);
status dict_count_or(struct dict *d, const char *key, long standard, long *out);
status dict_switch_or(struct dict *d, const char *key, bool standard, bool *out);
status dict_word(struct dict *d, const char *key, const char **out); /* one word or string */
status dict_word_or(struct dict *d, const char *key, const char *standard, const char **out);
status dict_vector(struct dict *d, const char *key, const signed char unit[3], double out[3]); /* (x y z) */
/* Reads a word that must be one of the `count` names at names[0], names + stride bytes, ...; *index is its place. The
 * error lists all names and suggests the nearest. */
status dict_choice(struct dict *d, const char *key, const char *const *names, int count, int *index);
status dict_words(struct dict *d, const char *key, int *count, const char *const **out); /* ( a b c ) or a */
status dict_numbers(struct dict *d, const char *key, int *count, const double **out);    /* ( 1 2 3 ) */
status dict_vectors(struct dict *d, const char *key, int *count, const double **out);    /* ((x y z) ...) */
status dict_dimensions(struct dict *d, const char *key, signed char out[7]);             /* [1 -3 0 0 0 0 0] */
/* Reads `table ((t v) ...)`, a Function1 of OpenFOAM: (*out)[*count][2] of rising t; *count = 0: the value is no
 * table. */
status dict_table(struct dict *d, const char *key, int *count, const double **out);
/* Reads a Function1 of OpenFOAM with values of 1 or 3 components: `v`, `constant v` or `table ((t v) ...)`, where v of
 * three is (x y z): (*out)[*count][1 + components], t and v, of rising t. A constant is one row, t = 0. */
status dict_function(struct dict *d, const char *key, int components, int *count, const double **out);

/* Adds file, line and text to the error s of compiling the text of an expression (expr.h); OK stays OK. Of a text that
 * lies outside of the case the error shows nothing. */
status dict_note_expression(const struct dict *d, const char *key, const char *text, status s);

/* Gives the tokens of a value, macros expanded: the lexer stands before the first one, and ';' follows the last. A
 * nonuniform List<...> of any size is read through this function alone: the parser skipped it; dict_header says how its
 * bytes lie. The lexer lives as long as the dictionary. */
struct lexer;
status dict_raw(struct dict *d, const char *key, struct lexer *out);

/* What was passed over in the files of the dictionary, as "FILE:LINE: #includeFunc NAME"; NULL: no more. */
const char *dict_passed(const struct dict *d, int i);

/* The entries in order, for dictionaries whose keys are names (patches, functions). */
int dict_count(const struct dict *d);
const char *dict_key(const struct dict *d, int i);

bool dict_is_used(const struct dict *d, int i); /* has entry i been read? */
/* Is the key of entry i a pattern that fits a name, or the name itself? */
bool dict_key_fits(const struct dict *d, int i, const char *name);
void dict_pass(struct dict *d, int i); /* marks entry i, and all below, as read: it is known and has no effect here */

/* Fails on the first key, in d and below, that no read asked for and no macro named: "FILE:LINE: keyword 'maxC0' is not
 * used; did you mean 'maxCo'?" The suggestion is one of the keys that were asked for in that dictionary. */
status dict_check_used(const struct dict *d);
/* Notes for that message in which dictionary a key belongs, if it stands elsewhere in the file of d. */
void dict_belongs(const struct dict *d, const char *key, const char *where);
const char *dict_unused(const struct dict *d); /* the first such key in d, but not below; NULL: there is none */
void dict_mark_used(struct dict *d);           /* marks all keys in d and below as read: they are for other programs */

/* Returns the whole dictionary as text, macros expanded (for provenance); the caller frees it. */
char *dict_print(const struct dict *d);

/* Returns the name nearest to `word` (edit distance at most 3 and at most half of the shorter one) for "did you mean",
 * or NULL. */
const char *nearest_name(const char *word, const char *const *names, int count);
/* The edit distance: letters to change, add or drop, or to swap with a neighbour; 64 of words of over 63 characters. */
int name_distance(const char *a, const char *b);
/* Writes and returns "; did you mean 'NAME'?" with the nearest name, "" if none is near. 'NAME' or 'OTHER': the other
 * one is less than twice as far, so that the first is not certain. */
enum { MEANT = 200 };
const char *name_question(const char *word, const char *const *names, int count, char out[MEANT]);

#endif
