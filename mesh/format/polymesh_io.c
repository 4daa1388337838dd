/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes the folder constant/polyMesh: points, faces, owner, neighbour, boundary. Reading validates every
 * index and the order of faces, and names file and line of the first entry that is wrong. */
#include "mesh/format/polymesh.h"

#include "mesh/format/files.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PATH = 4096, PATCHES = 10000 }; /* PATCHES: as many as a field can name */

/* ---- one file ---------------------------------------------------------------------------------------------------- */

struct file {
    struct source *source;
    struct foam_header header;
    struct lexer lexer; /* stands before the list */
};

static status file_open(const char *dir, const char *name, const char *class_name, struct file *f) {
    char path[PATH];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    *f = (struct file){0};
    TRY(source_open(path, &f->source));
    f->lexer = lexer_start(f->source);
    status s = foam_header_read(&f->lexer, &f->header);
    if (!s && f->header.present && strncmp(f->header.class_name, class_name, strlen(class_name)) != 0 &&
        !(strcmp(class_name, "faceList") == 0 && strcmp(f->header.class_name, "faceCompactList") == 0))
        s = source_fail(f->source, 1, "class %s; a mesh has %s here", f->header.class_name, class_name);
    if (s) {
        source_free(f->source);
        f->source = NULL;
    }
    return s;
}

/* Returns the line of an entry of the list, for messages, by counting numbers at the list's own depth; 0 in a binary
 * file. */
static int entry_line(const struct file *f, long entry) {
    if (f->header.present && f->header.binary) return 0;
    struct lexer l = f->lexer;
    struct token t;
    int depth = 0;
    long n = -1;
    for (;;) {
        status s = lexer_next(&l, &t);
        if (s || t.kind == TOKEN_END) {
            status_free(s);
            return 0;
        }
        if (depth == 1 && t.kind == TOKEN_NUMBER && ++n == entry) return t.line;
        depth += token_is(&t, "(") - token_is(&t, ")");
    }
}

static status entry_fail(const struct file *f, long entry, const char *text) {
    int line = entry_line(f, entry);
    char at[32] = "";
    if (line) snprintf(at, sizeof at, ":%d", line);
    return fail(ERR_INPUT, "%s%s: face %ld: %s", f->source->path, at, entry, text);
}

static status check_size(const struct file *f, long n, long most) {
    if (n > 0 && n <= most) return OK;
    return fail(ERR_INPUT, "%s: %ld entries; allowed are 1 to %ld", f->source->path, n, most);
}

/* ---- points, faces, owner, neighbour ----------------------------------------------------------------------------- */

static status read_points(const char *dir, struct polymesh *m) {
    struct file f;
    long n = 0;
    TRY(file_open(dir, "points", "vectorField", &f));
    status s = foam_list_read_doubles(&f.lexer, &f.header, 3, 0, &n, &m->points);
    if (!s) s = check_size(&f, n, INT_MAX / 3);
    m->npoints = (int)n;
    source_free(f.source);
    return s;
}

static status check_faces(const struct file *f, const struct polymesh *m) {
    for (int i = 0; i < m->nfaces; i++) {
        int n = m->face_start[i + 1] - m->face_start[i];
        const int *p = m->face_points + m->face_start[i];
        char text[200] = "";
        if (n < 3) snprintf(text, sizeof text, "%d points; a face has at least 3", n);
        for (int j = 0; j < n; j++) {
            if (p[j] < 0 || p[j] >= m->npoints)
                snprintf(text, sizeof text, "point %d; there are points 0 to %d", p[j], m->npoints - 1);
            else if (p[j] == p[(j + 1) % n])
                snprintf(text, sizeof text, "point %d twice in a row", p[j]);
        }
        if (*text) return entry_fail(f, i, text);
    }
    return OK;
}

