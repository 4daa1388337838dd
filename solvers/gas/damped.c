/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Says that implicit acoustics damps sound. */
#include "solvers/gas/damped.h"

#include <math.h>

/* A bed that lands damps sound in a step or two among many. So there is a warning while a run goes on if more of its
 * steps than LANDING have done so, and MOST of all; at its end if MOST have. */
enum { LANDING = 2 };
static const double MOST = 0.05;

status damped_say(bool *said, struct setup *s, const struct case_models *models, const struct gas_counts *n, FILE *f) {
    const bool automatic = models->gas.acoustics->automatic, often = n->damped > (f ? LANDING : 0);
    const double *at = n->damped_at, percent = 100 * fmin(n->damping, 1);
    if (*said || n->damped == 0) return OK;
    if (!automatic && !(often && (double)n->damped > MOST * (double)n->beds)) return OK;
    *said = true;
    if (!automatic)
        return warn(&s->warnings, WARN_DAMPED,
                    "%s:%d: implicit steps damp waves in dense gas: one takes %.3g %% of the motion around (%.6g %.6g "
                    "%.6g); acoustics automatic, or explicit, keeps waves",
                    dict_path(models->solution), dict_line(models->solution, "acoustics"), percent, at[0], at[1],
                    at[2]);
    if (f && comm_root(s->comm))
        fprintf(f,
                "    implicit steps of the bed are left out: they would take %.3g %% of its motion by sound, most at "
                "(%.6g %.6g %.6g)\n",
                percent, at[0], at[1], at[2]);
    return OK;
}
