/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens a file whose long list is to be spread over the ranks in slices (foamfile.h). Of a plain binary file each rank
 * reads its slice by itself. Any other file the root reads in pieces, which it sends on: no rank holds its text. What
 * is not as writers put it is left to source_open on every rank, which knows comments and says what is wrong. */
#include "mesh/base/window.h"
#include "mesh/format/files.h"
#include "mesh/format/foamfile_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PIECE = 1 << 14 }; /* entries that the root holds at a time */

struct stream { /* the root's */
    const struct share *share;
    struct source *source; /* what is being made */
    struct long_list list;
    struct window window;
    struct source text; /* that of the window, which is being read */
    struct lexer lexer; /* in that */
    double *piece;      /* [PIECE][components] */
    long at;            /* entries so far */
};

/* ---- from the root to the slices --------------------------------------------------------------------------------- */

/* Hands n entries to the ranks whose slices they belong to. */
static void deliver(struct stream *x, long n) {
    const struct comm *c = x->share->comm;
    const int m = x->list.components;
    for (int r = 0; r < comm_size(c); r++) {
        const struct share theirs = share_at_rank(x->share, r);
        const long from = theirs.first > x->at ? theirs.first : x->at,
                   to = theirs.end < x->at + n ? theirs.end : x->at + n;
        if (from >= to) continue;
        double *values = x->piece + (from - x->at) * m;
        long count = to - from;
        if (r == 0) {
            memcpy(x->source->part + (from - theirs.first) * m, values, (size_t)(count * m) * sizeof *values);
            continue;
        }
        comm_from_root(c, r, &count, sizeof count);
        comm_from_root(c, r, values, count * m * (long)sizeof *values);
    }
    x->at += n;
}

/* Tells the ranks whose slices are not full that nothing more comes. */
static void give_up(const struct stream *x) {
    long none = -1;
    for (int r = 1; r < comm_size(x->share->comm); r++) {
        const struct share theirs = share_at_rank(x->share, r);
        if (theirs.end > theirs.first && theirs.end > x->at) comm_from_root(x->share->comm, r, &none, sizeof none);
    }
}

/* Receives the slice of this rank. */
static void receive(const struct share *share, int components, double *part) {
    for (long got = 0, n; got < share->end - share->first; got += n) {
        comm_from_root(share->comm, comm_rank(share->comm), &n, sizeof n);
        if (n < 0) return;
        comm_from_root(share->comm, comm_rank(share->comm), part + got * components,
                       n * components * (long)sizeof *part);
    }
}

/* ---- the root reads ---------------------------------------------------------------------------------------------- */

/* Fills the window behind what is left in it. Returns whether the file can be read. */
static bool refill(struct stream *x) {
    const bool good = window_fill(&x->window, x->lexer.position);
    x->lexer.position = 0;
    x->text = (struct source){.text = x->window.text, .size = x->window.size, .file = -1};
    return good;
}

/* Reads the ascii entries that stand in the window before its last line end. */
static void read_lines(struct stream *x) {
    struct window *w = &x->window;
    size_t end = w->size;
    while (end > x->lexer.position && w->text[end - 1] != '\n') end--;
    const char cut = w->text[end];
    w->text[end] = 0;
    for (long n = 1; n > 0 && x->at < x->share->n;) {
        const long left = x->share->n - x->at;
        n = plain_entries(&x->lexer, left < PIECE ? left : PIECE, x->list.components, x->piece);
        deliver(x, n);
    }
    w->text[end] = cut;
}

/* Reads the entries of an ascii list. Returns whether all were as writers put them. */
static bool read_ascii(struct stream *x) {
    while (x->at < x->share->n) {
        const long before = x->at;
        if (!refill(x)) return false;
        read_lines(x);
        if (x->at == before) return false;
    }
    return refill(x);
}

static bool read_binary(struct stream *x) {
    const int m = x->list.components;
    const size_t number = (size_t)x->list.header.scalar_bytes, entry = number * (size_t)m;
    while (x->at < x->share->n) {
        if (x->window.size - x->lexer.position < entry && !refill(x)) return false;
        const size_t here = (x->window.size - x->lexer.position) / entry;
        long n = x->share->n - x->at < PIECE ? x->share->n - x->at : PIECE;
        n = (size_t)n < here ? n : (long)here;
        if (n == 0) return false;
        for (long i = 0; i < n * m; i++, x->lexer.position += number) {
            float f;
            const char *raw = x->window.text + x->lexer.position;
            memcpy(number == 4 ? (void *)&f : (void *)&x->piece[i], raw, number);
            if (number == 4) x->piece[i] = f;
            if (!isfinite(x->piece[i])) return false;
        }
        deliver(x, n);
    }
    return true;
}

