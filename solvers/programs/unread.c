/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds the files of a case that nothing reads, and the names that were meant (unread.h). */
#include "solvers/programs/unread.h"

#include "mesh/format/foamfile.h"

#include <ctype.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define COUNT(table) ((int)(sizeof table / sizeof *table))
enum { ALIKE = 5 /* letters at the start of two names that then mean the same, as granularProps */ };
enum { NAME = 256, PATH = 4096 + NAME, MOST_SAID = 20, MOST_SEARCHED = 1 << 20 };

enum folder { CONSTANT, SYSTEM, START, ROOT, FOLDERS }; /* ROOT: the case itself */
struct known {
    enum folder folder;
    const char *name;
};
/* Files that programs of haff read; those of another program of haff may lie in a case, too. */
static const struct known ours[] = {
    {CONSTANT, "granularProperties"},
    {CONSTANT, "g"},
    {CONSTANT, "shaking"},
    {CONSTANT, "particleProperties"},
    {CONSTANT, "segregationProperties"},
    {SYSTEM, "controlDict"},
    {SYSTEM, "fvSchemes"},
    {SYSTEM, "fvSolution"},
    {SYSTEM, "meshDict"},
    {SYSTEM, "blockMeshDict"},
    {SYSTEM, "units"},
    {START, "alpha"},
    {START, "rho"},
    {START, "U"},
    {START, "T"},
    {START, "p"},
    {START, "rhoU"},
    {START, "rhoE"},
};
/* Files of OpenFOAM's tools, which work on a case of haff, too. */
static const char *const tools[] = {
    "decomposeParDict",
    "topoSetDict",
    "createPatchDict",
    "snappyHexMeshDict",
    "mirrorMeshDict",
    "refineMeshDict",
    "extrudeMeshDict",
    "extrude2DMeshDict",
    "surfaceFeaturesDict",
    "createBafflesDict",
    "surfaceFeatureExtractDict",
    "renumberMeshDict",
    "changeDictionaryDict",
    "mapFieldsDict",
    "meshQualityDict",
    "sampleDict",
    "stitchMeshDict",
    "subsetMeshDict",
    "foamDataToFluentDict",
    "collapseDict",
    "manipulateMeshDict",
    "splitMeshRegionsDict",
    "modifyMeshDict",
    "moveDynamicMesh",
    "postProcessing",
    "C",
    "Cx",
    "Cy",
    "Cz",
    "V",
    "cellLevel",
    "pointLevel",
    "cellDist",
    "cellToRegion",
};
/* Files that are something in OpenFOAM and nothing here, with what takes their place. */
static const struct {
    const char *name, *instead;
} foreign[] = {
    {"thermophysicalProperties", "gamma belongs in constant/granularProperties: equationOfState perfectGas; "
                                 "perfectGasCoeffs { gamma 1.4; }, and T of a field is R T (m^2/s^2), no kelvin"},
    {"physicalProperties", "gamma belongs in constant/granularProperties: equationOfState perfectGas; "
                           "perfectGasCoeffs { gamma 1.4; }, and T of a field is R T (m^2/s^2), no kelvin"},
    {"transportProperties", "viscosity and heat conduction follow from the grains: `transport` of "
                            "constant/granularProperties"},
    {"turbulenceProperties", "there are no turbulence models"},
    {"momentumTransport", "there are no turbulence models"},
    {"RASProperties", "there are no turbulence models"},
    {"LESProperties", "there are no turbulence models"},
    {"kineticTheoryProperties", "grains are described in constant/granularProperties"},
    {"fvOptions", "what acts on the gas stands in `sources` of constant/granularProperties"},
    {"fvModels", "what acts on the gas stands in `sources` of constant/granularProperties"},
    {"fvConstraints", "bounds stand in `limits` of system/fvSolution"},
    {"dynamicMeshDict", "the mesh does not move; a shaken plate is constant/shaking"},
    {"MRFProperties",
     "frames do not rotate here; a wall that moves along itself is translatingWallVelocity or rotatingWallVelocity"},
    {"setFieldsDict", "setFields works on the folder 0, and this run starts from " TIME_ORIGINAL
                      ": put `expression` into its fields, or take the folder 0 in its place"},
};
/* Words of the field for files whose name has nothing in common with that of haff. */
static const struct {
    enum folder folder;
    const char *word, *name;
} others[] = {
    {CONSTANT, "gravity", "g"},
    {CONSTANT, "gravitation", "g"},
    {CONSTANT, "acceleration", "g"},
    {CONSTANT, "vibration", "shaking"},
    {CONSTANT, "grainProperties", "granularProperties"},
    {START, "velocity", "U"},
    {START, "temperature", "T"},
    {START, "Theta", "T"},
    {START, "granularTemperature", "T"},
    {START, "density", "rho"},
    {START, "volumeFraction", "alpha"},
    {START, "pressure", "p"},
    {START, "nu", "alpha"},
    {START, "phi", "alpha"},
};

