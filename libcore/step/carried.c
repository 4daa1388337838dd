/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Carried quantities as a part of a step: the mass that its stages bring through the faces is summed up. When the step
 * stands, gas_step moves the quantities by it (libcore/gas/carried.h). */
#include "libcore/gas/carried.h"
#include "libcore/step/step_parts.h"

static bool are_carried(const struct gas *g, const struct attempt *a) {
    (void)a;
    return g->carried != NULL;
}

static bool carried_first(struct gas *g, struct attempt *a) {
    (void)a;
    carried_begin(g);
    return true;
}

static bool carried_stage(struct gas *g, struct attempt *a, const struct stage_now *s) {
    (void)a;
    carried_keep(g, s->part * s->dt);
    return true;
}

const struct part carried_part = {"carried quantities", are_carried, carried_first, carried_stage, NULL,
                                  BOOKS_ITSELF,         true};
