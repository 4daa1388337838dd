/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Turns on rows of source_table by name, for tests. */
#ifndef TESTS_LIBCORE_SOURCES_H
#define TESTS_LIBCORE_SOURCES_H

#include "libcore/models/source.h"

#include <stdlib.h>

/* value: of the row's parameters one after the other, of a vector three. */
static inline void choose_source(struct sources *s, const char *name, const double *value) {
    for (int row = 0; row < source_count; row++) {
        const struct model *m = &source_table[row].model;
        if (strcmp(m->name, name)) continue;
        s->on[row] = true;
        for (int i = 0; i < m->nparam; i++) {
            const size_t n = m->param[i].kind == PARAM_VECTOR ? 3 : 1;
            if (m->param[i].offset + n * sizeof *value > sizeof s->params[row]) abort();
            memcpy((char *)&s->params[row] + m->param[i].offset, value, n * sizeof *value);
            value += n;
        }
        return;
    }
    abort();
}

#endif
