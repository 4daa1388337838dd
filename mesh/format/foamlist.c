/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads lists in OpenFOAM's grammar, ascii and binary: numbers, vectors, labels, faces (foamfile.h). */
#include "mesh/format/foamfile_private.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { EQUAL = 8 }; /* most entries of `N { v }` in lists of corners and offsets: sound faces have no equal ones */

/* The array that a list is read into. It grows, because `( ... )` may come without a count. */
struct growing {
    void *data;
    long count, room;
    size_t size; /* bytes of one item */
};

static status grow(struct growing *g, long more) {
    if (g->count + more <= g->room) return OK;
    long room = g->count + more > 2 * g->room ? g->count + more : 2 * g->room;
    void *data = realloc(g->data, (size_t)room * g->size);
    if (!data) return fail(ERR_SYSTEM, "no memory for a list of %ld values", room);
    g->data = data;
    g->room = room;
    return OK;
}

/* Hands the array over to the caller, or frees it if e is an error. The array of an empty list is allocated, too: the
 * caller always has something to free. */
static status take(struct growing *g, status e, void *out) {
    if (!e && !g->data) e = grow(g, 1);
    if (e) {
        free(g->data);
        g->data = NULL;
    }
    memcpy(out, &g->data, sizeof g->data);
    return e;
}

static status whole_number(const struct lexer *l, const struct token *t, const char *what, int *out) {
    if (t->kind != TOKEN_NUMBER || t->number != floor(t->number)) return lexer_fail(l, t, "expected %s", what);
    if (fabs(t->number) > INT_MAX) return lexer_fail(l, t, "%s is at most %d", what, INT_MAX);
    *out = (int)t->number;
    return OK;
}

/* How a list starts: `count` is -1 if not given. */
struct opening {
    long count;
    int line;
    bool binary, uniform, empty;
};

/* Reads how a list starts; `count { value }`, equal entries, may have at most `most` of them. */
static status open_list(struct lexer *l, const struct foam_header *h, long most, struct opening *o) {
    struct token t;
    *o = (struct opening){.count = -1};
    TRY(lexer_next(l, &t));
    o->line = t.line;
    if (t.kind == TOKEN_NUMBER) {
        int n = 0;
        TRY(whole_number(l, &t, "the count of a list", &n));
        if (n < 0) return lexer_fail(l, &t, "the count of a list is not negative");
        o->count = n;
        struct lexer before = *l;
        TRY(lexer_next(l, &t));
        /* OpenFOAM writes an empty binary list as `0` alone. */
        if (n == 0 && h->binary && !token_is(&t, "(")) {
            *l = before;
            o->empty = true;
            return OK;
        }
    }
    o->uniform = o->count >= 0 && t.kind == TOKEN_PUNCTUATION && t.text[0] == '{';
    if (o->uniform && o->count > most)
        return lexer_fail(l, &t, "%ld equal entries; at most %ld can stand here", o->count, most);
    if (!o->uniform && !(t.kind == TOKEN_PUNCTUATION && t.text[0] == '('))
        return lexer_fail(l, &t,
                          o->count < 0 ? "expected a list: a count and '(', or '('" : "expected '(' of the list");
    o->binary = h->binary && !o->uniform && o->count > 0;
    return OK;
}

/* Passes over the raw bytes of a binary list and its ')'; *raw points to the bytes, or is NULL: the text lacks them. */
static status raw_bytes(struct lexer *l, const struct opening *o, int bytes, const char **raw) {
    const struct source *s = l->source;
    const size_t need = (size_t)o->count * (size_t)bytes;
    const bool apart = s->gap_bytes && l->position == s->gap, same = apart && need == s->gap_bytes;
    const size_t left = s->size - l->position, skip = same ? 0 : need;
    if ((apart && !same) || skip >= left || s->text[l->position + skip] != ')')
        return source_fail(s, o->line,
                           "the binary list of %ld entries of %d bytes does not end with ')': the count or the 'arch' "
                           "of the header is wrong, or the file was cut",
                           o->count, bytes);
    *raw = same ? NULL : s->text + l->position;
    l->position += skip + 1;
    l->last_line = l->line;
    return OK;
}

static status wrong_count(const struct lexer *l, const struct opening *o, long found) {
    return source_fail(l->source, l->line, "the list that starts at line %d says %ld entries, but has %ld", o->line,
                       o->count, found);
}

/* Returns the lexer moved past the blanks and line ends that writers put between entries; lexer_next handles
 * comments. */
