/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The fields of written times from the grains: means over windows k * window .. (k + 1) * window, of moments evenly
 * spread in them and of all impacts. The fields are those of the last complete window, or of the present moment before
 * there is one. All times are multiples of the window from t = 0: a restart continues to the bit. */
#ifndef SOLVERS_GRAINS_AVERAGES_H
#define SOLVERS_GRAINS_AVERAGES_H

#include "libcore/grains/coarse.h"
#include "solvers/case/case.h"
#include "solvers/grains/grains_mesh.h"
#include "solvers/grains/grains_models.h"

enum { GRAINS_QUANTITIES = 6, KIND_QUANTITIES = 3 };
#define GRAINS_QUANTITY_ROWS                                                                                           \
    {"rho", 1, {1, -3, 0, 0, 0, 0, 0}, false}, {"alpha", 1, {0, 0, 0, 0, 0, 0, 0}, false},                             \
        {"U", 3, {0, 1, -1, 0, 0, 0, 0}, false}, {"T", 1, {0, 2, -2, 0, 0, 0, 0}, false},                              \
        {"p", 1, {1, -1, -2, 0, 0, 0, 0}, false}, {                                                                    \
        "TComponents", 3, {0, 2, -2, 0, 0, 0, 0}, false                                                                \
    }
extern const struct quantity grains_quantity[];    /* rho alpha U T p TComponents */
extern const enum coarse_field grains_coarse_of[]; /* of each */
extern const int grains_written[];                 /* all, ended by -1 */
struct grains_fields { /* the quantities of a mixture: those of all its grains, then alpha U T of each kind */
    struct quantity quantity[MAX_QUANTITIES];
    char name[GRAIN_KINDS * KIND_QUANTITIES][KIND_NAME + 8];
    int written[MAX_QUANTITIES + 1];
};
/* Returns the quantities of the case; f is filled for a mixture, whose names are like alpha.big. */
struct offered grains_fields_offer(struct grains_fields *f, const struct grains_models *m);
/* Returns the number of components of a quantity that lie along solved axes. */
int grains_components(const struct setup *s, int quantity);

struct averages_mark { /* how far the averages are; saved as it is */
    double window;     /* s; 0: the fields are always of the present moment */
    int64_t index;     /* number of the running window */
    int32_t samples, taken;
    int32_t whole;    /* was the beginning of the running window seen? */
    int32_t complete; /* is there a last complete window? */
};
struct averages;
struct averages_saved { /* for a restart */
    struct averages_mark mark;
    double grid[16]; /* struct coarse_grid of the sums, as numbers, so that two grids can be compared */
    long nsums;
    double *sums[2]; /* [nsums]: running window, last complete one */
};
/* Returns the cells of the averages: those of the lattice, or those of a mesh instead of one box around it. */
struct coarse_grid grains_grid(const struct setup *s, const struct grains_models *m, const struct grains_mesh *mesh);
/* Makes averages that start at time t (s); `grains` is their number. */
status averages_make(const struct coarse_grid *grid, double window, int samples, double t, int grains,
                     struct averages **out);
/* The same, which go on from sums that were saved; *kept: do they? They begin anew with `saved` NULL, and if cells,
 * kernel or windows are others. */
status averages_resume(const struct coarse_grid *grid, double window, int samples, double t, int grains,
                       const struct averages_saved *saved, struct averages **out, bool *kept);
status averages_room(struct averages *a, int grains);               /* makes room for these grains */
void averages_save(struct averages *a, struct averages_saved *out); /* borrows the sums */
void averages_free(struct averages *a);
/* Could averages have such a mark? */
static inline bool averages_sound(const struct averages_saved *s) {
    return s->mark.samples > 0 && s->mark.taken >= 0 && s->mark.taken <= s->mark.samples;
}

/* Returns the observer of impacts now; it changes with averages_take. NULL: no one listens. */
struct grain_observer *averages_observer(struct averages *a);
/* Returns the time (s) at which averages_take is due next; INFINITY: never. */
double averages_next(const struct averages *a);
void averages_take(struct averages *a, const struct grains *g); /* samples the grains, which stand at that time */
/* Computes a quantity: out[k][cells], component k of a vector (else k = 0). */
void averages_value(struct averages *a, const struct grains *g, int quantity, double *const out[3]);

struct averages_moment { /* soft grains at the time t, with their contacts */
    double t;
    int n;
    const double (*x)[3], (*u)[3], (*spin)[3];
    long ncontacts;
    const struct coarse_contact *contact;
};
/* The same of soft grains, whose stress is a mean over the samples. */
void averages_take_soft(struct averages *a, const struct averages_moment *now);
void averages_value_soft(struct averages *a, const struct averages_moment *now, enum coarse_field f,
                         double *const out[3]);

struct averages_mark *averages_mark(struct averages *a);
/* Returns the sums of the running window (which = 0) or the last complete one (1), *n doubles. */
double *averages_sums(struct averages *a, int which, long *n);

#endif
