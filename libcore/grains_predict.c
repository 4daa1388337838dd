/* What happens to a grain next.
 *
 * Each grain stores one predicted impact, and the time at which it leaves its cell if that comes first. What holds
 * between events, for every pair i, j in neighbouring cells that would meet at t_ij on their present courses, is
 *
 *   event[i].t <= t_ij  or  event[j].t <= t_ij.                                                                (1)
 *
 * So no impact is missed: the earliest of the true ones is stored by one of its two grains, or that grain has something
 * stored that comes before it. (1) survives because
 * - a grain whose event is taken, or whose velocity has changed, predicts anew from all its neighbours, and then its
 *   own side of (1) holds for all its pairs. An event whose partner has meanwhile changed is only a time at which to
 *   predict anew; until then it is early enough for (1).
 * - a grain that enters a cell keeps its event and looks only at the cells that are newly beside it, for the pairs with
 *   all others satisfy (1) already; the same courses stay the same.
 * - a grain i that predicts may leave out j when event[j].t <= t_ij: that is the other side of (1). event[j] only
 *   becomes later when j predicts from all its neighbours, i among them.
 * Walls are in the same way part of i's own side. */
#include "libcore/grains_private.h"

enum { PAD = 8 }; /* candidates are filled up to a whole vector with the grain itself */

/* The grain that predicts, and what tells when others meet it */
struct mover {
    double x[3], u[3], gravity[3], period[3], half[3], now, d, growth;
};

/* Times at which |r + v t| = d + growth t, approaching; HUGE_VAL: never. They may touch or overlap by round-off: then
 * it is now if they close. Nothing branches, so that all candidates cost the same. */
ALWAYS_INLINE void meet(const struct mover *mover, const struct grain *restrict grain, int m,
                        const uint32_t *restrict list, double *restrict when, int dim, bool grows) {
    const struct mover me = *mover;
    for (int q = 0; q < (m + PAD - 1) / PAD * PAD; q++) {
        const struct grain *p = &grain[list[q]];
        double dt = me.now - p->t, rv = 0, vv = 0, rr = 0;
        for (int k = 0; k < dim; k++) {
            double fall = me.gravity[k] * dt, v = p->u[k] + fall - me.u[k];
            double r = p->x[k] + dt * (p->u[k] + 0.5 * fall) - me.x[k];
            r -= select_double(r > me.half[k], me.period[k], 0);
            r += select_double(r < -me.half[k], me.period[k], 0);
            rv += r * v;
            vv += v * v;
            rr += r * r;
        }
        double a = grows ? vv - me.growth * me.growth : vv, b = grows ? rv - me.d * me.growth : rv;
        double c = larger(rr - me.d * me.d, 0), square = b * b - a * c, root = sqrt(larger(square, 0));
        double t = select_double((b < 0) & (square >= 0), me.now + c / (root - b), HUGE_VAL);
        if (grows) t = select_double((b >= 0) & (a < 0), me.now - (b + root) / a, t);
        when[q] = t;
    }
}
KERNEL static void meet_disks(const struct mover *me, const struct grain *grain, int m, const uint32_t *list,
                              double *when) {
    meet(me, grain, m, list, when, 2, false);
}
KERNEL static void meet_spheres(const struct mover *me, const struct grain *grain, int m, const uint32_t *list,
                                double *when) {
    meet(me, grain, m, list, when, 3, false);
}
static void meet_growing(const struct mover *me, const struct grain *grain, int m, const uint32_t *list, double *when) {
    meet(me, grain, m, list, when, 3, true);
}

/* Which of m candidates grain i meets first, before `best`, equal times by the index; < 0: none */
static int first_of(const struct grains *g, int m, int i, const struct grain_event *best) {
    double first = best->t;
    int at = -1, partner = best->partner;
    for (int q = 0; q < m; q++) {
        double t = g->meeting[q];
        int j = (int)g->list[q];
        if (t > first || t == HUGE_VAL || (t == first && j >= partner) || j == i) continue;
        first = t;
        partner = j;
        at = q;
    }
    return at;
}

