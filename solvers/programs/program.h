/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The command line of the programs, and how a program ends. */
#ifndef SOLVERS_PROGRAM_H
#define SOLVERS_PROGRAM_H

#include "mesh/base/comm.h"
#include "mesh/format/files.h"
#include "solvers/dict/keywords.h"

struct lookup {         /* -keywords [NAME | -markdown] */
    bool asked, tables; /* tables: of docs/reference.md */
    const char *name;   /* NULL: all keywords */
};
/* Is argv[*i] -keywords? Then *i goes to its last word. */
bool lookup_option(int argc, char **argv, int *i, struct lookup *out);
status lookup_print(const struct lookup *l, keywords_walk *walk, const void *of); /* on standard output */

struct options {
    char dir[PLAIN_PATH]; /* -case DIR; default "."; without links, so that what is written goes through none */
    bool dry_run, strict, debug, help, list_models, list_boundaries, version;
    struct lookup keywords;
    int ranks;   /* -np N; 0: not given */
    int members; /* -ensemble N; 0: not given */
};
/* Helpers for the arguments of any program: option_unknown returns the error for an unknown word, which lists the known
 * ones; option_value takes the word behind argv[*i]. */
status option_unknown(const char *word, const char *const *names, int n);
status option_value(int argc, char **argv, int *i, const char **out);
/* Prints what -version asks for: name, version, compiler, libraries, licence. */
void program_version(const char *argv0);
/* Fails if the folder is not there. */
status case_folder(const char *dir);

/* Reads the options of a solver; the error for an unknown one lists -ensemble only if runs have seeds. */
status options_read(int argc, char **argv, bool seeds, struct options *out);
/* Replaces this process by mpirun -np N of the same program and options, for -np N; returns only if that failed. */
status options_relaunch(int argc, char **argv, const struct options *o);
/* Replaces this process by `haff ensemble`, for -ensemble N; returns only if that failed. */
status options_ensemble(const struct options *o);
/* Fails if mpirun has started far more ranks on this machine than it has processors, before MPI makes them wait for
 * each other; *first: is this process the one that says so? Says in the log if there are more ranks than processors. */
status options_launched(bool *first);
/* Prints an error once (on the root), frees it, ends MPI; returns the exit code. c may be NULL: MPI was not started. */
int program_end(struct comm *c, status s, bool debug);

struct medium_type;
/* The main of a solver for one type of medium. */
int solver_main(int argc, char **argv, const struct medium_type *type);

#endif
