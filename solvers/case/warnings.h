/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Warnings: what a case says and its user hardly means, though it can be run. A warning has a name, by which
 * `acceptWarnings (NAME ..);` in system/controlDict accepts it; -strict makes an error of each that is not accepted. */
#ifndef SOLVERS_WARNINGS_H
#define SOLVERS_WARNINGS_H

#include "mesh/base/status.h"
#include <stddef.h>

/* What they mean: warning_meanings. */
enum warning {
    WARN_HEADER,
    WARN_VERSION,
    WARN_UNEVALUATED,
    WARN_SCHEME,
    WARN_NARROW,
    WARN_OLD_MESH,
    WARN_IDLE,
    WARN_GRAIN_SIZE,
    WARN_FEW_GRAINS,
    WARN_RAREFIED,
    WARN_TEMPERATURE,
    WARN_SHAPE,
    WARN_LONG_STEP,
    WARN_COLLAPSE,
    WARN_FRICTION,
    WARN_DAMPED,
    WARN_PICTURE,
    WARN_OUTSIDE,
    WARN_PASSED,
    WARN_BESIDE,
    WARN_UNREAD,
    WARN_WRONG_HEADER,
    WARN_UPWARDS,
    WARN_SHAKING,
    WARN_ELASTIC,
    WARN_DENSITY,
    WARN_FIXED_STEP,
    WARN_MANY_STEPS,
    WARN_NOTHING_WRITTEN,
    WARN_MANY_WRITES,
    WARN_LONG_CONTACT_STEP,
    WARN_SOFT_GRAINS,
    WARN_SOFT_THRESHOLD,
    WARN_NO_LAMMPS,
    WARNINGS
};
extern const char *const warning_names[WARNINGS];
extern const char *const warning_meanings[WARNINGS]; /* for the reference of all keywords */

/* A change of the case's files that cures a mistake for certain: `checkCase -fix` shows and makes it. */
enum cure_kind {
    CURE_WORD,  /* in the line, the word `from` becomes `to` */
    CURE_VALUE, /* in the line, the key `from` gets the value `to` */
    CURE_ENTRY, /* in the line, the entry of the key `from` goes */
    CURE_FILE   /* the file becomes `to`, another path */
};
struct cure {
    enum cure_kind kind;
    char path[1024];
    int line;
    char from[128], to[1024];
};
enum { MOST_CURES = 64 };
struct cures {
    int n;
    struct cure cure[MOST_CURES];
};

struct warnings {
    bool strict;          /* is a warning that is not accepted an error? */
    bool silent;          /* does another rank print? */
    const bool *accepted; /* [WARNINGS] those that controlDict accepts; borrowed */
    bool said[WARNINGS];  /* was it said without being accepted? */
    struct cures *cures;  /* gets the cures; NULL: none are wanted */
};
/* Prints "warning: FILE:LINE: .. [NAME]", or "accepted warning: ..": `format` begins with the place. Fails if the
 * warning is an error. Every rank calls this alike. */
status warn(struct warnings *w, enum warning id, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* Notes the cure of a warning, unless that is accepted or no cures are wanted. `to` may be NULL with CURE_ENTRY. */
void warn_cure(struct warnings *w, enum warning id, enum cure_kind kind, const char *path, int line, const char *from,
               const char *to);
/* Returns how many kinds of warnings were said without being accepted, and lists their names. */
int warnings_said(const struct warnings *w, char *names, size_t room);

struct dict;
struct field;
status warn_passed(struct warnings *w, const struct dict *d); /* of function objects that were passed over */
/* Warns of a file (NULL: none) without a FoamFile header, or with one that names another class than `class_name` or
 * another object than the file. */
status warn_header(struct warnings *w, const struct dict *d, const char *class_name);
/* Warns of a field (NULL: none) that only these programs can read: without header, or by an expression and not in
 * 0.orig, which `original` says. */
status warn_field(struct warnings *w, const struct field *f, bool original);

#endif
