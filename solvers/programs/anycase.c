/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The main of programs that take a case of any solver (anycase.h). */
#include "solvers/programs/anycase.h"

#include "solvers/programs/program.h"

#include <string.h>

struct request {
    const char *dir;
    bool help, version, strict;
};

static status parse(int argc, char **argv, struct request *o) {
    const char *const slash = strrchr(argv[0], '/');
    static const char *const names[] = {"DIR", "-case", "-strict", "-help", "-version"};
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "-help") || !strcmp(argv[i], "--help"))
            o->help = true;
        else if (!strcmp(argv[i], "-version") || !strcmp(argv[i], "--version"))
            o->version = true;
        else if (!strcmp(argv[i], "-strict"))
            o->strict = true;
        else if (!strcmp(argv[i], "-case"))
            TRY(option_value(argc, argv, &i, &o->dir));
        else if (*argv[i] == '-' || o->dir)
            return option_unknown(argv[i], names, 5);
        else
            o->dir = argv[i];
    if (o->help || o->version) return OK;
    return o->dir ? case_folder(o->dir) : fail(ERR_INPUT, "which case? usage: %s DIR", slash ? slash + 1 : argv[0]);
}

/* Returns the medium that controlDict's `application` names; the action reports errors of that file. */
static const struct medium_type *medium_of(const char *dir) {
    char path[TIME_PATH];
    struct dict *d = NULL;
    const char *name = "";
    snprintf(path, sizeof path, "%.4000s/system/controlDict", dir);
    status e = dict_read(path, &d);
    if (!e) e = dict_word_or(d, "application", "", &name);
    static const struct medium_type *const types[] = {&gas_medium, &segregation_medium, &grains_medium};
    const struct medium_type *type = types[0];
    for (int i = 1; !e && i < 3; i++)
        if (!strcmp(name, types[i]->application)) type = types[i];
    status_free(e);
    dict_free(d);
    return type;
}

int anycase_main(int argc, char **argv, const char *help_text, anycase_action *action) {
    struct comm *c = NULL;
    struct request o = {.dir = NULL};
    status s = parse(argc, argv, &o);
    if (!s && (o.help || o.version)) {
        if (o.version) program_version(argv[0]);
        if (o.help) printf("%s", help_text);
        return 0;
    }
    if (!s) s = comm_start(&argc, &argv, &c);
    if (!s) s = action(o.dir, medium_of(o.dir), o.strict, c);
    return program_end(c, s, false);
}