static struct lexer past_blanks(const struct lexer *l) {
    struct lexer next = *l;
    for (const char *p = l->source->text + l->position; *p == ' ' || *p == '\n'; p++) {
        next.line += *p == '\n';
        next.position++;
    }
    return next;
}

static status too_many(const struct lexer *l, const struct opening *o) {
    return source_fail(l->source, past_blanks(l).line, "the list that starts at line %d says %ld entries, but has more",
                       o->line, o->count);
}

/* Moves past the closing bracket if it comes next, and sets *closed. */
static status closes(struct lexer *l, const struct opening *o, bool *closed) {
    struct token t;
    struct lexer next = past_blanks(l);
    char c = l->source->text[next.position];
    *closed = false;
    if ((c >= '0' && c <= '9') || c == '-' || c == '(') return OK;
    TRY(lexer_next(&next, &t));
    if (t.kind == TOKEN_END) return lexer_fail(l, &t, "the list that starts at line %d is not closed", o->line);
    *closed = t.kind == TOKEN_PUNCTUATION && t.text[0] == ')';
    if (*closed) *l = next;
    return OK;
}

/* Makes room for the entries that the list announces. A false count must not ask for memory that the file cannot
 * fill. */
static status make_room(const struct lexer *l, const struct opening *o, int components, struct growing *g) {
    const long most = (long)(l->source->size - l->position) / 2;
    return o->count > 0 && o->count * components <= most ? grow(g, o->count * components) : OK;
}

/* How many entries may follow n of them: any number, if the list does not say how many it has. */
static long entries_left(const struct opening *o, long n) {
    return o->count < 0 ? LONG_MAX : o->count - n;
}

/* ---- entries as writers put them ----
 *
 * Between entries stand blanks and line ends alone, whole numbers have nine digits at most. The functions below read
 * such entries in one pass, as long as there are any, at most `most`, and the array has room, and return how many they
 * read. What is left, the lexer reads, one entry at a time. */

/* Returns the first character at p or behind it that is no blank and no line end; *line counts these. */
static inline const char *after_blanks(const char *p, int *line) {
    for (; *p == ' ' || *p == '\n'; p++) *line += *p == '\n';
    return p;
}

static void move_to(struct lexer *l, const char *p, int line) {
    l->position = (size_t)(p - l->source->text);
    l->line = l->last_line = line;
}

static long plain_labels(struct lexer *l, long most, struct growing *g) {
    long n = 0;
    if (most > g->room - g->count) most = g->room - g->count;
    for (int line = l->line; n < most; n++) {
        int *v = (int *)g->data + g->count;
        const char *p = foam_digits(after_blanks(l->source->text + l->position, &line), v);
        if (!p || (*p != ' ' && *p != '\n' && *p != ')')) break;
        g->count++;
        move_to(l, p, line);
    }
    return n;
}

/* Reads faces `4(0 1 2 3)`. */
static long plain_faces(struct lexer *l, long most, struct growing *start, struct growing *points) {
    long n = 0;
    if (most > start->room - start->count) most = start->room - start->count;
    for (int line = l->line, corners; n < most; n++) {
        const char *p = foam_digits(after_blanks(l->source->text + l->position, &line), &corners);
        if (!p || *p++ != '(' || corners < 1 || corners > points->room - points->count) break;
        int *v = (int *)points->data + points->count, read = 0;
        while (read < corners && (p = foam_digits(p, v + read)) && *p++ == (read + 1 < corners ? ' ' : ')')) read++;
        if (read < corners || points->count + corners > INT_MAX) break;
        points->count += corners;
        ((int *)start->data)[start->count++] = (int)points->count;
        move_to(l, p, line);
    }
    return n;
}

long plain_entries(struct lexer *l, long most, int components, double *v) {
    long n = 0;
    for (int line = l->line; n < most; n++, v += components) {
        const char *p = after_blanks(l->source->text + l->position, &line);
        int read = 0;
        if (components > 1 && *p++ != '(') break;
        while (read < components && (p = foam_number(p + (read && *p == ' '), v + read)) && isfinite(v[read])) read++;
        if (read < components || (components > 1 && *p++ != ')')) break;
        move_to(l, p, line);
    }
    return n;
}

/* ---- numbers ---- */

