/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Event-driven motion of smooth hard disks (dim 2) and spheres (dim 3): free parabolas between impacts, impacts at
 * their exact times in their exact order (docs/physics.md 10.2). There is no time step.
 *
 * An impact (docs/physics.md 10.1) of two grains with relative velocity v and unit normal k (from a to b), v.k < 0,
 * gives each the impulse mu (1 + e) (v.k) k, mu = m_a m_b/(m_a + m_b), m/2 of equal grains; e = restitution, or 1 where
 * |v.k| < threshold (the rule of libcore/models/cooling.h, which keeps inelastic collapse away). A wall has infinite
 * mass and its own restitution. Grains leave an impact with at least 1e-13 of their speeds and 1e-7 sqrt(G diameter), G
 * the largest acceleration relative to the box: even without a threshold, time goes on (slowly: a collapse then takes
 * millions of impacts).
 *
 * Space is a box with axes 0..dim-1, periodic or walled axis by axis, or what facets bound in it (facets.h). The box as
 * a whole may be shaken: its displacement is s_k(t) = shake[k] cos(omega t + phase). All positions and velocities in
 * this header are in the frame of the box; inside, flight is computed in the frame at rest, where gravity is constant,
 * and the impact on a moving wall is the first root of the exact distance.
 *
 * Each grain keeps its own clock (position, velocity and the time they belong to) and its next event; cells of at least
 * one diameter find partners; a queue (calendar.h) orders the events, equal times by the grain's index. What was
 * predicted for a grain stays until it or its partner changes. Thus a run that is advanced in any pieces, saved and
 * resumed anywhere, has the same bits. Lubachevsky, J. Comput. Phys. 94 (1991) 255.
 */
#ifndef LIBCORE_GRAINS_H
#define LIBCORE_GRAINS_H

#include "libcore/grains/facets.h"
#include "mesh/base/status.h"

#include <stdbool.h>
#include <stdint.h>

/* A rough wall (docs/physics.md 10.7): of the impacts on it the part phi is diffuse: the grain's velocity along the
 * wall, relative to it, gets a new random direction and keeps its length. */
struct grain_rough {
    double phi;  /* 0 .. 1, the specularity coefficient of Johnson & Jackson (1987); 0: smooth */
    double u[3]; /* m/s: of the wall, which moves along itself */
};
struct grain_box {
    int dim;                /* 2: disks, 3: spheres */
    double low[3], high[3]; /* m, along axis k < dim */
    bool periodic[3];
    double restitution[3][2]; /* restitution of the low and the high wall of an axis that is not periodic */
    double shake[3];          /* m: amplitudes of s_k */
    double omega, phase;      /* 1/s, rad */
    /* 1/s: the gradient along axis 1 of the velocity along axis 0, which the images of a periodic box at rest have
     * (grains_shear.c); 0: none */
    double shear;
    /* Walls of any shape stand in place of the flat ones; low and high are then a box around them. Borrowed; NULL: no
     */
    const struct facets *facets;
    const double *wall_restitution;  /* [walls of facets]; NULL: 1 */
    const struct grain_rough *rough; /* [walls of facets]; NULL: all are smooth */
    uint64_t seed;                   /* of the impacts on rough walls */
    bool shut;                       /* facets that are open are walls all the same */
    bool fed;                        /* may grains come in through open facets, by grains_enter? */
};
enum { GRAIN_KINDS = 8 };
struct grain_kinds {                              /* of a mixture, by the numbers that grains have in grains_make */
    int n;                                        /* 0: all grains are alike */
    int first[GRAIN_KINDS + 1];                   /* grains first[k] .. first[k + 1] - 1 are of kind k */
    double size[GRAIN_KINDS], mass[GRAIN_KINDS];  /* diameter and mass over those of the law; no size is above 1 */
    double restitution[GRAIN_KINDS][GRAIN_KINDS]; /* of two grains; symmetric */
};
struct grain_law {
    double diameter; /* m, at time 0 */
    double growth;   /* m/s: diameter + growth * t, for packing.h; 0 in runs. Only in boxes at rest without gravity */
    double mass;     /* kg */
    double restitution, threshold; /* of two grains; m/s: slower impacts are elastic */
    double gravity[3];             /* m/s^2 */
    struct grain_kinds kinds;      /* then diameter is that of the largest, and restitution does not count */
};

