/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the files of #include: their names stay within the case; links there may lead out of it. */
#include "solvers/dict/dict_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Takes OpenFOAM's words for a folder of the case from the front of a path; *folder is that folder, NULL: that of the
 * including file. */
static void take_folder(struct token *t, const char **folder) {
    static const char *const words[][2] = {{"$FOAM_CASE/", ""},
                                           {"${FOAM_CASE}/", ""},
                                           {"<case>/", ""},
                                           {"<constant>/", "constant/"},
                                           {"<system>/", "system/"}};
    *folder = NULL;
    for (size_t i = 0; i < sizeof words / sizeof *words && !*folder; i++) {
        const int n = (int)strlen(words[i][0]);
        if (t->length < n || memcmp(t->text, words[i][0], (size_t)n) != 0) continue;
        *folder = words[i][1];
        t->text += n;
        t->length -= n;
    }
}

/* Joins the path of the including file, or of the case, and that of #include, without `.` and `..`; refuses a path that
 * is absolute or leaves the case. */
static status join(const struct lexer *l, const struct token *given, int root_length, char out[INCLUDE_PATH]) {
    const char *path = l->source->path, *slash = strrchr(path, '/'), *folder;
    char joined[INCLUDE_PATH];
    struct token cut = *given, *t = &cut;
    take_folder(t, &folder);
    if (t->length == 0 || *t->text == '/') return lexer_fail(l, given, "#include takes a path relative to this file");
    if (memchr(t->text, '$', (size_t)t->length) || memchr(t->text, '<', (size_t)t->length) || *t->text == '~')
        return lexer_fail(l, given, "#include takes a path in the case; of variables $FOAM_CASE alone is read");
    int base = slash ? (int)(slash - path) + 1 : 0;
    int n = folder ? snprintf(joined, sizeof joined, "%s%.*s", folder, t->length, t->text)
                   : snprintf(joined, sizeof joined, "%.*s%.*s", base - root_length, path + root_length, t->length,
                              t->text);
    int used = snprintf(out, INCLUDE_PATH, "%.*s", root_length, path);
    if (n >= INCLUDE_PATH || used + n >= INCLUDE_PATH) return lexer_fail(l, t, "the path is too long");
    int root = used;
    for (char *part = joined, *next; part; part = next) {
        next = strchr(part, '/');
        if (next) *next++ = 0;
        if (!*part || !strcmp(part, ".")) continue;
        if (!strcmp(part, "..")) {
            if (used == root)
                return lexer_fail(l, t, "the path leads out of the case; put a link to that file into the case");
            for (used--; used > root && out[used - 1] != '/'; used--) continue;
            out[used] = 0;
        } else {
            used += snprintf(out + used, (size_t)(INCLUDE_PATH - used), "%s%s", part, next ? "/" : "");
        }
    }
    return OK;
}

status include_find(const struct lexer *l, const struct token *t, int root_length, char out[INCLUDE_PATH],
                    bool *present) {
    struct stat info;
    TRY(join(l, t, root_length, out));
    size_t n = strlen(out);
    *present = !stat(out, &info);
    if (!*present && n + 4 < INCLUDE_PATH) {
        strcpy(out + n, ".gz");
        *present = !stat(out, &info);
    }
    if (!*present) out[n] = 0;
    return OK;
}