static status read_value(struct lexer *l, double *v) {
    struct lexer next = past_blanks(l);
    const char *text = l->source->text, *end = foam_number(text + next.position, v);
    if (end && isfinite(*v)) { /* the common case is read without making a token */
        *l = next;
        l->last_line = l->line;
        l->position = (size_t)(end - text);
        return OK;
    }
    struct token t;
    TRY(lexer_next(l, &t));
    if (t.kind != TOKEN_NUMBER) return lexer_fail(l, &t, "expected a number");
    *v = t.number;
    return OK;
}

static status read_entry(struct lexer *l, int components, double *v) {
    if (components == 1) return read_value(l, v);
    TRY(lexer_expect(l, '('));
    for (int c = 0; c < components; c++) TRY(read_value(l, &v[c]));
    return lexer_expect(l, ')');
}

enum { PIECE = 1 << 14 }; /* entries that are read at a time */

/* The entries of a list that are kept: first .. end - 1. */
struct part {
    int components;
    long first, end, at; /* at: the number of the next entry */
    struct growing kept;
};

/* Passes n entries, and keeps those of the part. */
static status keep(struct part *p, const double *v, long n) {
    const long from = p->first > p->at ? p->first - p->at : 0, to = p->end < p->at + n ? p->end - p->at : n;
    p->at += n;
    if (from >= to) return OK;
    TRY(grow(&p->kept, (to - from) * p->components));
    memcpy((double *)p->kept.data + p->kept.count, v + from * p->components,
           (size_t)((to - from) * p->components) * sizeof *v);
    p->kept.count += (to - from) * p->components;
    return OK;
}

/* Makes room for the part of a list, as far as the file can fill it. */
static status room_for(const struct lexer *l, const struct opening *o, struct part *p) {
    const long end = p->end < o->count ? p->end : o->count;
    const struct opening wanted = {.count = end - p->first};
    return make_room(l, &wanted, p->components, &p->kept);
}

static status ascii_doubles(struct lexer *l, const struct opening *o, struct part *p, struct growing *piece) {
    TRY(room_for(l, o, p));
    TRY(grow(piece, (long)PIECE * p->components));
    for (;;) {
        bool closed;
        const long left = entries_left(o, p->at);
        const long read = plain_entries(l, left < PIECE ? left : PIECE, p->components, piece->data);
        TRY(keep(p, piece->data, read));
        TRY(closes(l, o, &closed));
        if (closed) return o->count >= 0 && p->at != o->count ? wrong_count(l, o, p->at) : OK;
        if (p->at == o->count) return too_many(l, o);
        if (read == PIECE) continue;
        TRY(read_entry(l, p->components, piece->data));
        TRY(keep(p, piece->data, 1));
    }
}

static status uniform_doubles(struct lexer *l, const struct opening *o, struct part *p) {
    double v[16];
    TRY(read_entry(l, p->components, v));
    TRY(lexer_expect(l, '}'));
    for (long i = 0; i < o->count; i++) TRY(keep(p, v, 1));
    return OK;
}

/* Reads n entries of a binary list, from entry `from` on, out of the text or, where it lacks them, of the file. */
static status binary_entries(const struct source *s, const char *raw, size_t bytes, long from, long n, char *to) {
    size_t at = (size_t)from * bytes, left = (size_t)n * bytes;
    if (raw) memcpy(to, raw + at, left);
    while (!raw && left) {
        const ssize_t got = pread(s->file, to, left < 1 << 30 ? left : 1 << 30, (off_t)(s->gap + at));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0)
            return fail(ERR_INPUT, "%s: cannot be read to its end: %s", s->path, got ? strerror(errno) : "cut");
        to += got;
        at += (size_t)got;
        left -= (size_t)got;
    }
    return OK;
}

static status check_finite(const struct lexer *l, const struct opening *o, const struct part *p, const double *v,
                           long n) {
    for (long i = 0; i < n * p->components; i++)
        if (!isfinite(v[i]))
            return source_fail(l->source, o->line, "entry %ld of the binary list is %g; numbers must be finite",
                               p->at + i / p->components, v[i]);
    return OK;
}