/* One grain, saved and resumed as it is: struct grain is the cache line that other grains read when they predict,
 * struct grain_event the rest. Frame at rest; x is within the box along periodic axes. */
struct grain {
    double x[3], u[3], t; /* m, m/s, s: at its own time t */
    double impact;        /* s: time of the impact predicted for it, no later than its first; HUGE_VAL: none */
};
struct grain_event {
    /* partner in that impact: >= 0: grain; < 0: -1 - (2 axis + side) a wall; FIRST_FACET and below: a facet, see
     * grains_facet_of; other values are the engine's own */
    int32_t partner;
    uint32_t known;   /* the partner's `changes` when the impact was predicted */
    uint32_t changes; /* count of changes of the grain's velocity: events predicted with an older number are void */
    int32_t cell;     /* cell that the grain is in */
};
struct grain_counts {
    int64_t pairs, walls; /* impacts */
    int64_t elastic;      /* impacts of e < 1 that were below the threshold, or too slow to tell from rest */
    int64_t events;       /* events taken from the queue */
    /* J: energy the impacts took (pairs and walls), in the frame of the wall for walls, less the work of rough walls
     * that move along themselves */
    double lost;
    double wall_impulse[3][2]; /* kg m/s: sum of the impulses given to the walls, along their outward normal */
};
struct grain_impact {
    double t;
    double x[2]
            [3]; /* m: centres of both grains (box frame, the second unwrapped beside the first); a wall: x[1] = x[0] */
    double normal[3]; /* unit vector from the first to the second, or to the wall */
    double impulse;   /* kg m/s, > 0: the first grain gets -impulse * normal */
    double mass;      /* kg: of the first grain */
    double drag[3];   /* kg m/s: a rough wall gets it, along itself, */
    double work;      /* J: and gives this to the grain, since it moves */
    double branch;    /* m: the mean diameter of both; a wall: the radius */
    int a, b;         /* indices of the grains at that time; b < 0: the wall, as in struct grain_event */
};
enum { FIRST_FACET = -2000 };
/* Returns the facet that stands as b in an impact; NULL: b is no facet. */
const struct facet *grains_facet_of(const struct grain_box *box, int b);
struct grain_observer { /* hears of every impact; the first member of any struct that listens */
    void (*impact)(struct grain_observer *self, const struct grain_impact *i);
};

struct grains; /* opaque */
/* Makes n grains at time t. Fails with ERR_INPUT on a grain outside, two that overlap by more than 1e-9 diameters (both
 * are named, with their places), a box too small for its axes (periodic: under 3 cells) or too full. */
status grains_make(const struct grain_box *box, const struct grain_law *law, int n, const double (*x)[3],
                   const double (*u)[3], double t, struct grains **out);
struct grain_save { /* what grains_all, grains_events, grains_ids and grains_counted gave, and the time reached */
    int n;
    double t;
    const struct grain *grain;
    const struct grain_event *event;
    const int32_t *id;
    const struct grain_counts *counts;
    const double (*impulse)[3]; /* of grains_impulses; NULL without facets or shear */
    const uint8_t *kind;        /* of grains_kinds; NULL: kinds follow from the numbers */
};
/* Makes grains from what was saved: the run continues to the bit. */
status grains_resume(const struct grain_box *box, const struct grain_law *law, const struct grain_save *save,
                     struct grains **out);
void grains_free(struct grains *g);

/* In a box that is fed numbers stand ready for grains that come in: those of grains that have left, and more by
 * grains_grow, which makes the grains anew with numbers for n of them. */
