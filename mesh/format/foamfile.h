/* Text and binary files in the grammar of OpenFOAM: tokens with line numbers, the FoamFile header, lists in ascii and
 * binary, gzip, and writing that is atomic (temporary name, then rename). Knows no dictionary and no mesh. */
#ifndef MESH_FOAMFILE_H
#define MESH_FOAMFILE_H

#include "mesh/base/status.h"
#include <stddef.h>

/* ---- reading ---------------------------------------------------------------------------------------------------- */

struct source { /* a file in memory, already unzipped; text[size] is 0 */
    char *path; /* as given, or with .gz */
    char *text;
    size_t size;
};
/* Reads path, or path.gz where only that exists. Fails on a missing, unreadable or broken (gzip) file. */
status source_open(const char *path, struct source **out);
/* A source from a string in memory (copied); `name` stands for the path in messages. */
status source_from_text(const char *name, const char *text, struct source **out);
void source_free(struct source *s);

enum token_kind { TOKEN_END, TOKEN_WORD, TOKEN_STRING, TOKEN_NUMBER, TOKEN_PUNCTUATION, TOKEN_VERBATIM };
struct token {
    enum token_kind kind;
    const char *text; /* not terminated: the span in the source; of a string without its quotes */
    int length;
    double number; /* TOKEN_NUMBER */
    int line;      /* from 1 */
    bool first_on_line;
};
struct lexer {
    const struct source *source;
    size_t position;
    int line;
    int last_line; /* where the token before ended; 0: none yet */
};
struct lexer lexer_start(const struct source *s);
/* The next token; comments are skipped. Words may hold balanced parentheses and commas: div(rho*U,T). `${...}` is one
 * word, `#{ ... #}` is verbatim (without the marks), punctuation is one of ( ) { } [ ] ; , and numbers are finite: nan,
 * inf, 0x10 and 1d3 are words. */
status lexer_next(struct lexer *l, struct token *t);
status lexer_peek(const struct lexer *l, struct token *t);
status lexer_expect(struct lexer *l, char punctuation);
bool token_is(const struct token *t, const char *text);
/* "PATH:LINE: found 'TOKEN'; <format...>" */
status lexer_fail(const struct lexer *l, const struct token *found, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

struct foam_header {
    bool present;
    bool binary;
    int label_bytes;  /* 4 or 8 */
    int scalar_bytes; /* 4 or 8 */
    char class_name[64], object[64], location[256], note[256];
};
/* Reads `FoamFile { ... }` if it is there (present = false, ascii if not). */
status foam_header_read(struct lexer *l, struct foam_header *h);

/* Reads `N ( ... )`, `N { v }`, `( ... )`, binary `N` + `(` bytes `)`; components per entry (3: `(x y z)`).
 * *out is allocated [n * components]; non-finite numbers and wrong counts are errors with their line. `N { v }` is
 * refused where N > most: what else a list holds, and so its memory, is bounded by the size of the file. */
status foam_list_read_doubles(struct lexer *l, const struct foam_header *h, int components, long most, long *n,
                              double **out);
status foam_list_read_labels(struct lexer *l, const struct foam_header *h, long most, long *n, int **out);
/* faceList `N ( 4(0 1 2 3) ... )` or binary faceCompactList: start [n+1], points [start[n]]. */
status foam_list_read_faces(struct lexer *l, const struct foam_header *h, long *n, int **start, int **points);
/* Passes over a list without reading its values; item_bytes: of one entry in a binary file. */
status foam_list_skip(struct lexer *l, const struct foam_header *h, int item_bytes);

/* The decimal number at text[0]; NULL if there is none that a blank, bracket, ';', ',', quote or comment ends, else the
 * character after it. May be infinite (1e999). Independent of the locale. */
const char *foam_number(const char *text, double *out);

/* ---- writing ---------------------------------------------------------------------------------------------------- */

struct foam_format {
    bool binary;
    bool compress;
    int precision; /* significant digits of ascii numbers; 17 round-trips */
};
struct sink;
/* Opens path.tmp (path.gz.tmp if compress); nothing is at `path` until sink_close. */
status sink_open(const char *path, bool compress, struct sink **out);
void sink_printf(struct sink *s, const char *format, ...) __attribute__((format(printf, 2, 3)));
void sink_write(struct sink *s, const void *data, size_t bytes);
/* Flushes and renames; any error since sink_open (full disk) is returned here, and the old file is left. */
status sink_close(struct sink *s);

struct file_sum {             /* of a file's contents, before compression */
    unsigned long bytes, crc; /* CRC-32 (zlib) */
};
/* The same; sum, if not NULL: of all that was written, added up on the way. */
status sink_close_sum(struct sink *s, struct file_sum *sum);
/* Of path, or path.gz where only that exists. */
status file_sum_read(const char *path, struct file_sum *sum);

/* `FoamFile { version 2.0; format ...; arch ...; class ...; note (if not NULL); location ...; object ...; }` */
void foam_header_write(struct sink *s, const struct foam_format *f, const char *class_name, const char *location,
                       const char *object, const char *note);
/* The list alone, as the readers above and OpenFOAM's own take it. */
void foam_list_write_doubles(struct sink *s, const struct foam_format *f, int components, long n, const double *v);
void foam_list_write_labels(struct sink *s, const struct foam_format *f, long n, const int *v);
void foam_list_write_faces(struct sink *s, const struct foam_format *f, long n, const int *start, const int *points);

#endif
