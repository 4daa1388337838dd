/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The log as a table, postProcessing/run/<start>/run.dat, for programs that plot or watch a run: a row for the start
 * and for each step that the log prints (or each step; controlDict's runTable says which). The steps that print follow
 * the clock unless logInterval is given; the numbers of a row are the same on any ranks, but for the seconds.
 *
 * One head line, `# Time\tstep\tdt\tlimiter\tCourant\t..`, then one line a row; columns are parted by tabs:
 *   Time      s, end of the step
 *   step      its number, from the start of the case on
 *   dt        s, its length; 0 in the row of the start
 *   limiter   what limited dt, a word (blanks are `_`): `start` in the row of the start
 *   Courant   Courant number of the step (0 for granularMD, whose steps are no sweeps over cells)
 * then those of the medium (medium.h, struct log_row): granularGas
 *   alphaMin alphaMax magUMin magUMax TMin TMax MaMin MaMax      extremes over the cells
 *   mass momentum_x momentum_y momentum_z energy                 totals (per thickness of empty axes, as in the log)
 *   massChange energyChange                                      (now - first)/max(now, first); first: at the start of
 *                                                                the case, also after restarts
 *   limitedFaces limitedCells rejectedSteps flooredCells filledCells   counts since the start of the case
 *   computed                                                     part of the cell updates of this run that were
 *                                                                computed; the rest was uniform and skipped
 *   bedSteps bedCells newtonIterations linearIterations          implicit acoustics: steps of this run with it, cells
 *                                                                of the last one, iterations of this run
 * granularMD
 *   T kinetic potential lost energyChange collisions wallCollisions elastic events momentum_x momentum_y momentum_z
 * granularSegregation
 *   phiMin phiMax small smallChange solves iterations boundedFaces rejectedSteps
 * and at the end
 *   clockTime cpuTime   s since the start of this run: of the clock, and of the processors of all ranks together
 * and with runTableParts yes
 *   seconds_PART ..     s of the clock, rank 0: those that each part of the steps took in this run (granularGas) */
#ifndef SOLVERS_RUNTABLE_H
#define SOLVERS_RUNTABLE_H

#include "solvers/case/case.h"
#include <stdio.h>

struct run_moment { /* what the run itself knows of a row */
    double t, dt, courant;
    long step;
    const char *limit;
    double clock, cpu; /* s since the start of this run */
};
struct run_table_file {
    FILE *file; /* NULL: it has no row yet */
    bool parts; /* has it columns for the parts of steps? */
};
/* Writes a row, and before the first one opens the file. On the root. */
status run_table_row(struct run_table_file *table, const struct setup *s, const struct run_moment *now,
                     const struct log_row *row);

#endif
