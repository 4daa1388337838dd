/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shows and makes the changes that cure a case (fix.h). */
#include "solvers/programs/fix.h"

#include "mesh/format/files.h"
#include "mesh/format/foamfile.h"
#include "solvers/case/lock.h"
#include "solvers/dict/dict.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { WORD = 128, LINE = 2048, CERTAIN = 2 /* letters by which a word may differ from the one that is meant */ };

struct file_text { /* of a file */
    char *text;
    size_t size;
};

static status text_read(const char *path, struct file_text *out) {
    int file;
    size_t got = 0;
    *out = (struct file_text){0};
    TRY(file_open_read(path, &file, &out->size));
    status e = allocate(&out->text, (long)out->size + 1, 1, path);
    while (!e && got < out->size) {
        const ssize_t n = read(file, out->text + got, out->size - got);
        if (n <= 0) e = file_error(path, "cannot be read", n ? errno : EIO);
        if (n > 0) got += (size_t)n;
    }
    close(file);
    return e;
}

/* Finds the line of a number from 1 on; its length is without the line's end. NULL: there is none. */
static char *find_line(const struct file_text *t, int number, size_t *length) {
    char *at = t->text, *end = t->text + t->size;
    for (int k = 1; at && k < number; k++) {
        at = memchr(at, '\n', (size_t)(end - at));
        at = at ? at + 1 : NULL;
    }
    if (!at) return NULL;
    const char *stop = memchr(at, '\n', (size_t)(end - at));
    *length = (size_t)((stop ? stop : end) - at);
    return at;
}

static bool in_word(char c) {
    return isalnum((unsigned char)c) || c == '_';
}

/* Finds a whole word in a line, before a comment. */
static char *find_word(char *line, const char *word) {
    const size_t n = strlen(word);
    const char *comment = strstr(line, "//");
    for (char *at = line; n && (at = strstr(at, word)); at++)
        if ((at == line || !in_word(at[-1])) && !in_word(at[n]) && (!comment || at < comment)) return at;
    return NULL;
}

/* Writes the line as the cure makes it to `out`. Returns false if the line is not as the cure expects it. */
static bool change(const struct cure *c, char *line, char out[LINE]) {
    char *word = find_word(line, c->from), *from = word, *to = word ? word + strlen(c->from) : NULL;
    if (!word) return false;
    if (c->kind != CURE_WORD) { /* the key, its value and ';' */
        char *end = strchr(to, ';');
        if (!end || memchr(to, '{', (size_t)(end - to))) return false;
        if (c->kind == CURE_VALUE) from = to + strspn(to, " \t");
        to = c->kind == CURE_VALUE ? end : end + 1;
    }
    const int n = snprintf(out, LINE, "%.*s%s%s", (int)(from - line), line, c->kind == CURE_ENTRY ? "" : c->to, to);
    return n < LINE && strcmp(out, line) != 0;
}

static status write_line(const char *path, const struct file_text *t, const char *at, size_t length, const char *line) {
    struct sink *s;
    TRY(sink_open(path, false, &s));
    sink_unsummed(s);
    sink_write(s, t->text, (size_t)(at - t->text));
    sink_write(s, line, strlen(line));
    sink_write(s, at + length, t->size - (size_t)(at + length - t->text));
    return sink_close(s);
}

/* Cures a line of a file, unless that is a link, lies elsewhere or is zipped. */
static status fix_line(const struct cure *c, bool write, int *n) {
    struct file_text t = {0};
    char line[LINE], changed[LINE];
    size_t length = 0;
    const size_t name = strlen(c->path);
    if (path_is_link(c->path) || file_is_foreign(c->path, path_case(c->path)) || access(c->path, R_OK)) return OK;
    if (name > 3 && !strcmp(c->path + name - 3, ".gz")) return OK;
    status e = text_read(c->path, &t);
    char *at = e ? NULL : find_line(&t, c->line, &length);
    if (at && length < LINE && !memchr(at, 0, length)) {
        snprintf(line, sizeof line, "%.*s", (int)length, at);
        if (change(c, line, changed)) {
            ++*n;
            printf("  %s:%d:\n    - %s\n    + %s\n", c->path, c->line, line, changed);
            if (write) e = write_line(c->path, &t, at, length, changed);
        }
    }
    free(t.text);
    return e;
}

static status fix_name(const struct cure *c, bool write, int *n) {
    if (!access(c->to, F_OK) || access(c->path, F_OK)) return OK;
    ++*n;
    printf("  %s\n    - %s\n    + %s\n", "a file gets another name:", c->path, c->to);
    const int why = write ? file_rename(c->path, c->to) : 0;
    return why ? file_error(c->path, "cannot be renamed", why) : OK;
}

status fix_files(const char *dir, const struct cures *cures, bool write, int *n) {
    struct lock *lock = NULL;
    *n = 0;
    if (cures->n && write) TRY(lock_take(dir, "checkCase -fix", &lock));
    status e = OK;
    for (int i = 0; i < cures->n && !e; i++)
        e = (cures->cure[i].kind == CURE_FILE ? fix_name : fix_line)(&cures->cure[i], write, n);
    lock_release(lock);
    return e;
}

/* Takes FILE and LINE from the start of an error. */
static bool read_place(const char *text, struct cure *out) {
    for (const char *at = text; (at = strchr(at, ':')); at++) {
        char *end;
        const long line = strtol(at + 1, &end, 10);
        if (end == at + 1 || strncmp(end, ": ", 2) != 0 || line < 1) continue;
        const char *start = at;
        while (start > text && start[-1] != '\n') start--;
        start += strspn(start, " ");
        snprintf(out->path, sizeof out->path, "%.*s", (int)(at - start), start);
        out->line = (int)line;
        if (!access(out->path, R_OK)) return true;
    }
    return false;
}

/* Finds the one word of a line that the error names and for which c->to may stand. */
static bool find_wrong(const char *line, const char *error, struct cure *c) {
    int found = 0;
    for (const char *at = line; *at; at++) {
        char word[WORD];
        if (!in_word(*at) || (at > line && in_word(at[-1]))) continue;
        size_t n = 0;
        while (in_word(at[n])) n++;
        if (n >= sizeof word) continue;
        snprintf(word, sizeof word, "%.*s", (int)n, at);
        if (!strcmp(word, c->to) || !strstr(error, word) || name_distance(word, c->to) > CERTAIN) continue;
        found++;
        snprintf(c->from, sizeof c->from, "%s", word);
        at += n - 1;
    }
    return found == 1;
}

void fix_from_error(status error, struct cures *cures) {
    static const char asks[] = "did you mean '";
    const char *text = status_text(error), *meant = NULL;
    struct cure c = {.kind = CURE_WORD};
    struct file_text file = {0};
    size_t length = 0;
    char line[LINE];
    for (const char *at = text; (at = strstr(at, asks)); at = meant)
        meant = at + sizeof asks - 1; /* the last: hints stand before */
    if (!meant || cures->n == MOST_CURES || !read_place(text, &c)) return;
    snprintf(c.to, sizeof c.to, "%.*s", (int)strcspn(meant, "'"), meant);
    if (strncmp(meant + strlen(c.to), "'?", 2) != 0) return; /* or another one */
    status e = text_read(c.path, &file);
    const char *at = e ? NULL : find_line(&file, c.line, &length);
    if (at && length < LINE) {
        snprintf(line, sizeof line, "%.*s", (int)length, at);
        if (find_wrong(line, text, &c)) cures->cure[cures->n++] = c;
    }
    status_free(e);
    free(file.text);
}