static status read_faces(const char *dir, struct polymesh *m) {
    struct file f;
    long n = 0;
    TRY(file_open(dir, "faces", "faceList", &f));
    struct lexer start = f.lexer;
    status s = foam_list_read_faces(&f.lexer, &f.header, &n, &m->face_start, &m->face_points);
    if (!s) s = check_size(&f, n, INT_MAX - 1);
    m->nfaces = (int)n;
    f.lexer = start;
    if (!s) s = check_faces(&f, m);
    source_free(f.source);
    return s;
}

static status check_owner(const struct file *f, struct polymesh *m) {
    char text[200];
    for (int i = 0; i < m->nfaces; i++) {
        /* A closed cell has at least 4 faces, and a face at most 2 cells: there are fewer cells than faces. */
        if (m->owner[i] < 0 || m->owner[i] >= m->nfaces) {
            snprintf(text, sizeof text, "cell %d; a mesh of %d faces has cells from 0 and fewer than faces",
                     m->owner[i], m->nfaces);
            return entry_fail(f, i, text);
        }
        if (m->owner[i] >= m->ncells) m->ncells = m->owner[i] + 1;
    }
    return OK;
}

static status read_owner(const char *dir, struct polymesh *m) {
    struct file f;
    long n = 0;
    TRY(file_open(dir, "owner", "labelList", &f));
    struct lexer start = f.lexer;
    status s = foam_list_read_labels(&f.lexer, &f.header, m->nfaces, &n, &m->owner);
    f.lexer = start;
    if (!s && n != m->nfaces) s = fail(ERR_INPUT, "%s: %ld entries; there are %d faces", f.source->path, n, m->nfaces);
    if (!s) s = check_owner(&f, m);
    source_free(f.source);
    return s;
}

static status check_neighbour(const struct file *f, struct polymesh *m) {
    char text[200];
    for (int i = 0; i < m->ninternal; i++) {
        if (m->neighbour[i] <= m->owner[i] || m->neighbour[i] >= m->nfaces) {
            snprintf(text, sizeof text, "neighbour %d, owner %d; allowed are numbers above the owner's, below %d",
                     m->neighbour[i], m->owner[i], m->nfaces);
            return entry_fail(f, i, text);
        }
        if (m->neighbour[i] >= m->ncells) m->ncells = m->neighbour[i] + 1;
        if (i == 0 || m->owner[i] > m->owner[i - 1] ||
            (m->owner[i] == m->owner[i - 1] && m->neighbour[i] >= m->neighbour[i - 1]))
            continue;
        snprintf(text, sizeof text,
                 "owner %d, neighbour %d after %d, %d: inner faces must be sorted by owner, then neighbour; "
                 "run OpenFOAM's renumberMesh -overwrite",
                 m->owner[i], m->neighbour[i], m->owner[i - 1], m->neighbour[i - 1]);
        return entry_fail(f, i, text);
    }
    return OK;
}

static status read_neighbour(const char *dir, struct polymesh *m) {
    struct file f;
    long n = 0;
    TRY(file_open(dir, "neighbour", "labelList", &f));
    struct lexer start = f.lexer;
    status s = foam_list_read_labels(&f.lexer, &f.header, m->nfaces, &n, &m->neighbour);
    f.lexer = start;
    if (!s && n > m->nfaces) s = fail(ERR_INPUT, "%s: %ld entries; there are %d faces", f.source->path, n, m->nfaces);
    while (!s && n > 0 && m->neighbour[n - 1] == -1) n--; /* older files also list -1 for every boundary face */
    m->ninternal = (int)n;
    if (!s) s = check_neighbour(&f, m);
    source_free(f.source);
    return s;
}

/* Checks that every cell has four faces or more. */
static status check_cells(const char *dir, const struct polymesh *m) {
    int *count;
    TRY(allocate(&count, m->ncells, sizeof *count, "cells"));
    for (int i = 0; i < m->nfaces; i++) {
        count[m->owner[i]]++;
        if (i < m->ninternal) count[m->neighbour[i]]++;
    }
    int c = 0;
    while (c < m->ncells && count[c] >= 4) c++;
    int n = c < m->ncells ? count[c] : 0;
    free(count);
    if (c == m->ncells) return OK;
    if (n == 0)
        return fail(ERR_INPUT, "%s: no face belongs to cell %d, but owner and neighbour number cells up to %d", dir, c,
                    m->ncells - 1);
    return fail(ERR_INPUT, "%s/owner: cell %d has %d faces; a cell has at least 4", dir, c, n);
}

