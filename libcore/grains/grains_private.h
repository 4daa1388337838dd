/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the engine for hard grains (grains.h). Times of events are absolute; all places and velocities
 * are in the frame at rest. */
#ifndef LIBCORE_GRAINS_PRIVATE_H
#define LIBCORE_GRAINS_PRIVATE_H

#include "libcore/grains/calendar.h"
#include "libcore/grains/facets.h"
#include "libcore/grains/grains.h"
#include "libcore/models/kernel.h"

enum {
    NO_PARTNER = -1000, /* no impact is predicted; its time is HUGE_VAL */
    LOOK_AGAIN = -100,  /* no impact is found up to t: predict anew then */
    GONE = -50,         /* the grain has left through an open facet */
    STAYS = -1,         /* the grain does not leave its cell */
    CACHED = 8000       /* this many grains fit into a cache; for more, memory is prefetched */
};

/* Cells of at least one diameter. A grain's `cell` packs the cell's numbers along the three axes, `bits` each; arrays
 * of cells are indexed by the sum of the parts in its three rows. Along axes with walls a layer of empty cells lies
 * beyond each wall, so that every cell has neighbours on both sides. Up to SLOTS occupants stand in a cell's slots; a
 * fuller cell (of a dense gas, or a wide cell) has all but SLOTS - 1 of them in a chain through `next` that begins in
 * the last slot. */
enum { SLOTS = 4, CHAINED = SLOTS + 1, SLOT_BITS = 29, NEIGHBOURS = 27, ROOM = (NEIGHBOURS + 2) * SLOTS };
struct grain_row {     /* the cells of one number along an axis */
    int32_t around[3]; /* parts of the index: of the cells before, of these, of those after */
    int32_t wraps;     /* some of those lie beyond a periodic end */
    double edge[2];    /* m, where a grain leaves the cell; at a wall -HUGE_VAL, HUGE_VAL */
};
struct grain_cells {
    int n[3], bits[3], planes; /* planes: of neighbours along the last axis, 1 in 2D, else 3 */
    struct grain_row *row[3];  /* [n[k]] */
    /* m: what the cells cover in the frame at rest, with a shaken wall's whole reach */
    double low[3], high[3], width[3];
    int reach[3][2]; /* cells <= reach[k][0], >= reach[k][1] may touch a wall */
    int32_t all;     /* number of cells, with those beyond the walls */
    /* [all][SLOTS] grains; the last slot also holds count << SLOT_BITS, where count may be CHAINED */
    uint32_t *slot;
    int32_t *next; /* [n] next grain of a chain, -1: none */
};

struct grains {
    struct grain_box box;
    struct grain_law law;
    int n, dim;
    double start, time; /* start: time at which the diameter was law.diameter */
    double outgrown;    /* time at which the diameter reaches the width of the cells; HUGE_VAL: never */
    struct grain *grain;
    struct grain_event *event;
    int32_t *id;
    uint8_t *kind; /* [n] of a mixture, by index; NULL: all are alike */
    struct grain_counts counts;
    struct grain_cells cells;
    struct facet_cells walls; /* the facets near each cell; empty without facets */
    double (*impulse)[3];     /* [walls] kg m/s: given to each wall of facets; sheared: [1], J: the work of
                               * the ends, by grains that go through them and by impacts across them */
    struct calendar *queue;
    int64_t sort_at;           /* number of pair impacts at which the grains are sorted next; -1: never */
    uint64_t *order;           /* [n] scratch of grains_sort */
    uint32_t *list;            /* [n + ROOM] occupants: scratch of a prediction */
    double period[3], half[3]; /* length of a periodic axis and half of it; else 0, HUGE_VAL */
    bool falls;                /* gravity is not zero */
    double gentle;             /* m/s: 1e-7 sqrt(G diameter), see grains_impact.c */
    double pull[3];            /* m/s^2: bound G_k of the acceleration relative to the box */
    double pull_all;           /* the length of that vector */
    bool swings;               /* the box is shaken */
    bool opens;                /* grains can leave through facets */
    uint64_t *vacant;          /* [n/64 + 1] bits of the indices whose grains have left; NULL: the box is not fed */
};

