/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Predicts what happens to a grain next, for the order of events (docs/physics.md 10.2).
 *
 * Each grain stores one predicted impact, and the time at which it leaves its cell if that comes first. Between events
 * this holds for every pair i, j in neighbouring cells that would meet at t_ij on their present courses:
 *
 *   grain[i].impact <= t_ij  or  grain[j].impact <= t_ij.                                                      (1)
 *
 * So no impact is missed: the earliest of the true ones is stored by one of its two grains, or that grain has something
 * stored that comes before it. (1) survives because
 * - a grain whose event is taken, or whose velocity has changed, predicts anew from all its neighbours, and then its
 *   own side of (1) holds for all its pairs. An event whose partner has meanwhile changed is only a time at which to
 *   predict anew; until then it is early enough for (1).
 * - a grain that enters a cell keeps its event and looks only at the cells that are newly beside it, for the pairs with
 *   all others satisfy (1) already; the same courses stay the same.
 * - a grain i that predicts may leave out j when grain[j].impact <= t_ij: that is the other side of (1). It only
 *   becomes later when j predicts from all its neighbours, i among them.
 * Walls are in the same way part of i's own side. */
#include "libcore/grains/grains_private.h"

/* Candidates are looked at LANES at a time; their list is filled up with the grain itself. */
enum { LANES = 4 };
typedef double lanes __attribute__((vector_size(LANES * sizeof(double))));
typedef int64_t marks __attribute__((vector_size(LANES * sizeof(int64_t))));
typedef uint32_t indices __attribute__((vector_size(LANES * sizeof(uint32_t))));

/* Macros, for a function that takes vectors is called in another way on each instruction set. */
#define ONLY(where, yes)       ((lanes)((where) & (marks)(yes)))
#define CHOOSE(where, yes, no) ((lanes)(((where) & (marks)(yes)) | (~(where) & (marks)(no))))

ALWAYS_INLINE void take_root(lanes *of) {
    double v[LANES];
    memcpy(v, of, sizeof v);
    for (int q = 0; q < LANES; q++) v[q] = sqrt(v[q]);
    memcpy(of, v, sizeof v);
}

/* Gathers four numbers of each of LANES grains: column[k] holds the k-th number of all. */
ALWAYS_INLINE void gather(const struct grain *grain, const uint32_t *list, size_t offset, lanes column[4]) {
    lanes r[LANES];
    for (int q = 0; q < LANES; q++) memcpy(&r[q], (const char *)&grain[list[q]] + offset, sizeof r[q]);
    lanes even = __builtin_shufflevector(r[0], r[1], 0, 4, 2, 6), odd = __builtin_shufflevector(r[0], r[1], 1, 5, 3, 7);
    lanes even2 = __builtin_shufflevector(r[2], r[3], 0, 4, 2, 6),
          odd2 = __builtin_shufflevector(r[2], r[3], 1, 5, 3, 7);
    column[0] = __builtin_shufflevector(even, even2, 0, 1, 4, 5);
    column[1] = __builtin_shufflevector(odd, odd2, 0, 1, 4, 5);
    column[2] = __builtin_shufflevector(even, even2, 2, 3, 6, 7);
    column[3] = __builtin_shufflevector(odd, odd2, 2, 3, 6, 7);
}

struct found {
    double t;
    int64_t partner;
};

struct manner { /* wraps: a candidate may be seen beyond a periodic end; falls: there is gravity */
    int dim;
    bool wraps, falls, grows, mixed;
};

struct widths { /* of pairs of grains: mean diameters, and how fast they grow */
    lanes d, growth;
};
/* Finds those of grain i and each of LANES others, at `now`. */
ALWAYS_INLINE void find_widths(const struct grains *g, int i, double now, const uint32_t *list, bool mixed,
                               struct widths *w) {
    lanes size = (lanes){0} + 1;
    for (int q = 0; mixed && q < LANES; q++) size[q] = grains_pair_size(g, i, (int)list[q]);
    w->d = size * grains_diameter(g, now);
    w->growth = size * g->law.growth;
}

/* Takes the earliest of LANES times; of equal ones that with the lowest partner. */
ALWAYS_INLINE void take_first(const lanes *t, const marks *partner, struct found *first) {
    for (int q = 0; q < LANES; q++) {
        bool better = ((*t)[q] < first->t) | (((*t)[q] == first->t) & ((*partner)[q] < first->partner));
        first->t = better ? (*t)[q] : first->t;
        first->partner = better ? (*partner)[q] : first->partner;
    }
}

/* Finds the earliest of the times at which grain i has |r + v t| = d + growth t, approaching, with m others, and which
 * is before the other's own event; of equal times that with the lowest partner. Grains may touch or overlap by
 * round-off: if they close the time is now. Nothing branches, so that all candidates cost the same. */
