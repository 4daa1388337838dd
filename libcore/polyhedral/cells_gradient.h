/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gradients of the cells of polyhedra from their neighbours across faces, exact for linear fields. */
#ifndef LIBCORE_CELLS_GRADIENT_H
#define LIBCORE_CELLS_GRADIENT_H

#include "libcore/polyhedral/cells.h"

/* r <- the weights of the gradients of cells < nnear, 1/m; to be freed by entries_free. Collective. */
status cells_gradient_weights(const struct gas *g, struct entries *r);

/* gradient[k lines + c] <- d/dx_k of the lines q[c] (a batch of lanes longer than the polyhedra's size), in cells
 * from <= i < to (< nnear) and in those that share a batch of lanes with them: these have their own turn later. */
void cells_gradients(int dim, const struct entries *r, int lines, int from, int to, double *const *q,
                     double *const *gradient);

/* Finds what part of the gradients of T and rho a face may take, keep[faces], 1 where these are alike in both cells and
 * all their neighbours, 0 where no mesh resolves them; alike[size] is scratch. Fills the ghosts of alike. */
void cells_find_keep(struct gas *g, const double *rho, const double *T, double *alike, double *keep);

#endif
