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

/* Time from now at which |r + v t| = d + growth t, approaching; HUGE_VAL: never. They may touch or overlap by
 * round-off: then it is now if they close. */
double grains_meet(const double r[3], const double v[3], double d, double growth) {
    double b = r[0] * v[0] + r[1] * v[1] + r[2] * v[2] - d * growth;
    double a = v[0] * v[0] + v[1] * v[1] + v[2] * v[2] - growth * growth;
    if (b >= 0 && a >= 0) return HUGE_VAL;
    double c = r[0] * r[0] + r[1] * r[1] + r[2] * r[2] - d * d;
    if (c <= 0) return b < 0 ? 0 : -2 * b / a;
    double square = b * b - a * c;
    if (square < 0) return HUGE_VAL;
    return b < 0 ? c / (sqrt(square) - b) : (-b - sqrt(square)) / a;
}

static inline void consider(struct grains *g, int i, int j, double now, double d, struct grain_event *best) {
    const struct grain *p = &g->grain[i], *q = &g->grain[j];
    double x[3], u[3], r[3], v[3];
    fly(g, q, now, x, u);
    for (int k = 0; k < 3; k++) {
        r[k] = nearest(g, k, x[k] - p->x[k]);
        v[k] = u[k] - p->u[k];
    }
    double t = now + grains_meet(r, v, d, g->law.growth);
    if (!(t < best->t || (t == best->t && j < best->partner)) || g->event[j].t <= t) return;
    *best = (struct grain_event){t, j, q->changes};
}

static void consider_cells(struct grains *g, int i, double now, int exit, struct grain_event *best) {
    const struct grain_cells *c = &g->cells;
    struct grain_block b = grains_block(c, g->box.periodic, g->grain[i].cell, exit);
    double d = grains_diameter(g, now);
    for (int z = 0; z < b.n[2]; z++)
        for (int y = 0; y < b.n[1]; y++)
            for (int x = 0; x < b.n[0]; x++)
                for (int j = c->head[b.start[0][x] + b.start[1][y] + b.start[2][z]]; j >= 0; j = c->next[j])
                    if (j != i) consider(g, i, j, now, d, best);
}

/* When and where grain i leaves its cell */
static double leaves(const struct grains *g, int i, int *exit) {
    const struct grain_cells *c = &g->cells;
    const struct grain *p = &g->grain[i];
    double first = HUGE_VAL;
    *exit = STAYS;
    for (int k = 0; k < g->dim; k++) {
        int number = cell_number(c, p->cell, k);
        double a = g->law.gravity[k];
        for (int side = 0; side < 2; side++) {
            if (!g->box.periodic[k] && number == (side ? c->n[k] - 1 : 0)) continue;
            double h = side ? grains_cell_edge(c, k, number + 1) - p->x[k] : p->x[k] - grains_cell_edge(c, k, number);
            double t = grains_first_root(h, side ? -p->u[k] : p->u[k], side ? -a : a);
            if (t < first) {
                first = t;
                *exit = 2 * k + side;
            }
        }
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
