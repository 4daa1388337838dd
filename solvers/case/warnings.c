/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Says warnings, and remembers which (warnings.h). */
#include "solvers/case/warnings.h"

#include "mesh/format/foamfile.h"
#include "solvers/case/fields.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

const char *const warning_names[WARNINGS] = {
    [WARN_HEADER] = "noHeader",
    [WARN_UNEVALUATED] = "unevaluated",
    [WARN_SCHEME] = "unusedScheme",
    [WARN_NARROW] = "narrowCell",
    [WARN_GRAIN_SIZE] = "largeGrains",
    [WARN_FEW_GRAINS] = "fewGrains",
    [WARN_RAREFIED] = "rarefied",
    [WARN_TEMPERATURE] = "temperature",
    [WARN_SHAPE] = "otherShape",
    [WARN_LONG_STEP] = "longTimeStep",
    [WARN_COLLAPSE] = "collapse",
    [WARN_FRICTION] = "noFriction",
    [WARN_PICTURE] = "noPicture",
    [WARN_VERSION] = "olderVersion",
    [WARN_OLD_MESH] = "oldMesh",
    [WARN_IDLE] = "idleRanks",
    [WARN_OUTSIDE] = "openSide",
    [WARN_DAMPED] = "dampedSound",
    [WARN_UNREAD] = "unreadFile",
    [WARN_WRONG_HEADER] = "wrongHeader",
    [WARN_UPWARDS] = "upwardGravity",
    [WARN_SHAKING] = "faintShaking",
    [WARN_ELASTIC] = "elasticGrains",
    [WARN_DENSITY] = "heavyGrains",
    [WARN_FIXED_STEP] = "fixedStep",
    [WARN_MANY_STEPS] = "manySteps",
    [WARN_NOTHING_WRITTEN] = "nothingWritten",
    [WARN_PASSED] = "passedOver",
    [WARN_BESIDE] = "newerStart",
    [WARN_MANY_WRITES] = "manyWrites",
    [WARN_LONG_CONTACT_STEP] = "longContactStep",
    [WARN_SOFT_GRAINS] = "softGrains",
    [WARN_SOFT_THRESHOLD] = "softThreshold",
    [WARN_NO_LAMMPS] = "noLammps",
};

const char *const warning_meanings[WARNINGS] = {
    [WARN_HEADER] = "a file lacks the FoamFile header",
    [WARN_VERSION] = "what an entry that is left out means has changed since the haffVersion of the case",
    [WARN_UNEVALUATED] = "the start is given by expressions in a folder that other programs read",
    [WARN_SCHEME] = "the scheme that is given is for the other kind of mesh",
    [WARN_NARROW] = "a cell is far narrower than the others",
    [WARN_OLD_MESH] = "constant/polyMesh is older than system/blockMeshDict, which then does not count",
    [WARN_IDLE] = "there are more ranks than parts of the mesh to deal to them",
    [WARN_GRAIN_SIZE] = "grains are wider than cells, or than the domain",
    [WARN_FEW_GRAINS] = "cells hold less than a grain",
    [WARN_RAREFIED] = "the mean free path is no small part of the domain",
    [WARN_TEMPERATURE] = "T is far from the square of every other speed",
    [WARN_SHAPE] = "the gas of the case is one of spheres and its grains are disks, or the other way round",
    [WARN_LONG_STEP] = "deltaT is longer than the time scheme allows",
    [WARN_COLLAPSE] = "grains hit each other too slowly to part again: inelastic collapse",
    [WARN_FRICTION] = "dense gas is slow under gravity, and the case has no friction",
    [WARN_OUTSIDE] = "U leads along a side that is open, as the state outside is given there",
    [WARN_DAMPED] = "`acoustics implicit` damps waves in dense gas",
    [WARN_PASSED] = "a function object that is OpenFOAM's, by #includeFunc, is passed over",
    [WARN_BESIDE] = "the start is a 0 that no run wrote, as mapFields or setFields make it",
    [WARN_PICTURE] = "a picture of function object image could not be made",
    [WARN_UNREAD] = "nothing reads a file in constant, system or the folder of the start",
    [WARN_WRONG_HEADER] = "the FoamFile header names another class, or another object, than that of the file",
    [WARN_UPWARDS] = "gravity points upwards: along the last solved axis, in two or three dimensions",
    [WARN_SHAKING] = "a plate is shaken so faintly that the layer never leaves it, or that a grain does not notice it",
    [WARN_ELASTIC] = "restitution is below 1, but cooling none or a high thresholdSpeed makes impacts elastic; or "
                     "cooling is given, and no "
                     "restitution",
    [WARN_DENSITY] = "a grain is denser than any metal, or lighter than air; mass 1 counts grains and is fine",
    [WARN_FIXED_STEP] = "maxDeltaT is below deltaT with adjustTimeStep no, where it does not count",
    [WARN_MANY_STEPS] = "there are more than 1e7 steps to endTime",
    [WARN_NOTHING_WRITTEN] = "no time is written before endTime, or a function object writes nothing behind the start",
    [WARN_LONG_CONTACT_STEP] = "the steps of soft grains are longer than a thirtieth of a contact",
    [WARN_SOFT_GRAINS] = "soft grains at rest overlap by more than a hundredth of their diameter",
    [WARN_NO_LAMMPS] = "the program lmp, which granularDEM runs, is missing or lacks a package",
    [WARN_SOFT_THRESHOLD] = "thresholdSpeed is given, which soft grains do not have",
    [WARN_MANY_WRITES] = "more than 1e5 times are written, and purgeWrite keeps them all",
};

