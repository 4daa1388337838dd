/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes files in OpenFOAM's grammar: a buffered, optionally gzipped file that replaces the old one when it is closed,
 * headers and lists (foamfile.h). */
#include "mesh/format/foamfile.h"

#include "mesh/format/files.h"

#include <errno.h>
#include <stdarg.h>
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
    sum->crc = crc32_z(sum->crc, (const unsigned char *)data, bytes);
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
    char *zipped = joined(path, ".gz"), buffer[BUFFER];
    if (!zipped) return fail(ERR_SYSTEM, "no memory to read %s", path);
    *sum = (struct file_sum){0};
    const char *found = access(path, F_OK) ? zipped : path;
    size_t bytes;
    int file, got = -1, closed = Z_OK;
    status e = file_open_read(found, &file, &bytes);
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

/* ---- headers and lists ---- */

void foam_header_write(struct sink *s, const struct foam_format *f, const char *class_name, const char *location,
                       const char *object, const char *note) {
    sink_printf(s, "FoamFile\n{\n    version     2.0;\n    format      %s;\n", f->binary ? "binary" : "ascii");
    if (f->binary) sink_printf(s, "    arch        \"LSB;label=32;scalar=64\";\n");
    sink_printf(s, "    class       %s;\n", class_name);
    if (note) sink_printf(s, "    note        \"%s\";\n", note);
    sink_printf(s, "    location    \"%s\";\n    object      %s;\n}\n\n", location, object);
}

/* Writes the list if it is empty, and returns whether it is. In a binary file OpenFOAM's reader accepts no brackets
 * after the count 0. */
static bool write_empty(struct sink *s, const struct foam_format *f, long n) {
    if (n == 0) sink_printf(s, f->binary ? "0\n" : "0()\n");
    return n == 0;
}

static void write_raw(struct sink *s, long n, const void *data, size_t bytes) {
    sink_printf(s, "%ld\n(", n);
    sink_write(s, data, bytes);
    sink_printf(s, ")\n");
}

void foam_list_write_doubles(struct sink *s, const struct foam_format *f, int components, long n, const double *v) {
    if (write_empty(s, f, n)) return;
    if (f->binary) {
        write_raw(s, n, v, (size_t)n * (size_t)components * sizeof *v);
        return;
    }
    sink_printf(s, "%ld\n(\n", n);
    for (long i = 0; i < n; i++, v += components) {
        if (components == 1) {
            sink_printf(s, "%.*g\n", f->precision, *v);
            continue;
        }
        for (int c = 0; c < components; c++) sink_printf(s, "%c%.*g", c ? ' ' : '(', f->precision, v[c]);
        sink_printf(s, ")\n");
    }
    sink_printf(s, ")\n");
}

void foam_list_write_labels(struct sink *s, const struct foam_format *f, long n, const int *v) {
    if (write_empty(s, f, n)) return;
    if (f->binary) {
        write_raw(s, n, v, (size_t)n * sizeof *v);
        return;
    }
    sink_printf(s, "%ld\n(\n", n);
    for (long i = 0; i < n; i++) sink_printf(s, "%d\n", v[i]);
    sink_printf(s, ")\n");
}

void foam_list_write_faces(struct sink *s, const struct foam_format *f, long n, const int *start, const int *points) {
    if (f->binary) {
        foam_list_write_labels(s, f, n + 1, start);
        foam_list_write_labels(s, f, start[n], points);
        return;
    }
    if (write_empty(s, f, n)) return;
    sink_printf(s, "%ld\n(\n", n);
    for (long i = 0; i < n; i++) {
        sink_printf(s, "%d", start[i + 1] - start[i]);
        for (int k = start[i]; k < start[i + 1]; k++) sink_printf(s, "%c%d", k > start[i] ? ' ' : '(', points[k]);
        sink_printf(s, start[i] == start[i + 1] ? "()\n" : ")\n");
    }
    sink_printf(s, ")\n");
}
