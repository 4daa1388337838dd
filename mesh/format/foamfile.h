/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text and binary files in the grammar of OpenFOAM: tokens with line numbers, the FoamFile header, lists in ascii and
 * binary, gzip, and writing that is atomic (temporary name, then rename). Nothing here knows a dictionary or a mesh. */
#ifndef MESH_FOAMFILE_H
#define MESH_FOAMFILE_H

#include "mesh/base/share.h"
#include <stddef.h>

/* ---- reading ---------------------------------------------------------------------------------------------------- */

struct source { /* a file in memory, already unzipped; text[size] is 0 */
    char *path; /* as given, or with .gz added */
    char *text;
    size_t size;
    /* Of a file that is not zipped the text lacks the entries of the first long binary list (`nonuniform List<..>`): a
     * rank that needs some of them reads these alone (foam_list_read_part). */
    int file;         /* the open file; -1: nothing is left out */
    size_t gap;       /* position in text where they would stand, and in the file where they do */
    size_t gap_bytes; /* their length; 0: nothing is left out */
    /* source_open_shared leaves them out of the text, too, and keeps those of this rank: entries part_first .. part_end
     * - 1, until they are taken; gap_lines line ends stood among them. */
    double *part;
    int components, gap_lines;
    long part_first, part_end;
    bool foreign; /* does the file lie outside of the case (files.h)? Messages then show none of its text */
};
/* Reads path, or path.gz where only that exists. Fails on a missing, unreadable or broken (gzip) file, on what is no
 * regular file, and where both are there (file_single). */
status source_open(const char *path, struct source **out);
/* The same of a file whose very name the user gives: path.gz beside it is not in question. */
status source_open_named(const char *path, struct source **out);
/* The same by all ranks together: of the first list, if it is long and has an entry for each cell, a rank gets its
 * slice alone, which foam_list_read_part then gives once; it can give no other part. Collective. */
