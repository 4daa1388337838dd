/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the lists of a polyMesh folder in slices (lists.h). */
#include "mesh/spread/lists.h"

#include "mesh/base/window.h"
#include "mesh/format/files.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    PATH = 4096,
    MOST_CORNERS = 1 << 12,           /* of a face of an ascii list */
    ROOM = WINDOW + 8 * MOST_CORNERS, /* bytes of a message: a window, and an entry beyond it */
    DONE = 0,
    UNUSUAL = -1 /* in place of such a number of bytes */
};
static const double FARTHEST = 1e60; /* largest |coordinate|, m: polymesh_check_points refuses more */

enum entry { POINT, LABEL, FACE };
struct list { /* what the root has found in the head of a list; the same on every rank */
    bool usual, zipped, binary, compact;
    int label_bytes, scalar_bytes;
    long count;
    long at; /* the byte of the file behind the opening bracket */
};
struct list_reader { /* of a file */
    const struct comm *comm;
    char path[PATH];
    struct list list;
    int file;             /* of a plain binary file, on every rank; else -1 */
    struct window window; /* the root's; what is still to be read begins at `next` */
    size_t next;
    char *sent; /* [ROOM] what the root sends */
};
struct bytes { /* a slice, as far as it is there */
    char *data;
    size_t n, room;
};

void lists_agree(const struct comm *c, bool *sound) {
    double all = *sound;
    comm_min(c, &all, 1);
    *sound = all > 0;
}

static status add(struct bytes *b, const void *data, size_t n) {
    if (b->n + n > b->room) {
        const size_t room = 2 * (b->n + n);
        char *more = realloc(b->data, room);
        if (!more) return fail(ERR_SYSTEM, "no memory for a slice of %zu bytes", room);
        b->data = more;
        b->room = room;
    }
    memcpy(b->data + b->n, data, n);
    b->n += n;
    return OK;
}

/* ---- the head of a list ------------------------------------------------------------------------------------------ */

/* Reads the count and the bracket of a list at the start of a text. Returns whether they are there; *at is the place
 * behind the bracket. */
static bool find_count(struct lexer *l, long *count, long *at) {
    struct token t;
    status e = lexer_next(l, &t);
    bool good = !e && t.kind == TOKEN_NUMBER && t.number >= 1 && t.number <= 1e18 && t.number == floor(t.number);
    if (good) *count = (long)t.number;
    if (!e) e = lexer_expect(l, '(');
    good &= !e;
    status_free(e);
    *at = (long)l->position;
    return good;
}

static bool read_head(struct list_reader *r, const char *class_name, const char *text, size_t size) {
    struct source head = {.path = r->path, .text = (char *)(uintptr_t)text, .size = size, .file = -1};
    struct lexer l = lexer_start(&head);
    struct foam_header h;
    const status e = foam_header_read(&l, &h);
    status_free(e);
    if (e || !h.present) return false;
    r->list.binary = h.binary;
    r->list.label_bytes = h.label_bytes;
    r->list.scalar_bytes = h.scalar_bytes;
    r->list.compact = !strcmp(h.class_name, "faceCompactList");
    const bool faces = !strcmp(class_name, "faceList"),
               named = !strncmp(h.class_name, class_name, strlen(class_name)) || (faces && r->list.compact);
    if (!named || (faces && r->list.compact != h.binary)) return false;
    return find_count(&l, &r->list.count, &r->list.at);
}

/* Fills the window of the root behind what is left in it. Returns whether the file can be read. */
static bool refill(struct list_reader *r) {
    const size_t used = r->next;
    r->next = 0;
    return window_fill(&r->window, used);
}

