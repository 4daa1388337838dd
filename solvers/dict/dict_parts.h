/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files that read dictionaries, and private to them: dict.c (memory and look-up), dict_parse.c (grammar),
 * dict_include.c (files), dict_typed.c (typed reads). */
#ifndef SOLVERS_DICT_PARTS_H
#define SOLVERS_DICT_PARTS_H

#include "mesh/format/foamfile.h"
#include "solvers/dict/dict.h"
#include <regex.h>

struct value { /* a token, macros expanded */
    enum token_kind kind;
    const char *text;
    double number;
    int line;     /* 0: that of the token before it */
    bool foreign; /* does it come from a file outside of the case? Messages do not show it then */
};
struct entry {
    const char *key, *path; /* path: the file that the entry stands in */
    int line;
    bool foreign;     /* does it stand in a file outside of the case? */
    bool used, open;  /* open: a sub-dictionary that is still being read */
    regex_t *pattern; /* compiled from a quoted key, or NULL */
    struct dict *sub; /* sub-dictionary, or NULL */
    struct value *value;
    int count, room;
    bool raw;           /* the value ends with a list that was skipped */
    struct lexer start; /* the start of a raw value */
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
    void **memory; /* [blocks] freed with the document */
    long blocks, room;
    struct source **source;
    int sources, source_room;
    regex_t **pattern;
    int patterns, pattern_room;
    struct names passed; /* what was passed over, "FILE:LINE: .." */
    struct names places; /* key, dictionary that it belongs in, key, .. (dict_belongs) */
};

/* Allocates zeroed memory that lives as long as the document; document_copy does so for a copy of a text. */
status document_take(struct document *d, size_t bytes, void *out);
status document_copy(struct document *d, const char *text, int length, const char **out);
/* Takes note of what was passed over, with a format of one %s. */
status document_note(struct document *d, const struct source *s, int line, const char *format, const char *name);
/* Adds a source, which the document then owns. */
status document_keep(struct document *d, struct source *s);
/* Compiles a pattern that the document owns. If that fails, *out is NULL and `why` says the reason. */
status document_pattern(struct document *d, const char *text, regex_t **out, char *why, size_t room);
/* Compiles a pattern for whole keys. Returns false, with the reason in `why`, if the text is no pattern or one that
 * takes much memory. */
bool pattern_compile(regex_t *out, const char *text, char *why, size_t room);
/* Makes room in *items [count] for one more. */
status document_grow(struct document *d, void *items, int count, int *room, size_t size);

/* Finds the exact key, else the last pattern that fits, else NULL. */
struct entry *dict_find(const struct dict *d, const char *key);
struct entry *dict_find_exact(const struct dict *d, const char *key);   /* the key as it was written, or NULL */
struct entry *dict_find_pattern(const struct dict *d, const char *key); /* the last pattern that fits and is read */
/* Finds an entry as dict_find does, and marks it as used and the key as known. */
struct entry *dict_ask(const struct dict *d, const char *key);
/* Prints the value as text, cut at `room`. */
void entry_print(const struct entry *e, char *text, size_t room);
char *entry_lines(const struct entry *e); /* the whole value with ';' behind it, its tokens on the lines they stood on;
                                             the caller frees it; NULL: no memory */
bool entry_is_foreign(const struct entry *e); /* does it, or a value of it, come from a file outside of the case? */
/* Returns the name that a word may stand for: the nearest, else one that the word begins with or is the begin of, as
 * restitution for restitutionCoefficient; NULL: none. */
const char *dict_meant(const char *word, const char *const *names, int count);
/* Returns the error of an entry whose text messages do not show. */
status entry_fail_hidden(const struct entry *e);

/* Files of #include (dict_include.c). */
enum { INCLUDE_PATH = 4096 };
/* Finds the path of the file that token t names, in the file l reads; path.gz where only that is there. Refuses a path
 * that is absolute or leaves the case; a link in the case may lead out of it. */
status include_find(const struct lexer *l, const struct token *t, int root_length, char out[INCLUDE_PATH],
                    bool *present);

/* Reads the entries of a source into the document's top dictionary. */
status dict_parse(struct document *d, struct source *s);

#endif
