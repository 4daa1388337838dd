/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A window that moves along a file, zipped or not, whose text no rank holds as a whole. */
#ifndef MESH_WINDOW_H
#define MESH_WINDOW_H

#include "mesh/base/status.h"

#include <stddef.h>

#ifndef HAFF_WINDOW
#define HAFF_WINDOW (1 << 20) /* tests/fuzz has windows that are smaller than its files, so that they move */
#endif
enum { WINDOW = HAFF_WINDOW }; /* bytes of text that are held at a time */
struct gzFile_s;
struct window { /* {0} is closed */
    struct gzFile_s *file;
    char *text; /* [size], and a 0 behind it */
    size_t size;
    bool ended; /* does the file end with this text? */
};
/* Takes over an open file, at its beginning; the window is empty. */
status window_open(int file, struct window *out);
void window_close(struct window *w);
/* Drops the first `used` bytes of the text and fills the window behind what is left. Returns whether the file can be
 * read. */
bool window_fill(struct window *w, size_t used);
bool window_zipped(const struct window *w); /* of one that has been filled */
/* Reads n bytes from byte `at` of the unzipped file on; the window is not filled any more then. Returns whether they
 * are there. */
bool window_read(struct window *w, long at, char *to, long n);
bool window_ends(struct window *w); /* closes the window; was what has been read sound to its end (checksums)? */

#endif
