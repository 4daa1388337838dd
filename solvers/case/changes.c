/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Records mesh and dictionaries in a time's provenance, and compares a case with that record entry by entry
 * (changes.h). */
#include "solvers/case/changes.h"

#include "mesh/base/build.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FILES = MAX_FILES + 1, SHOWN = 20, KEY = 1024 };

/* Lists controlDict and the medium's dictionaries; returns how many. */
static int list_files(const struct setup *s, struct setup_file out[FILES]) {
    out[0] = (struct setup_file){"system", "controlDict", s->control->dict};
    memcpy(out + 1, s->file, (size_t)s->nfiles * sizeof *out);
    return 1 + s->nfiles;
}

void changes_record(struct sink *o, const struct setup *s) {
    struct setup_file file[FILES];
    const int n = list_files(s, file);
    sink_printf(o, "meshChecksum    \"%016lx\";\ncells           %d;\n", s->checksum, s->mesh->ncells);
    sink_printf(o, "dictionaries\n{\n");
    for (int i = 0; i < n; i++) {
        char *text = file[i].dict ? dict_print(file[i].dict) : NULL;
        if (!text) continue;
        sink_printf(o, "    %s\n    {\n", file[i].name);
        for (char *line = strtok(text, "\n"); line; line = strtok(NULL, "\n")) sink_printf(o, "        %s\n", line);
        sink_printf(o, "    }\n");
        free(text);
    }
    sink_printf(o, "}\n");
}

/* Opens the provenance of the start time; *out is NULL if it has none. */
static status open_provenance(const struct setup *s, struct dict **out) {
    char path[TIME_PATH + TIME_NAME];
    *out = NULL;
    snprintf(path, sizeof path, "%.4000s/%s/uniform/provenance", s->dir, s->start.folder);
    return access(path, F_OK) ? OK : dict_read(path, out);
}

status changes_check_mesh(const struct setup *s) {
    struct dict *was;
    long cells = s->mesh->ncells;
    status e = open_provenance(s, &was);
    if (!e && was) e = dict_count_or(was, "cells", cells, &cells);
    dict_free(was);
    status_free(e); /* changes_print reports the error; the run does not need the file */
    if (cells == s->mesh->ncells) return OK;
    return fail(ERR_INPUT,
                "%s: it has %d cells, but time %s was written on a mesh of %ld cells; put that mesh "
                "back, start from a time of the new one, or map the fields to it (OpenFOAM's mapFields)",
                s->mesh_path, s->mesh->ncells, s->start.name, cells);
}

/* ---- two printed dictionaries, entry by entry ---- */

struct changed_entry {
    char *key, *value; /* key: with the names of the dictionaries around it, "grain.restitution" */
};
struct entries {
    int n, room;
    struct changed_entry *entry;
};

static void entries_free(struct entries *e) {
    for (int i = 0; i < e->n; i++) {
        free(e->entry[i].key);
        free(e->entry[i].value);
    }
    free(e->entry);
}

static void add_entry(struct entries *e, const char *key, const char *value) {
    if (e->n == e->room) {
        struct changed_entry *more = realloc(e->entry, (size_t)(2 * e->room + 32) * sizeof *more);
        if (!more) return;
        e->entry = more;
        e->room = 2 * e->room + 32;
    }
    struct changed_entry *one = &e->entry[e->n];
    *one = (struct changed_entry){strdup(key), strdup(value)};
    if (one->key && one->value) {
        e->n++;
        return;
    }
    free(one->key);
    free(one->value);
}

/* Splits a printed dictionary into entries: dict_print sets one entry or bracket to a line. Frees the text. */
static void split(char *text, struct entries *out) {
    char key[KEY] = "";
    for (char *line = text ? strtok(text, "\n") : NULL; line; line = strtok(NULL, "\n")) {
        line += strspn(line, " ");
        size_t n = strlen(line), used = strlen(key);
        if (!strcmp(line, "}")) {
            if (used) key[used - 1] = 0;
            char *dot = strrchr(key, '.');
            key[dot ? dot + 1 - key : 0] = 0;
        } else if (n > 2 && !strcmp(line + n - 2, " {")) {
            snprintf(key + used, sizeof key - used, "%.*s.", (int)n - 2, line);
        } else {
            size_t word = strcspn(line, " ;");
            snprintf(key + used, sizeof key - used, "%.*s", (int)word, line);
            if (n && line[n - 1] == ';') line[n - 1] = 0;
            add_entry(out, key, line + word + (line[word] == ' '));
            key[used] = 0;
        }
    }
    free(text);
}

