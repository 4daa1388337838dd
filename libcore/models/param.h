/* Parameters are a table: it drives reading, range and unit errors, -listModels, checkCase and the documentation.
 *
 * A row says name, member, default, range, unit and meaning; PARAM_STRUCT names the struct whose members are filled:
 *   #define PARAM_STRUCT struct material
 *   NUMBER("diameter", diameter, REQUIRED, POSITIVE, UNIT(0, 1, 0), "grain diameter"),
 *   WHOLE("seed", seed, 1, FROM_TO(0, 2e9), "of the random places"),
 *   SWITCH("printedSoundSpeed", printed_sound, false, "sound speed as printed"),
 *   VECTOR("axis", axis, 0, FROM_TO(-1, 1), NO_UNIT, "of rotation"),
 *   CHOICE("bulk", bulk, 0, bulk_words, "viscosity by the contact integral, or twice that"), */
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
    PARAM_CHOICE  /* int: index of one of the words */
};
struct param {
    const char *name;
    enum param_kind kind;
    size_t offset;            /* of the member in the struct that is filled */
    double standard;          /* default; NAN: must be given; of a choice the index, below 0: no word */
    double low, high;         /* allowed, both included unless open */
    bool open;                /* low and high themselves are excluded */
    signed char unit[3];      /* exponents of kg, m, s */
    const char *const *words; /* of a choice, NULL behind the last */
    const char *meaning;      /* one line */
};

/* Defaults, ranges and units of rows */
#define REQUIRED              NAN
#define FROM_TO(least, most)  .low = (least), .high = (most), .open = false
#define BETWEEN(below, above) .low = (below), .high = (above), .open = true
#define POSITIVE              BETWEEN(0, HUGE_VAL)
#define ANY_NUMBER            BETWEEN(-HUGE_VAL, HUGE_VAL)
#define UNIT(kg, m, s)                                                                                                 \
    { kg, m, s }
#define NO_UNIT                                                                                                        \
    { 0, 0, 0 }

/* Offset of a member; the compiler refuses one of another type, which reading would overwrite. */
#define PARAM_OFFSET(member, type)                                                                                     \
    (offsetof(PARAM_STRUCT, member) + 0 * sizeof(char[_Generic(((PARAM_STRUCT *)0)->member, type : 1, default : -1)]))
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
        .name = key, .kind = PARAM_CHOICE, .offset = PARAM_OFFSET(member, int), .standard = otherwise, .words = among, \
        .meaning = text                                                                                                \
    }

/* What every row of a table of models begins with (equation of state, transport, cooling, source, wall, ..): its name
 * in the dictionaries, one line for -listModels, and the parameters of its NAMECoeffs. */
struct model {
    const char *name, *about;
    const struct param *param;
    int nparam;
};
#define MODEL(name, about)                                                                                             \
    { name, about, NULL, 0 }
#define MODEL_WITH(name, about, table)                                                                                 \
    { name, about, table, sizeof(table) / sizeof *(table) }

/* Room for the parameters of any row of a table whose rows have parameters of their own: the row copies them into its
 * own struct, which must fit. */
struct own_params {
    double room[8];
};
#define OWN_PARAMS_FIT(type) _Static_assert(sizeof(type) <= sizeof(struct own_params), #type " is too large")

/* The row of a table[count] of rows of `stride` bytes, each of which begins with struct model, that has the name; NULL:
 * none has. */
const void *model_find(const void *table, size_t stride, int count, const char *name);

#endif
