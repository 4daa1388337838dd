/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the reference tables of tests/oracles: rows of comma-separated words. */
#ifndef TESTS_ORACLE_H
#define TESTS_ORACLE_H

/* cmocka.h wants these three headers before it */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include "libcore/models/eos.h"
#include "tests/defaults.h"
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct oracle_row {
    int n;
    char *word[20];
    char text[1024];
};

static inline FILE *oracle_open(const char *name) {
    char path[1024];
    const char *source = getenv("HAFF_SOURCE");
    snprintf(path, sizeof path, "%s/tests/oracles/%s", source ? source : ".", name);
    FILE *f = fopen(path, "r");
    if (!f) fail_msg("cannot open %s (set HAFF_SOURCE to the repository)", path);
    return f;
}

static inline int oracle_row(FILE *f, struct oracle_row *r) {
    if (!fgets(r->text, sizeof r->text, f)) return 0;
    r->n = 0;
    for (char *w = strtok(r->text, ",\n\r"); w && r->n < 20; w = strtok(NULL, ",\n\r")) r->word[r->n++] = w;
    return 1;
}

static inline double oracle_number(const struct oracle_row *r, int i) {
    return strtod(r->word[i], NULL);
}

static inline void assert_close(double found, double expected, double relative, const char *what) {
    if (!(fabs(found - expected) <= relative * fabs(expected)))
        fail_msg("%s: %.17g, expected %.17g, relative error %.3g, allowed %.3g", what, found, expected,
                 fabs(found - expected) / fabs(expected), relative);
}

static inline void assert_near(double found, double expected, double allowed) {
    if (!(fabs(found - expected) <= allowed))
        fail_msg("%.17g, expected %.17g, error %.3g, allowed %.3g", found, expected, fabs(found - expected), allowed);
}

/* Returns grains of diameter sigma with the defaults of an equation of state. */
static inline struct material grains_of(const struct eos *eos, double e, double sigma) {
    struct material m = {.diameter = sigma, .mass = 1, .restitution = e, .disks = eos->disks};
    model_defaults(&eos->model, &m);
    if (eos->packing) m.alpha_max = eos->packing(0);
    return m;
}

#endif
