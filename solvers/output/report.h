/* The log: who runs what (provenance), one entry per step, totals and their drift. Printed by the root. */
#ifndef SOLVERS_REPORT_H
#define SOLVERS_REPORT_H

#include "solvers/case/case.h"
#include <stdio.h>

/* Version, compiler, host, ranks, mesh, models; the expanded dictionaries if asked for. */
void report_header(FILE *f, const struct setup *s, bool dictionaries);
/* CASE/TIME/uniform/provenance at `path`: the same as a dictionary. */
status provenance_write(const char *path, const char *location, const struct setup *s);

struct progress {                 /* of a run, for its log */
    double start_clock, last_log; /* s */
    double mark_clock, mark_time; /* s: where the present pace was measured from */
    double pace;                  /* s of the clock for a second of the run, lately */
    long first_step;
};
double clock_now(void); /* s, wall */
double cpu_now(void);   /* s, this process */

struct step_entry { /* what one log entry says */
    double t, dt, courant, end_time;
    long step;
    const char *limit;
    double place[3]; /* of the cell that limits, if `limit` is the Courant number */
    bool at_cell;
};
void progress_start(struct progress *p, const struct setup *s);
/* Collective: prints the step, the medium's lines, speed and what is left. */
status progress_print(struct progress *p, const struct setup *s, const struct step_entry *e);

/* Smallest and largest value of a scalar quantity over all ranks. */
status report_extremes(const struct setup *s, int quantity, double range[2]);

#endif
