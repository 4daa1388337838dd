/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Segregation on a lattice of equal boxes in one to three dimensions, carried by a given flow (docs/physics.md 11.4):
 *
 *     capacity phi_t + div(u phi + f phi (1 - phi) - D grad phi) = 0
 *
 * with u, f (along the direction of percolation) and D given on the faces. A gas of steady flow has its density as
 * capacity, and u, f and D times its density. A face where all three are 0 is a wall; cells whose faces are all walls
 * are holes. Through the other faces of the boundary goes what goes inside: all three fluxes where phi is given on
 * them, the first two where phi is that of the cell. Where u has no divergence on the lattice, sum of u area = 0 over
 * each cell, a uniform phi without percolation stays to round-off, and 0 <= phi <= 1 is kept.
 *
 * The scheme is Crank-Nicolson, linearised at the old time and factored by axes (Beam & Warming 1976): a tridiagonal
 * system for each line of cells, second order in space and time; on one axis it is Newton's first iterate of
 * segregation.h. All change is a sum of fluxes through faces, so that phi is conserved to round-off. Fluxes are central
 * and bounded as in segregation.h: where |u| + |f| > 2 D/h or phi would leave 0 .. 1, fluxes are pulled towards those
 * of explicit Engquist-Osher steps. D(phi) is taken at the middle of the step, which comes from a first solution with D
 * at its start. */
#ifndef LIBCORE_SEGREGATION_LATTICE_H
#define LIBCORE_SEGREGATION_LATTICE_H

#include "libcore/models/kernel.h"
#include "mesh/base/comm.h"

struct segregation_lattice { /* borrowed, with its arrays; cells: axis 0 fastest */
    int dim, n[MAX_DIM];     /* cells along each axis, at least 2; 1 beyond dim */
    /* NULL: n counts all cells. Else the lattice, of two or three axes, is cut across its last axis into slabs
     * (slab.h), one a rank: there n counts the layers of this rank, at least 1, and all arrays are of its cells and
     * their faces. Faces between two ranks are on both. All functions are collective then. The results have the same
     * bits on any number of ranks. */
    const struct comm *comm;
    double width[MAX_DIM]; /* m */
    /* Velocity m/s, percolation velocity m/s, diffusivity m^2/s on the faces of axis k, n[k] + 1 along it. */
    const double *u[MAX_DIM], *f[MAX_DIM], *D[MAX_DIM];
    /* On which faces of the boundary is phi given, and as what? `fixed` NULL: on none. On the others phi is that of the
     * cell. Inside and on seams `fixed` is false. */
    const bool *fixed[MAX_DIM];
    const double *value[MAX_DIM];
    const double *capacity; /* [cells], greater than 0; NULL: 1 */
    bool cyclic[MAX_DIM];   /* the first and the last faces of the axis are the same: u, f and D are, too */
    /* Computes D on the faces of axis k from phi there, 0 on walls. NULL: the arrays D above hold. */
    void (*law)(const void *context, int k, const double *phi, double *D);
    const void *context; /* the first argument of law */
};
struct segregation_lattice_counts {
    long steps, bounded, substeps; /* steps; those that needed bounds; monotone steps for them */
    long corrected;                /* faces whose flux was pulled back */
    long rejected;                 /* steps that segregation_field_advance repeated with a smaller one */
};

struct segregation_field; /* opaque */
status segregation_field_make(const struct segregation_lattice *lattice, struct segregation_field **out);
void segregation_field_free(struct segregation_field *s);
/* Advances phi[cells] by dt (s). `damped` steps are two implicit Euler steps of dt/2, as in segregation.h. Fails with
 * ERR_STATE if the step is far too long; phi is then as it was. */
status segregation_field_step(struct segregation_field *s, double dt, bool damped, double *phi);
/* Advances phi as segregation_advance does. */
status segregation_field_advance(struct segregation_field *s, double allowed, double *dt, double *next, double *phi);
struct segregation_lattice_counts segregation_field_counts(const struct segregation_field *s);
/* Returns the largest over the cells of the sum over faces of the fastest way out, 1/s; Courant number = dt * rate. */
double segregation_field_rate(const struct segregation_field *s);

#endif
