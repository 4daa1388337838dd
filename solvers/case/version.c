/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compares the version that a case was written for with that of the programs (version.h). */
#include "solvers/case/version.h"

#include "mesh/base/build.h"
#include "mesh/format/foamfile.h"
#include "solvers/case/case.h"

#include <stdio.h>
#include <string.h>

/* A default that has changed: it matters to a case with the entry `with` (of the value `as`, NULL: any but `none`) that
 * lacks the entry `without`. Entries stand in dictionaries as DICT/KEY. */
struct change {
    struct version since;
    const char *application;
    struct {
        const char *file, *entry, *as;
    } with;
    struct {
        const char *file, *entry;
    } without;
    const char *now, *name; /* what it means now; what to write to have the old meaning */
};
static const struct change changes[] = {
    {{0, 2},
     "granularGas",
     {"granularProperties", "grain/thresholdSpeed", NULL},
     {"fvSolution", "acoustics"},
     "gas that comes to rest near packing takes implicit steps",
     "acoustics { type explicit; }"},
    {{0, 2},
     "granularGas",
     {"granularProperties", "transport", NULL},
     {"fvSolution", "diffusion"},
     "diffusion takes the stages of RKJ2",
     "diffusion { type RKL2; }"},
    {{0, 2},
     "granularGas",
     {"granularProperties", "equationOfState", "TorquatoDisks"},
     {"granularProperties", "TorquatoDisksCoeffs/tangent"},
     "the pressure diverges at alphaMax",
     "TorquatoDisksCoeffs { tangent yes; }"},
    {{0, 2},
     "granularGas",
     {"granularProperties", "equationOfState", "TorquatoSpheres"},
     {"granularProperties", "TorquatoSpheresCoeffs/tangent"},
     "the pressure diverges at alphaMax",
     "TorquatoSpheresCoeffs { tangent yes; }"},
    {{0, 2},
     "granularGas",
     {"fvSchemes", "fluxScheme", "common"},
     {"fvSchemes", "commonCoeffs"},
     "strong shocks, steep expansions and dense contacts on lattices follow rules of their own",
     "commonCoeffs { shocks off; expansions off; contacts off; }"},
    {{0, 3},
     "granularGas",
     {"fvSchemes", "fluxScheme", "common"},
     {"fvSchemes", "commonCoeffs"},
     "entropy and shears are damped beside fronts of shocks in 2D and 3D",
     "commonCoeffs { fronts off; }"},
};

static bool is_older(struct version a, struct version b) {
    return a.major < b.major || (a.major == b.major && a.minor < b.minor);
}

/* Reads "0.2" or "0.2.1" at text[0 .. n]. */
static bool parse(const char *text, int n, struct version *v) {
    int patch, end = 0;
    const int found = sscanf(text, "%4d.%4d%n.%4d%n", &v->major, &v->minor, &end, &patch, &end);
    return found >= 2 && end == n && v->major >= 0 && v->minor >= 0;
}

status version_read(struct dict *control, struct version *out) {
    struct lexer l;
    struct token t, next;
    struct version own;
    const char *const number = build_number();
    *out = (struct version){0};
    if (!dict_has(control, "haffVersion")) return OK;
    TRY(dict_raw(control, "haffVersion", &l));
    TRY(lexer_next(&l, &t));
    TRY(lexer_peek(&l, &next));
    if (!parse(t.text, t.length, out) || !token_is(&next, ";"))
        return dict_fail(control, "haffVersion", "expected the version of haff that the case was written for: 0.2");
    if (!parse(number, (int)strlen(number), &own) || !is_older(own, *out)) return OK;
    return dict_fail(control, "haffVersion",
                     "the case was written for a newer haff than this, %s: get haff %d.%d, or, if the case uses "
                     "nothing that is newer, say  haffVersion %d.%d;",
                     number, out->major, out->minor, own.major, own.minor);
}

static struct dict *file_of(const struct setup *s, const char *name) {
    for (int i = 0; i < s->nfiles; i++)
        if (!strcmp(s->file[i].name, name)) return s->file[i].dict;
    return NULL;
}

/* Finds the dictionary that an entry stands in; NULL: the entry is not there. *key is the last part of its name. */
static status entry_holder(struct dict *d, const char *entry, const char **key, struct dict **out) {
    const char *const slash = strchr(entry, '/');
    char sub[64];
    *out = NULL;
    *key = slash ? slash + 1 : entry;
    if (d && slash) {
        snprintf(sub, sizeof sub, "%.*s", (int)(slash - entry), entry);
        TRY(dict_sub_optional(d, sub, &d));
    }
    if (d && dict_has(d, *key)) *out = d;
    return OK;
}

/* Does the row matter to the case? */
static status matters(const struct setup *s, const struct change *row, bool *out) {
    const char *key, *word;
    struct dict *d;
    *out = false;
    if (!is_older(s->control->written, row->since) || strcmp(s->medium->type->application, row->application)) return OK;
    TRY(entry_holder(file_of(s, row->without.file), row->without.entry, &key, &d));
    if (d) return OK;
    TRY(entry_holder(file_of(s, row->with.file), row->with.entry, &key, &d));
    if (!d) return OK;
    *out = true;
    if (strchr(row->with.entry, '/')) return OK; /* the entry is a number: that it is there counts */
    TRY(dict_word(d, key, &word));
    *out = row->with.as ? !strcmp(word, row->with.as) : strcmp(word, "none") != 0;
    return OK;
}

status version_warn(struct setup *s) {
    const struct version was = s->control->written;
    const struct dict *d = s->control->dict;
    if (!was.major && !was.minor) return OK;
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        const struct change *row = &changes[i];
        bool yes;
        TRY(matters(s, row, &yes));
        if (yes)
            TRY(warn(&s->warnings, WARN_VERSION,
                     "%s:%d: the case was written for haff %d.%d, and since %d.%d %s where %s does not say else: say  "
                     "%s  there to have it as it was, or  haffVersion %d.%d;  for how it is",
                     dict_path(d), dict_line(d, "haffVersion"), was.major, was.minor, row->since.major,
                     row->since.minor, row->now, row->without.file, row->name, row->since.major, row->since.minor));
    }
    return OK;
}
