/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gas whose grains rub: the energy that friction gives to it, and a restart in the middle of a run. */
#ifndef STRESS_CONTACT_H
#define STRESS_CONTACT_H

#include "libcore/gas/gas_private.h"

struct contacts {
    double worked; /* J: by walls that move, since the start */
    double most;   /* J: the largest sum of what friction gave to the gas, without that */
};
/* After a step of an audited gas. Collective. */
status contacts_look(struct contacts *c, const struct gas *g);

struct kept { /* what a restart reads again, of the cells of this rank */
    double *lines;
    long cells;
    int variables, friction; /* numbers of lines */
    struct gas_counts counts;
};
status kept_take(struct kept *k, const struct gas *g);
void kept_give(const struct kept *k, struct gas *g); /* to a gas just made */
void kept_free(struct kept *k);

#endif
