/* SPDX-License-Identifier: GPL-3.0-or-later */
/* caseToVTK: the written times of a case as VTK files. */
#define _XOPEN_SOURCE 700 /* realpath */
#include "solvers/case/blockmesh.h"
#include "solvers/case/fields.h"
#include "solvers/case/times.h"
#include "solvers/output/clouds.h"
#include "solvers/output/vtk.h"
#include "solvers/programs/program.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST = 64 };

struct conversion {
    char plain[PLAIN_PATH];   /* dir without links */
    const char *dir, *phases; /* phases: name of the phaseAverage to convert; NULL: the case's times */
    char root[TIME_PATH];     /* folder of the times */
    char name[256];
    const char *times[MOST], *fields[MOST]; /* names that the command line asks for; none: all */
    int ntimes, nfields;
    enum vtk_form form;
    bool help, version;
    int clouds; /* number of clouds written */
    struct polymesh *mesh;
    struct vtk_grid *grid;
};

static const char usage[] =
    "caseToVTK [-case] DIR [-time T1,T2,..] [-fields F1,F2,..] [-phases NAME] [-ascii | -vtu] [-help] [-version]\n\n"
    "Converts the written times of the case (default: all) to DIR/VTK/NAME_TIME.vtk with a .vtk.series; fields:\n"
    "default rho alpha U T p, those that are there; any volScalarField or volVectorField can be named. Grains of\n"
    "granularMD go to DIR/VTK/NAME-grains_TIME.vtk. -phases: instead of times the phases of that phaseAverage (of its\n"
    "latest start), to DIR/VTK/NAME_PHASE.vtk. -vtu: XML files whose arrays are compressed instead of legacy VTK.\n";

static status take_list(char *text, const char **out, int *n) {
    for (char *word = strtok(text, ", "); word; word = strtok(NULL, ", ")) {
        if (*n == MOST) return fail(ERR_INPUT, "more than %d names in a list", MOST);
        out[(*n)++] = word;
    }
    return OK;
}

static status read_options(int argc, char **argv, struct conversion *c) {
    static const char *const names[] = {"DIR",    "-case", "-time", "-fields", "-phases",
                                        "-ascii", "-vtu",  "-help", "-version"};
    const char *value;
    for (int i = 1; i < argc; i++) {
        bool time = !strcmp(argv[i], "-time"), field = !strcmp(argv[i], "-fields");
        if (!strcmp(argv[i], "-ascii"))
            c->form = VTK_ASCII;
        else if (!strcmp(argv[i], "-vtu"))
            c->form = VTK_XML;
        else if (!strcmp(argv[i], "-help") || !strcmp(argv[i], "--help"))
            c->help = true;
        else if (!strcmp(argv[i], "-version") || !strcmp(argv[i], "--version"))
            c->version = true;
        else if (!strcmp(argv[i], "-case"))
            TRY(option_value(argc, argv, &i, &c->dir));
        else if (!strcmp(argv[i], "-phases"))
            TRY(option_value(argc, argv, &i, &c->phases));
        else if (time || field) {
            TRY(option_value(argc, argv, &i, &value));
            TRY(take_list(argv[i], time ? c->times : c->fields, time ? &c->ntimes : &c->nfields));
        } else if (argv[i][0] == '-' || c->dir)
            return option_unknown(argv[i], names, 9);
        else
            c->dir = argv[i];
    }
    if (c->help || c->version) return OK;
    if (!c->dir) return fail(ERR_INPUT, "which case? usage: caseToVTK DIR (more with -help)");
    TRY(case_folder(c->dir));
    TRY(folder_plain(c->dir, c->plain));
    c->dir = c->plain;
    return OK;
}

static bool same_time(const char *word, const struct instant *at) {
    char *end;
    double t = strtod(word, &end);
    return !strcmp(word, at->name) || (end != word && !*end && t == strtod(at->name, NULL));
}

static bool asked(const struct conversion *c, const struct instant *at) {
    bool wanted = !c->ntimes;
    for (int i = 0; i < c->ntimes; i++) wanted |= same_time(c->times[i], at);
    return wanted;
}

static status check_times(const struct conversion *c, int n, const struct instant *list) {
    char names[512] = "";
    for (int i = 0; i < n; i++) {
        size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, " %s", list[i].name);
    }
    struct instant start;
    if (!n && time_original(c->root, &start))
        return fail(ERR_INPUT,
                    "%s: it has no time folders yet;  initialFields %s  writes the time 0 from " TIME_ORIGINAL, c->root,
                    c->root);
    if (!n) return fail(ERR_INPUT, "%s: it has no time folders; nothing to convert", c->root);
    for (int k = 0; k < c->ntimes; k++) {
        bool found = false;
        for (int i = 0; i < n; i++) found |= same_time(c->times[k], &list[i]);
        if (!found) return fail(ERR_INPUT, "%s: there is no time '%s'; there are:%s", c->root, c->times[k], names);
    }
    return OK;
}

