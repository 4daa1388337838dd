/* The box of the grains from the case's mesh and the patch types of its field U. Axes are computational: the solved
 * ones in order. */
#ifndef SOLVERS_PARTICLE_BOX_H
#define SOLVERS_PARTICLE_BOX_H

#include "solvers/case/case.h"
#include "solvers/grains/grains_models.h"

/* Is the mesh a full box with two or three solved axes? */
status grains_box_check(const struct setup *s);
/* Of U the patches count: walls, or an error. */
status grains_box_make(const struct setup *s, const struct grains_models *m, const struct field *U,
                       struct grain_box *out);
/* Index of the cell that holds x, axis 0 fastest; a place outside counts for the nearest cell. */
long grains_box_cell(const struct lattice *l, const double x[3]);
/* x in physical axes; what is not solved lies in the middle of the mesh. */
void grains_box_place(const struct setup *s, const double x[3], double out[3]);

#endif