struct unread { /* what is known of a case, and found in it */
    const char *dir, *application;
    const struct offered *fields, *usual; /* of the case, and of each case of the program */
    const char *folder[FOLDERS];          /* names in the case; START: NULL, a run wrote it */
    int n;
    struct found {
        char path[PATH], meant[PATH + 4], text[1024]; /* meant: another path, or empty */
        bool certain;                                 /* is there no file of that name yet? */
    } * found;                                        /* [MOST_SAID] */
};

static bool is_one_of(const char *name, const char *const *names, int n) {
    for (int i = 0; i < n; i++)
        if (!strcmp(name, names[i])) return true;
    return false;
}

static bool same_letters(const char *a, const char *b) {
    while (*a && tolower((unsigned char)*a) == tolower((unsigned char)*b)) a++, b++;
    return !*a && !*b;
}

static bool ends_with(const char *name, const char *ending) {
    const size_t n = strlen(name), m = strlen(ending);
    return n > m && !strcmp(name + n - m, ending);
}

/* Is the file a backup, a note, or hidden? */
static bool is_aside(const char *name) {
    static const char *const endings[] = {"~", ".bak", ".orig", ".org", ".old", ".save", ".swp", ".tmp", ".md"};
    for (int i = 0; i < COUNT(endings); i++)
        if (ends_with(name, endings[i])) return true;
    return strchr(".#", *name) || !strncmp(name, "README", 6) || !strncmp(name, "LICEN", 5) || !strncmp(name, "All", 3);
}

static void join(const struct unread *u, enum folder in, const char *name, char path[PATH]) {
    if (in == ROOT)
        snprintf(path, PATH, "%.3700s/%.255s", u->dir, name);
    else
        snprintf(path, PATH, "%.3700s/%.200s/%.255s", u->dir, u->folder[in], name);
}

static bool exists(const struct unread *u, enum folder in, const char *name) {
    char path[PATH];
    join(u, in, name, path);
    return field_exists(path);
}

/* Has the file a line with a word, and another word behind it, as  #include "times"? */
static bool says(const char *path, const char *word, const char *name) {
    struct stat info;
    struct source *s = NULL;
    bool found = false;
    if (stat(path, &info) || !S_ISREG(info.st_mode) || info.st_size > MOST_SEARCHED) return false;
    status e = source_open_named(path, &s);
    for (const char *at = e ? NULL : s->text; at && (at = strstr(at, word)) && !found; at++) {
        const char *end = strchr(at, '\n'), *there = strstr(at, name);
        found = there && (!end || there < end);
    }
    source_free(s);
    status_free(e);
    return found;
}

/* Is the name that of a file which is read from the folder, by this program or with it? */
static bool is_read(const struct unread *u, enum folder folder, const char *name) {
    for (int i = 0; i < COUNT(ours); i++)
        if (ours[i].folder == folder && !strcmp(ours[i].name, name)) return true;
    for (const int *q = u->fields->written; *q >= 0 && folder == START; q++)
        if (*q >= u->usual->noffered && *q < u->fields->noffered && !strcmp(u->fields->quantity[*q].name, name))
            return true;
    if (folder == START && u->fields == u->usual) { /* a case that was not read: it may carry the field */
        char path[PATH];
        join(u, CONSTANT, "granularProperties", path);
        if (says(path, name, "")) return true;
    }
    return folder == START && !strcmp(u->application, "granularSegregation") && !strcmp(name, "phi");
}