struct swing { /* displacement (m) and velocity (m/s) of the box along one axis */
    double s, v;
};
/* Returns cos x and sets *sine to sin x, with the same bits everywhere (grains_walls.c). */
double grains_phase_cos(double x, double *sine);
struct swing grains_swing(const struct grain_box *box, int axis, double t);
/* The rows of `impulse`. */
static inline long grains_rows(const struct grain_box *b) {
    return b->facets ? (b->fed ? 3L : b->facets->opens ? 2L : 1L) * b->facets->space.walls : b->shear != 0;
}
static inline double grains_diameter(const struct grains *g, double t) {
    return g->law.diameter + g->law.growth * (t - g->start);
}
/* Diameter and mass of grain i over those of the law: 1 where all are alike. */
static inline double grains_size(const struct grains *g, int i) {
    return g->kind ? g->law.kinds.size[g->kind[i]] : 1;
}
static inline double grains_mass(const struct grains *g, int i) {
    return g->law.mass * (g->kind ? g->law.kinds.mass[g->kind[i]] : 1);
}
static inline double grains_pair_size(const struct grains *g, int a, int b) {
    return 0.5 * (grains_size(g, a) + grains_size(g, b));
}
static inline double grains_restitution(const struct grains *g, int a, int b) {
    return g->kind ? g->law.kinds.restitution[g->kind[a]][g->kind[b]] : g->law.restitution;
}
static inline bool is_shaken(const struct grain_box *box, int k) {
    return !box->periodic[k] && box->shake[k] != 0;
}

/* Computes x and u of grain p at time t. */
static inline void fly(const struct grains *g, const struct grain *p, double t, double x[3], double u[3]) {
    double dt = t - p->t;
    for (int k = 0; k < 3; k++) {
        double a = g->law.gravity[k];
        x[k] = p->x[k] + dt * (p->u[k] + 0.5 * a * dt);
        u[k] = p->u[k] + a * dt;
    }
}
/* Moves grain p and its clock to time t. */
static inline void bring(const struct grains *g, struct grain *p, double t) {
    double x[3], u[3];
    fly(g, p, t, x, u);
    for (int k = 0; k < 3; k++) {
        p->x[k] = x[k];
        p->u[k] = u[k];
    }
    p->t = t;
}
/* Turns the difference r along axis k into that to the nearest image (of grains in neighbouring cells). */
static inline double nearest(const struct grains *g, int k, double r) {
    r -= r > g->half[k] ? g->period[k] : 0;
    return r + (r < -g->half[k] ? g->period[k] : 0);
}

/* grains.c: grains without places, of a law and box that are checked; the caller frees them, also after an error. */
status grains_make_empty(const struct grain_box *box, const struct grain_law *law, int n, double t,
                         struct grains **out);

/* grains_enter.c: the list of vacant indices, of a box that is fed. */
status grains_vacant_make(struct grains *g);
void grains_vacant_find(struct grains *g); /* after indices have changed */

/* grains_cells.c */
status grains_cells_make(struct grains *g);
/* Fits cells to the diameter at g->time, which all clocks show; false: no room. */
bool grains_cells_widen(struct grains *g);
static inline int cell_number(const struct grain_cells *c, int32_t cell, int k) {
    int shift = k > 0 ? (k > 1 ? c->bits[0] + c->bits[1] : c->bits[0]) : 0;
    return (cell >> shift) & ((1 << c->bits[k]) - 1);
}
static inline const struct grain_row *cell_row(const struct grain_cells *c, int32_t cell, int k) {
    return &c->row[k][cell_number(c, cell, k)];
}
static inline double grains_cell_edge(const struct grain_cells *c, int k, int number) {
    return select_double(number == c->n[k], c->high[k], c->low[k] + number * c->width[k]);
}
int32_t grains_cell_of(const struct grains *g, const double x[3]);
void grains_cell_enter(struct grains *g, int i);
void grains_cell_leave(struct grains *g, int i);
static inline bool is_gone(const struct grains *g, int i) {
    return g->event[i].partner == GONE;
}
/* Moves grain i, which is brought to the time of leaving, through the face `exit`. */
void grains_cell_cross(struct grains *g, int i, int exit);
struct grain_block { /* a block of cells: the product of the cells around one along each axis */
    const int32_t *around[3];
    int from[3], to[3], wraps;
};
/* Makes the block of all cells around a cell or, if exit != STAYS, of only those that are new beyond that face. */
static inline void grains_block(const struct grain_cells *c, int32_t cell, int exit, struct grain_block *b) {
    b->wraps = 0;
    for (int k = 0; k < 3; k++) {
        const struct grain_row *row = cell_row(c, cell, k);
        b->around[k] = row->around;
        b->wraps |= row->wraps;
        b->from[k] = 0;
        b->to[k] = k < 2 ? 3 : c->planes;
    }
    if (exit == STAYS) return;
    b->from[exit / 2] = exit & 1 ? 2 : 0;
    b->to[exit / 2] = b->from[exit / 2] + 1;
}
/* Lists all grains in the cells of a block; list has room for n + ROOM. Returns how many. */
int grains_occupants(const struct grain_cells *c, const struct grain_block *b, uint32_t *list);