/* ---- boundary ---------------------------------------------------------------------------------------------------- */

static status copy_token(const struct token *t, char **out) {
    free(*out);
    *out = calloc((size_t)t->length + 1, 1);
    if (!*out) return fail(ERR_SYSTEM, "no memory for a word");
    memcpy(*out, t->text, (size_t)t->length);
    return OK;
}

static bool is_name(const struct token *t) {
    return t->kind == TOKEN_WORD || t->kind == TOKEN_STRING;
}

/* Skips to the ';' of an entry, or over its '{ ... }'. */
static status skip_value(struct lexer *l, const struct token *key) {
    int depth = 0;
    struct token t;
    do {
        TRY(lexer_next(l, &t));
        if (t.kind == TOKEN_END || (depth == 0 && token_is(&t, "}")))
            return lexer_fail(l, &t, "the entry '%.*s' has no ';'", key->length, key->text);
        bool closes = token_is(&t, "}") || token_is(&t, ")");
        depth += token_is(&t, "{") || token_is(&t, "(");
        depth -= closes;
        if (depth == 0 && token_is(&t, "}")) return OK;
    } while (depth > 0 || !token_is(&t, ";"));
    return OK;
}

static status read_label(struct lexer *l, int most, int *out) {
    struct token t;
    TRY(lexer_next(l, &t));
    if (t.kind != TOKEN_NUMBER || !(t.number >= 0 && t.number <= most) || t.number != (int)t.number)
        return lexer_fail(l, &t, "a whole number from 0 to %d is needed", most);
    *out = (int)t.number;
    return lexer_expect(l, ';');
}

static status read_word(struct lexer *l, char **out) {
    struct token t;
    TRY(lexer_next(l, &t));
    if (!is_name(&t)) return lexer_fail(l, &t, "a word is needed");
    TRY(copy_token(&t, out));
    return lexer_expect(l, ';');
}

/* Reads the value of inGroups: `1(wall)`, `(a b)` or `List<word> 1(wall)`. */
static status read_groups(struct lexer *l, const struct token *key, char **out) {
    struct lexer start = *l;
    struct token t;
    TRY(skip_value(l, key));
    TRY(allocate(out, (long)(l->position - start.position) + 1, 1, "the groups of a patch"));
    do {
        TRY(lexer_next(&start, &t));
        if (is_name(&t) && !token_is(&t, "List<word>"))
            sprintf(*out + strlen(*out), "%s%.*s", **out ? " " : "", t.length, t.text);
    } while (!token_is(&t, ";"));
    return OK;
}

static status check_type(struct lexer *l, const struct token *name, const struct patch *p) {
    static const char *const known[] = {"patch", "wall", "empty", "cyclic", "symmetry", "symmetryPlane", "wedge"};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (p->type && strcmp(p->type, known[i]) == 0) {
            if (i == 3 && !p->neighbour)
                return lexer_fail(l, name, "this cyclic patch needs a neighbourPatch, its other half");
            return OK;
        }
    return lexer_fail(
        l, name, "this patch has the type '%s'; allowed are patch wall empty cyclic symmetry symmetryPlane wedge%s",
        p->type ? p->type : "(none)",
        p->type && strcmp(p->type, "processor") == 0 ? "; reconstruct the decomposed case first" : "");
}