static bool is_included(const struct unread *u, const char *name) {
    bool found = false;
    for (enum folder k = 0; k < ROOT && !found; k++) {
        char path[PATH];
        if (!u->folder[k]) continue;
        join(u, k, "", path);
        DIR *folder = opendir(path);
        for (struct dirent *e; folder && !found && (e = readdir(folder));) {
            join(u, k, e->d_name, path);
            found = strcmp(e->d_name, name) && says(path, "#include", name);
        }
        if (folder) closedir(folder);
    }
    return found;
}

/* Finds the name that was meant by one in a folder, and the folder that it is read from; NULL: there is none. `stem` is
 * the name up to its first dot. */
static const char *meant(const struct unread *u, enum folder in, const char *name, const char *stem, enum folder *out) {
    const char *names[COUNT(ours)];
    int n = 0;
    for (int i = 0; i < COUNT(ours); i++) {
        *out = ours[i].folder;
        if (ours[i].folder != in && u->folder[*out] && !strcmp(ours[i].name, stem)) return ours[i].name;
        if (ours[i].folder == in && same_letters(ours[i].name, stem)) return ours[i].name;
    }
    *out = in;
    if (strcmp(name, stem)) return NULL; /* such endings are of other tools */
    for (int i = 0; i < COUNT(others); i++)
        if (others[i].folder == in && same_letters(others[i].word, name)) return others[i].name;
    for (int i = 0; i < COUNT(ours); i++)
        if (ours[i].folder == in) names[n++] = ours[i].name;
    const char *near = nearest_name(name, names, n);
    for (int i = 0; i < n && !near; i++)
        if (!strncmp(name, names[i], ALIKE)) near = names[i];
    return near;
}

/* Returns what stands in the place of a file of OpenFOAM, or NULL. */
static const char *instead(const struct unread *u, const char *path, const char *name) {
    for (int i = 0; i < COUNT(foreign); i++) {
        if (strcmp(foreign[i].name, name)) continue;
        if (!strcmp(name, "setFieldsDict") && (!u->folder[START] || strcmp(u->folder[START], TIME_ORIGINAL) != 0))
            return NULL;
        return (!strcmp(name, "turbulenceProperties") || !strcmp(name, "momentumTransport")) &&
                       says(path, "simulationType", "laminar")
                   ? NULL
                   : foreign[i].instead;
    }
    return NULL;
}

static bool is_foreign(const char *name) {
    bool found = false;
    for (int i = 0; i < COUNT(foreign); i++) found |= !strcmp(foreign[i].name, name);
    return found;
}

/* Says the files that are read from a folder. */
static void list_ours(enum folder folder, char *text, size_t room) {
    *text = 0;
    for (int i = 0; i < COUNT(ours); i++) {
        const size_t used = strlen(text);
        if (ours[i].folder == folder) snprintf(text + used, room - used, "%s%s", used ? " " : "", ours[i].name);
    }
}

/* Notes a file that nothing reads. `entry` is its whole name, `name` that without .gz, `stem` that up to a dot. */
static void note(struct unread *u, enum folder in, const char *entry, const char *name, const char *stem) {
    struct found *f = &u->found[u->n];
    enum folder to = in;
    char known[400];
    join(u, in, entry, f->path);
    const char *other = instead(u, f->path, name), *right = is_foreign(name) ? NULL : meant(u, in, name, stem, &to);
    if (right ? false : !other && (is_foreign(name) || in == ROOT || strcmp(name, stem) != 0)) return;
    u->n++;
    *f->meant = 0;
    if (other) {
        snprintf(f->text, sizeof f->text, "%s; remove the file when that is done", other);
    } else if (right) {
        const char *zip = strcmp(entry, name) ? ".gz" : "", *end = name + strlen(stem);
        const bool there = exists(u, to, right);
        join(u, to, right, f->meant);
        snprintf(f->meant + strlen(f->meant), 4, "%s", zip);
        f->certain = !there && (!*end || !strcmp(end, ".txt"));
        snprintf(f->text, sizeof f->text, "did you mean '%s/%s%s'? %s", u->folder[to], right, zip,
                 there ? "that is there, too: remove one of the two" : "rename it");
    } else {
        list_ours(in, known, sizeof known);
        snprintf(f->text, sizeof f->text, "here lie %s; remove it, or call it %s.txt if it is a note", known, name);
    }
}

