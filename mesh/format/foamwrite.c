/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes files in OpenFOAM's grammar: a buffered, optionally gzipped file that replaces the old one when it is closed,
 * headers and lists (foamfile.h). */
#include "mesh/format/foamfile.h"

#include "mesh/format/files.h"

#include <errno.h>
#include <libdeflate.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

enum { BUFFER = 1 << 16 };

struct sink {
    char *path, *temporary, *other; /* other: the name with the other compression; sink_close removes that file, as a
                                       reader might prefer it */
    int file;
    gzFile zip;
    int error; /* errno of the first failure; later output is dropped */
    bool unsummed;
    struct file_sum sum;
    size_t used;
    char buffer[BUFFER];
};

static char *joined(const char *a, const char *b) {
    char *s = malloc(strlen(a) + strlen(b) + 1);
    if (s) sprintf(s, "%s%s", a, b);
    return s;
}

static void sink_free(struct sink *s) {
    free(s->path);
    free(s->temporary);
    free(s->other);
    free(s);
}

status sink_open(const char *path, bool compress, struct sink **out) {
    *out = NULL;
    struct sink *s = calloc(1, sizeof *s);
    if (!s) return fail(ERR_SYSTEM, "no memory to write %s", path);
    s->path = joined(path, compress ? ".gz" : "");
    s->other = joined(path, compress ? "" : ".gz");
    s->temporary = joined(path, compress ? ".gz.tmp" : ".tmp");
    if (!s->path || !s->other || !s->temporary) {
        sink_free(s);
        return fail(ERR_SYSTEM, "no memory to write %s", path);
    }
    int why = file_create(s->temporary, &s->file);
    if (!why && compress && !(s->zip = gzdopen(s->file, "wb"))) {
        close(s->file);
        why = ENOMEM;
    }
    if (why) {
        status e = file_error(s->temporary, "cannot write", why);
        sink_free(s);
        return e;
    }
    *out = s;
    return OK;
}

void sink_unsummed(struct sink *s) {
    s->unsummed = true;
}

static void add_up(struct file_sum *sum, const char *data, size_t bytes) {
    sum->crc = libdeflate_crc32((uint32_t)sum->crc, data, bytes);
    sum->bytes += bytes;
}

static void put(struct sink *s, const char *data, size_t bytes) {
    if (!s->unsummed) add_up(&s->sum, data, bytes);
    while (bytes && !s->error) {
        size_t part = bytes < 1 << 30 ? bytes : 1 << 30;
        errno = 0;
        ssize_t done = s->zip ? gzwrite(s->zip, data, (unsigned)part) : write(s->file, data, part);
        if (done > 0) {
            data += done;
            bytes -= (size_t)done;
        } else if (errno != EINTR) {
            s->error = errno ? errno : EIO;
        }
    }
}

static void flush(struct sink *s) {
    put(s, s->buffer, s->used);
    s->used = 0;
}

void sink_write(struct sink *s, const void *data, size_t bytes) {
    if (bytes > BUFFER - s->used) flush(s);
    if (bytes > BUFFER) {
        put(s, data, bytes);
        return;
    }
    memcpy(s->buffer + s->used, data, bytes);
    s->used += bytes;
}

void sink_printf(struct sink *s, const char *format, ...) {
    va_list args;
    for (;;) {
        va_start(args, format);
        int n = vsnprintf(s->buffer + s->used, BUFFER - s->used, format, args);
        va_end(args);
        if (n >= 0 && (size_t)n < BUFFER - s->used) {
            s->used += (size_t)n;
            return;
        }
        if (n < 0 || !s->used) break;
        flush(s);
    }
    va_start(args, format);
    int n = vsnprintf(NULL, 0, format, args);
    va_end(args);
    char *text = n < 0 ? NULL : malloc((size_t)n + 1);
    if (!text) {
        s->error = s->error ? s->error : ENOMEM;
        return;
    }
    va_start(args, format);
    vsnprintf(text, (size_t)n + 1, format, args);
    va_end(args);
    put(s, text, (size_t)n);
    free(text);
}

static void shut(struct sink *s) {
    errno = 0;
    bool failed = s->zip ? gzclose(s->zip) != Z_OK : close(s->file) != 0;
    if (failed && !s->error) s->error = errno ? errno : EIO;
}

status sink_close_sum(struct sink *s, struct file_sum *sum) {
    flush(s);
    shut(s);
    if (sum) *sum = s->sum;
    if (!s->error) s->error = file_rename(s->temporary, s->path);
    status e = s->error ? file_error(s->path, "cannot write", s->error) : OK;
    (void)file_remove(s->error ? s->temporary : s->other);
    sink_free(s);
    return e;
}