static status binary_doubles(struct lexer *l, const struct foam_header *h, const struct opening *o, struct part *p,
                             struct growing *piece) {
    const char *raw = NULL;
    const size_t bytes = (size_t)(h->scalar_bytes * p->components);
    const long end = p->end < o->count ? p->end : o->count;
    TRY(raw_bytes(l, o, (int)bytes, &raw));
    TRY(grow(piece, (long)PIECE * p->components));
    if (p->first < end) TRY(grow(&p->kept, (end - p->first) * p->components));
    for (p->at = p->first < end ? p->first : o->count; p->at < end;) {
        const long n = end - p->at < PIECE ? end - p->at : PIECE;
        double *v = piece->data;
        TRY(binary_entries(l->source, raw, bytes, p->at, n, piece->data));
        for (long i = n * p->components - 1; h->scalar_bytes == 4 && i >= 0; i--) { /* backwards: doubles are longer */
            float f;
            memcpy(&f, (const char *)piece->data + 4 * i, 4);
            v[i] = f;
        }
        TRY(check_finite(l, o, p, v, n));
        TRY(keep(p, v, n));
    }
    p->at = o->count;
    return OK;
}

/* Are the entries of the list that begins here left out of the text because the ranks have their slices of them? */
static bool is_shared(const struct lexer *l) {
    return l->source->components && l->position == l->source->gap;
}

/* Passes over the ')' of such a list. */
static status pass_shared(struct lexer *l) {
    l->line += l->source->gap_lines;
    return lexer_expect(l, ')');
}

/* Hands over the slice of this rank. */
static status take_shared(struct lexer *l, struct part *p, long count) {
    struct source *s = (struct source *)(uintptr_t)l->source; /* what is handed over is no part of the text */
    if (!s->part || p->components != s->components || p->first != s->part_first || p->end != s->part_end)
        return fail(ERR_SYSTEM, "%s: this rank does not hold all of the entries that were asked for", s->path);
    p->kept.data = s->part;
    p->kept.count = p->kept.room = (s->part_end - s->part_first) * s->components;
    p->at = count;
    s->part = NULL;
    return pass_shared(l);
}

status foam_list_read_part(struct lexer *l, const struct foam_header *h, int components, long most, long first,
                           long end, long *n, double **out) {
    struct part p = {.components = components, .first = first, .end = end, .kept.size = sizeof(double)};
    struct growing piece = {.size = sizeof(double)};
    struct opening o;
    *out = NULL;
    if (components < 1 || components > 16) return fail(ERR_SYSTEM, "a list has 1 to 16 components, not %d", components);
    TRY(open_list(l, h, most, &o));
    status e = OK;
    if (is_shared(l))
        e = take_shared(l, &p, o.count);
    else if (o.uniform)
        e = uniform_doubles(l, &o, &p);
    else if (o.binary)
        e = binary_doubles(l, h, &o, &p, &piece);
    else if (!o.empty)
        e = ascii_doubles(l, &o, &p, &piece);
    free(piece.data);
    TRY(take(&p.kept, e, out));
    *n = p.at;
    return OK;
}

status foam_list_read_doubles(struct lexer *l, const struct foam_header *h, int components, long most, long *n,
                              double **out) {
    return foam_list_read_part(l, h, components, most, 0, LONG_MAX, n, out);
}

/* ---- labels and faces ---- */

static status read_label(struct lexer *l, int *out) {
    double v;
    struct lexer before = *l;
    struct token t;
    TRY(read_value(l, &v));
    if (v == floor(v) && fabs(v) <= INT_MAX) {
        *out = (int)v;
        return OK;
    }
    TRY(lexer_next(&before, &t));
    return whole_number(l, &t, "a whole number", out);
}

static status binary_labels(struct lexer *l, const struct foam_header *h, const struct opening *o, struct growing *g) {
    const char *raw = NULL;
    TRY(raw_bytes(l, o, h->label_bytes, &raw));
    TRY(grow(g, o->count));
    int *v = (int *)g->data + g->count;
    if (h->label_bytes == 4) memcpy(v, raw, (size_t)o->count * 4);
    for (long i = 0; i < o->count && h->label_bytes == 8; i++) {
        int64_t wide;
        memcpy(&wide, raw + 8 * i, 8);
        if (wide > INT_MAX || wide < INT_MIN)
            return source_fail(l->source, o->line, "entry %ld of the binary list is %lld; labels are at most %d", i,
                               (long long)wide, INT_MAX);
        v[i] = (int)wide;
    }
    g->count += o->count;
    return OK;
}

