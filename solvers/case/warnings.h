/* Warnings: what a case says and its user hardly means, though it can be run. A warning has a name, by which
 * `acceptWarnings (NAME ..);` in system/controlDict accepts it; -strict makes an error of each that is not accepted. */
#ifndef SOLVERS_WARNINGS_H
#define SOLVERS_WARNINGS_H

#include "mesh/base/status.h"
#include <stddef.h>

enum warning {
    WARN_HEADER,      /* a file lacks the FoamFile header */
    WARN_UNEVALUATED, /* a start by expressions stands in a folder that other programs read */
    WARN_SCHEME,      /* the scheme that is given is for the other kind of mesh */
    WARN_NARROW,      /* a cell is far narrower than the others */
    WARN_GRAIN_SIZE,  /* grains are wider than cells, or than the domain */
    WARN_FEW_GRAINS,  /* cells hold less than a grain */
    WARN_RAREFIED,    /* the mean free path is no small part of the domain */
    WARN_TEMPERATURE, /* T is far from the square of every other speed */
    WARN_SHAPE,       /* the gas of the case is one of spheres and its grains are disks, or the other way round */
    WARN_LONG_STEP,   /* deltaT is longer than the time scheme allows */
    WARN_COLLAPSE,    /* grains hit each other too slowly to part again: inelastic collapse */
    WARN_FRICTION,    /* dense gas is slow, where real grains would hold each other */
    WARNINGS
};
extern const char *const warning_names[WARNINGS];
extern const char *const warning_meanings[WARNINGS]; /* for the reference of all keywords */

struct warnings {
    bool strict;          /* is a warning that is not accepted an error? */
    bool silent;          /* does another rank print? */
    const bool *accepted; /* [WARNINGS] those that controlDict accepts; borrowed */
    bool said[WARNINGS];  /* was it said without being accepted? */
};
/* Prints "warning: FILE:LINE: .. [NAME]", or "accepted warning: ..": `format` begins with the place. Fails if the
 * warning is an error. Every rank calls this alike. */
status warn(struct warnings *w, enum warning id, const char *format, ...) __attribute__((format(printf, 3, 4)));
/* Returns how many kinds of warnings were said without being accepted, and lists their names. */
int warnings_said(const struct warnings *w, char *names, size_t room);

struct dict;
struct field;
status warn_header(struct warnings *w, const struct dict *d); /* of a file without a FoamFile header; d may be NULL */
/* Warns of a field (NULL: none) that only these programs can read: without header, or by an expression and not in
 * 0.orig, which `original` says. */
status warn_field(struct warnings *w, const struct field *f, bool original);

#endif
