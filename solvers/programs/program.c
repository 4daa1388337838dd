/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the solvers' command line, starts mpirun for -np, and ends a program (program.h). */
#include "solvers/programs/program.h"

#include "mesh/base/build.h"
#include "solvers/dict/dict.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { NAMES = 10, VALUES = 3 };               /* options of a solver, but -keywords; the first ones have a value */
enum { MOST_STARTED = 8, MOST_LAUNCHED = 64 }; /* ranks for a processor: by -np, and by mpirun, which tests overload */

status option_unknown(const char *word, const char *const *names, int n) {
    char known[512] = "", meant[MEANT];
    for (int i = 0; i < n; i++) {
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, " %s", names[i]);
    }
    return fail(ERR_INPUT, "unknown argument '%s'%s; known are%s (more with -help)", word,
                name_question(word, names, n, meant), known);
}

void program_version(const char *argv0) {
    const char *slash = strrchr(argv0, '/');
    printf("%s %s\ncompiler  %s\nPETSc     %s\n\n", slash ? slash + 1 : argv0, build_version(), build_compiler(),
           build_petsc() ? "yes, for implicit diffusion" : "no: built without implicit diffusion");
    printf("Licence GPL-3.0-or-later: GNU GPL version 3 or later <https://www.gnu.org/licenses/gpl-3.0.html>.\n"
           "This is free software: you may change and pass it on. There is NO WARRANTY, as far as the law permits.\n");
}

status case_folder(const char *dir) {
    struct stat info;
    if (stat(dir, &info)) return fail(ERR_INPUT, "%s: no such folder; give that of a case", dir);
    return S_ISDIR(info.st_mode) ? OK : fail(ERR_INPUT, "%s: is no folder; give that of a case", dir);
}

status option_value(int argc, char **argv, int *i, const char **out) {
    if (*i + 1 >= argc) return fail(ERR_INPUT, "option %s wants a value; see -help", argv[*i]);
    *out = argv[++*i];
    return OK;
}

bool lookup_option(int argc, char **argv, int *i, struct lookup *out) {
    const char *word = argv[*i], *next = *i + 1 < argc ? argv[*i + 1] : "-";
    if (strcmp(word, "-keywords") && strcmp(word, "--keywords")) return false;
    out->asked = true;
    out->tables = !strcmp(next, "-markdown");
    if (*next != '-') out->name = next;
    *i += out->tables || out->name;
    return true;
}

status lookup_print(const struct lookup *l, keywords_walk *walk, const void *of) {
    if (!l->tables) return keywords_print(stdout, walk, of, l->name);
    keywords_print_tables(stdout, walk, of);
    return OK;
}

static long count_processors(void) {
    const long found = sysconf(_SC_NPROCESSORS_ONLN);
    return found > 0 ? found : 1;
}

/* Refuses more than `each` ranks for a processor of this machine: beyond a few they only wait for each other. */
static status check_ranks(long n, long each) {
    const long processors = count_processors(), most = each * processors;
    if (n <= most) return OK;
    return fail(
        ERR_INPUT,
        "-np %ld: this machine has %ld processor%s, so that more than %ld ranks would only wait for each other: "
        "say  -np %ld;  on several machines start  mpirun -hostfile FILE granularGas ..",
        n, processors, processors == 1 ? "" : "s", most, processors);
}

/* Returns the number that one of two variables of the environment has, or -1. Open MPI sets the first, MPICH the
 * second. */
static long launched(const char *openmpi, const char *mpich) {
    const char *text = getenv(openmpi) ? getenv(openmpi) : getenv(mpich);
    return text ? atol(text) : -1;
}

status options_launched(bool *first) {
    const long n = launched("OMPI_COMM_WORLD_LOCAL_SIZE", "MPI_LOCALNRANKS"), processors = count_processors();
    *first = launched("OMPI_COMM_WORLD_RANK", "PMI_RANK") <= 0;
    TRY(check_ranks(n, MOST_LAUNCHED));
    if (*first && n > processors)
        printf("%ld ranks share %ld processor%s and wait for each other: %ld of them take less time\n", n, processors,
               processors == 1 ? "" : "s", processors);
    return OK;
}

/* OpenFOAM's option -parallel goes with mpirun, which then has said how many ranks there are. */
static status check_parallel(void) {
    if (launched("OMPI_COMM_WORLD_RANK", "PMI_RANK") >= 0) return OK;
    return fail(ERR_INPUT,
                "-parallel: the number of ranks is to be given: say  -np N  in its place, or start  mpirun -np N "
                "granularGas ..;  the case needs no decomposePar");
}

