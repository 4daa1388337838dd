/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What friction keeps from step to step (docs/physics.md 9.3), in the folder of a time: uniform/frictionPressure, the
 * pressure of each cell in the last step of the bed, and for each side of a cell a file of the stress, a symmetric
 * tensor. Sides of a lattice have the names frictionStressXLow, XHigh, YLow ..; those of polyhedra have numbers, in the
 * order of the polyMesh's faces. A restart goes on with them to the bit. For users there is frictionStress, the mean of
 * a cell's sides that carry stress, and the quantity stressRatio, |tau|/p of that mean, |tau| = sqrt(tau:tau/2). */
#ifndef SOLVERS_GAS_FRICTION_H
#define SOLVERS_GAS_FRICTION_H

#include "libcore/gas/gas.h"
#include "solvers/case/case.h"
#include "solvers/case/checksums.h"

enum { FRICTION_NAME = 40 };
struct friction_files {
    int n;                       /* 1 + sides of a cell; 0: there is no friction */
    char (*name)[FRICTION_NAME]; /* [n] in the folder of a time; the pressure's is the first */
    bool lost;                   /* did the run go on from a time without them? */
};
/* Names the files, and gives the gas what those of the start have. Where one is missing there is no stress. Collective.
 */
status friction_resume(struct friction_files *f, const struct setup *s, struct gas *g);
/* Writes the files of a time, and adds their checksums. Collective. */
status friction_save(const struct friction_files *f, const struct setup *s, const struct gas *g,
                     const struct field_writer *w, struct checksums *sums);
/* Computes stressRatio in the cells of this rank, one block after the other. Local. */
status friction_ratio(const struct setup *s, const struct gas *g, bool disks, double *out);
void friction_files_free(struct friction_files *f);

#endif
