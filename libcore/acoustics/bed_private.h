/* What the files of the bed share: lines of work memory and the parts of a step. */
#ifndef LIBCORE_BED_PRIVATE_H
#define LIBCORE_BED_PRIVATE_H

#include "libcore/acoustics/bed.h"
#include "libcore/acoustics/multigrid.h"

#define MOST_OUT 0.95 /* most of a cell's volume that may flow in, or out, in a step */

struct bed_lines {
    double *memory_cells, *memory_faces;
    int *whole_cells, *whole_faces, *whole_links; /* memory of the lists of integers */
    /* [cells + ghosts] of the start */
    double *rho, *u[MAX_DIM], *eps, *p, *c;
    /* [cells + ghosts] of Newton's method: root rho and -tau' of (*), residual, diagonal, change of p */
    double *root, *slack, *residual, *diagonal, *change;
    /* [cells + ghosts] after acoustics; state of rho, u, eps; slopes of u along its own axis */
    double *after[MAX_VAR], *tilt[MAX_DIM];
    double *slope[MAX_DIM][MAX_VAR]; /* [cells + ghosts] of rho, u, eps over a cell, along each axis */
    /* [faces] U without pressures; dt/(rho_f h), 0 where U does not depend on p; pressure beyond the face; U; p_f */
    double *drift, *give, *beyond, *U, *p_face;
    /* the links of the linear system */
    int *link_first, *link;
    double *weight;
};

/* Calls the caller's fill, if there are other ranks. */
void bed_fill(const struct bed *b, int n, double *const *line);
/* Finds p, U and root of the step; *done as bed_step. */
status bed_find_pressure(struct bed *b, double dt, const double gravity[MAX_DIM], bool *done);
/* Returns the energy (J/m^3) that a cell and those beside it had at the start: a cell that is lifted by more shows that
 * the step is far too long for what hits it. */
double bed_energy_near(const struct bed *b, int cell);
/* Finds p_face and the state `after` acoustics. Returns whether no cell of this rank was lifted too much. */
bool bed_update(struct bed *b, double dt, const double gravity[MAX_DIM]);
/* Carries the state with U and puts the result into b->U. Returns whether no cell of this rank gains or loses too
 * much. */
bool bed_remap(struct bed *b, double dt);

/* The limited difference over a cell, of the differences below and above it (van Leer's monotonised central). */
ALWAYS_INLINE double limited(double below, double above) {
    const double least = 2 * smaller(fabs(below), fabs(above)), mean = 0.5 * (below + above);
    const double size = smaller(least, fabs(mean));
    return below * above > 0 ? (mean > 0 ? size : -size) : 0;
}

#endif
