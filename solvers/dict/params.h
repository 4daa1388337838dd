/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fills a struct of parameters from a dictionary by a parameter table (libcore/models/param.h). */
#ifndef SOLVERS_PARAMS_H
#define SOLVERS_PARAMS_H

#include "libcore/models/param.h"
#include "solvers/dict/dict.h"
#include <stdio.h>

/* Reads every row of table[n] from d into the struct at base. A missing key gets its default (an error where the row
 * has none); type, range, word and unit are checked: "FILE:LINE: restitution is 1.2; allowed is 0 .. 1". */
status params_read(struct dict *d, const struct param *table, int n, void *base);
void params_print(FILE *f, const struct param *table, int n); /* prints name, default, range or words, unit, meaning */
/* Prints names and the values that the struct at base holds. */
void params_print_values(FILE *f, const struct param *table, int n, const void *base);

/* Fails for a value of a key that is beyond MOST_NUMBER or, but for 0, below LEAST_NUMBER. */
status param_check_size(const struct dict *d, const char *key, double v);

enum { PARAM_VALUE = 128 };
/* Writes the value that the struct at base holds. */
void param_value(char text[PARAM_VALUE], const struct param *p, const void *base);
bool param_fills(const struct param *p);                   /* is a member filled by the row? */
void param_unit(char text[64], const signed char unit[3]); /* writes "kg m^-1 s^-2", or "-" */

#endif