/* Takes the value of -case, -np or -ensemble. */
static status take_value(const char *name, const char *value, struct options *out) {
    char *end = NULL;
    if (!strcmp(name, "-case")) return folder_plain(value, out->dir);
    const bool ranks = !strcmp(name, "-np");
    const long n = strtol(value, &end, 10), least = ranks ? 1 : 2;
    if (*end || end == value || n < least || n > 1000000)
        return fail(ERR_INPUT, "%s %s: the number of %s is a whole number from %ld on", name, value,
                    ranks ? "ranks" : "members", least);
    if (ranks) TRY(check_ranks(n, MOST_STARTED));
    *(ranks ? &out->ranks : &out->members) = (int)n;
    return OK;
}

status options_read(int argc, char **argv, bool seeds, struct options *out) {
    static const char *const names[] = {"-ensemble", "-case",       "-np",      "-dry-run", "-strict",  "-debug",
                                        "-help",     "-listModels", "-listBCs", "-version", "-keywords"};
    *out = (struct options){.dir = "."};
    bool *const flags[] = {&out->dry_run,     &out->strict,          &out->debug,  &out->help,
                           &out->list_models, &out->list_boundaries, &out->version};
    for (int i = 1; i < argc; i++) {
        int k = 0;
        if (lookup_option(argc, argv, &i, &out->keywords)) continue;
        const char *word = !strncmp(argv[i], "--", 2) ? argv[i] + 1 : argv[i], *value = NULL;
        if (!strcmp(word, "-h")) word = "-help";
        if (!strcmp(word, "-parallel")) {
            TRY(check_parallel());
            continue;
        }
        while (k < NAMES && strcmp(word, names[k])) k++;
        if (k == NAMES) return option_unknown(argv[i], names + !seeds, NAMES + seeds);
        if (k >= VALUES) {
            *flags[k - VALUES] = true;
            continue;
        }
        TRY(option_value(argc, argv, &i, &value));
        TRY(take_value(names[k], value, out));
    }
    const bool asks = out->help || out->list_models || out->list_boundaries || out->version || out->keywords.asked;
    return asks ? OK : case_folder(out->dir);
}

status options_ensemble(const struct options *o) {
    char members[16], cores[16], haff[4096];
    if (o->strict || o->debug) return fail(ERR_INPUT, "-ensemble goes with -case, -np and -dry-run alone");
    snprintf(members, sizeof members, "%d", o->members);
    snprintf(cores, sizeof cores, "%d", o->ranks ? o->ranks : 1);
    if (!build_companion("haff", sizeof haff, haff))
        return fail(ERR_SYSTEM, "-ensemble: the command haff, which runs the members, is not beside this program; "
                                "build or install haff as a whole");
    fflush(NULL);
    execl(haff, haff, "ensemble", o->dir, "-members", members, "-cores", cores, (char *)NULL);
    return fail(ERR_SYSTEM, "%s cannot be started: %s", haff, strerror(errno));
}

status options_relaunch(int argc, char **argv, const struct options *o) {
    char number[16], wrapper[4096];
    char **command = NULL;
    const bool ours = build_companion("mpirun", sizeof wrapper, wrapper); /* it needs no flags; else any mpirun */
    TRY(allocate(&command, argc + 8L, sizeof *command, "command line"));
    int n = 0;
    snprintf(number, sizeof number, "%d", o->ranks);
    command[n++] = ours ? wrapper : "mpirun";
    command[n++] = "-np";
    command[n++] = number;
    for (int i = 0; i < argc; i++)
        if (i && (!strcmp(argv[i], "-np") || !strcmp(argv[i], "--np")))
            i++;
        else
            command[n++] = argv[i];
    fflush(NULL);
    execvp(command[0], command);
    int reason = errno;
    free(command);
    return fail(ERR_SYSTEM, "mpirun cannot be started: %s; on Debian, run  apt-get install openmpi-bin",
                strerror(reason));
}

/* Warns if the log could not be written, except to a pipe: a pipe without a reader was closed on purpose. */
static void check_log(void) {
    struct stat info;
    bool failed = fflush(stdout) || ferror(stdout);
    if (!failed || fstat(STDOUT_FILENO, &info) || S_ISFIFO(info.st_mode) || S_ISSOCK(info.st_mode)) return;
    fprintf(stderr, "note: standard output could not be written (is its disk full?): the log is incomplete, the "
                    "written times are whole\n");
}

int program_end(struct comm *c, status s, bool debug) {
    int code = s ? (int)status_kind(s) : 0;
    check_log();
    if (s && (!c || comm_root(c))) code = status_print(s, debug);
    status_free(s);
    if (c) comm_finish(c);
    return code;
}
