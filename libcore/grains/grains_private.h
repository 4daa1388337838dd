/* What the files of the engine share. Times of events are absolute; all places and velocities in the frame at rest. */
#ifndef LIBCORE_GRAINS_PRIVATE_H
#define LIBCORE_GRAINS_PRIVATE_H

#include "libcore/grains/calendar.h"
#include "libcore/grains/grains.h"
#include "libcore/models/kernel.h"

enum {
    NO_PARTNER = -1000, /* with t = HUGE_VAL */
    LOOK_AGAIN = -100,  /* nothing found up to t: predict anew */
    STAYS = -1,         /* in its cell */
    CACHED = 8000       /* so many grains fit into a cache; beyond, memory is asked for ahead */
};

/* Cells of at least one diameter. A grain's `cell` packs its three numbers, `bits` each; arrays of cells are indexed by
 * the sum of what its rows say. Along axes with walls a layer of empty cells lies beyond each wall, so that every cell
 * has neighbours on both sides. As many as SLOTS occupants stand in a cell's slots; a fuller one (a dense or a wide
 * cell) has all but SLOTS - 1 of them in a chain through `next` that begins in the last. */
enum { SLOTS = 4, CHAINED = SLOTS + 1, SLOT_BITS = 29, NEIGHBOURS = 27, ROOM = (NEIGHBOURS + 2) * SLOTS };
struct grain_row {     /* the cells of one number along an axis */
    int32_t around[3]; /* parts of the index: of the cells before, of its own, of those after */
    int32_t wraps;     /* some of those are beyond a periodic end */
    double edge[2];    /* where it is left; a wall: -HUGE_VAL, HUGE_VAL */
};
struct grain_cells {
    int n[3], bits[3], planes;        /* planes: of neighbours along the last axis, 1 in 2D, else 3 */
    struct grain_row *row[3];         /* [n[k]] */
    double low[3], high[3], width[3]; /* what they cover, at rest; a shaken wall's whole reach */
    int reach[3][2];                  /* cells <= reach[k][0], >= reach[k][1] may touch a wall */
    int32_t all;                      /* cells, with those beyond the walls */
    uint32_t *slot;                   /* [all][SLOTS]; count << SLOT_BITS is added to the last, count: or CHAINED */
    int32_t *next;                    /* [n] */
};

struct grains {
    struct grain_box box;
    struct grain_law law;
    int n, dim;
    double start, time; /* start: when the diameter was law.diameter */
    double outgrown;    /* when it reaches the width of the cells; HUGE_VAL: never */
    struct grain *grain;
    struct grain_event *event;
    int32_t *id;
    struct grain_counts counts;
    struct grain_cells cells;
    struct calendar *queue;
    int64_t sort_at;           /* so many pairs; -1: never */
    uint64_t *order;           /* [n] scratch of grains_sort */
    uint32_t *list;            /* [n + ROOM] of occupants: scratch of a prediction */
    double period[3], half[3]; /* of periodic axes: length and half of it; else 0, HUGE_VAL */
    bool falls;                /* gravity is not zero */
    double gentle;             /* m/s: 1e-7 sqrt(G diameter), see grains_impact.c */
    double pull[3];            /* m/s^2: bound G_k of the acceleration relative to the box */
};

struct swing { /* of the box along one axis */
    double s, v;
};
double grains_phase_cos(double x, double *sine);
struct swing grains_swing(const struct grain_box *box, int axis, double t);
static inline double grains_diameter(const struct grains *g, double t) {
    return g->law.diameter + g->law.growth * (t - g->start);
}
static inline bool is_shaken(const struct grain_box *box, int k) {
    return !box->periodic[k] && box->shake[k] != 0;
}

/* x and u at time t */
static inline void fly(const struct grains *g, const struct grain *p, double t, double x[3], double u[3]) {
    double dt = t - p->t;
    for (int k = 0; k < 3; k++) {
        double a = g->law.gravity[k];
        x[k] = p->x[k] + dt * (p->u[k] + 0.5 * a * dt);
        u[k] = p->u[k] + a * dt;
    }
}
static inline void bring(const struct grains *g, struct grain *p, double t) {
    double x[3], u[3];
    fly(g, p, t, x, u);
    for (int k = 0; k < 3; k++) {
        p->x[k] = x[k];
        p->u[k] = u[k];
    }
    p->t = t;
}
/* r becomes the difference to the nearest image (of grains that are in neighbouring cells). */
static inline double nearest(const struct grains *g, int k, double r) {
    r -= r > g->half[k] ? g->period[k] : 0;
    return r + (r < -g->half[k] ? g->period[k] : 0);
}

/* grains_cells.c */
status grains_cells_make(struct grains *g);
bool grains_cells_widen(struct grains *g); /* for the diameter at g->time, all clocks showing it; false: no room */
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
/* Moves grain i, which is brought to the time of leaving, through the face `exit`. */
void grains_cell_cross(struct grains *g, int i, int exit);
struct grain_block { /* of cells: the product of those around one along each axis */
    const int32_t *around[3];
    int from[3], to[3], wraps;
};
/* All about a cell; exit != STAYS: only those new beyond that face. */
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
/* All in the cells of a block; list has room for n + ROOM. Returns how many. */
int grains_occupants(const struct grain_cells *c, const struct grain_block *b, uint32_t *list);

void grains_cells_fill(struct grains *g); /* from the grains' cells */

/* grains_order.c: indices change; the queue is to be made anew from the grains. */
void grains_sort(struct grains *g);
void grains_set_sorting(struct grains *g); /* sort_at from the counts */

/* grains_predict.c; grain i's clock shows `now` */
void grains_predict(struct grains *g, int i, double now);                  /* from all neighbours */
void grains_predict_beyond(struct grains *g, int i, double now, int exit); /* after a crossing */
double grains_schedule(const struct grains *g, int i);                     /* the time of its next event */
int grains_exit(const struct grains *g, int i); /* the face where it leaves its cell: 2 axis + side, or STAYS */
void grains_predict_all(struct grains *g);      /* all clocks show g->time */
double grains_wrap(const struct grain_box *box, int k, double x); /* into the box */
/* grains_walls.c: the wall's first contact no later than `limit`, else HUGE_VAL; *again: none up to the time returned
 */
double grains_wall_time(const struct grains *g, int i, int axis, int side, double limit, bool *again);
double grains_first_root(double h, double v, double a);

/* grains_impact.c */
void grains_collide(struct grains *g, int a, int b, double t, struct grain_observer *observer);
void grains_rebound(struct grains *g, int a, int wall, double t, struct grain_observer *observer);

#endif