/* Looks at the file on the root. */
static status look(struct list_reader *r, const char *class_name) {
    size_t bytes;
    int file;
    TRY(file_single(r->path));
    status e = file_open_pieces(r->path, &file, &bytes);
    if (e && strlen(r->path) + 4 < PATH) {
        strcat(r->path, ".gz");
        status_free(e);
        e = file_open_pieces(r->path, &file, &bytes);
    }
    status_free(e);
    if (e) return OK; /* who reads the whole file tells why it cannot be */
    TRY(window_open(file, &r->window));
    if (!refill(r)) return OK;
    const size_t length = strlen(r->path);
    r->list.zipped = window_zipped(&r->window) || (length > 3 && !strcmp(r->path + length - 3, ".gz"));
    r->list.usual = read_head(r, class_name, r->window.text, r->window.size);
    r->next = (size_t)r->list.at;
    if (r->list.usual && r->list.count >= INT_MAX)
        return fail(ERR_INPUT,
                    "%s: %ld entries; labels of 32 bits, which meshes have here, count at most %d: give a "
                    "coarser mesh, or a union of boxes as system/blockMeshDict",
                    r->path, r->list.count, INT_MAX - 1);
    return OK;
}

static status reader_open(struct list_reader *r, const struct comm *c, const char *dir, const char *name,
                          const char *class_name) {
    size_t bytes;
    *r = (struct list_reader){.comm = c, .file = -1};
    snprintf(r->path, sizeof r->path, "%s/%s", dir, name);
    TRY(comm_agree(c, allocate_unset(&r->sent, ROOM, 1, "a part of a file")));
    TRY(comm_agree(c, comm_root(c) ? look(r, class_name) : OK));
    comm_broadcast(c, &r->list, sizeof r->list);
    if (!r->list.usual || !r->list.binary || r->list.zipped) return OK;
    return comm_agree(c, file_open_pieces(r->path, &r->file, &bytes));
}

static void reader_close(struct list_reader *r) {
    window_close(&r->window);
    if (r->file >= 0) close(r->file);
    free(r->sent);
}

/* ---- binary ------------------------------------------------------------------------------------------------------ */

static bool read_at(int file, long at, char *to, long n) {
    while (n > 0) {
        const ssize_t got = pread(file, to, (size_t)(n < 1 << 30 ? n : 1 << 30), (off_t)at);
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        to += got;
        at += got;
        n -= got;
    }
    return true;
}

/* Reads the bytes at .. at + n - 1 of the file, which each rank asks for, those of rank 0 first. Of a zipped file the
 * root reads them in pieces and sends them on. */
static bool read_bytes(struct list_reader *r, long at, long n, char *to) {
    const struct comm *c = r->comm;
    long ask[2] = {at, n};
    bool good = true;
    if (r->file >= 0) return read_at(r->file, at, to, n);
    if (!comm_root(c)) comm_to_root(c, comm_rank(c), ask, sizeof ask);
    for (long done = 0; !comm_root(c) && done < n; done += WINDOW)
        comm_from_root(c, comm_rank(c), to + done, n - done < WINDOW ? n - done : WINDOW);
    for (int rank = 0; comm_root(c) && rank < comm_size(c); rank++) {
        if (rank) comm_to_root(c, rank, ask, sizeof ask);
        if (!rank) good = window_read(&r->window, at, to, n);
        for (long done = 0; rank && done < ask[1]; done += WINDOW) {
            const long piece = ask[1] - done < WINDOW ? ask[1] - done : WINDOW;
            good = good && window_read(&r->window, ask[0] + done, r->sent, piece);
            comm_from_root(c, rank, r->sent, piece);
        }
    }
    return good;
}

/* Turns n labels or numbers of other lengths, in place, into ints or doubles. */
static bool widen(int bytes, bool labels, long n, char *data) {
    bool good = true;
    for (long i = 0; labels && bytes == 8 && i < n; i++) {
        int64_t wide;
        memcpy(&wide, data + 8 * i, 8);
        good &= wide >= INT_MIN && wide <= INT_MAX;
        const int label = (int)wide;
        memcpy(data + 4 * i, &label, 4);
    }
    for (long i = n - 1; !labels && bytes == 4 && i >= 0; i--) { /* backwards: doubles are longer */
        float f;
        memcpy(&f, data + 4 * i, 4);
        const double v = f;
        memcpy(data + 8 * i, &v, 8);
    }
    return good;
}

