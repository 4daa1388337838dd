/* The fields of written times from the grains: means over windows k * window .. (k + 1) * window, of moments evenly
 * spread in them and of all impacts. What is written is the last complete window, or the present moment before there is
 * one. All its times are multiples from t = 0: a restart continues to the bit. */
#ifndef SOLVERS_PARTICLE_AVERAGES_H
#define SOLVERS_PARTICLE_AVERAGES_H

#include "libcore/grains/coarse.h"

struct averages_mark { /* how far it is; saved as it is */
    double window;     /* s; 0: always the present moment */
    int64_t index;     /* of the running window */
    int32_t samples, taken;
    int32_t whole;    /* of the running window its beginning was seen */
    int32_t complete; /* there is a last one */
};
struct averages;
status averages_make(const struct coarse_grid *grid, double window, int samples, double t, int grains,
                     struct averages **out);
void averages_free(struct averages *a);

/* Who listens to impacts now; it changes with averages_take. NULL: no one. */
struct grain_observer *averages_observer(struct averages *a);
double averages_next(const struct averages *a);                 /* the time it wants next; INFINITY: none */
void averages_take(struct averages *a, const struct grains *g); /* there */
/* out[k][cells], component k of U. */
void averages_value(struct averages *a, const struct grains *g, enum coarse_field f, double *const out[3]);

struct averages_mark *averages_mark(struct averages *a);
double *averages_sums(struct averages *a, int which, long *n); /* of the running window 0, the last complete 1 */

#endif