static status read_patch(struct lexer *l, const struct polymesh *m, const struct token *name, struct patch *p) {
    struct token t;
    TRY(copy_token(name, &p->name));
    TRY(lexer_expect(l, '{'));
    p->start = p->nfaces = -1;
    for (;;) {
        TRY(lexer_next(l, &t));
        if (token_is(&t, "}")) break;
        if (!is_name(&t)) return lexer_fail(l, &t, "a keyword or '}' is needed in patch '%s'", p->name);
        if (token_is(&t, "type"))
            TRY(read_word(l, &p->type));
        else if (token_is(&t, "neighbourPatch"))
            TRY(read_word(l, &p->neighbour));
        else if (token_is(&t, "nFaces"))
            TRY(read_label(l, m->nfaces, &p->nfaces));
        else if (token_is(&t, "startFace"))
            TRY(read_label(l, m->nfaces, &p->start));
        else if (token_is(&t, "inGroups") && !p->groups)
            TRY(read_groups(l, &t, &p->groups));
        else
            TRY(skip_value(l, &t));
    }
    if (p->nfaces < 0 || p->start < 0) return lexer_fail(l, name, "this patch needs nFaces and startFace");
    if (p->neighbour && (!p->type || strcmp(p->type, "cyclic") != 0)) {
        free(p->neighbour);
        p->neighbour = NULL;
    }
    return check_type(l, name, p);
}

static status read_patches(struct lexer *l, struct polymesh *m) {
    struct token t;
    TRY(lexer_next(l, &t));
    if (t.kind != TOKEN_NUMBER || !(t.number >= 0 && t.number <= PATCHES) || t.number != (int)t.number)
        return lexer_fail(l, &t, "the number of patches is needed, at most %d", PATCHES);
    int n = (int)t.number, next = m->ninternal;
    TRY(lexer_expect(l, '('));
    TRY(allocate(&m->patch, n, sizeof *m->patch, "patches"));
    for (;;) {
        TRY(lexer_next(l, &t));
        if (token_is(&t, ")")) break;
        if (t.kind != TOKEN_WORD) return lexer_fail(l, &t, "a patch name, a word without quotes, or ')' is needed");
        if (m->npatches == n) return lexer_fail(l, &t, "there are more than the %d patches announced", n);
        struct patch *p = &m->patch[m->npatches++];
        TRY(read_patch(l, m, &t, p));
        if (polymesh_find_patch(m, p->name) < m->npatches - 1) return lexer_fail(l, &t, "a second patch of that name");
        if (p->start != next)
            return lexer_fail(l, &t, "startFace %d; patches must follow each other: allowed is %d", p->start, next);
        next += p->nfaces;
        if (next > m->nfaces) return lexer_fail(l, &t, "nFaces %d: the mesh has %d faces only", p->nfaces, m->nfaces);
    }
    if (m->npatches < n) return lexer_fail(l, &t, "%d patches; the list announced %d", m->npatches, n);
    if (next != m->nfaces) return lexer_fail(l, &t, "patches end at face %d; the mesh has %d faces", next, m->nfaces);
    return OK;
}

status polymesh_read_patches(const char *dir, struct polymesh *m) {
    struct file f;
    TRY(file_open(dir, "boundary", "polyBoundaryMesh", &f));
    status s = read_patches(&f.lexer, m);
    for (int i = 0; i < m->npatches && !s; i++) {
        const struct patch *p = &m->patch[i];
        int j = p->neighbour ? polymesh_find_patch(m, p->neighbour) : -1;
        if (p->neighbour && (j < 0 || j == i || !m->patch[j].neighbour || strcmp(m->patch[j].neighbour, p->name) != 0))
            s = fail(ERR_INPUT, "%s: cyclic patch '%s' has neighbourPatch '%s'; each half must name the other one",
                     f.source->path, p->name, p->neighbour);
    }
    source_free(f.source);
    return s;
}

status polymesh_read(const char *dir, struct polymesh **out) {
    *out = NULL;
    struct polymesh *m;
    TRY(allocate(&m, 1, sizeof *m, "a mesh"));
    status s = read_points(dir, m);
    if (!s) s = read_faces(dir, m);
    if (!s) s = read_owner(dir, m);
    if (!s) s = read_neighbour(dir, m);
    if (!s) s = check_cells(dir, m);
    if (!s) s = polymesh_read_patches(dir, m);
    if (s)
        polymesh_free(m);
    else
        *out = m;
    return s;
}