/* Reads n numbers from number `from` of the list on, which begins at byte `at`. */
static status read_numbers(struct list_reader *r, bool labels, long from, long n, struct bytes *out, bool *good) {
    const int bytes = labels ? r->list.label_bytes : r->list.scalar_bytes;
    const int room = labels && bytes < 8 ? (int)sizeof(int) : 8;
    TRY(comm_agree(r->comm, allocate(&out->data, n + 1, room, "a slice of a mesh")));
    *good = read_bytes(r, r->list.at + from * bytes, n * bytes, out->data) && widen(bytes, labels, n, out->data);
    out->n = (size_t)n * (labels ? sizeof(int) : sizeof(double));
    return OK;
}

/* Ends the binary list with ')' after entries of so many bytes? On the root; elsewhere true. */
static bool is_closed(struct list_reader *r, int bytes) {
    const struct list *l = &r->list;
    const long at = l->at + l->count * bytes;
    char end = 0;
    if (!comm_root(r->comm) || l->count == 0) return true;
    return (l->zipped ? window_read(&r->window, at, &end, 1) : read_at(r->file, at, &end, 1)) && end == ')';
}

/* ---- ascii ------------------------------------------------------------------------------------------------------- */

/* Reads one entry at p as writers put it, and returns what follows it, or NULL. */
static const char *read_label(const char *p, int *out) {
    double v;
    const char *end = foam_digits(p, out);
    if (end && (*end == ' ' || *end == ')' || *end == '\n')) return end;
    end = foam_number(p, &v);
    if (!end || v != floor(v) || fabs(v) > INT_MAX) return NULL;
    *out = (int)v;
    return end;
}

static const char *read_point(const char *p, double *x) {
    if (*p++ != '(') return NULL;
    for (int k = 0; k < 3 && p; k++) {
        if (k && *p++ != ' ') return NULL;
        p = foam_number(p, &x[k]);
    }
    return p && *p == ')' ? p + 1 : NULL;
}

/* out: the number of corners and these */
static const char *read_face(const char *p, int *out) {
    p = foam_digits(p, out);
    if (!p || *p++ != '(' || out[0] < 1 || out[0] > MOST_CORNERS) return NULL;
    for (int i = 0; i < out[0] && p; i++) {
        if (i && *p++ != ' ') return NULL;
        p = read_label(p, out + 1 + i);
    }
    return p && *p == ')' ? p + 1 : NULL;
}

/* Adds the next entry of the root's text. Entries stand in lines, so that one ends before the last line end of the
 * window. Returns whether there was one as writers put it. */
static bool next_entry(struct list_reader *r, enum entry kind, struct bytes *out, status *e) {
    union {
        double x[3];
        int label, face[1 + MOST_CORNERS];
    } v;
    for (int again = 0; again < 2; again++) {
        const char *p = r->window.text + r->next, *end;
        while (*p == ' ' || *p == '\n') p++;
        const size_t left = r->window.size - (size_t)(p - r->window.text);
        const bool whole = r->window.ended || memchr(p, '\n', left) != NULL;
        if (!whole && !again && refill(r)) continue;
        if (!whole) return false;
        end = kind == POINT ? read_point(p, v.x) : kind == LABEL ? read_label(p, &v.label) : read_face(p, v.face);
        if (!end) return false;
        *e = add(out, &v,
                 kind == POINT   ? sizeof v.x
                 : kind == LABEL ? sizeof(int)
                                 : (1 + (size_t)v.face[0]) * sizeof(int));
        r->next = (size_t)(end - r->window.text);
        return !*e;
    }
    return false;
}

/* Sends what is there to a rank. */
static void send_piece(const struct list_reader *r, int rank, struct bytes *piece) {
    long n = (long)piece->n;
    if (n == 0) return;
    comm_from_root(r->comm, rank, &n, sizeof n);
    comm_from_root(r->comm, rank, piece->data, n);
    piece->n = 0;
}