status warn(struct warnings *w, enum warning id, const char *format, ...) {
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    const bool accepted = w->accepted[id];
    const char *name = warning_names[id];
    if (!accepted && w->strict)
        return fail(ERR_INPUT, "%s (-strict: warning %s; to accept it say  acceptWarnings (%s);  in controlDict)", text,
                    name, name);
    if (!w->silent) printf("%s: %s [%s]\n", accepted ? "accepted warning" : "warning", text, name);
    w->said[id] |= !accepted;
    return OK;
}

void warn_cure(struct warnings *w, enum warning id, enum cure_kind kind, const char *path, int line, const char *from,
               const char *to) {
    if (!w->cures || w->accepted[id] || w->cures->n == MOST_CURES) return;
    struct cure *c = &w->cures->cure[w->cures->n++];
    *c = (struct cure){.kind = kind, .line = line};
    snprintf(c->path, sizeof c->path, "%s", path);
    snprintf(c->from, sizeof c->from, "%s", from);
    snprintf(c->to, sizeof c->to, "%s", to ? to : "");
}

/* Warns of a word of the header that is given, and is not `right`. */
static status check_word(struct warnings *w, const struct dict *d, const char *key, const char *given, int line,
                         const char *right) {
    if (!*given || !strcmp(given, right)) return OK;
    warn_cure(w, WARN_WRONG_HEADER, CURE_VALUE, dict_path(d), line, key, right);
    return warn(w, WARN_WRONG_HEADER,
                "%s:%d: FoamFile: %s is %s, but the file is of %s %s: OpenFOAM's programs take it for another one; "
                "write  %s %s;",
                dict_path(d), line, key, given, key, right, key, right);
}

status warn_header(struct warnings *w, const struct dict *d, const char *class_name) {
    char name[256];
    if (!d) return OK;
    const struct foam_header *h = dict_header(d);
    const char *slash = strrchr(dict_path(d), '/');
    if (!h->present)
        return warn(w, WARN_HEADER,
                    "%s:1: the file has no FoamFile { .. } header, without which OpenFOAM's programs and ParaView "
                    "cannot read the case",
                    dict_path(d));
    if (dict_is_outside(d)) return OK;
    snprintf(name, sizeof name, "%s", slash ? slash + 1 : dict_path(d));
    const size_t length = strlen(name);
    if (length > 3 && !strcmp(name + length - 3, ".gz")) name[length - 3] = 0;
    TRY(check_word(w, d, "class", h->class_name, h->class_line, class_name));
    return check_word(w, d, "object", h->object, h->object_line, name);
}

status warn_passed(struct warnings *w, const struct dict *d) {
    const char *what;
    for (int i = 0; (what = dict_passed(d, i)); i++)
        TRY(warn(w, WARN_PASSED,
                 "%s is passed over: there is no such file in that folder, and OpenFOAM's own are not haff's; "
                 "granularGas -listModels lists the function objects that are",
                 what));
    return OK;
}

status warn_field(struct warnings *w, const struct field *f, bool original) {
    if (!f) return OK;
    TRY(warn_header(w, f->dict, f->kind->components == 3 ? "volVectorField" : "volScalarField"));
    if (original || !(f->plan.changes || dict_has(f->dict, "expression"))) return OK;
    return warn(
        w, WARN_UNEVALUATED,
        "%s:%d: the field is not given by values alone, so that other programs cannot show the start: rename the "
        "folder to 0.orig, from which a run, or initialFields, writes 0",
        dict_path(f->dict), dict_line(f->dict, f->plan.fills ? f->plan.fills : "expression"));
}

int warnings_said(const struct warnings *w, char *names, size_t room) {
    int n = 0;
    *names = 0;
    for (int i = 0; i < WARNINGS; i++) {
        if (!w->said[i]) continue;
        const size_t used = strlen(names);
        snprintf(names + used, room - used, "%s%s", n++ ? " " : "", warning_names[i]);
    }
    return n;
}
