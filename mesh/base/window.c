/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Moves a window along a file by zlib, which reads plain files, too (window.h). */
#include "mesh/base/window.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

status window_open(int file, struct window *out) {
    *out = (struct window){.file = gzdopen(file, "rb")};
    if (!out->file) close(file);
    if (!out->file) return fail(ERR_SYSTEM, "no memory for a part of a file");
    TRY(allocate_unset(&out->text, WINDOW + 1, 1, "a part of a file"));
    out->text[0] = 0;
    return OK;
}

bool window_ends(struct window *w) {
    const bool sound = !w->file || gzclose(w->file) == Z_OK;
    free(w->text);
    *w = (struct window){.file = NULL};
    return sound;
}

void window_close(struct window *w) {
    (void)window_ends(w);
}

bool window_fill(struct window *w, size_t used) {
    memmove(w->text, w->text + used, w->size - used);
    w->size -= used;
    while (w->size < WINDOW && !w->ended) {
        const int got = gzread(w->file, w->text + w->size, (unsigned)(WINDOW - w->size));
        if (got < 0) return false;
        w->size += (size_t)got;
        w->ended = got == 0;
    }
    w->text[w->size] = 0;
    return true;
}

bool window_zipped(const struct window *w) {
    return !gzdirect(w->file);
}

bool window_read(struct window *w, long at, char *to, long n) {
    if (gzseek(w->file, at, SEEK_SET) != at) return false;
    while (n > 0) {
        const int got = gzread(w->file, to, (unsigned)(n < 1 << 30 ? n : 1 << 30));
        if (got <= 0) return false;
        to += got;
        n -= got;
    }
    return true;
}