/* Reads the n entries of one rank, none if n is UNUSUAL, and sends them there unless it is the root itself. */
static bool feed(struct list_reader *r, enum entry kind, int rank, long n, struct bytes *mine, struct bytes *piece,
                 status *e) {
    struct bytes *to = rank ? piece : mine;
    bool good = n >= 0;
    for (long i = 0; i < n && good; i++) {
        good = next_entry(r, kind, to, e);
        if (rank && piece->n > WINDOW) send_piece(r, rank, piece);
    }
    if (rank && good) send_piece(r, rank, piece);
    long mark = good ? DONE : UNUSUAL;
    if (rank) comm_from_root(r->comm, rank, &mark, sizeof mark);
    return good;
}

/* Does the list of the root's text end here? */
static bool ends(struct list_reader *r) {
    if (!refill(r)) return false;
    const char *text = r->window.text;
    while (text[r->next] == ' ' || text[r->next] == '\n') r->next++;
    return text[r->next] == ')';
}

/* Receives the entries of this rank. */
static bool receive(struct list_reader *r, struct bytes *out, status *e) {
    const int me = comm_rank(r->comm);
    for (long n;;) {
        comm_from_root(r->comm, me, &n, sizeof n);
        if (n <= 0) return n == DONE;
        comm_from_root(r->comm, me, r->sent, n);
        if (!*e) *e = add(out, r->sent, (size_t)n);
    }
}

/* The slice of a rank of a list that may be shorter than what is shared. */
static struct share slice_of(const struct list_reader *r, const struct share *share, int rank) {
    struct share s = share_at_rank(share, rank);
    if (s.first > r->list.count) s.first = r->list.count;
    if (s.end > r->list.count) s.end = r->list.count;
    return s;
}

static status read_text(struct list_reader *r, enum entry kind, const struct share *share, struct bytes *out,
                        bool *good) {
    struct bytes piece = {0};
    status e = OK;
    *good = true;
    if (!comm_root(r->comm)) *good = receive(r, out, &e);
    for (int rank = 0; comm_root(r->comm) && rank < comm_size(r->comm); rank++) {
        const struct share theirs = slice_of(r, share, rank);
        const long n = theirs.end - theirs.first;
        *good = feed(r, kind, rank, *good ? n : UNUSUAL, out, &piece, &e);
    }
    if (comm_root(r->comm)) *good = *good && ends(r);
    free(piece.data);
    return comm_agree(r->comm, e);
}

/* ---- lists ------------------------------------------------------------------------------------------------------- */

/* Reads the slice of a list: of points, which it shares out, or of labels, as far as there are any; *n is the number of
 * entries of all. */
static status read_list(const struct comm *c, const char *dir, const char *name, enum entry kind, struct share *share,
                        long *n, void *out, bool *good) {
    struct list_reader r;
    struct bytes b = {0};
    status e = reader_open(&r, c, dir, name, kind == POINT ? "vectorField" : "labelList");
    if (kind == POINT) *share = share_make(c, r.list.count);
    *n = r.list.count;
    *good = !e && r.list.usual && *n <= share->n;
    const struct share here = slice_of(&r, share, comm_rank(c));
    const long each = kind == POINT ? 3 : 1;
    if (*good && r.list.binary) {
        e = read_numbers(&r, kind == LABEL, here.first * each, (here.end - here.first) * each, &b, good);
        *good = *good && is_closed(&r, kind == LABEL ? r.list.label_bytes : 3 * r.list.scalar_bytes);
    } else if (*good) {
        e = read_text(&r, kind, share, &b, good);
    }
    reader_close(&r);
    memcpy(out, &b.data, sizeof b.data);
    lists_agree(c, good);
    return e;
}

/* Makes offsets of n faces of what stands one after the other, as [count, corners ..], in corner[]. */
static status split_faces(long n, struct bytes *b, int **start) {
    int *all = (int *)(void *)b->data;
    TRY(allocate(start, n + 1, sizeof **start, "the faces"));
    for (long i = 0, from = 0, to = 0; i < n; i++) {
        const int count = all[from];
        memmove(all + to, all + from + 1, (size_t)count * sizeof *all);
        from += 1 + count;
        to += count;
        (*start)[i + 1] = (int)to;
    }
    return OK;
}

