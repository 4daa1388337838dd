/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outcomes added up: a row per scheme and family. */
#ifndef STRESS_TABLE_H
#define STRESS_TABLE_H

#include "tests/stress/run.h"

#include <stdio.h>

struct oracle_row {
    char scheme[128];
    int family;
    long runs, verdicts[VERDICTS], steps, cell_stages;
    struct gas_counts counts;
    long asked[2], made[2]; /* problems with `implicit`, with `automatic`; those of each that made implicit steps */
    double least, relative[CONSERVED], drift[CONSERVED], source;
};
struct table {
    int rows;
    struct oracle_row *row;
};
void table_add(struct table *t, const struct problem *p, const struct scheme *s, const struct outcome *o);
void table_print(FILE *f, const struct table *t);
void table_summary(FILE *f, const struct table *t); /* a line */
void table_free(struct table *t);

#endif
