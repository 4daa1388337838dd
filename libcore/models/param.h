/* Parameters are a table: it drives reading, range and unit errors, -listModels, checkCase and the documentation. */
#ifndef LIBCORE_PARAM_H
#define LIBCORE_PARAM_H

#include <stdbool.h>
#include <stddef.h>

enum param_kind {
    PARAM_NUMBER, /* double */
    PARAM_COUNT,  /* int */
    PARAM_SWITCH, /* bool */
    PARAM_VECTOR  /* double[3] */
};
struct param {
    const char *name;
    enum param_kind kind;
    size_t offset;       /* of the member in the struct that is filled */
    double standard;     /* default; NAN: must be given */
    double low, high;    /* allowed, both included unless open */
    bool open;           /* low and high themselves are excluded */
    signed char unit[3]; /* exponents of kg, m, s */
    const char *meaning; /* one line */
};

/* What every row of a table of models begins with (equation of state, transport, cooling, source, wall, ..): its name
 * in the dictionaries, one line for -listModels, and the parameters of its NAMECoeffs. */
struct model {
    const char *name, *about;
    const struct param *param;
    int nparam;
};

#endif
