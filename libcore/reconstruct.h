/* Face values from cell averages: a table of one-dimensional reconstructions.
 *
 * face: right-face value of the middle cell of five (q[2] holds the cell, q[3] its downwind neighbour), for n cells; a
 * left-face value is the same function on the mirrored stencil. Exact for constants, to the last bit. */
#ifndef LIBCORE_RECONSTRUCT_H
#define LIBCORE_RECONSTRUCT_H

struct reconstruct {
    const char *name, *about;
    int reach; /* cells used on each side: 0, 1 or 2 */
    void (*face)(int n, const double *const q[5], double *restrict out);
};

extern const struct reconstruct reconstruct_table[];
extern const int reconstruct_count;
const struct reconstruct *reconstruct_find(const char *name); /* NULL: none */

#endif
