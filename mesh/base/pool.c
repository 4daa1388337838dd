/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pools: lists of pieces of memory (pool.h). */
#include "mesh/base/pool.h"

#include <stdlib.h>
#include <string.h>

enum { HEAD = 64 }; /* bytes in front of the objects, which keep the alignment of aligned_alloc */
struct pool_piece {
    struct pool_piece *before;
};

status pool_take(struct pool *p, void *out, long count, long size, const char *what) {
    const size_t bytes = HEAD + ((size_t)count * (size_t)size + HEAD - 1) / HEAD * HEAD;
    struct pool_piece *piece = count < 0 ? NULL : aligned_alloc(HEAD, bytes);
    if (!piece) return fail(ERR_SYSTEM, "no memory for %s: %ld x %ld bytes", what, count, size);
    memset(piece, 0, bytes);
    piece->before = p->last;
    p->last = piece;
    void *objects = (char *)piece + HEAD;
    memcpy(out, &objects, sizeof objects);
    return OK;
}

void pool_free(struct pool *p) {
    while (p->last) {
        struct pool_piece *piece = p->last;
        p->last = piece->before;
        free(piece);
    }
}
