/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Takes numbers from the bytes of a state that was read. */
#ifndef SOLVERS_GRAINS_BYTES_H
#define SOLVERS_GRAINS_BYTES_H

#include <stdbool.h>
#include <stddef.h>
#include <string.h>

struct bytes {
    const char *at;
    size_t left;
};
/* Copies the next bytes to out; returns false if there are fewer. */
static inline bool bytes_take(struct bytes *b, void *out, size_t bytes) {
    if (bytes > b->left) return false;
    memcpy(out, b->at, bytes);
    b->at += bytes;
    b->left -= bytes;
    return true;
}

#endif