void grains_cells_fill(struct grains *g); /* puts all grains into the cells that they name */

/* grains_order.c: sets the kinds from the numbers. */
void grains_set_kinds(struct grains *g);
/* The indices change; the caller makes the queue anew from the grains. */
void grains_sort(struct grains *g);
void grains_set_sorting(struct grains *g); /* sets sort_at from the counts */

/* grains_predict.c: grain i's clock shows `now`. */
void grains_predict(struct grains *g, int i, double now);                  /* predicts from all neighbours */
void grains_predict_beyond(struct grains *g, int i, double now, int exit); /* after a crossing */
double grains_schedule(const struct grains *g, int i);                     /* the time of its next event */
int grains_exit(const struct grains *g, int i); /* the face where it leaves its cell: 2 axis + side, or STAYS */
void grains_predict_all(struct grains *g);      /* all clocks show g->time */
double grains_wrap(const struct grain_box *box, int k, double x); /* x moved into the box by whole periods */
/* grains_walls.c: returns the time of the first contact with the wall no later than `limit`, else HUGE_VAL. *again:
 * there is no contact up to the time returned, but one may follow. */
double grains_wall_time(const struct grains *g, int i, int axis, int side, double limit, bool *again);
double grains_first_root(double h, double v, double a);

/* grains_shear.c, of a sheared box: is grain i in the first or last row along axis 1? Place r (m) and velocity v (m/s)
 * of q relative to p, both at time t, by its nearest image;
 * returns the velocity (m/s) that this has beside q's own. Turns grain i, which leaves through an end of axis 1, into
 * its image on the other side. Looks for impacts with grains beyond the end, no later than grain i leaves its cell. */
bool grains_is_sheared_row(const struct grains *g, int i);
double grains_sheared(const struct grains *g, const struct grain *p, const struct grain *q, double t, double r[3],
                      double v[3]);
void grains_shear_wrap(struct grains *g, int i, bool up);
void grains_consider_beyond(struct grains *g, int i, double now, double leaving);

/* grains_facets.c: lists the facets near each cell, if there are any; looks for impacts on those near grain i's cell no
 * later than it leaves that; lets grain a rebound from the facet of `partner`. */
status grains_facets_make(struct grains *g);
void grains_consider_facets(struct grains *g, int i, double leaving);
void grains_depart(struct grains *g, int i, int partner); /* grain i leaves through an open facet, at its time */
void grains_rebound_facet(struct grains *g, int a, int partner, double t, struct grain_observer *observer);
double grains_facet_time(const struct grains *g, int i, int facet, double limit, bool *again); /* as grains_wall_time */

/* grains_impact.c: returns the speed at which a grain of velocity u leaves a wall that it came to at `approach`; makes
 * what the observer hears of an impact along r, which has the length `distance`. */
double grains_speed_after(struct grains *g, double approach, double e, const double u[3]);
struct grain_impact grains_impact_of(const struct grains *g, int a, int b, double t, const double r[3], double distance,
                                     double impulse);
void grains_collide(struct grains *g, int a, int b, double t, struct grain_observer *observer);
void grains_rebound(struct grains *g, int a, int wall, double t, struct grain_observer *observer);

#endif
