/* Finds the files of #include: they lie within the case, or beside the file that includes them, and nowhere else. */
#define _XOPEN_SOURCE 700 /* realpath */
#include "solvers/dict/dict_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

int include_root(const char *path) {
    const char *end = strrchr(path, '/');
    int length = end ? (int)(end - path) + 1 : 0;
    for (const char *p = path, *next; (next = strchr(p, '/')); p = next + 1) {
        double time;
        char part[64];
        snprintf(part, sizeof part, "%.*s", (int)(next - p), p);
        const char *rest = foam_number(part, &time);
        if (!strcmp(part, "system") || !strcmp(part, "constant") || (rest && !*rest)) length = (int)(p - path);
    }
    return length;
}

/* Joins the path of the including file and that of #include, without `.` and `..`; refuses a path that is absolute or
 * leaves the case. */
static status join(const struct lexer *l, const struct token *t, int root_length, char out[INCLUDE_PATH]) {
    const char *path = l->source->path, *slash = strrchr(path, '/');
    char joined[INCLUDE_PATH];
    if (t->length == 0 || *t->text == '/') return lexer_fail(l, t, "#include takes a path relative to this file");
    if (memchr(t->text, '$', (size_t)t->length) || memchr(t->text, '<', (size_t)t->length) || *t->text == '~')
        return lexer_fail(l, t, "#include takes a plain path; variables are not read");
    int base = slash ? (int)(slash - path) + 1 : 0;
    int n = snprintf(joined, sizeof joined, "%.*s%.*s", base - root_length, path + root_length, t->length, t->text);
    int used = snprintf(out, INCLUDE_PATH, "%.*s", root_length, path);
    if (n >= INCLUDE_PATH || used + n >= INCLUDE_PATH) return lexer_fail(l, t, "the path is too long");
    int root = used;
    for (char *part = joined, *next; part; part = next) {
        next = strchr(part, '/');
        if (next) *next++ = 0;
        if (!*part || !strcmp(part, ".")) continue;
        if (!strcmp(part, "..")) {
            if (used == root) return lexer_fail(l, t, "the path leads out of the case");
            for (used--; used > root && out[used - 1] != '/'; used--) continue;
            out[used] = 0;
        } else {
            used += snprintf(out + used, (size_t)(INCLUDE_PATH - used), "%s%s", part, next ? "/" : "");
        }
    }
    return OK;
}

/* Is the file, links followed, in the folder or below? The first `length` characters of `folder` name it. */
static bool is_inside(const char *real, const char *folder, int length) {
    char name[INCLUDE_PATH];
    snprintf(name, sizeof name, "%.*s", length, folder);
    char *top = realpath(length ? name : ".", NULL);
    size_t n = top ? strlen(top) : 0;
    bool inside = top && !strncmp(real, top, n) && (real[n] == '/' || !strcmp(top, "/"));
    free(top);
    return inside;
}

status include_find(const struct lexer *l, const struct token *t, int root_length, char out[INCLUDE_PATH],
                    bool *present) {
    struct stat info;
    const char *from = l->source->path, *slash = strrchr(from, '/');
    TRY(join(l, t, root_length, out));
    size_t n = strlen(out);
    *present = !stat(out, &info);
    if (!*present && n + 4 < INCLUDE_PATH) {
        strcpy(out + n, ".gz");
        *present = !stat(out, &info);
    }
    if (!*present) {
        out[n] = 0;
        return OK;
    }
    char *real = realpath(out, NULL);
    bool inside =
        real && (is_inside(real, from, root_length) || is_inside(real, from, slash ? (int)(slash - from) : 0));
    free(real);
    return inside ? OK : lexer_fail(l, t, "a link leads out of the case; copy that file into it");
}
