/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes and verifies TIME/uniform/checksums, a dictionary of file sizes and CRC-32 (checksums.h). */
#include "solvers/case/checksums.h"

#include "solvers/dict/dict.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH = 4096 + 128 };

/* The dictionary holds the files of the folder itself in `fields`, those of its uniform/ in `uniform`, those of a cloud
 * of grains, where there is one, in `grains`. */
enum { GROUPS = 3, ALWAYS = 2 };
static const char *const group_name[GROUPS] = {"fields", "uniform", "grains"};
static const char *const group_folder[GROUPS] = {"", "uniform/", "lagrangian/grains/"};

static int group_of(const char *name) {
    for (int g = 1; g < GROUPS; g++)
        if (!strncmp(name, group_folder[g], strlen(group_folder[g]))) return g;
    return 0;
}

status checksums_add(struct checksums *c, const char *name, struct file_sum sum) {
    if (c->n == CHECKSUMS_MOST) return fail(ERR_SYSTEM, "more than %d files in a time folder", CHECKSUMS_MOST);
    c->name[c->n] = name;
    c->sum[c->n++] = sum;
    return OK;
}

status checksums_write(const struct checksums *c, const char *folder, const char *time_name) {
    char path[PATH], location[PATH];
    struct sink *s;
    const struct foam_format ascii = {.precision = 17};
    snprintf(path, sizeof path, "%s/uniform/checksums", folder);
    snprintf(location, sizeof location, "%s/uniform", time_name);
    TRY(sink_open(path, false, &s));
    foam_header_write(s, &ascii, "dictionary", location, "checksums", NULL);
    sink_printf(s, "// of the contents, before compression; a file that was changed on purpose: remove this one\n");
    sink_printf(s, "files           %d;\n", c->n);
    if (c->part) sink_printf(s, "part            %d;\n", c->part - 1);
    for (int g = 0; g < GROUPS; g++) {
        int members = 0;
        for (int i = 0; i < c->n; i++) members += group_of(c->name[i]) == g;
        if (!members && g >= ALWAYS) continue;
        sink_printf(s, "%s\n{\n", group_name[g]);
        for (int i = 0; i < c->n; i++)
            if (group_of(c->name[i]) == g)
                sink_printf(s, "    %-11s { size %lu; crc32 \"%08lx\"; }\n", c->name[i] + strlen(group_folder[g]),
                            c->sum[i].bytes, c->sum[i].crc);
        sink_printf(s, "}\n");
    }
    return sink_close(s);
}

static status verify_file(const char *path, struct dict *d) {
    struct file_sum sum;
    double bytes;
    const char *crc;
    char found[16];
    TRY(dict_number(d, "size", NULL, &bytes));
    TRY(dict_word(d, "crc32", &crc));
    char zipped[PATH + 8];
    snprintf(zipped, sizeof zipped, "%s.gz", path);
    if (access(path, F_OK) && access(zipped, F_OK))
        return fail(ERR_INPUT, "%s: the file is missing; the run that wrote this time wrote it, too", path);
    TRY(file_sum_read(path, &sum));
    if ((double)sum.bytes != bytes)
        return fail(ERR_INPUT, "%s: the file has %lu bytes, the run wrote %.0f: it was %s or changed", path, sum.bytes,
                    bytes, (double)sum.bytes < bytes ? "cut" : "lengthened");
    snprintf(found, sizeof found, "%08lx", sum.crc);
    if (!strcmp(found, crc)) return OK;
    return fail(ERR_INPUT, "%s: the file is not as it was written: its CRC-32 is %s, it was %s", path, found, crc);
}

static status verify_group(const char *folder, int g, struct dict *all, long *seen) {
    struct dict *group, *one;
    TRY(g < ALWAYS ? dict_sub(all, group_name[g], &group) : dict_sub_optional(all, group_name[g], &group));
    for (int i = 0; group && i < dict_count(group); i++, ++*seen) {
        char path[PATH];
        snprintf(path, sizeof path, "%s/%s%.100s", folder, group_folder[g], dict_key(group, i));
        TRY(dict_sub(group, dict_key(group, i), &one));
        TRY(verify_file(path, one));
    }
    return OK;
}

status checksums_verify(const char *folder) {
    char path[PATH];
    struct dict *d;
    long files = -1, seen = 0;
    snprintf(path, sizeof path, "%s/uniform/checksums", folder);
    if (access(path, F_OK)) return OK;
    TRY(dict_read(path, &d));
    status s = dict_count_or(d, "files", -1, &files);
    const bool of_part = dict_has(d, "part");
    for (int g = 0; !s && !of_part && g < GROUPS; g++) s = verify_group(folder, g, d, &seen);
    if (!s && !of_part && files != seen)
        s = fail(ERR_INPUT, "%s: it lists %ld files, not %ld: it was cut", path, seen, files);
    dict_free(d);
    return s;
}