/* Appends what is left in the window, and in the file, to the text of the source. */
static bool read_tail(struct stream *x) {
    struct source *s = x->source;
    size_t room = x->list.at;
    for (bool more = true; more; more = !x->window.ended) {
        const size_t n = x->window.size - x->lexer.position;
        if (s->size + n + 1 > room) {
            room = 2 * (s->size + n) + 1;
            char *text = room < file_most() ? realloc(s->text, room) : NULL;
            if (!text) return false;
            s->text = text;
        }
        memcpy(s->text + s->size, x->window.text + x->lexer.position, n);
        s->size += n;
        s->text[s->size] = 0;
        x->lexer.position += n;
        if (!refill(x)) return false;
        if (x->window.ended && x->window.size > 0)
            x->window.ended = false; /* one more round for the last of the window */
    }
    return true;
}

/* Reads the list and what follows it. Returns whether all is as it should be. */
static bool read_list(struct stream *x) {
    struct source *s = x->source;
    memcpy(s->text, x->window.text, x->list.at);
    s->size = s->gap = x->list.at;
    x->lexer = (struct lexer){.source = &x->text, .position = x->list.at, .line = x->list.line};
    const bool binary = x->list.header.binary;
    if (!(binary ? read_binary(x) : read_ascii(x))) return false;
    if (binary && !refill(x)) return false;
    const char *p = x->window.text;
    for (; !binary && (*p == ' ' || *p == '\n'); p++) x->lexer.line += *p == '\n';
    x->lexer.position = (size_t)(p - x->window.text);
    s->gap_lines = binary ? 0 : x->lexer.line - x->list.line;
    return *p == ')' && read_tail(x);
}

/* Finds out whether the root is to read the file: one with a list that has an entry for each cell, which the ranks
 * cannot read by themselves. */
static status look(struct stream *x, bool *streams) {
    size_t bytes;
    int file;
    *streams = false;
    TRY(file_open_pieces(x->source->path, &file, &bytes));
    TRY(window_open(file, &x->window));
    if (!refill(x)) return OK;
    struct source head = x->text;
    const bool zipped = window_zipped(&x->window);
    if (head.size > HEAD) head.size = HEAD;
    const char cut = head.text[head.size];
    head.text[head.size] = 0;
    const bool found = find_list(&head, &x->list) && x->list.count == x->share->n;
    head.text[head.size] = cut;
    *streams = found && (zipped || !x->list.header.binary);
    return OK;
}

/* ---- all ranks --------------------------------------------------------------------------------------------------- */

struct told { /* what the root tells the others */
    bool streams, whole, foreign;
    int components, gap_lines;
    size_t gap, size;
};

/* Gives all ranks the text around the list, or nothing if the list was not whole. */
static status share_text(const struct share *share, struct source *s, struct told *told) {
    const bool root = comm_root(share->comm);
    if (root) *told = (struct told){true, told->whole, s->foreign, s->components, s->gap_lines, s->gap, s->size};
    comm_broadcast(share->comm, told, sizeof *told);
    status e = OK;
    if (told->whole && !root) e = allocate(&s->text, (long)told->size + 1, 1, "the text of a file");
    TRY(comm_agree(share->comm, e));
    if (!told->whole) return OK;
    comm_broadcast(share->comm, s->text, (long)told->size);
    s->gap = told->gap;
    s->size = told->size;
    s->gap_lines = told->gap_lines;
    s->foreign = told->foreign;
    return OK;
}

/* Reads the file of s; told->whole says whether it could be read so. */
static status read_shared(struct stream *x, struct source *s, struct told *told) {
    const struct share *share = x->share;
    const long n = share->end - share->first;
    s->components = told->components;
    s->part_first = share->first;
    s->part_end = share->end;
    status e = allocate(&s->part, n * s->components, sizeof *s->part, "a slice of a field");
    if (!e && comm_root(share->comm)) e = allocate(&x->piece, (long)PIECE * s->components, sizeof(double), "a field");
    if (!e && comm_root(share->comm)) e = allocate(&s->text, (long)x->list.at + 1, 1, "the text of a file");
    TRY(comm_agree(share->comm, e));
    if (comm_root(share->comm)) {
        told->whole = read_list(x);
        if (x->at < share->n) give_up(x);
        told->whole &= window_ends(&x->window);
    } else {
        receive(share, s->components, s->part);
    }
    return share_text(share, s, told);
}

static status open_shared(struct stream *x, struct source *s, bool *done) {
    const struct share *share = x->share;
    struct told told = {0};
    bool streams = false;
    status e = comm_root(share->comm) ? look(x, &streams) : OK;
    TRY(comm_agree(share->comm, e));
    told.streams = streams;
    told.components = x->list.components;
    comm_broadcast(share->comm, &told, sizeof told);
    if (told.streams) TRY(read_shared(x, s, &told));
    *done = told.streams && told.whole;
    return OK;
}

status source_open_shared(const char *path, const struct share *share, struct source **out) {
    struct source *s = NULL;
    *out = NULL;
    TRY(comm_agree(share->comm, file_single(path)));
    TRY(comm_agree(share->comm, source_name(path, &s)));
    struct stream x = {.share = share, .source = s};
    bool done = false;
    const status e = open_shared(&x, s, &done);
    window_close(&x.window);
    free(x.piece);
    if (done && !e) {
        *out = s;
        return OK;
    }
    source_free(s);
    return e ? e : source_open(path, out);
}
