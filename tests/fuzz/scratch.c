/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/fuzz/target.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { PATH = 512, FILES = 8 };

static struct {
    char folder[64];
    char written[FILES][PATH];
    int count;
} place;

void promise_broken(const char *text) {
    fprintf(stderr, "broken promise: %s\n", text);
    abort();
}

static void remove_scratch(void) {
    char line[PATH];
    snprintf(line, sizeof line, "rm -rf '%s'", place.folder);
    if (system(line)) fprintf(stderr, "%s failed\n", line);
}

const char *scratch(void) {
    if (*place.folder) return place.folder;
    struct stat info;
    bool memory = !stat("/dev/shm", &info) && !access("/dev/shm", W_OK);
    int made = -1; /* libFuzzer tries the names it sees compared: most often the same */
    for (int i = 0; made && i < 10000; i++) {
        snprintf(place.folder, sizeof place.folder, "%s/haff-fuzz-%d", memory ? "/dev/shm" : "/tmp", i);
        made = mkdir(place.folder, 0700);
    }
    PROMISE(!made, "there is room for scratch files");
    atexit(remove_scratch);
    return place.folder;
}

void scratch_write(const char *name, const void *data, size_t size) {
    char path[PATH];
    snprintf(path, sizeof path, "%s/%s", scratch(), name);
    FILE *f = fopen(path, "wb");
    for (char *p = path + strlen(scratch()) + 1; !f && (p = strchr(p, '/')); *p++ = '/') {
        *p = 0;
        mkdir(path, 0777);
    }
    if (!f) f = fopen(path, "wb");
    PROMISE(f && fwrite(data, 1, size, f) == size && !fclose(f), "scratch files can be written");
}

/* FILE or FOLDER/FILE of a case. Other folders are not made: an input must leave nothing behind for the next one. */
static bool good_name(const char *name) {
    static const char *const folders[] = {"system/", "constant/", "0/"};
    for (int i = 0; i < 3; i++) {
        size_t n = strlen(folders[i]);
        if (!strncmp(name, folders[i], n - 1) && !name[n - 1]) return false; /* a file in place of the folder */
        if (!strncmp(name, folders[i], n)) {
            name += n;
            break;
        }
    }
    bool good = isalnum((unsigned char)*name);
    for (const char *c = name; *c; c++) good = good && (isalnum((unsigned char)*c) || *c == '.');
    return good;
}

static void unpack_one(const char *folder, const char *name, size_t length, const void *data, size_t size) {
    char path[PATH], clean[64];
    struct stat info;
    snprintf(clean, sizeof clean, "%.*s", (int)(length < 60 ? length : 60), name);
    if (place.count == FILES || !good_name(clean)) return;
    snprintf(path, sizeof path, "%s/%s/%s", scratch(), folder, clean);
    if (!lstat(path, &info)) return; /* a trap, or a name that stands twice */
    snprintf(place.written[place.count++], PATH, "%s", path);
    scratch_write(path + strlen(scratch()) + 1, data, size);
}

void scratch_unpack(const char *folder, const char *standard, const uint8_t *data, size_t size) {
    const char *text = (const char *)data, *end = text + size;
    if (size < 3 || memcmp(text, "@@ ", 3) != 0) {
        unpack_one(folder, standard, strlen(standard), data, size);
        return;
    }
    while (text < end) {
        const char *name = text + 3, *line = memchr(name, '\n', (size_t)(end - name)), *next = line;
        if (!line) return;
        while (next && (end - next < 4 || memcmp(next, "\n@@ ", 4) != 0))
            next = end - next < 4 ? NULL : memchr(next + 1, '\n', (size_t)(end - next - 1));
        const char *stop = next ? next + 1 : end;
        unpack_one(folder, name, (size_t)(line - name), line + 1, stop > line + 1 ? (size_t)(stop - line - 1) : 0);
        text = stop;
    }
}

void scratch_clear(void) {
    for (int i = 0; i < place.count; i++) unlink(place.written[i]);
    place.count = 0;
}

bool accepted(status s) {
    if (!s) return true;
    PROMISE(*status_text(s), "an error says what is wrong");
    for (const char *c = status_text(s); *c; c++)
        PROMISE((unsigned char)*c >= ' ' || *c == '\n', "an error holds no control characters");
    PROMISE(status_kind(s) == ERR_INPUT, "a bad file is a mistake of the user, no shortage of memory");
    status_free(s);
    return false;
}
