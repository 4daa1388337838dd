/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parameters of models without a dictionary: the defaults of their tables, and one value by its name. */
#ifndef TESTS_DEFAULTS_H
#define TESTS_DEFAULTS_H

#include "libcore/models/param.h"
#include <stdlib.h>
#include <string.h>

static inline void param_put(const struct param *p, void *base, double value) {
    void *member = (char *)base + p->offset;
    const int whole = (int)value;
    const bool on = value != 0;
    if (p->kind == PARAM_NUMBER)
        memcpy(member, &value, sizeof value);
    else if (p->kind == PARAM_SWITCH)
        memcpy(member, &on, sizeof on);
    else
        memcpy(member, &whole, sizeof whole);
}

/* Parameters without a default stay as they are. */
static inline void model_defaults(const struct model *m, void *base) {
    for (int i = 0; i < m->nparam; i++)
        if (!isnan(m->param[i].standard)) param_put(&m->param[i], base, m->param[i].standard);
}

static inline struct own_params own_defaults(const struct model *m) {
    struct own_params own = {{0}};
    model_defaults(m, &own);
    return own;
}

static inline void model_put(const struct model *m, void *base, const char *name, double value) {
    for (int i = 0; i < m->nparam; i++)
        if (!strcmp(m->param[i].name, name)) {
            param_put(&m->param[i], base, value);
            return;
        }
    abort();
}

#endif