/* Appends the labels of one list to g. */
static status labels(struct lexer *l, const struct foam_header *h, long most, struct growing *g) {
    struct opening o;
    TRY(open_list(l, h, most, &o));
    if (o.empty) return OK;
    if (o.binary) return binary_labels(l, h, &o, g);
    if (o.uniform) {
        int v;
        TRY(read_label(l, &v));
        TRY(lexer_expect(l, '}'));
        TRY(grow(g, o.count));
        for (long i = 0; i < o.count; i++) ((int *)g->data)[g->count++] = v;
        return OK;
    }
    TRY(make_room(l, &o, 1, g));
    for (long n = 0;; n++) {
        bool closed;
        n += plain_labels(l, entries_left(&o, n), g);
        TRY(closes(l, &o, &closed));
        if (closed) return o.count >= 0 && n != o.count ? wrong_count(l, &o, n) : OK;
        if (n == o.count) return too_many(l, &o);
        TRY(grow(g, 1));
        TRY(read_label(l, (int *)g->data + g->count));
        g->count++;
    }
}

status foam_list_read_labels(struct lexer *l, const struct foam_header *h, long most, long *n, int **out) {
    struct growing g = {.size = sizeof(int)};
    *n = 0;
    TRY(take(&g, labels(l, h, most, &g), out));
    *n = g.count;
    return OK;
}

static status append(struct growing *g, int v) {
    TRY(grow(g, 1));
    ((int *)g->data)[g->count++] = v;
    return OK;
}

/* Reads a faceCompactList: n + 1 offsets, then the points of all faces. */
static status compact_faces(struct lexer *l, const struct foam_header *h, struct growing *start,
                            struct growing *points) {
    int line = l->line;
    TRY(labels(l, h, EQUAL, start));
    TRY(labels(l, h, EQUAL, points));
    if (!start->count) TRY(append(start, 0));
    const int *s = start->data;
    bool good = s[0] == 0 && s[start->count - 1] == points->count;
    for (long i = 1; i < start->count; i++) good = good && s[i] >= s[i - 1];
    if (!good)
        return source_fail(l->source, line, "the offsets of the faceCompactList do not rise from 0 to its %ld points",
                           points->count);
    return OK;
}

static status listed_faces(struct lexer *l, const struct foam_header *h, struct growing *start,
                           struct growing *points) {
    struct opening o;
    TRY(open_list(l, h, 0, &o));
    TRY(append(start, 0));
    if (o.empty) return OK;
    TRY(make_room(l, &o, 1, start));
    for (long n = 0;; n++) {
        bool closed;
        n += plain_faces(l, entries_left(&o, n), start, points);
        TRY(closes(l, &o, &closed));
        if (closed) return o.count >= 0 && n != o.count ? wrong_count(l, &o, n) : OK;
        if (n == o.count) return too_many(l, &o);
        TRY(labels(l, h, EQUAL, points));
        if (points->count > INT_MAX)
            return source_fail(l->source, l->line, "faces have more than %d points in all", INT_MAX);
        TRY(append(start, (int)points->count));
    }
}

status foam_list_read_faces(struct lexer *l, const struct foam_header *h, long *n, int **start, int **points) {
    struct growing s = {.size = sizeof(int)}, p = {.size = sizeof(int)};
    bool compact = !strcmp(h->class_name, "faceCompactList");
    *n = 0;
    status e = compact ? compact_faces(l, h, &s, &p) : listed_faces(l, h, &s, &p);
    e = take(&s, e, start);
    e = take(&p, e, points);
    if (e) {
        free(*start);
        *start = NULL;
        return e;
    }
    *n = s.count - 1;
    return OK;
}

status foam_list_skip(struct lexer *l, const struct foam_header *h, int item_bytes) {
    struct opening o;
    const char *raw = NULL;
    TRY(open_list(l, h, LONG_MAX, &o));
    if (o.empty) return OK;
    if (is_shared(l)) return pass_shared(l);
    if (o.binary) return raw_bytes(l, &o, item_bytes, &raw);
    const char *text = l->source->text, *p = text + l->position;
    int depth = 1, line = l->line;
    for (; *p && depth; p++) {
        depth += (*p == '(' || *p == '{') - (*p == ')' || *p == '}');
        line += *p == '\n';
        if (p[0] == '/' && p[1] == '/') {
            while (p[1] && p[1] != '\n') p++;
        } else if (p[0] == '/' && p[1] == '*') {
            const char *end = strstr(p + 2, "*/");
            if (!end) break;
            for (; p <= end; p++) line += *p == '\n';
        }
    }
    if (depth)
        return source_fail(l->source, o.line,
                           "the list is not closed: the file was cut, or 'format' of its header is wrong");
    l->position = (size_t)(p - text);
    l->line = l->last_line = line;
    return OK;
}