/* Is the name that of a file which is read from any folder? */
static bool is_ours(const char *name) {
    bool found = false;
    for (int i = 0; i < COUNT(ours); i++) found |= !strcmp(ours[i].name, name);
    return found;
}

static void look_at(struct unread *u, enum folder in, const char *entry) {
    char path[PATH], name[NAME], stem[NAME];
    struct stat info;
    join(u, in, entry, path);
    if (u->n == MOST_SAID || is_aside(entry) || stat(path, &info) || !S_ISREG(info.st_mode)) return;
    snprintf(name, sizeof name, "%s", entry);
    if (ends_with(name, ".gz")) name[strlen(name) - 3] = 0;
    snprintf(stem, sizeof stem, "%.*s", (int)strcspn(name, "."), name);
    if (in == ROOT && !is_ours(name)) return; /* anything else may lie there */
    if (is_read(u, in, name) || is_one_of(name, tools, COUNT(tools)) || is_included(u, entry)) return;
    note(u, in, entry, name, stem);
}

static int by_name(const void *a, const void *b) {
    return strcmp(((const struct found *)a)->path, ((const struct found *)b)->path);
}

static void look_through(struct unread *u) {
    for (enum folder k = 0; k < FOLDERS; k++) {
        char path[PATH];
        if (!u->folder[k]) continue;
        join(u, k, "", path);
        DIR *folder = opendir(path);
        for (struct dirent *e; folder && (e = readdir(folder));) look_at(u, k, e->d_name);
        if (folder) closedir(folder);
    }
    if (u->n) qsort(u->found, (size_t)u->n, sizeof *u->found, by_name);
}

static status say(struct setup *s, const struct found *f) {
    if (*f->meant && f->certain) warn_cure(&s->warnings, WARN_UNREAD, CURE_FILE, f->path, 0, "", f->meant);
    return warn(&s->warnings, WARN_UNREAD, "%s: nothing reads this file: %s", f->path, f->text);
}

/* Begins to look through a case that starts from a folder. */
static status begin(const char *dir, const struct medium_type *type, const char *start, const struct offered *fields,
                    struct unread *u) {
    char stamp[PATH];
    *u = (struct unread){.dir = dir,
                         .application = type->application,
                         .fields = fields,
                         .usual = &type->fields,
                         .folder = {"constant", "system", start, "."}};
    snprintf(stamp, sizeof stamp, "%.3900s/%s/uniform/time", dir, start);
    if (!access(stamp, F_OK)) u->folder[START] = NULL;
    return allocate_unset(&u->found, MOST_SAID, sizeof *u->found, "names of files");
}

status unread_warn(struct setup *s) {
    struct unread u;
    status e = OK;
    TRY(comm_agree(s->comm, begin(s->dir, s->medium->type, s->start.folder, &s->medium->fields, &u)));
    if (comm_root(s->comm)) look_through(&u);
    comm_broadcast(s->comm, &u.n, sizeof u.n);
    if (u.n) comm_broadcast(s->comm, u.found, u.n * (long)sizeof *u.found);
    for (int i = 0; i < u.n && !e; i++) e = say(s, &u.found[i]);
    free(u.found);
    return e;
}

status unread_hint(const char *dir, const struct medium_type *type, struct cures *cures, status error) {
    struct instant original;
    struct unread u;
    const bool accepted[WARNINGS] = {false};
    struct warnings w = {.accepted = accepted, .cures = cures};
    status e = begin(dir, type, time_original(dir, &original) ? TIME_ORIGINAL : "0", &type->fields, &u);
    if (!e) look_through(&u);
    for (int i = 0; !e && i < u.n; i++) {
        const struct found *f = &u.found[i];
        if (!*f->meant || !f->certain) continue;
        warn_cure(&w, WARN_UNREAD, CURE_FILE, f->path, 0, "", f->meant);
        error = status_note(error, "%s: nothing reads this file: %s", f->path, f->text);
    }
    free(u.found);
    status_free(e);
    return error;
}
