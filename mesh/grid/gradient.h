/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gradients of values in cells, from values in cells alone: no boundary condition takes part. */
#ifndef MESH_GRADIENT_H
#define MESH_GRADIENT_H

#include "mesh/grid/grid.h"

enum { GRADIENT_LINES = 8 }; /* most lines of one call */

/* Sets gradient[k lines + c] to the derivatives of values[c] along the computational axes k < dim; all are lines over
 * the cells of this rank, block after block. On a lattice they are differences of the cells beside a cell, and beside a
 * patch those of the next two inside, both of second order. On polyhedra they are those of a quadratic function whose
 * means over the cells of the stencil are fitted to the values, by least squares with weights 1/|distance|^2, also
 * of second order; of a linear one, exact for linear values, where the stencil has too few cells for that. The same
 * bits on any number of ranks. Collective. */
status grid_gradients(const struct grid *g, int lines, const double *const *values, double *const *gradient);

#endif