status grains_grow(struct grains **g, int n);
bool grains_is_full(const struct grains *g); /* are all numbers in use? */
/* Lets a grain of a kind (0 where all are alike) come in through an open wall at x (m) with velocity u (m/s, relative
 * to the box), at the time reached. Returns false and changes nothing where another grain or a closed wall is too near,
 * or all numbers are in use. */
bool grains_enter(struct grains *g, const double x[3], const double u[3], int kind, int wall);
/* Returns the index of the grain that covers the point x (m) at the time reached, with its place and velocity relative
 * to the box; -1: none does. grains_push adds du (m/s) to its velocity, on behalf of grains beyond an open wall. */
int grains_covering(const struct grains *g, const double x[3], double at[3], double u[3]);
int grains_kind_of(const struct grains *g, int i); /* of the grain with that index */
void grains_push(struct grains *g, int i, const double du[3], int wall);

/* Works off all events up to `until`, but no more than `most` of them; returns the time reached: `until`, or that of
 * the last event (until = HUGE_VAL: also when nothing will ever happen). observer may be NULL. */
double grains_advance(struct grains *g, double until, int64_t most, struct grain_observer *observer);

/* Sets x (m) and u (m/s, relative to the box) of all grains at time t, which is not before the time reached and not
 * after the next event; changes nothing in g. Indexed by id, which is the place a grain had in grains_make. Grains
 * that have left have x = NAN, u = 0. */
void grains_at(const struct grains *g, double t, double (*x)[3], double (*u)[3]);
/* Sets kinetic and potential energy (J, frame of the box) and momentum (kg m/s) at the time reached. */
void grains_energy(const struct grains *g, double *kinetic, double *potential, double momentum[3]);

int grains_number(const struct grains *g);
const struct grain *grains_all(const struct grains *g);          /* [n] */
const struct grain_event *grains_events(const struct grains *g); /* [n] */
const int32_t *grains_ids(const struct grains *g);   /* [n]: at index i is number id[i]; indices change now and then */
const uint8_t *grains_kinds(const struct grains *g); /* [n] of a mixture, by index; NULL: all are alike */
/* Sets the kind of each grain by number; 0 where all are alike. In a box that is fed a number changes its kind with the
 * grain that has it. */
void grains_kinds_by_number(const struct grains *g, uint8_t *kind);
const struct grain_counts *grains_counted(const struct grains *g);
/* Grains that have left through open facets: how many of the n are still there; row w of grains_impulses has the
 * momentum that left through wall w, row walls + w the number of the grains, their kinetic and their potential energy
 * (J). In a box that is fed row 2 walls + w has the same of grains that came in or were pushed; what momentum these got
 * is taken off row w. */
int grains_present(const struct grains *g);
double grains_total_mass(const struct grains *g); /* kg, of those present */
double grains_work(const struct grains *g);       /* J: that the ends of a sheared box have done */
/* Kinetic energy (J) of the motion relative to the mean flow, shear * (x_1 - the middle) along axis 0 in a sheared box,
 * and the mean velocity. */
double grains_thermal(const struct grains *g);
const double (*grains_impulses(const struct grains *g))[3]; /* [walls of facets] kg m/s: given to each of them;
                                                             * sheared: one row, the work by flow and by impacts */
double grains_time(const struct grains *g);
double grains_mean_size(const struct grain_kinds *k, int dim); /* mean of size^dim over the grains; 1: all alike */
double grains_mean_mass(const struct grain_kinds *k);          /* mean mass over that of the law */
/* Sets for each kind the variance of a velocity component (m^2/s^2) about the mean velocity of all; in a sheared box
 * that is of the velocities relative to the mean flow. */
void grains_kinds_T(const struct grains *g, double T[GRAIN_KINDS]);
double grains_volume(const struct grain_box *box); /* m^3 (disks: m^2) between the walls */
double grains_bytes(int n, int dim);               /* memory that a run takes, about */

#endif
