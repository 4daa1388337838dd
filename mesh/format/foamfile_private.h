/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by foamfile.c, which reads files in OpenFOAM's grammar, foamlist.c, which reads lists, and foamshared.c, which
 * reads files whose longest list is spread over the ranks. */
#ifndef MESH_FOAMFILE_PRIVATE_H
#define MESH_FOAMFILE_PRIVATE_H

#include "mesh/format/foamfile.h"

enum { HEAD = 1 << 16 }; /* bytes of a file's start in which its long list is looked for */

struct long_list { /* the first `nonuniform List<..>` of a file */
    size_t at;     /* where its entries begin: behind the bracket */
    int line;      /* there */
    long count;
    int components;
    struct foam_header header;
};
/* Finds the long list in the head of a file. Returns false if there is none, or a short one. */
bool find_list(const struct source *head, struct long_list *out);

/* Makes an empty source for the file at `path`, or at path.gz where only that exists. */
status source_name(const char *path, struct source **out);

/* Reads entries as writers put them, `(0 1 2)` or 0, with blanks and line ends alone between them, as long as there are
 * any, at most `most`; returns how many. */
long plain_entries(struct lexer *l, long most, int components, double *out);

#endif