status sink_close(struct sink *s) {
    return sink_close_sum(s, NULL);
}

status file_sum_read(const char *path, struct file_sum *sum) {
    TRY(file_single(path));
    char *zipped = joined(path, ".gz"), buffer[BUFFER];
    if (!zipped) return fail(ERR_SYSTEM, "no memory to read %s", path);
    *sum = (struct file_sum){0};
    const char *found = access(path, F_OK) ? zipped : path;
    size_t bytes;
    int file, got = -1, closed = Z_OK;
    status e = file_open_pieces(found, &file, &bytes);
    gzFile f = e ? NULL : gzdopen(file, "rb"); /* reads plain files, too */
    if (!e && !f) close(file);
    if (f)
        while ((got = gzread(f, buffer, BUFFER)) > 0) add_up(sum, buffer, (size_t)got);
    if (f) closed = gzclose(f);
    if (!e && !f)
        e = fail(ERR_SYSTEM, "no memory to read %s", found);
    else if (!e && (got < 0 || closed == Z_BUF_ERROR))
        e = fail(ERR_INPUT, "%s: cannot be read to its end", found);
    free(zipped);
    return e;
}

/* ---- headers and lists: OpenFOAM's bytes but for the banner, since readers are written against them ---- */

static const char banner[] = "/*--------------------------------*- C++ -*----------------------------------*\\\n"
                             "| haff: hydrodynamics of granular gases                                       |\n"
                             "\\*---------------------------------------------------------------------------*/\n",
                  divider[] = "// * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * //\n\n",
                  end_line[] = "\n\n// ************************************************************************* //\n";

void foam_header_write(struct sink *s, const struct foam_format *f, const char *class_name, const char *location,
                       const char *object, const char *note) {
    sink_write(s, banner, sizeof banner - 1);
    sink_printf(s, "FoamFile\n{\n    version     2.0;\n    format      %s;\n", f->binary ? "binary" : "ascii");
    sink_printf(s, "    class       %s;\n", class_name);
    if (f->binary) sink_printf(s, "    arch        \"LSB;label=32;scalar=64\";\n");
    if (note) sink_printf(s, "    note        \"%s\";\n", note);
    sink_printf(s, "    location    \"%s\";\n    object      %s;\n}\n", location, object);
    sink_write(s, divider, sizeof divider - 1);
}

void foam_end_write(struct sink *s) {
    sink_write(s, end_line, sizeof end_line - 1);
}

/* Writes the list if it is empty, and returns whether it is. In a binary file OpenFOAM's reader accepts no brackets
 * after the count 0. */
static bool write_empty(struct sink *s, const struct foam_format *f, long n) {
    if (n == 0) sink_printf(s, f->binary ? "\n0\n" : "\n0()\n");
    return n == 0;
}

/* A list begins on a line of its own. One of text ends its line, too. */
static void open_bracket(struct sink *s, const struct foam_format *f, long n) {
    sink_printf(s, f->binary ? "\n%ld\n(" : "\n%ld\n(\n", n);
}
static void close_bracket(struct sink *s, const struct foam_format *f) {
    sink_printf(s, f->binary ? ")" : ")\n");
}

/* Writes entries of a list, between its brackets. */
static void write_entries(struct sink *s, const struct foam_format *f, int components, long n, const double *v) {
    if (f->binary) {
        sink_write(s, v, (size_t)n * (size_t)components * sizeof *v);
        return;
    }
    for (long i = 0; i < n; i++, v += components) {
        if (components == 1) {
            sink_printf(s, "%.*g\n", f->precision, *v);
            continue;
        }
        for (int c = 0; c < components; c++) sink_printf(s, "%c%.*g", c ? ' ' : '(', f->precision, v[c]);
        sink_printf(s, ")\n");
    }
}

void foam_list_write_doubles(struct sink *s, const struct foam_format *f, int components, long n, const double *v) {
    if (write_empty(s, f, n)) return;
    open_bracket(s, f, n);
    write_entries(s, f, components, n, v);
    close_bracket(s, f);
}

/* ---- lists in slices ---- */

enum { PIECE = 1 << 15 }; /* entries that the root gets at a time */

/* The root writes the slices of all ranks, one after the other. */
static status write_pieces(struct sink *s, const struct foam_format *f, int components, const struct share *share,
                           const double *slice) {
    const long bytes = components * (long)sizeof *slice;
    const int mine = comm_rank(share->comm);
    double *piece = NULL;
    status e = s ? allocate(&piece, (long)PIECE * components, sizeof *piece, "a piece of a field") : OK;
    TRY(comm_agree(share->comm, e));
    if (s) write_entries(s, f, components, share->end, slice);
    for (int r = s ? 1 : mine; r < (s ? comm_size(share->comm) : mine + 1); r++) {
        const struct share theirs = share_at_rank(share, r);
        for (long at = theirs.first; at < theirs.end; at += PIECE) {
            const long n = theirs.end - at < PIECE ? theirs.end - at : PIECE;
            comm_to_root(share->comm, r, s ? piece : (double *)(uintptr_t)slice + (at - share->first) * components,
                         n * bytes);
            if (s) write_entries(s, f, components, n, piece);
        }
    }
    free(piece);
    return OK;
}