static const char *find(const struct entries *e, const char *key) {
    for (int i = 0; i < e->n; i++)
        if (!strcmp(e->entry[i].key, key)) return e->entry[i].value;
    return NULL;
}

static bool same_value(const char *a, const char *b) {
    char *end_a, *end_b;
    double x = strtod(a, &end_a), y = strtod(b, &end_b);
    return !strcmp(a, b) || (end_a != a && end_b != b && !*end_a && !*end_b && x == y);
}

struct teller { /* prints the heading before the first line */
    FILE *file;
    const char *time, *date;
    int lines;
};

static void say(struct teller *t, const char *what, const char *key, const char *was, const char *is) {
    if (!t->lines++) fprintf(t->file, "Changed since time %s was written (%s)\n", t->time, t->date);
    fprintf(t->file, "    %s: %s%s%.100s%s%.100s\n", what, key, was ? " " : " (new) ", was ? was : "",
            is && was ? " -> " : "", is ? is : " -> (gone)");
}

static void compare(struct teller *t, const struct setup_file *file, const struct dict *was) {
    char what[64];
    struct entries a = {0}, b = {0};
    int differ = 0;
    snprintf(what, sizeof what, "%s/%s", file->folder, file->name);
    if (was) split(dict_print(was), &a);
    if (file->dict) split(dict_print(file->dict), &b);
    for (int i = 0; i < a.n; i++) {
        const char *now = find(&b, a.entry[i].key);
        if ((!now || !same_value(a.entry[i].value, now)) && differ++ < SHOWN)
            say(t, what, a.entry[i].key, a.entry[i].value, now);
    }
    for (int i = 0; i < b.n; i++)
        if (!find(&a, b.entry[i].key) && differ++ < SHOWN) say(t, what, b.entry[i].key, NULL, b.entry[i].value);
    if (differ > SHOWN) fprintf(t->file, "    %s: and %d entries more\n", what, differ - SHOWN);
    entries_free(&a);
    entries_free(&b);
}

static status tell(FILE *f, const struct setup *s, struct dict *was) {
    const char *checksum, *version, *date;
    char now[32];
    struct dict *all, *one;
    struct setup_file file[FILES];
    TRY(dict_word_or(was, "meshChecksum", "", &checksum));
    TRY(dict_word_or(was, "version", build_version(), &version));
    TRY(dict_word_or(was, "date", "no date", &date));
    TRY(dict_sub_optional(was, "dictionaries", &all));
    struct teller t = {f, s->start.name, date, 0};
    snprintf(now, sizeof now, "%016lx", s->checksum);
    if (*checksum && strcmp(checksum, now) != 0) {
        say(&t, s->mesh->boxes ? "system/blockMeshDict" : "constant/polyMesh", "checksum", checksum, now);
        fprintf(f, "    WARNING: the fields of time %s belong to another mesh; they are taken cell by cell\n",
                s->start.name);
    }
    const int n = list_files(s, file);
    for (int i = 0; all && i < n; i++) {
        TRY(dict_sub_optional(all, file[i].name, &one));
        compare(&t, &file[i], one);
    }
    if (strcmp(version, build_version()) != 0) say(&t, "haff", "version", version, build_version());
    return OK;
}

void changes_print(FILE *f, const struct setup *s) {
    struct dict *was;
    status e = open_provenance(s, &was);
    if (!e && was) e = tell(f, s, was);
    if (e) fprintf(f, "What has changed since time %s is not known: %s\n", s->start.name, status_text(e));
    status_free(e);
    dict_free(was);
}
