/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The main of programs that take a case of any solver (anycase.h). */
#include "solvers/programs/anycase.h"

#include "solvers/programs/fix.h"
#include "solvers/programs/program.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ROUNDS = 50 }; /* of -fix -write */

struct request {
    const char *dir;
    bool help, version, strict, fix, write;
};

static status parse(int argc, char **argv, bool mends, struct request *o) {
    const char *const slash = strrchr(argv[0], '/');
    static const char *const names[] = {"DIR", "-case", "-strict", "-help", "-version", "-fix", "-write"};
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "-help") || !strcmp(argv[i], "--help"))
            o->help = true;
        else if (!strcmp(argv[i], "-version") || !strcmp(argv[i], "--version"))
            o->version = true;
        else if (!strcmp(argv[i], "-strict"))
            o->strict = true;
        else if (mends && !strcmp(argv[i], "-fix"))
            o->fix = true;
        else if (mends && !strcmp(argv[i], "-write"))
            o->write = true;
        else if (!strcmp(argv[i], "-case"))
            TRY(option_value(argc, argv, &i, &o->dir));
        else if (*argv[i] == '-' || o->dir)
            return option_unknown(argv[i], names, mends ? 7 : 5);
        else
            o->dir = argv[i];
    if (o->help || o->version) return OK;
    if (o->write && !o->fix) return fail(ERR_INPUT, "-write makes the changes of -fix: say  -fix -write");
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
    static const struct medium_type *const types[] = {&gas_medium, &segregation_medium, &grains_medium, &dem_medium};
    const int ntypes = sizeof types / sizeof *types;
    const struct medium_type *type = types[0];
    for (int i = 1; !e && i < ntypes; i++)
        if (!strcmp(name, types[i]->application)) type = types[i];
    status_free(e);
    dict_free(d);
    return type;
}

/* Says what a round of -fix has shown or made. */
static void say_round(const struct request *o, int n, bool wrong) {
    if (!n)
        printf("%s\n",
               o->write ? "Nothing more has a cure that is certain." : "Nothing here has a cure that is certain.");
    else if (o->write)
        printf("%d change%s made.\n\n", n, n == 1 ? "" : "s");
    else
        printf("Nothing was written;  checkCase -fix -write %s  makes %s%s\n", o->dir,
               n == 1 ? "this change" : "these changes", wrong ? ", and looks for more behind the error." : ".");
}

/* Checks, shows the cures, and with -write makes them and checks again. */
static status mend(const struct request *o, const struct comm *c, anycase_action *action) {
    struct cures *cures;
    if (comm_size(c) > 1) return fail(ERR_INPUT, "-fix is for one rank");
    TRY(allocate(&cures, 1, sizeof *cures, "cures"));
    status e = OK;
    for (int round = 0, n = 1; n && round < MOST_ROUNDS; round++) {
        status_free(e);
        cures->n = 0;
        e = action(o->dir, medium_of(o->dir), (struct case_reading){.strict = o->strict, .cures = cures}, c);
        if (e) fix_from_error(e, cures);
        status failed = fix_files(o->dir, cures, o->write, &n);
        say_round(o, n, e != OK);
        if (failed) {
            status_free(e);
            e = failed;
        }
        if (failed || !o->write) break;
    }
    free(cures);
    return e;
}

int anycase_main(int argc, char **argv, const char *help_text, anycase_action *action, bool mends) {
    struct comm *c = NULL;
    struct request o = {.dir = NULL};
    status s = parse(argc, argv, mends, &o);
    if (!s && (o.help || o.version)) {
        if (o.version) program_version(argv[0]);
        if (o.help) printf("%s", help_text);
        return 0;
    }
    if (!s) s = comm_start(&argc, &argv, &c);
    if (!s && o.fix)
        s = mend(&o, c, action);
    else if (!s)
        s = action(o.dir, medium_of(o.dir), (struct case_reading){.strict = o.strict}, c);
    return program_end(c, s, false);
}