static void consider_cells(struct grains *g, int i, double now, int exit, struct grain_event *best) {
    struct grain_block b;
    grains_block(&g->cells, g->box.periodic, g->grain[i].cell, exit, &b);
    int m = grains_occupants(&g->cells, &b, g->list);
    for (int q = 0; q < PAD; q++) g->list[m + q] = (uint32_t)i;
    for (int q = 0; q < m; q++) {
        __builtin_prefetch(&g->grain[g->list[q]]);
        __builtin_prefetch(&g->event[g->list[q]]);
    }
    struct mover me = {.now = now, .d = grains_diameter(g, now), .growth = g->law.growth};
    for (int k = 0; k < 3; k++) {
        me.x[k] = g->grain[i].x[k];
        me.u[k] = g->grain[i].u[k];
        me.gravity[k] = g->law.gravity[k];
        me.period[k] = g->period[k];
        me.half[k] = g->half[k];
    }
    if (g->law.growth != 0)
        meet_growing(&me, g->grain, m, g->list, g->meeting);
    else if (g->dim == 2)
        meet_disks(&me, g->grain, m, g->list, g->meeting);
    else
        meet_spheres(&me, g->grain, m, g->list, g->meeting);
    for (int earliest; (earliest = first_of(g, m, i, best)) >= 0;) { /* event[] of few is read */
        double t = g->meeting[earliest];
        int j = (int)g->list[earliest];
        if (g->event[j].t > t) {
            *best = (struct grain_event){t, j, g->grain[j].changes};
            return;
        }
        g->meeting[earliest] = HUGE_VAL;
    }
}

/* When x, moving at u inside cell `number` of axis k, leaves it, and which side; nothing branches on the sign of u. */
static inline double leaves_straight(const struct grains *g, int k, int number, double x, double u, int *side) {
    const struct grain_cells *c = &g->cells;
    bool up = u > 0, wall = !g->box.periodic[k] && number == (up ? c->n[k] - 1 : 0);
    double edge = grains_cell_edge(c, k, number + up), h = larger(up ? edge - x : x - edge, 0);
    *side = up;
    return wall || u == 0 ? HUGE_VAL : h / fabs(u);
}

static inline double leaves_falling(const struct grains *g, int k, int number, double x, double u, int *side) {
    const struct grain_cells *c = &g->cells;
    double first = HUGE_VAL, a = g->law.gravity[k];
    for (int s = 0; s < 2; s++) {
        if (!g->box.periodic[k] && number == (s ? c->n[k] - 1 : 0)) continue;
        double h = s ? grains_cell_edge(c, k, number + 1) - x : x - grains_cell_edge(c, k, number);
        double t = grains_first_root(h, s ? -u : u, s ? -a : a);
        if (t >= first) continue;
        first = t;
        *side = s;
    }
    return first;
}

/* When and where grain i leaves its cell */
static double leaves(const struct grains *g, int i, int *exit) {
    const struct grain *p = &g->grain[i];
    double first = HUGE_VAL;
    *exit = STAYS;
    for (int k = 0; k < g->dim; k++) {
        int number = cell_number(&g->cells, p->cell, k), side = 0;
        double t = g->law.gravity[k] == 0 ? leaves_straight(g, k, number, p->x[k], p->u[k], &side)
                                          : leaves_falling(g, k, number, p->x[k], p->u[k], &side);
        *exit = t < first ? 2 * k + side : *exit;
        first = smaller(t, first);
    }
    return p->t + first;
}

/* Walls no later than the exit from the cell: after it they are looked for again. */
static void consider_walls(const struct grains *g, int i, double leaving, struct grain_event *best) {
    const struct grain_cells *c = &g->cells;
    for (int k = 0; k < g->dim; k++)
        for (int side = 0; side < 2; side++) {
            int number = cell_number(c, g->grain[i].cell, k);
            if (side ? number < c->reach[k][1] : number > c->reach[k][0]) continue;
            bool again;
            double t = grains_wall_time(g, i, k, side, fmin(best->t, leaving), &again);
            if (t < best->t) *best = (struct grain_event){t, again ? LOOK_AGAIN : -1 - (2 * k + side), 0};
        }
}

static void settle(struct grains *g, int i, struct grain_event best) {
    int exit;
    double leaving = leaves(g, i, &exit);
    consider_walls(g, i, leaving, &best);
    g->event[i] = best;
    g->exit[i] = (int8_t)(leaving < best.t ? exit : STAYS);
    calendar_move(g->queue, i, fmin(leaving, best.t));
}

void grains_predict(struct grains *g, int i, double now) {
    struct grain_event best = {HUGE_VAL, NO_PARTNER, 0};
    consider_cells(g, i, now, STAYS, &best);
    settle(g, i, best);
}

void grains_predict_beyond(struct grains *g, int i, double now, int exit) {
    struct grain_event best = g->event[i];
    consider_cells(g, i, now, exit, &best);
    settle(g, i, best);
}

double grains_schedule(struct grains *g, int i) {
    int exit;
    double leaving = leaves(g, i, &exit), t = g->event[i].t;
    g->exit[i] = (int8_t)(leaving < t ? exit : STAYS);
    return fmin(leaving, t);
}

void grains_predict_all(struct grains *g) {
    for (int i = 0; i < g->n; i++) {
        g->event[i] = (struct grain_event){HUGE_VAL, NO_PARTNER, 0};
        calendar_set(g->queue, i, HUGE_VAL);
    }
    calendar_start(g->queue, g->time);
    for (int i = 0; i < g->n; i++) grains_predict(g, i, g->time);
    calendar_start(g->queue, g->time);
}
