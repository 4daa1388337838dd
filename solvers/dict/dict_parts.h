/* What the reader (dict_parse.c) and the typed reads (dict.c) of dictionaries share; for nobody else. */
#ifndef SOLVERS_DICT_PARTS_H
#define SOLVERS_DICT_PARTS_H

#include "mesh/format/foamfile.h"
#include "solvers/dict/dict.h"
#include <regex.h>

struct value { /* a token, macros expanded */
    enum token_kind kind;
    const char *text;
    double number;
};
struct entry {
    const char *key, *path; /* path: of the file it stands in */
    int line;
    bool used, open;  /* open: a sub-dictionary that is still being read */
    regex_t *pattern; /* of a quoted key, or NULL */
    struct dict *sub; /* or NULL */
    struct value *value;
    int count, room;
    bool raw;           /* ends with a list that was skipped */
    struct lexer start; /* of a raw value */
    struct foam_header header;
};
struct names {
    const char **name;
    int count, room;
};
struct dict {
    struct document *document;
    struct dict *parent;
    const char *name, *path; /* name: "boundaryField.inlet", "" at the top */
    int line;
    struct entry *entry;
    int count, room;
    struct names *asked; /* keys that the program asked for */
};
struct document { /* owns all memory of a dictionary */
    struct dict *top;
    struct foam_header header;
    void **memory; /* freed with the document */
    long blocks, room;
    struct source **source;
    int sources, source_room;
    regex_t **pattern;
    int patterns, pattern_room;
};

/* Zeroed memory that lives as long as the document. */
status document_take(struct document *d, size_t bytes, void *out);
status document_copy(struct document *d, const char *text, int length, const char **out);
/* Adds a source, which the document then owns. */
status document_keep(struct document *d, struct source *s);
/* pattern_compile; the document owns the pattern. *out is NULL and `why` says it if that fails. */
status document_pattern(struct document *d, const char *text, regex_t **out, char *why, size_t room);
/* Compiles a pattern for whole keys; false and `why` if it is none, or one that takes much memory. */
bool pattern_compile(regex_t *out, const char *text, char *why, size_t room);
/* Makes room in *items [count] for one more. */
status document_grow(struct document *d, void *items, int count, int *room, size_t size);

struct entry *dict_find(const struct dict *d, const char *key);       /* exact, then the last pattern; NULL */
struct entry *dict_find_exact(const struct dict *d, const char *key); /* the key as it was written */
/* dict_find that marks the entry as used and the key as known. */
struct entry *dict_ask(const struct dict *d, const char *key);
/* The value as text, cut at `room`. */
void entry_print(const struct entry *e, char *text, size_t room);

/* Files of #include (dict_include.c). */
enum { INCLUDE_PATH = 4096 };
/* The length of the part of `path` that names the case: the folder above the last `system`, `constant` or time folder,
 * with its '/'; else the file's own. */
int include_root(const char *path);
/* The path of the file that token t names, in the file l reads; path.gz where only that is there. Refused if it is
 * absolute or, links followed, lies neither in the case nor in the folder of the file that includes it. */
status include_find(const struct lexer *l, const struct token *t, int root_length, char out[INCLUDE_PATH],
                    bool *present);

status dict_parse(struct document *d, struct source *s);

#endif