/* Reads a faceCompactList: the offsets of the slice, one more than it has faces, then the corners between them. */
static status read_compact(struct list_reader *r, struct lists *s, struct bytes *corner, bool *good) {
    struct bytes offset = {0};
    const long n = s->faces.end - s->faces.first;
    status e = read_numbers(r, true, s->faces.first, n + 1, &offset, good);
    s->start = (int *)(void *)offset.data;
    if (e) return e;
    for (long i = 0; i < n; i++) *good = *good && s->start[i] >= 0 && s->start[i + 1] >= s->start[i];
    if (s->faces.first == 0) *good = *good && s->start[0] == 0;
    struct list *l = &r->list;
    const long second = l->at + l->count * l->label_bytes; /* there the first list ends */
    char text[64] = "";
    if (comm_root(r->comm)) {
        const bool read = l->zipped ? window_read(&r->window, second, text, 32) : read_at(r->file, second, text, 32);
        struct source head = {.path = r->path, .text = text + 1, .size = strlen(text + (text[0] != 0)), .file = -1};
        struct lexer x = lexer_start(&head);
        long at = 0;
        l->usual = read && text[0] == ')' && find_count(&x, &l->count, &at) && l->count < INT_MAX;
        l->at = second + 1 + at;
    }
    comm_broadcast(r->comm, l, sizeof *l);
    *good = *good && l->usual && s->start[n] <= l->count && (s->faces.end < s->faces.n || s->start[n] == l->count);
    lists_agree(r->comm, good);
    if (!*good) return OK;
    s->first_corner = s->start[0];
    for (long i = n; i >= 0; i--) s->start[i] -= s->start[0];
    e = read_numbers(r, true, s->first_corner, s->start[n], corner, good);
    *good = *good && is_closed(r, l->label_bytes);
    return e;
}

/* Tells each rank how many corners the ranks before it have. */
static status count_corners(struct lists *s, bool *good) {
    const struct comm *c = s->faces.comm;
    int *count = NULL;
    const int size = comm_size(c);
    TRY(comm_agree(c, allocate(&count, 2L * size + 1, sizeof *count, "the corners of the faces")));
    long sum = s->start[s->faces.end - s->faces.first];
    const int mine = (int)sum;
    comm_sum_long(c, &sum, 1);
    *good = sum < INT_MAX;
    status e = *good ? comm_share_count(c, mine, count, count + size) : OK;
    if (*good && !e) s->first_corner = count[size + comm_rank(c)];
    free(count);
    return e;
}

static status read_faces(const struct comm *c, const char *dir, struct lists *s, bool *good) {
    struct list_reader r;
    struct bytes b = {0};
    status e = reader_open(&r, c, dir, "faces", "faceList");
    const bool compact = r.list.compact;
    *good = !e && r.list.usual;
    s->faces = share_make(c, r.list.count - compact);
    if (*good && compact)
        e = read_compact(&r, s, &b, good);
    else if (*good)
        e = read_text(&r, FACE, &s->faces, &b, good);
    reader_close(&r);
    s->corner = (int *)(void *)b.data;
    lists_agree(c, good);
    if (e || !*good || compact) return e;
    e = comm_agree(c, split_faces(s->faces.end - s->faces.first, &b, &s->start));
    return e ? e : count_corners(s, good);
}

/* ---- all --------------------------------------------------------------------------------------------------------- */

static bool sound_points(const struct lists *s) {
    const long n = 3 * (s->points.end - s->points.first);
    bool good = s->points.n <= INT_MAX / 3;
    for (long i = 0; i < n; i++) good &= fabs(s->point[i]) <= FARTHEST; /* false for what is no number, too */
    return good;
}

