/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of parameters: they drive reading, range and unit errors, -listModels, -keywords, checkCase and
 * docs/reference.md.
 *
 * A row says name, member, default, range, unit and meaning; PARAM_STRUCT names the struct whose members are filled:
 *   #define PARAM_STRUCT struct material
 *   NUMBER("diameter", diameter, REQUIRED, POSITIVE, UNIT(0, 1, 0), "grain diameter"),
 *   WHOLE("seed", seed, 1, FROM_TO(0, 2e9), "of the random places"),
 *   SWITCH("printedSoundSpeed", printed_sound, false, "sound speed as printed"),
 *   VECTOR("axis", axis, 0, FROM_TO(-1, 1), NO_UNIT, "of rotation"),
 *   CHOICE("bulk", bulk, 0, bulk_words, "viscosity by the contact integral, or twice that"),
 *   EITHER("writeFormat", binary, false, format_words, "of the fields"),
 *   ONLY("interpolationScheme", 0, scheme_words, "values are those of the cell"),
 * A key that has a reader of its own, or that is for other programs, stands in the table of its dictionary, too, so
 * that the reference of all keywords (solvers/dict/keywords.h) knows it: NOTED("functions", "dictionary", "none",
 * "function objects by name", "functions { p1 { type probes; } }"), IGNORED("libs", "for OpenFOAM's programs: nothing
 * is loaded"), */
#ifndef LIBCORE_PARAM_H
#define LIBCORE_PARAM_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

enum param_kind {
    PARAM_NUMBER, /* double */
    PARAM_WHOLE,  /* int */
    PARAM_SWITCH, /* bool */
    PARAM_VECTOR, /* double[3] */
    PARAM_CHOICE, /* int or enum: index into the words */
    PARAM_EITHER, /* bool: has the word an odd index among the words? */
    PARAM_ONLY,   /* nothing is filled: the word is checked */
    PARAM_NOTED,  /* nothing is filled: the key has a reader of its own */
    PARAM_IGNORED /* nothing is filled: the key, and all below it, is for other programs */
};
struct param {
    const char *name;
    enum param_kind kind;
    size_t offset;            /* offset of the member in the struct that is filled */
    double standard;          /* default; NAN: it must be given; of a choice: the index, < 0: no word */
    double low, high;         /* range allowed, both ends included unless open */
    bool open;                /* are low and high themselves excluded? */
    signed char unit[3];      /* exponents of kg, m, s */
    const char *const *words; /* the words of a choice, ended by NULL */
    const char *meaning;      /* one line for lists and messages */
    /* For the reference, where NULL stands for what the members above say: the type as a user writes it, the default,
     * and an entry, whole with its ';'. */
    const char *type, *usual, *example;
};

/* What a case may hold besides 0: products of a few such numbers are finite, and not 0. */
#define MOST_NUMBER  1e60
#define LEAST_NUMBER 1e-60

/* Defaults, ranges and units of rows. */
#define REQUIRED              NAN
#define REQUIRED_AS(entry)    NAN, .example = entry
#define USUALLY(value, text)  (value), .usual = text /* a default that is better said in words */
#define FROM_TO(least, most)  .low = (least), .high = (most), .open = false
#define BETWEEN(below, above) .low = (below), .high = (above), .open = true
#define POSITIVE              BETWEEN(0, HUGE_VAL)
#define ANY_NUMBER            BETWEEN(-HUGE_VAL, HUGE_VAL)
#define UNIT(kg, m, s)                                                                                                 \
    { kg, m, s }
#define NO_UNIT                                                                                                        \
    { 0, 0, 0 }

#define TABLE_OR_NUMBER ANY_NUMBER, .type = "number, or table ((t v) (t v) ..)"

/* Offset of a member. The compiler refuses a member of another type, since reading would write beyond it. */
#define PARAM_OFFSET(member, type)                                                                                     \
    (offsetof(PARAM_STRUCT, member) + 0 * sizeof(char[_Generic(((PARAM_STRUCT *)0)->member, type : 1, default : -1)]))
#define PARAM_INDEX_OFFSET(member)                                                                                     \
    (offsetof(PARAM_STRUCT, member) +                                                                                  \
     0 * sizeof(char[_Generic(((PARAM_STRUCT *)0)->member, int : 1, unsigned : 1, default                              \
                              : -1)]))
#define NUMBER(key, member, otherwise, range, in, text)                                                                \
    {                                                                                                                  \
        .name = key, .kind = PARAM_NUMBER, .offset = PARAM_OFFSET(member, double), .standard = otherwise, range,       \
        .unit = in, .meaning = text                                                                                    \
    }
#define WHOLE(key, member, otherwise, range, text)                                                                     \
    {                                                                                                                  \
        .name = key, .kind = PARAM_WHOLE, .offset = PARAM_OFFSET(member, int), .standard = otherwise, range,           \
        .meaning = text                                                                                                \
    }
#define SWITCH(key, member, otherwise, text)                                                                           \
    {                                                                                                                  \
        .name = key, .kind = PARAM_SWITCH, .offset = PARAM_OFFSET(member, bool), .standard = otherwise, .high = 1,     \
        .meaning = text                                                                                                \
    }
#define VECTOR(key, member, otherwise, range, in, text)                                                                \
    {                                                                                                                  \
        .name = key, .kind = PARAM_VECTOR, .offset = PARAM_OFFSET(member, double *), .standard = otherwise, range,     \
        .unit = in, .meaning = text                                                                                    \
    }
#define CHOICE(key, member, otherwise, among, text)                                                                    \
    {                                                                                                                  \
        .name = key, .kind = PARAM_CHOICE, .offset = PARAM_INDEX_OFFSET(member), .standard = otherwise,                \
        .words = among, .meaning = text                                                                                \
    }
#define EITHER(key, member, otherwise, among, text)                                                                    \
    {                                                                                                                  \
        .name = key, .kind = PARAM_EITHER, .offset = PARAM_OFFSET(member, bool), .standard = otherwise,                \
        .words = among, .meaning = text                                                                                \
    }
#define ONLY(key, otherwise, among, text)                                                                              \
    { .name = key, .kind = PARAM_ONLY, .standard = otherwise, .words = among, .meaning = text }
/* usually: the default as text, NULL: the key is required. */
#define NOTED(key, as, usually, text, entry)                                                                           \
    { .name = key, .kind = PARAM_NOTED, .type = as, .usual = usually, .meaning = text, .example = entry }
#define IGNORED(key, text)                                                                                             \
    { .name = key, .kind = PARAM_IGNORED, .type = "any", .meaning = text }

/* Every row of a table of models (equation of state, transport, cooling, source, ..) begins with this: its name in the
 * dictionaries, one line for -listModels, and the parameters of its dictionary NAMECoeffs. */
struct model {
    const char *name, *about;
    const struct param *param;
    int nparam;
};
#define MODEL(name, about)                                                                                             \
    { name, about, NULL, 0 }
#define MODEL_WITH(name, about, table)                                                                                 \
    { name, about, table, sizeof(table) / sizeof *(table) }

/* Room for the parameters of any row of a table whose rows have parameters of their own. The row's functions copy them
 * into the row's own struct, which must fit. */
struct own_params {
    double room[10];
};
#define OWN_PARAMS_FIT(type) _Static_assert(sizeof(type) <= sizeof(struct own_params), #type " is too large")

/* Finds the row with a name in table[count], whose rows have `stride` bytes and begin with struct model; NULL: there is
 * none. */
const void *model_find(const void *table, size_t stride, int count, const char *name);

#endif
