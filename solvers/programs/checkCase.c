/* checkCase: checks all that a solver's -dry-run checks. */
#include "solvers/programs/program.h"
#include "solvers/programs/run.h"

#include <string.h>

static const char HELP[] =
    "checkCase DIR [-strict]\n\nReads and checks the whole case: dictionaries, mesh, fields, function objects. Writes "
    "nothing.\n\n"
    "  -strict  warnings are errors, but for those of  acceptWarnings (NAME ..);  in system/controlDict\n\n"
    "Exit code 0: sound, or with warnings, which it counts; 1: not.\n";

static status parse(int argc, char **argv, const char **dir, bool *help, bool *strict) {
    static const char *const names[] = {"DIR", "-case", "-strict", "-help"};
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "-help") || !strcmp(argv[i], "--help"))
            *help = true;
        else if (!strcmp(argv[i], "-strict"))
            *strict = true;
        else if (!strcmp(argv[i], "-case"))
            TRY(option_value(argc, argv, &i, dir));
        else if (*argv[i] == '-' || *dir)
            return option_unknown(argv[i], names, 4);
        else
            *dir = argv[i];
    if (*help) return OK;
    return *dir ? case_folder(*dir) : fail(ERR_INPUT, "which case? usage: checkCase DIR");
}

/* Returns the medium that controlDict's `application` names; run_check reports errors of that file. */
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

int main(int argc, char **argv) {
    struct comm *c = NULL;
    const char *dir = NULL;
    bool help = false, strict = false;
    status s = parse(argc, argv, &dir, &help, &strict);
    if (!s && help) {
        printf("%s", HELP);
        return 0;
    }
    if (!s) s = comm_start(&argc, &argv, &c);
    if (!s) s = run_check(dir, medium_of(dir), strict, c);
    return program_end(c, s, false);
}
