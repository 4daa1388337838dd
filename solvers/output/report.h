/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The log and the provenance of a run: who runs what, one entry per step with totals and pace. The root prints. */
#ifndef SOLVERS_REPORT_H
#define SOLVERS_REPORT_H

#include "mesh/base/clock.h"
#include "solvers/case/case.h"
#include "solvers/output/runtable.h"
#include <stdio.h>

/* Prints version, compiler, host, ranks, mesh, models; and the expanded dictionaries if `dictionaries`. */
void report_header(FILE *f, const struct setup *s, bool dictionaries);
/* Writes the same as a dictionary, CASE/TIME/uniform/provenance, to `path`. */
status provenance_write(const char *path, const char *location, const struct setup *s);

struct progress {                 /* pace of a run, for its log */
    double start_clock, last_log; /* s */
    double mark_clock, mark_time; /* s: clock and time from which the present pace is measured */
    double pace;                  /* seconds of the clock per second of the run, lately */
    long first_step;
    double first_cpu;            /* s, of this rank */
    bool lost;                   /* was the folder of the case gone at the last entry? */
    struct run_table_file table; /* run.dat, on the root */
};

struct step_entry { /* the numbers of one log entry */
    double t, dt, courant, end_time;
    long step;
    const char *limit;
    char cell[200]; /* the cell that limits the step, as the medium says; empty: none does */
};
void progress_start(struct progress *p, const struct setup *s);
void progress_end(struct progress *p);
/* Writes the step as a row of run.dat and, if `print`, to the log: the step, the medium's lines, speed and the time
 * left. Collective. */
status progress_step(struct progress *p, const struct setup *s, const struct step_entry *e, bool print);
/* Returns the change of a total that is not negative, relative to the larger of both; 0 if both are 0. A start near 0
 * then makes no change look large, and a total that stays has its first value as scale. */
double relative_change(double now, double first);

/* Finds the smallest and largest value of a quantity, of a vector of its magnitude, over all ranks. Collective. */
status report_extremes(const struct setup *s, int quantity, double range[2]);

#endif