static status read_one(const struct conversion *c, const struct instant *at, const char *field, struct vtk_field *list,
                       int *n) {
    char path[TIME_PATH];
    double *values;
    snprintf(path, sizeof path, "%.3900s/%s/%.100s", c->root, at->name, field);
    if (!field_exists(path)) {
        if (!c->nfields) return OK;
        const char *names[FIELD_COUNT];
        for (int i = 0; i < FIELD_COUNT; i++) names[i] = field_kinds[i].name;
        char meant[MEANT];
        return fail(ERR_INPUT, "%s: no such field%s", path, name_question(field, names, FIELD_COUNT, meant));
    }
    TRY(field_read_values(path, c->mesh->ncells, &list[*n].components, &values));
    list[*n].name = field;
    list[(*n)++].values = values;
    return OK;
}

/* Converts the cloud of grains of a time that has one. */
static status convert_cloud(struct conversion *c, const struct instant *at) {
    char folder[TIME_PATH], vtk[TIME_PATH + 8];
    struct cloud cloud;
    snprintf(folder, sizeof folder, "%.4000s/%s", c->root, at->name);
    if (!cloud_exists(folder)) return OK;
    TRY(cloud_read(folder, c->mesh->ncells, &cloud));
    snprintf(vtk, sizeof vtk, "%.4000s/VTK", c->dir);
    status s = cloud_write_vtk(&cloud, vtk, c->name, at->name, c->form, at->t, at->step);
    if (!s) printf("%s/%s-grains_%s%s\n", vtk, c->name, at->name, vtk_ending(c->form));
    c->clouds++;
    cloud_free(&cloud);
    return s;
}

static status convert(struct conversion *c, const struct instant *at) {
    struct vtk_field list[MOST];
    int n = 0;
    char path[TIME_PATH];
    status s = OK;
    if (c->nfields)
        for (int i = 0; !s && i < c->nfields; i++) s = read_one(c, at, c->fields[i], list, &n);
    else
        for (int i = 0; !s && i < FIELD_COUNT; i++) s = read_one(c, at, field_kinds[i].name, list, &n);
    snprintf(path, sizeof path, "%s/VTK", c->dir);
    if (!s) s = make_folders(path);
    snprintf(path, sizeof path, "%s/VTK/%s_%s%s", c->dir, c->name, at->name, vtk_ending(c->form));
    if (!s) s = vtk_write(c->grid, path, c->form, at->t, at->step, n, list);
    if (!s) printf("%s\n", path);
    for (int i = 0; i < n; i++) free((void *)(uintptr_t)list[i].values);
    return s ? s : convert_cloud(c, at);
}

/* Finds the folder of the times and the name of the VTK files. */
static status find_root(struct conversion *c) {
    char full[PATH_MAX];
    struct instant *starts = NULL;
    int n = 0;
    const char *resolved = realpath(c->dir, full), *slash = resolved ? strrchr(full, '/') : NULL;
    snprintf(c->name, sizeof c->name, "%s", c->phases ? c->phases : slash && slash[1] ? slash + 1 : "case");
    snprintf(c->root, sizeof c->root, "%s", c->dir);
    if (!c->phases) return OK;
    snprintf(c->root, sizeof c->root, "%.3800s/postProcessing/%.200s", c->dir, c->phases);
    if (access(c->root, F_OK))
        return fail(ERR_INPUT, "%s: no such folder; -phases wants the name of a phaseAverage that has run", c->root);
    TRY(times_list(c->root, &n, &starts));
    if (n) snprintf(c->root + strlen(c->root), sizeof c->root - strlen(c->root), "/%.64s", starts[n - 1].name);
    free(starts);
    return OK;
}

static status read_mesh(struct conversion *c) {
    struct case_mesh read;
    const status s = case_mesh_read(c->dir, &read);
    c->mesh = read.mesh;
    return s ? s : polymesh_complete(c->mesh);
}

static status convert_all(struct conversion *c) {
    char path[TIME_PATH];
    struct instant *times = NULL;
    int n = 0;
    double latest = -HUGE_VAL;
    status damage = OK; /* the error of the first damaged time; the other times are converted */
    TRY(find_root(c));
    TRY(times_list(c->root, &n, &times));
    status s = check_times(c, n, times);
    if (!s) s = read_mesh(c);
    if (!s) s = vtk_grid_make(c->mesh, &c->grid);
    for (int i = 0; !s && i < n; i++) {
        if (!asked(c, &times[i])) continue;
        status wrong = time_verify(c->root, &times[i]);
        if (wrong && damage)
            status_free(wrong);
        else if (wrong)
            damage = status_note(wrong, "time %s is damaged and was left out", times[i].name);
        if (wrong) continue;
        s = convert(c, &times[i]);
        latest = times[i].t;
    }
    snprintf(path, sizeof path, "%s/VTK", c->dir);
    if (!s) s = vtk_series_write(path, c->name, vtk_ending(c->form), latest);
    snprintf(c->name + strlen(c->name), sizeof c->name - strlen(c->name), "-grains");
    if (!s && c->clouds) s = vtk_series_write(path, c->name, vtk_ending(c->form), latest);
    free(times);
    if (!s) return damage;
    status_free(damage);
    return s;
}

int main(int argc, char **argv) {
    struct conversion c = {.dir = NULL};
    status s = read_options(argc, argv, &c);
    if (!s && (c.help || c.version)) {
        if (c.version) program_version(argv[0]);
        if (c.help) printf("%s", usage);
        return 0;
    }
    if (!s) s = convert_all(&c);
    vtk_grid_free(c.grid);
    polymesh_free(c.mesh);
    return program_end(NULL, s, false);
}
