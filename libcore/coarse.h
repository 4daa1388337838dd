/* Coarse graining: fields on equal cells from grains and their impacts (Goldhirsch, Granular Matter 12 (2010) 239;
 * Weinhart et al., Granular Matter 14 (2012) 289). With a kernel phi of integral 1, at the centre r of a cell,
 *
 *   rho = sum m phi(r - x),  rho U = sum m u phi(r - x),  T = sum m |u - U|^2 phi / (dim rho),  p = p_kin + p_coll,
 *   p_kin = rho T,  p_coll = 1/(dim tau) sum over impacts in tau of impulse * branch * psi,
 *
 * branch: distance of the centres (to a wall: radius), psi: the mean of phi along the branch, here of its ends and its
 * middle by Simpson's rule. Averages over time are those of the sums, so that U and T are of all grains that were
 * there. Walls and periodic axes: mass that a kernel would put beyond a wall is mirrored, beyond a periodic side
 * wrapped.
 */
#ifndef LIBCORE_COARSE_H
#define LIBCORE_COARSE_H

#include "libcore/grains.h"

enum coarse_kernel {
    COARSE_CELL,      /* phi = 1/volume in the cell, 0 outside: exact means over cells */
    COARSE_HEAVISIDE, /* 1/volume of the ball of radius width */
    COARSE_GAUSSIAN   /* exp(-r^2/(2 width^2)), cut at 3 width, normalised */
};
struct coarse_grid {
    int dim, n[3];       /* cells; 1 for axes >= dim */
    double low[3], h[3]; /* m: lower corner, size of a cell */
    bool periodic[3];
    enum coarse_kernel kernel;
    double width;          /* m */
    double mass, diameter; /* of a grain */
};
enum coarse_field { COARSE_RHO, COARSE_ALPHA, COARSE_U, COARSE_T, COARSE_P, COARSE_FIELDS };

struct coarse; /* sums; a grain_observer of the impacts */
status coarse_make(const struct coarse_grid *grid, struct coarse **out);
void coarse_free(struct coarse *c);
struct grain_observer *coarse_observer(struct coarse *c);

void coarse_clear(struct coarse *c);                                                     /* all sums 0 */
void coarse_sample(struct coarse *c, int n, const double (*x)[3], const double (*u)[3]); /* a moment, box frame */
/* Fields of what was summed, impacts over `tau` seconds (0: no p_coll). out[k]: [cells], component k of U. Cells
 * without grains have U = T = p = 0. */
void coarse_value(const struct coarse *c, double tau, enum coarse_field f, double *const out[3]);
/* The sums themselves, for restarts: how many doubles, and where. */
long coarse_size(const struct coarse *c);
double *coarse_sums(struct coarse *c);

#endif
