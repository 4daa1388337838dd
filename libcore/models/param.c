/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Looks up a row by name, for all tables of models. */
#include "libcore/models/param.h"

#include <string.h>

const void *model_find(const void *table, size_t stride, int count, const char *name) {
    for (int i = 0; i < count; i++) {
        const struct model *m = (const void *)((const char *)table + (size_t)i * stride);
        if (!strcmp(name, m->name)) return m;
    }
    return NULL;
}