/* Writes bytes into the file of another rank's sink. */
static status write_at(const char *path, const char *temporary, const char *data, size_t bytes, size_t at) {
    int file, why = file_open_again(temporary, &file);
    if (why) return file_error(path, "cannot write", why);
    while (bytes && !why) {
        const ssize_t done = pwrite(file, data, bytes < 1 << 30 ? bytes : 1 << 30, (off_t)at);
        if (done > 0) {
            data += done;
            at += (size_t)done;
            bytes -= (size_t)done;
        } else if (done == 0 || errno != EINTR) {
            why = done ? errno : EIO;
        }
    }
    if (close(file) && !why) why = errno;
    return why ? file_error(path, "cannot write", why) : OK;
}

/* Passes over what the other ranks wrote, whose sums are given. */
static void pass_over(struct sink *s, int ranks, const double *sums, size_t bytes) {
    flush(s);
    for (int r = 1; r < ranks; r++)
        s->sum.crc = crc32_combine(s->sum.crc, (unsigned long)sums[2 * r], (z_off_t)sums[2 * r + 1]);
    s->sum.bytes += bytes;
    if (!s->error && lseek(s->file, (off_t)bytes, SEEK_CUR) < 0) s->error = errno;
}

/* Each rank writes its slice into the root's temporary file. */
static status write_slices(struct sink *s, const char *path, int components, const struct share *share,
                           const double *slice) {
    const size_t item = (size_t)components * sizeof *slice, bytes = (size_t)(share->end - share->first) * item;
    char *temporary = joined(path, ".tmp");
    double *sums = NULL, mine[2] = {0, 0};
    size_t at = 0;
    if (s) {
        flush(s);
        at = s->sum.bytes; /* nothing else was written than what is summed */
        sink_write(s, slice, bytes);
    }
    status e = temporary ? OK : fail(ERR_SYSTEM, "no memory to write %s", path);
    e = comm_agree(share->comm, e);
    if (!e) comm_broadcast(share->comm, &at, sizeof at);
    if (!e && !s) e = write_at(path, temporary, (const char *)slice, bytes, at + (size_t)share->first * item);
    if (!e && !s) mine[0] = libdeflate_crc32(0, slice, bytes);
    mine[1] = (double)bytes;
    free(temporary);
    TRY(comm_agree(share->comm, e));
    TRY(comm_gather(share->comm, mine, 2, &sums, NULL));
    if (s) pass_over(s, comm_size(share->comm), sums, (size_t)(share->n - share->end) * item);
    free(sums);
    return OK;
}

status foam_list_write_shared(struct sink *s, const char *path, const struct foam_format *f, int components,
                              const struct share *share, const double *slice) {
    const bool together = f->binary && !f->compress && comm_size(share->comm) > 1;
    if (s && write_empty(s, f, share->n)) return OK;
    if (!share->n) return OK;
    if (s) open_bracket(s, f, share->n);
    TRY(together ? write_slices(s, path, components, share, slice) : write_pieces(s, f, components, share, slice));
    if (s) close_bracket(s, f);
    return OK;
}

void foam_list_write_labels(struct sink *s, const struct foam_format *f, long n, const int *v) {
    if (write_empty(s, f, n)) return;
    open_bracket(s, f, n);
    if (f->binary) sink_write(s, v, (size_t)n * sizeof *v);
    for (long i = 0; i < n && !f->binary; i++) sink_printf(s, "%d\n", v[i]);
    close_bracket(s, f);
}

void foam_list_write_faces(struct sink *s, const struct foam_format *f, long n, const int *start, const int *points) {
    if (f->binary) {
        foam_list_write_labels(s, f, n + 1, start);
        foam_list_write_labels(s, f, start[n], points);
        return;
    }
    if (write_empty(s, f, n)) return;
    open_bracket(s, f, n);
    for (long i = 0; i < n; i++) {
        sink_printf(s, "%d", start[i + 1] - start[i]);
        for (int k = start[i]; k < start[i + 1]; k++) sink_printf(s, "%c%d", k > start[i] ? ' ' : '(', points[k]);
        sink_printf(s, start[i] == start[i + 1] ? "()\n" : ")\n");
    }
    close_bracket(s, f);
}
