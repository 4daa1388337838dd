/* postProcessing/limiter/<start>/limiter.dat: a row for every step in which something kept the state admissible
 * (libcore/schemes/limit.h); made when there is one. */
#ifndef SOLVERS_LIMITER_H
#define SOLVERS_LIMITER_H

#include "libcore/gas/gas.h"
#include "solvers/case/case.h"

struct limiter_table {        /* zeroed: nothing happened yet */
    struct gas_counts counts; /* at the last row */
    bool fills;               /* there is a density floor: with columns for it */
    FILE *file;               /* root */
};
/* After a step that ended at `now`; collective. Fails (ERR_SYSTEM) where it cannot be written. */
status limiter_record(struct limiter_table *l, const struct setup *s, const struct gas *g, const struct moment *now);
void limiter_close(struct limiter_table *l);

#endif
