/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors as values, and the memory allocation that returns them (status.h). */
#define _DEFAULT_SOURCE /* madvise */
#include "mesh/base/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

enum { TRAIL = 16, TEXT = 2048 };

struct error {
    enum status_kind kind;
    char text[TEXT];
    int depth;
    struct {
        const char *file;
        int line;
    } way[TRAIL];
};

/* The error of a machine without memory for one. Others, of other threads too, may hold it: nothing changes it. */
static const struct error no_memory = {.kind = ERR_SYSTEM, .text = "out of memory"};

/* Replaces control characters by blanks: messages quote files, and what a file holds must not steer the terminal. */
static void make_printable(char *text) {
    for (char *c = text; *c; c++)
        if (((unsigned char)*c < ' ' && *c != '\n') || *c == 127) *c = ' ';
}

status fail(enum status_kind kind, const char *format, ...) {
    struct error *e = calloc(1, sizeof *e);
    if (!e) return (status)&no_memory;
    e->kind = kind;
    va_list args;
    va_start(args, format);
    vsnprintf(e->text, sizeof e->text, format, args);
    va_end(args);
    make_printable(e->text);
    return e;
}

status status_note(status s, const char *format, ...) {
    if (!s || s == &no_memory) return s;
    char text[TEXT], note[TEXT / 2];
    va_list args;
    va_start(args, format);
    vsnprintf(note, sizeof note, format, args);
    va_end(args);
    snprintf(text, sizeof text, "%s\n  %.*s", note, TEXT / 2 - 8, s->text);
    make_printable(text);
    memcpy(s->text, text, sizeof text);
    return s;
}

status status_up(status s, const char *file, int line) {
    if (s && s != &no_memory && s->depth < TRAIL) {
        s->way[s->depth].file = file;
        s->way[s->depth++].line = line;
    }
    return s;
}

enum status_kind status_kind(status s) {
    return s->kind;
}
const char *status_text(status s) {
    return s->text;
}

int status_print(status s, bool trail) {
    if (!s) return 0;
    fprintf(stderr, "error: %s\n", s->text);
    for (int i = 0; trail && i < s->depth; i++) fprintf(stderr, "    at %s:%d\n", s->way[i].file, s->way[i].line);
    return (int)s->kind;
}

void status_free(status s) {
    if (s != &no_memory) free(s);
}

/* Returns memory that is not set, in pages of 2 MB where it is large and Linux has them: what is read in no order, as
 * many grains are, then misses fewer translations of addresses. */
static void *take(size_t bytes) {
    const size_t large = (size_t)1 << 21;
    if (bytes < large) return aligned_alloc(64, bytes ? bytes : 64);
    void *p = aligned_alloc(large, (bytes + large - 1) / large * large);
#ifdef MADV_HUGEPAGE
    if (p) (void)madvise(p, bytes / large * large, MADV_HUGEPAGE);
#endif
    return p;
}

/* Bytes of whole lines of the cache. */
static size_t lines(long count, long size) {
    return ((size_t)count * (size_t)size + 63) / 64 * 64;
}

status allocate_unset(void *out, long count, long size, const char *what) {
    void *p = count < 0 ? NULL : take(lines(count, size));
    if (!p) return fail(ERR_SYSTEM, "no memory for %s: %ld x %ld bytes", what, count, size);
    memcpy(out, &p, sizeof p);
    return OK;
}

status allocate(void *out, long count, long size, const char *what) {
    void *p = NULL;
    TRY(allocate_unset(&p, count, size, what));
    memset(p, 0, lines(count, size));
    memcpy(out, &p, sizeof p);
    return OK;
}

void release_freed(void) {
#ifdef __GLIBC__
    malloc_trim(0);
#endif
}
