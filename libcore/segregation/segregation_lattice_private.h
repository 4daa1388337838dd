/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of segregation on a lattice (segregation_lattice.h). */
#ifndef LIBCORE_SEGREGATION_LATTICE_PRIVATE_H
#define LIBCORE_SEGREGATION_LATTICE_PRIVATE_H

#include "libcore/segregation/segregation_lattice.h"
#include "libcore/segregation/slab.h"

#include <stdlib.h>

enum { LINES = BATCH }; /* lines of cells that are solved at a time */

struct segregation_field {
    struct segregation_lattice lattice;
    struct segregation_lattice_counts counts;
    /* what other ranks have beyond the last axis's ends: of the cells or faces of the last swap; of s->low */
    struct slab slab, low_slab;
    long cells, faces[MAX_DIM], stride[MAX_DIM];
    double rate, advance_rate; /* 1/s: largest rate of the flow; of the flow and diffusion */
    bool coarse;               /* is the central flux on any face not monotone? */
    double *room;
    /* [faces] fluxes, means over the step; share of `flux` let through */
    double *flux[MAX_DIM], *low_flux[MAX_DIM], *part[MAX_DIM];
    /* [cells] change of phi; phi' of Crank-Nicolson, of the monotone steps; bounds of phi' */
    double *change, *next, *low, *least, *most;
    /* [cells] 1 / capacity; room of struct segregation_steps */
    double *ease, *before, *whole, *halves;
    double *D[MAX_DIM]; /* [faces] D from the law; NULL without one */
    /* [cells] does the cell limit its faces; is it beside a coarse face? */
    bool *watched, *sharp;
    double *line_phi, *line_right, *line_up, *line_down, *line_above, *line_ease; /* [longest + 1][LINES] */
    double *line_seam;
};

/* Does another rank have what lies beyond this end of the axis? */
static inline bool joined(const struct segregation_field *s, int k, bool high) {
    return k == s->lattice.dim - 1 && (high ? s->slab.high : s->slab.low);
}
/* Do the last cells of the axis border on its first ones, on this rank? */
static inline bool wraps(const struct segregation_field *s, int k) {
    return s->lattice.cyclic[k] && !joined(s, k, false);
}

static inline long outer_count(const struct segregation_field *s, int k) {
    return s->cells / (s->lattice.n[k] * s->stride[k]);
}

struct cell_faces { /* faces of a cell along an axis */
    long low, high;
};
static inline struct cell_faces sides_of(const struct segregation_field *s, int k, long c) {
    const long block = s->lattice.n[k] * s->stride[k], low = c + c / block * s->stride[k];
    return (struct cell_faces){low, low + s->stride[k]};
}

/* Sets the flux on all faces at phi, whose layers on other ranks s->slab has then: central, or monotone (Engquist &
 * Osher). */
void segregation_take_flux(struct segregation_field *s, bool monotone, const double *phi, double *const flux[MAX_DIM]);
/* Subtracts dt/capacity div flux from out. */
void segregation_subtract(const struct segregation_field *s, double dt, double *const flux[MAX_DIM], double *out);

struct boundary_flux { /* the flux along the axis on a face of the boundary, and its derivative to phi of the cell
                          beside it */
    double flux, slope;
};
struct boundary_flux segregation_edge(const struct segregation_field *s, int k, bool high, long face, double phi);
/* Is phi given on the face? */
static inline bool fixed_on(const struct segregation_lattice *l, int k, long face) {
    return l->fixed[k] && l->fixed[k][face];
}

/* Kernels of the tridiagonal systems of lines, LINES abreast: (I + part ease J) right = right. */
struct jacobian_lines { /* phi of the cells below and above faces; u, f and D on these; the Jacobian */
    const double *restrict below, *restrict above, *restrict u, *restrict f, *restrict D;
    double *restrict up, *restrict down;
};
/* Sets the Jacobian of the flux at phi: `up` to the cell below a face, `down` to the one above. */
void segregation_assemble(long count, double per_width, const struct jacobian_lines *l);
/* Eliminates down the lines; before: [2][LINES] `above` and `right` of the cells before the first ones, or NULL. */
void segregation_forward(long n, double part, const double *ease, const double *up, const double *down,
                         const double *before, double *above, double *right);
/* Solves back; behind: [LINES] solution in the cells behind the last ones, or NULL. */
void segregation_backward(long n, const double *above, const double *behind, double *right);
/* Does along the last axis, whose lines go through several ranks, what solve_axis does along the others. s->slab has
 * phi's layers. */
void segregation_solve_slabs(struct segregation_field *s, double dt, double late, const double *phi);

/* Is the flux through an inner face of the cell not monotone? */
bool segregation_beside_coarse(const struct segregation_field *s, int k, long cell, struct cell_faces sides);
/* Brings s->next within its bounds; s->flux becomes its excess over the low flux. */
void segregation_bound_lattice(struct segregation_field *s, double dt, const double *phi);

#endif