status source_open_shared(const char *path, const struct share *share, struct source **out);
/* Returns the error "PATH:LINE: <format...>"; of a foreign file it says no more than that. */
status source_fail(const struct source *s, int line, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* Makes a source from a string in memory (copied); `name` stands for the path in messages. */
status source_from_text(const char *name, const char *text, struct source **out);
void source_free(struct source *s);
void source_drop_text(struct source *s); /* frees the text; the source is then an empty file */

enum token_kind { TOKEN_END, TOKEN_WORD, TOKEN_STRING, TOKEN_NUMBER, TOKEN_PUNCTUATION, TOKEN_VERBATIM };
struct token {
    enum token_kind kind;
    const char *text; /* first character in the source, not terminated; a string stands without its quotes */
    int length;
    double number; /* TOKEN_NUMBER */
    int line;      /* line number, from 1 */
    bool first_on_line;
};
struct lexer {
    const struct source *source;
    size_t position;
    int line;
    int last_line; /* line where the token before this one ended; 0: no token yet */
};
struct lexer lexer_start(const struct source *s);
/* Reads the next token and skips comments. A word may hold balanced parentheses and commas: div(rho*U,T). `${...}` is
 * one word, `#{ ... #}` is verbatim (without the marks), punctuation is one of ( ) { } [ ] ; , and a number is finite:
 * nan, inf, 0x10 and 1d3 are words. lexer_peek does not move on; lexer_expect fails unless `punctuation` comes next. */
status lexer_next(struct lexer *l, struct token *t);
status lexer_peek(const struct lexer *l, struct token *t);
status lexer_expect(struct lexer *l, char punctuation);
bool token_is(const struct token *t, const char *text);
/* Returns the error "PATH:LINE: found 'TOKEN'; <format...>". */
status lexer_fail(const struct lexer *l, const struct token *found, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

struct foam_header {
    bool present;
    bool binary;
    int label_bytes;  /* 4 or 8 */
    int scalar_bytes; /* 4 or 8 */
    char class_name[64], object[64], location[256], note[256];
    int class_line, object_line;
};
/* Reads `FoamFile { ... }` if it is there (present = false, ascii if not). */
status foam_header_read(struct lexer *l, struct foam_header *h);

/* Reads a list of doubles: `N ( ... )`, `N { v }`, `( ... )`, or binary `N` + `(` bytes `)`; an entry has `components`
 * numbers (3: `(x y z)`). *out is allocated [n * components]; non-finite numbers and wrong counts are errors with their
 * line. `N { v }` is refused where N > most, because a few bytes could ask for any amount of memory; the size of the
 * file bounds all other lists. */
status foam_list_read_doubles(struct lexer *l, const struct foam_header *h, int components, long most, long *n,
                              double **out);
/* Reads a part of such a list: entries first .. end - 1, as far as there are any. *n is the number of all entries; all
 * of an ascii list are read and checked, but of a binary one those of the part. */
status foam_list_read_part(struct lexer *l, const struct foam_header *h, int components, long most, long first,
                           long end, long *n, double **out);
status foam_list_read_labels(struct lexer *l, const struct foam_header *h, long most, long *n, int **out);
/* Reads a faceList `N ( 4(0 1 2 3) ... )` or a binary faceCompactList: start [n+1], points [start[n]]. */
status foam_list_read_faces(struct lexer *l, const struct foam_header *h, long *n, int **start, int **points);
/* Passes over a list without reading its values; item_bytes is the size of one entry in a binary file. */
status foam_list_skip(struct lexer *l, const struct foam_header *h, int item_bytes);

/* Reads the decimal number at text[0] and returns the character after it, or NULL if there is no number or if anything
 * but a blank, bracket, ';', ',', quote or comment follows. *out may be infinite (1e999). The locale does not
 * matter. */
const char *foam_number(const char *text, double *out);

/* Reads a whole number of at most nine digits at p and returns the character behind it; NULL: there is none. */
static inline const char *foam_digits(const char *p, int *out) {
    const char *first = p;
    unsigned v = 0;
    for (; *p >= '0' && *p <= '9'; p++) v = 10 * v + (unsigned)(*p - '0');
    *out = (int)v;
    return p > first && p - first <= 9 ? p : NULL;
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

struct foam_format {
    bool binary;
    bool compress;
    int precision; /* significant digits of ascii numbers; 17 round-trips */
};
struct sink;
/* Opens path.tmp (path.gz.tmp if `compress`); nothing stands at `path` until sink_close. */
status sink_open(const char *path, bool compress, struct sink **out);
void sink_unsummed(struct sink *s); /* no checksum is wanted: sink_close_sum will not be called */
void sink_printf(struct sink *s, const char *format, ...) __attribute__((format(printf, 2, 3)));
void sink_write(struct sink *s, const void *data, size_t bytes);
/* Flushes and renames. Returns the first error since sink_open (for example a full disk) and then leaves the old
 * file. */
status sink_close(struct sink *s);

struct file_sum {             /* size and checksum of a file's contents before compression */
    unsigned long bytes, crc; /* CRC-32 (zlib) */
};
/* Closes as sink_close does; *sum (if not NULL) gets the sum of everything written, added up while writing. */
status sink_close_sum(struct sink *s, struct file_sum *sum);
/* Reads path, or path.gz where only that exists, and adds up its sum. */
status file_sum_read(const char *path, struct file_sum *sum);

/* Writes `FoamFile { version 2.0; format ...; arch ...; class ...; note (if not NULL); location ...; object ...; }`. */
void foam_header_write(struct sink *s, const struct foam_format *f, const char *class_name, const char *location,
                       const char *object, const char *note);
void foam_end_write(struct sink *s); /* the line with which OpenFOAM ends a file */
/* Write one list without header or keyword, in the form that the readers above and OpenFOAM's own accept. */
void foam_list_write_doubles(struct sink *s, const struct foam_format *f, int components, long n, const double *v);
/* Writes a list of doubles whose entries are spread over the ranks in slices. s, which sink_open gave the root for
 * `path`, is NULL on the others. A binary list that is not zipped is written by all ranks at once, any other one by the
 * root, which gets it in pieces. Who needs the file on the disk calls folder_sync on every rank. Collective. */
status foam_list_write_shared(struct sink *s, const char *path, const struct foam_format *f, int components,
                              const struct share *share, const double *slice);
void foam_list_write_labels(struct sink *s, const struct foam_format *f, long n, const int *v);
void foam_list_write_faces(struct sink *s, const struct foam_format *f, long n, const int *start, const int *points);

#endif