ALWAYS_INLINE void meet(const struct grains *g, int i, double now, int m, struct found *first, struct manner manner) {
    const int dim = manner.dim;
    const bool wraps = manner.wraps, falls = manner.falls, grows = manner.grows;
    const struct grain *me = &g->grain[i];
    const lanes zero = {0}, never = zero + HUGE_VAL;
    lanes least = zero + first->t;
    marks with = (marks)zero + first->partner;
    for (const uint32_t *list = g->list; list < g->list + m; list += LANES) {
        lanes low[4], high[4], rv = zero, vv = zero, rr = zero;
        gather(g->grain, list, 0, low);
        gather(g->grain, list, 4 * sizeof(double), high);
        lanes x[3] = {low[0], low[1], low[2]}, u[3] = {low[3], high[0], high[1]}, dt = now - high[2], impact = high[3];
        for (int k = 0; k < dim; k++) {
            lanes fall = falls ? g->law.gravity[k] * dt : zero, v = (falls ? u[k] + fall : u[k]) - me->u[k];
            lanes r = x[k] + dt * (falls ? u[k] + 0.5 * fall : u[k]) - me->x[k];
            if (wraps) {
                r -= ONLY(r > g->half[k], zero + g->period[k]);
                r += ONLY(r < -g->half[k], zero + g->period[k]);
            }
            rv += r * v;
            vv += v * v;
            rr += r * r;
        }
        struct widths w;
        find_widths(g, i, now, list, manner.mixed, &w);
        lanes a = grows ? vv - w.growth * w.growth : vv, b = grows ? rv - w.d * w.growth : rv, c = rr - w.d * w.d;
        c = ONLY(c > 0, c);
        lanes square = b * b - a * c, root = ONLY(square > 0, square);
        take_root(&root);
        lanes t = CHOOSE((b < 0) & (square >= 0), now + c / (root - b), never);
        if (grows) t = CHOOSE((b >= 0) & (a < 0), now - (b + root) / a, t);
        indices index;
        memcpy(&index, list, sizeof index);
        marks j = __builtin_convertvector(index, marks);
        /* without growth b = 0 excludes the grain itself */
        t = CHOOSE(grows ? (impact > t) & (j != i) : impact > t, t, never);
        marks better = (t < least) | ((t == least) & (j < with));
        least = CHOOSE(better, t, least);
        with = (better & j) | (~better & with);
    }
    take_first(&least, &with, first);
}
/* One function each for disks and spheres; near: no candidate is seen beyond a periodic end; free: no gravity. */
typedef void meeting(const struct grains *g, int i, double now, int m, struct found *first);
#define MEETING(name, ...)                                                                                             \
    KERNEL static void name(const struct grains *g, int i, double now, int m, struct found *first) {                   \
        meet(g, i, now, m, first, (struct manner){__VA_ARGS__, false, false});                                         \
    }
MEETING(disks_near_free, 2, false, false)
MEETING(disks_near, 2, false, true)
MEETING(disks_free, 2, true, false)
MEETING(disks, 2, true, true)
MEETING(spheres_near_free, 3, false, false)
MEETING(spheres_near, 3, false, true)
MEETING(spheres_free, 3, true, false)
MEETING(spheres, 3, true, true)
static void growing(const struct grains *g, int i, double now, int m, struct found *first) {
    meet(g, i, now, m, first, (struct manner){3, true, false, true, false});
}
static void mixed_growing(const struct grains *g, int i, double now, int m, struct found *first) {
    meet(g, i, now, m, first, (struct manner){3, true, false, true, true});
}
KERNEL static void mixed(const struct grains *g, int i, double now, int m, struct found *first) {
    meet(g, i, now, m, first, (struct manner){3, true, true, false, true});
}

static meeting *meeting_of(const struct grains *g, bool wraps) {
    if (g->law.growth != 0) return g->kind ? mixed_growing : growing;
    if (g->kind) return mixed;
    if (g->dim == 2) return g->falls ? (wraps ? disks : disks_near) : wraps ? disks_free : disks_near_free;
    return g->falls ? (wraps ? spheres : spheres_near) : wraps ? spheres_free : spheres_near_free;
}

