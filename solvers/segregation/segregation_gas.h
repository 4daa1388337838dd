/* A time of another case, as a rule of granularGas, whose fields a segregation takes. */
#ifndef SOLVERS_SEGREGATION_GAS_H
#define SOLVERS_SEGREGATION_GAS_H

#include "solvers/case/case.h"

struct gas_time {
    const struct dict *asked; /* the entry that asks for it, for messages; borrowed */
    const char *entry;
    char dir[TIME_PATH], name[TIME_NAME];
    struct polymesh *mesh;
    int dim, axis[3];
    double *centre, *volume, *face_centre; /* [ncells][3], [ncells], [nfaces][3] */
};
/* case_dir: from the folder of s, or absolute; time: NAN: the latest. gas_time_close after success and
 * failure. */
status gas_time_open(const struct setup *s, const struct dict *asked, const char *entry, const char *case_dir,
                     double time, struct gas_time *out);
void gas_time_close(struct gas_time *g);
status gas_time_field(const struct gas_time *g, const char *name, int components, double **out);
/* out[ncells of s]: its cell that holds the centre of each; an error where there is none. */
status gas_time_cells(const struct gas_time *g, const struct setup *s, int **out);

struct column { /* the mean over all cells whose centres share a coordinate */
    double at, weight, value[3];
};
/* Ascending, at least 3; values[ncells][components] of g. */
status gas_time_columns(const struct gas_time *g, int axis, int components, const double *values, int *n,
                        struct column **out);
/* Between the columns: linear, constant beyond the first and the last; so are the slopes between their middles. */
double column_value(int n, const struct column *c, int component, double at);
double column_slope(int n, const struct column *c, double at); /* of component 0 */

/* grad q of q[stride * cell], by least squares over the neighbours: out[ncells][3], 0 along axes that are not solved.
 * Exact for linear q, of second order between two neighbours on a line. */
void cell_gradients(const struct polymesh *m, const double *centre, const double *face_centre, int dim,
                    const int axis[3], int stride, const double *q, double *out, double *room /* [ncells][6] */);

#endif
