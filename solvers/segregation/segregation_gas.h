/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A time of another case, a run of granularGas as a rule, whose fields a segregation takes. */
#ifndef SOLVERS_SEGREGATION_GAS_H
#define SOLVERS_SEGREGATION_GAS_H

#include "solvers/segregation/segregation_places.h"

struct gas_time {
    const struct dict *asked; /* the dictionary that asks for the time, for messages; borrowed */
    const char *entry;
    char dir[TIME_PATH], name[TIME_NAME];
    struct polymesh *mesh;
    int dim, axis[3];
    struct polymesh_geometry geometry;
};
/* Opens a time of the case case_dir (relative to the folder of s, or absolute); time NAN: the latest. Call
 * gas_time_close after success and failure. */
status gas_time_open(const struct setup *s, const struct dict *asked, const char *entry, const char *case_dir,
                     double time, struct gas_time *out);
void gas_time_close(struct gas_time *g);
/* Reads a field of that time: out[ncells][components], which the caller frees. */
status gas_time_field(const struct gas_time *g, const char *name, int components, double **out);
/* Finds for each place of a lattice the cell of the other case that holds its centre: out[n], -1 in holes; fails where
 * there is none. Collective. */
status gas_time_cells(const struct gas_time *g, const struct segregation_places *p, int **out);

struct segregation_column { /* the mean over all cells whose centres share a coordinate */
    double at, weight, value[3];
};
/* Makes the columns of values[ncells][components] of g, ascending, at least 3. */
status gas_time_columns(const struct gas_time *g, int axis, int components, const double *values, int *n,
                        struct segregation_column **out);
/* Value and slope at a coordinate (m). The value is linear between the columns and constant beyond the first and the
 * last; the slope is so between their middles. */
double column_value(int n, const struct segregation_column *c, int component, double at);
double column_slope(int n, const struct segregation_column *c, double at); /* slope of component 0 */

struct cell_centres { /* of a mesh, with those of its faces; the axes that are solved */
    const struct polymesh *mesh;
    const double *centre, *face_centre;
    int dim;
    const int *axis; /* [3] */
};
/* Computes grad q of q[stride * cell], by least squares over the neighbours: out[ncells][3], 0 along axes that are not
 * solved. It is exact for linear q, and of second order between two neighbours on a line. */
void cell_gradients(const struct cell_centres *at, int stride, const double *q, double *out,
                    double *room /* [ncells][6] */);

#endif