static void consider_cells(struct grains *g, int i, double now, int exit) {
    struct grain_block b;
    struct grain *p = &g->grain[i];
    struct grain_event *e = &g->event[i];
    grains_block(&g->cells, e->cell, exit, &b);
    if (g->box.shear != 0) { /* grains_shear.c looks beyond the ends */
        const int number = cell_number(&g->cells, e->cell, 1);
        b.from[1] += number == 0 && b.from[1] == 0;
        b.to[1] -= number == g->cells.n[1] - 1 && b.to[1] == 3;
    }
    int m = grains_occupants(&g->cells, &b, g->list);
    for (int q = 0; q < LANES; q++) g->list[m + q] = (uint32_t)i;
    if (g->n > CACHED)
        for (int q = 0; q < m; q++) __builtin_prefetch(&g->grain[g->list[q]]);
    struct found first = {p->impact, e->partner};
    meeting_of(g, b.wraps)(g, i, now, m, &first);
    if (first.t == p->impact && first.partner == e->partner) return;
    p->impact = first.t;
    e->partner = (int32_t)first.partner;
    e->known = g->event[e->partner].changes;
}

/* Returns the time in which x, moving at u, leaves the space between the edges, and on which side; nothing branches on
 * the sign of u. */
static inline double leaves_straight(const double edge[2], double x, double u, int *side) {
    int up = u > 0;
    *side = up;
    return larger((edge[up] - x) * (2 * up - 1), 0) / fabs(u);
}

static inline double leaves_falling(const double edge[2], double x, double u, double a, int *side) {
    double first = HUGE_VAL;
    for (int s = 0; s < 2; s++) {
        double h = s ? edge[1] - x : x - edge[0];
        double t = h < HUGE_VAL ? grains_first_root(h, s ? -u : u, s ? -a : a) : HUGE_VAL;
        if (t >= first) continue;
        first = t;
        *side = s;
    }
    return first;
}

/* Returns when grain i leaves its cell; *exit is the face. */
static double leaves(const struct grains *g, int i, int *exit) {
    const struct grain *p = &g->grain[i];
    double first = HUGE_VAL;
    int through = STAYS;
    for (int k = 0; k < g->dim; k++) {
        const double *edge = cell_row(&g->cells, g->event[i].cell, k)->edge;
        int side = 0;
        double t = g->law.gravity[k] == 0 ? leaves_straight(edge, p->x[k], p->u[k], &side)
                                          : leaves_falling(edge, p->x[k], p->u[k], g->law.gravity[k], &side);
        through += (2 * k + side - through) * (t < first); /* a product does not branch; 0/0 is not less */
        first = smaller(t, first);
    }
    *exit = through;
    return p->t + first;
}

/* Looks for impacts on walls no later than the exit from the cell: after it the grain looks again. */
static void consider_walls(struct grains *g, int i, double leaving) {
    const struct grain_cells *c = &g->cells;
    struct grain *p = &g->grain[i];
    struct grain_event *e = &g->event[i];
    if (g->box.facets) {
        grains_consider_facets(g, i, leaving);
        return;
    }
    for (int k = 0; k < g->dim; k++)
        for (int side = 0; side < 2; side++) {
            int number = cell_number(c, e->cell, k);
            if (side ? number < c->reach[k][1] : number > c->reach[k][0]) continue;
            bool again;
            double t = grains_wall_time(g, i, k, side, fmin(p->impact, leaving), &again);
            if (t >= p->impact) continue;
            p->impact = t;
            e->partner = again ? LOOK_AGAIN : -1 - (2 * k + side);
        }
}

static void settle(struct grains *g, int i) {
    int exit;
    double leaving = leaves(g, i, &exit);
    if (grains_is_sheared_row(g, i)) grains_consider_beyond(g, i, g->grain[i].t, leaving);
    consider_walls(g, i, leaving);
    calendar_move(g->queue, i, fmin(leaving, g->grain[i].impact));
}

static void forget(struct grains *g, int i) {
    g->grain[i].impact = HUGE_VAL;
    g->event[i].partner = NO_PARTNER;
}

void grains_predict(struct grains *g, int i, double now) {
    forget(g, i);
    consider_cells(g, i, now, STAYS);
    settle(g, i);
}

void grains_predict_beyond(struct grains *g, int i, double now, int exit) {
    if (grains_is_sheared_row(g, i)) {
        grains_predict(g, i, now);
        return;
    }
    consider_cells(g, i, now, exit);
    settle(g, i);
}

double grains_schedule(const struct grains *g, int i) {
    int exit;
    if (is_gone(g, i)) return HUGE_VAL;
    return fmin(leaves(g, i, &exit), g->grain[i].impact);
}

int grains_exit(const struct grains *g, int i) {
    int exit;
    leaves(g, i, &exit);
    return exit;
}

void grains_predict_all(struct grains *g) {
    for (int i = 0; i < g->n; i++) {
        if (!is_gone(g, i)) forget(g, i);
        calendar_set(g->queue, i, HUGE_VAL);
    }
    calendar_start(g->queue, g->time);
    for (int i = 0; i < g->n; i++)
        if (!is_gone(g, i)) grains_predict(g, i, g->time);
    calendar_start(g->queue, g->time);
}