/* ---- writing ----------------------------------------------------------------------------------------------------- */

static status write_start(const char *dir, const char *name, const char *class_name, const struct foam_format *f,
                          const char *note, struct sink **out) {
    char path[PATH];
    snprintf(path, sizeof path, "%s/%s", dir, name);
    TRY(sink_open(path, f->compress, out));
    foam_header_write(*out, f, class_name, "constant/polyMesh", name, note);
    return OK;
}

/* Closes the file and removes the same file in the other compression, which would shadow the new one. */
static status write_end(const char *dir, const char *name, const struct foam_format *f, struct sink *s) {
    char path[PATH];
    foam_end_write(s);
    TRY(sink_close(s));
    snprintf(path, sizeof path, "%s/%s%s", dir, name, f->compress ? "" : ".gz");
    int why = file_remove(path);
    return why && why != ENOENT ? file_error(path, "the old file cannot be removed", why) : OK;
}

static status write_boundary(const struct polymesh *m, const char *dir, const struct foam_format *format) {
    struct foam_format ascii = {.precision = format->precision, .compress = format->compress};
    struct sink *s;
    TRY(write_start(dir, "boundary", "polyBoundaryMesh", &ascii, NULL, &s));
    sink_printf(s, "\n%d\n(\n", m->npatches);
    for (int i = 0; i < m->npatches; i++) {
        const struct patch *p = &m->patch[i];
        sink_printf(s, "    %s\n    {\n        type            %s;\n", p->name, p->type);
        patch_write_groups(s, p);
        sink_printf(s, "        nFaces          %d;\n        startFace       %d;\n", p->nfaces, p->start);
        if (p->neighbour)
            sink_printf(s,
                        "        matchTolerance  0.0001;\n        transform       translational;\n"
                        "        neighbourPatch  %s;\n",
                        p->neighbour);
        if (p->neighbour && p->nfaces > 0) {
            const struct patch *q = &m->patch[polymesh_find_patch(m, p->neighbour)];
            const double *a = m->points + 3L * m->face_points[m->face_start[p->start]];
            const double *b = m->points + 3L * m->face_points[m->face_start[q->start]];
            sink_printf(s, "        separationVector (%.17g %.17g %.17g);\n", b[0] - a[0], b[1] - a[1], b[2] - a[2]);
        }
        sink_printf(s, "    }\n");
    }
    sink_printf(s, ")\n");
    return write_end(dir, "boundary", &ascii, s);
}

status polymesh_write(const struct polymesh *m, const char *dir, const struct foam_format *f) {
    char note[200];
    snprintf(note, sizeof note, "nPoints:%d  nCells:%d  nFaces:%d  nInternalFaces:%d", m->npoints, m->ncells, m->nfaces,
             m->ninternal);
    struct sink *s;
    int why = folder_make(dir);
    if (why) return file_error(dir, "the folder cannot be made", why);
    TRY(write_start(dir, "points", "vectorField", f, NULL, &s));
    foam_list_write_doubles(s, f, 3, m->npoints, m->points);
    TRY(write_end(dir, "points", f, s));
    TRY(write_start(dir, "faces", f->binary ? "faceCompactList" : "faceList", f, NULL, &s));
    foam_list_write_faces(s, f, m->nfaces, m->face_start, m->face_points);
    TRY(write_end(dir, "faces", f, s));
    TRY(write_start(dir, "owner", "labelList", f, note, &s));
    foam_list_write_labels(s, f, m->nfaces, m->owner);
    TRY(write_end(dir, "owner", f, s));
    TRY(write_start(dir, "neighbour", "labelList", f, note, &s));
    foam_list_write_labels(s, f, m->ninternal, m->neighbour);
    TRY(write_end(dir, "neighbour", f, s));
    return write_boundary(m, dir, f);
}