static bool sound_faces(const struct lists *s) {
    const long n = s->faces.end - s->faces.first;
    bool good = true;
    for (long f = 0; f < n; f++) {
        const int *p = s->corner + s->start[f], count = s->start[f + 1] - s->start[f];
        good &= count >= 3;
        for (int i = 0; i < count; i++) good &= p[i] >= 0 && p[i] < s->points.n && p[i] != p[i + 1 < count ? i + 1 : 0];
    }
    return good;
}

static bool after(const int *pair, const int *before) {
    return pair[0] > before[0] || (pair[0] == before[0] && pair[1] > before[1]);
}

/* Inner faces are sorted by owner, then neighbour; also from slice to slice. */
static status sound_cells(struct lists *s, bool *good) {
    const struct comm *c = s->faces.comm;
    const long n = s->faces.end - s->faces.first, left = s->ninternal - s->faces.first,
               inner = left < 0   ? 0
                       : left < n ? left
                                  : n;
    int ends[4] = {-1, -1, -1, -1}, *count = NULL, *all;
    double most = -1;
    const int size = comm_size(c);
    for (long f = 0; f < n; f++) {
        *good &= s->owner[f] >= 0 && s->owner[f] < s->faces.n;
        if (f < inner) *good &= s->neighbour[f] > s->owner[f] && s->neighbour[f] < s->faces.n;
        most = fmax(most, fmax(s->owner[f], f < inner ? s->neighbour[f] : -1));
        const int here[2] = {s->owner[f], f < inner ? s->neighbour[f] : -1};
        if (f < inner && ends[0] >= 0) *good &= after(here, ends + 2);
        if (f < inner) memcpy(ends + (f ? 2 : 0), here, sizeof here);
        if (f < inner && f == 0) memcpy(ends + 2, here, sizeof here);
    }
    comm_max(c, &most, 1);
    s->ncells = (long)most + 1;
    TRY(comm_agree(c, allocate(&count, 2L * size + 1 + 4L * size, sizeof *count, "the faces")));
    all = count + 2L * size + 1;
    status e = comm_share_count(c, 4, count, count + size);
    if (!e) comm_share_int(c, ends, count, count + size, all);
    const int *last = NULL;
    for (int r = 0; !e && r < size; r++) {
        if (all[4 * r] < 0) continue;
        if (last) *good &= after(all + 4L * r, last);
        last = all + 4L * r + 2;
    }
    free(count);
    return e;
}

static status fill_neighbour(struct lists *s) {
    const long n = s->faces.end - s->faces.first, left = s->ninternal - s->faces.first;
    int *wider;
    TRY(allocate(&wider, n, sizeof *wider, "the faces"));
    for (long f = 0; f < n; f++) wider[f] = f < left ? s->neighbour[f] : -1;
    free(s->neighbour);
    s->neighbour = wider;
    return OK;
}

static status read_all(const char *dir, const struct comm *c, struct lists *s, bool *good) {
    long n;
    TRY(read_list(c, dir, "points", POINT, &s->points, &n, &s->point, good));
    if (*good) TRY(read_faces(c, dir, s, good));
    if (*good) TRY(read_list(c, dir, "owner", LABEL, &s->faces, &n, &s->owner, good));
    *good = *good && n == s->faces.n;
    if (*good) TRY(read_list(c, dir, "neighbour", LABEL, &s->faces, &s->ninternal, &s->neighbour, good));
    if (!*good) return OK;
    TRY(comm_agree(c, fill_neighbour(s)));
    *good = sound_points(s) && sound_faces(s);
    return sound_cells(s, good);
}

status lists_read(const char *dir, const struct comm *c, struct lists *s, bool *sound) {
    *s = (struct lists){.ncells = 0};
    *sound = false;
    TRY(read_all(dir, c, s, sound));
    lists_agree(c, sound);
    return OK;
}

void lists_free(struct lists *s) {
    void *const all[] = {s->point, s->start, s->corner, s->owner, s->neighbour};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) free(all[i]);
    *s = (struct lists){.ncells = 0};
}
