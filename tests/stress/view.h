/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The same problem, seen in other ways: in other units, mirrored, turned, with its cells in another order. What comes
 * of it must be the same. Bodies of revolution have a mirror image of their own (problem_mirrored). */
#ifndef STRESS_VIEW_H
#define STRESS_VIEW_H

#include "tests/stress/run.h"

#include "mesh/format/polymesh.h"

struct view {
    const char *name;
    double kg, m, s; /* how many new units one old unit has */
    int axis[3];     /* the old axis that lies along the new axis k */
    bool flip[3];    /* does the new axis k point the other way? */
    bool reversed;   /* of polyhedra: cells and faces in the opposite order */
    double jitter;   /* every value of the start and every coordinate is changed by this part of itself, up or down */
};

/* The problem as it is seen; v and p are borrowed. */
struct problem problem_seen(const struct problem *p, const struct view *v);
/* The problem that was drawn. */
const struct problem *view_origin(const struct problem *p);
/* Of a lattice: the old axis, the old patch, the old cell of a new one. */
int view_axis(const struct problem *p, int axis);
int view_patch(const struct problem *p, int patch);
long view_cell(const struct problem *p, long cells, long cell);
/* Turns a vector to the new axes; no units. */
void view_turn(const struct problem *p, double x[3]);
/* Moves the points of polyhedra, and sorts their cells anew. place: [cells][3] the old centres, which are sorted, too.
 */
status view_mesh(const struct problem *p, struct polymesh *m, double *place);
/* A state of a cell of the start: from the old to the new one. cell: the old number. */
void view_start(const struct problem *p, long cell, double *rho, double u[3], double *T);
/* An end state U[variables][cells] of new cells, as the one who drew the problem sees it: out[variables][cells]. */
void view_end(const struct problem *p, long cells, int variables, double *const U[MAX_VAR], double *out);

/* Compares a problem, whose outcome is there, with the same one seen in all ways that hold for it. Fails by `out`. */
status views_compare(const struct problem *p, const struct scheme *scheme, const struct run_options *o,
                     const struct comm *c, struct outcome *out);

#endif
