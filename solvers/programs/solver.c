/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The main of a solver, whatever its medium: options, lists, relaunch under mpirun, check or run. */
#include "solvers/case/blockmesh.h"
#include "solvers/functions/functions.h"
#include "solvers/programs/program.h"
#include "solvers/programs/run.h"

static void go_through(struct keywords *k, const void *type) {
    control_keywords(k);
    blockmesh_keywords(k);
    functions_keywords(k, type);
    ((const struct medium_type *)type)->keywords(k);
}

static const char common_options[] =
    "  -dry-run     reads and checks everything, says what a run would do, writes nothing (see checkCase)\n"
    "  -strict      warnings are errors, but for those of  acceptWarnings (NAME ..);  in system/controlDict\n"
    "  -listModels  models, schemes and function objects with their parameters\n"
    "  -listBCs     boundary conditions\n"
    "  -keywords    every keyword of every file with type, range, default, meaning; or those named NAME\n"
    "  -debug       the way an error took through the program\n"
    "  -version     version, compiler, licence\n";

static void print_help(const struct medium_type *type) {
    printf("%s -case DIR %s [-dry-run] [-strict] [-debug] [-listModels] [-listBCs] [-keywords [NAME]] [-version] "
           "[-help]\n\n%s\n%s%s\n%s",
           type->application, type->help->usage, type->help->about, type->help->own, common_options, type->help->end);
}

int solver_main(int argc, char **argv, const struct medium_type *type) {
    struct options o;
    struct comm *c = NULL;
    status s = options_read(argc, argv, type->seeds, &o);
    if (s) return program_end(NULL, s, false);
    if (o.keywords.asked) return program_end(NULL, lookup_print(&o.keywords, go_through, type), o.debug);
    if (o.help || o.list_models || o.list_boundaries || o.version) {
        if (o.version) program_version(argv[0]);
        if (o.help) print_help(type);
        if (o.list_models) {
            type->list_models(stdout);
            printf("\nsystem/controlDict: functions\n");
            functions_list(type, stdout);
        }
        if (o.list_boundaries) type->list_boundaries(stdout);
        return 0;
    }
    if (o.members && !type->seeds)
        s = fail(ERR_INPUT, "-ensemble %d: %s has no seed, so that all members would be the same run", o.members,
                 type->application);
    else if (o.members && !o.dry_run)
        s = options_ensemble(&o);
    if (s) return program_end(NULL, s, o.debug);
    if (o.members) o.ranks = 0; /* a dry run of one member */
    if (o.ranks > 1 && !type->starts) return program_end(NULL, options_relaunch(argc, argv, &o), o.debug);
    bool first;
    s = options_launched(&first);
    if (s && !first) {
        status_free(s);
        return ERR_INPUT;
    }
    if (s) return program_end(NULL, s, o.debug);
    s = comm_start(&argc, &argv, &c);
    if (!s)
        s = (o.dry_run ? run_check : run_case)(o.dir, type, (struct case_reading){.strict = o.strict, .ranks = o.ranks},
                                               c);
    return program_end(c, s, o.debug);
}
