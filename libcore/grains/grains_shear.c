/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Flight in sheared periodic boxes (Lees & Edwards, J. Phys. C 5 (1972) 1921; docs/physics.md 10.2). The images of the
 * box above and below it along axis 1 move along axis 0 at +-S L, L the length of axis 1: at time t they stand at +-S L
 * t. A grain that leaves through such an end comes back as the image of itself, displaced and with another velocity.
 *
 * Beyond that end every cell of the last row on the other side may come by, so a grain in an end row looks at all
 * grains of that row (of a square box this is less than the work for all others), at all their images along axis 0 that
 * come by before the grain leaves its cell; then it looks again. Thus (1) of grains_predict.c holds, with the time at
 * which one of the two leaves its cell as a third case. */
#include "libcore/grains/grains_private.h"

/* Returns the rows of images between which grain i of an end row looks: +1 from the highest, -1 from the lowest; 0: it
 * is in no end row. */
static int end_row(const struct grains *g, int i) {
    const int number = cell_number(&g->cells, g->event[i].cell, 1);
    return number == 0 ? -1 : number == g->cells.n[1] - 1 ? 1 : 0;
}

bool grains_is_sheared_row(const struct grains *g, int i) {
    return g->box.shear != 0 && end_row(g, i) != 0;
}

double grains_sheared(const struct grains *g, const struct grain *p, const struct grain *q, double t, double r[3],
                      double v[3]) {
    const double length = g->box.high[1] - g->box.low[1], period = g->box.high[0] - g->box.low[0];
    for (int k = 0; k < 3; k++) {
        r[k] = nearest(g, k, q->x[k] - p->x[k]);
        v[k] = q->u[k] - p->u[k];
    }
    const double above = r[1] < -0.5 * length ? 1 : r[1] > 0.5 * length ? -1 : 0; /* the image of q that is nearest */
    if (above == 0) return 0;
    r[1] += above * length;
    r[0] += above * g->box.shear * length * t;
    r[0] -= period * floor(r[0] / period + 0.5);
    v[0] += above * g->box.shear * length;
    return above * g->box.shear * length;
}

void grains_shear_wrap(struct grains *g, int i, bool up) {
    const double length = g->box.high[1] - g->box.low[1], way = up ? -1 : 1;
    const struct grain_cells *c = &g->cells;
    struct grain *p = &g->grain[i];
    const double before = p->u[0];
    p->x[0] = grains_wrap(&g->box, 0, p->x[0] + way * g->box.shear * length * p->t);
    p->u[0] += way * g->box.shear * length;
    g->impulse[0][0] += 0.5 * grains_mass(g, i) * (p->u[0] - before) * (p->u[0] + before);
    const double q = floor((p->x[0] - c->low[0]) / c->width[0]);
    const int number = (int)fmax(0, fmin(q, c->n[0] - 1));
    g->event[i].cell += number - cell_number(c, g->event[i].cell, 0);
}

/* Lists the grains of the row beyond an end: of all cells along axis 0, and those around the grain's along axis 2. */
static int occupants_beyond(const struct grains *g, int i, int side) {
    const struct grain_cells *c = &g->cells;
    struct grain_block b;
    int n = 0;
    grains_block(c, g->event[i].cell, STAYS, &b);
    b.from[1] = side > 0 ? 2 : 0;
    b.to[1] = b.from[1] + 1;
    for (int q = 0; q < c->n[0]; q++) {
        b.around[0] = c->row[0][q].around;
        b.from[0] = 1;
        b.to[0] = 2;
        n += grains_occupants(c, &b, g->list + n);
    }
    return n;
}

/* The images of a grain along axis 0 that may come by: relative place and velocity of one of them, and when (s) the two
 * are near each other along axis 1. */
struct passing {
    double r[3], v[3], from, to;
};

/* Sets the span within `horizon` in which |r_1 + v_1 s| <= d; returns whether there is one. */
static bool find_span(struct passing *w, double d, double horizon) {
    const double r = w->r[1], v = w->v[1];
    w->from = 0;
    w->to = horizon;
    if (v == 0) return fabs(r) <= d;
    const double a = (-d - r) / v, b = (d - r) / v;
    w->from = fmax(0, fmin(a, b));
    w->to = fmin(horizon, fmax(a, b));
    return w->from <= w->to;
}

/* Returns the first time (s) at which one of the images touches, approaching; HUGE_VAL: none. */
static double first_touch(const struct passing *w, double d, double period) {
    const double x0 = w->r[0] + w->v[0] * w->from, x1 = w->r[0] + w->v[0] * w->to;
    double first = HUGE_VAL;
    for (double m = ceil((-d - fmax(x0, x1)) / period); m <= floor((d - fmin(x0, x1)) / period); m++) {
        double rr = 0, rv = 0, vv = 0;
        for (int k = 0; k < 3; k++) {
            const double r = k == 0 ? w->r[0] + m * period : w->r[k];
            rr += r * r;
            rv += r * w->v[k];
            vv += w->v[k] * w->v[k];
        }
        const double c = fmax(rr - d * d, 0), square = rv * rv - vv * c;
        if (rv < 0 && square >= 0) first = fmin(first, c / (sqrt(square) - rv));
    }
    return first;
}

void grains_consider_beyond(struct grains *g, int i, double now, double leaving) {
    const double length = g->box.high[1] - g->box.low[1], period = g->box.high[0] - g->box.low[0];
    const double jump = g->box.shear * length, pass = now + period / fabs(jump);
    const double horizon = fmin(leaving, pass);
    const int side = end_row(g, i), m = occupants_beyond(g, i, side);
    struct grain *p = &g->grain[i];
    struct grain_event *e = &g->event[i];
    for (int q = 0; q < m; q++) {
        const int j = (int)g->list[q];
        struct passing w;
        double x[3], u[3];
        fly(g, &g->grain[j], now, x, u);
        for (int k = 0; k < 3; k++) {
            w.r[k] = nearest(g, k, x[k] - p->x[k]);
            w.v[k] = u[k] - p->u[k];
        }
        w.r[0] = x[0] - p->x[0] + side * jump * now;
        w.r[1] += side * length;
        w.v[0] += side * jump;
        const double d = g->law.diameter * grains_pair_size(g, i, j);
        if (!find_span(&w, d, horizon - now)) continue;
        const double t = now + first_touch(&w, d, period);
        if (!(t <= horizon) || !(g->grain[j].impact > t) || t > p->impact || (t == p->impact && j > e->partner))
            continue;
        p->impact = t;
        e->partner = j;
        e->known = g->event[j].changes;
    }
    if (horizon >= leaving || p->impact <= horizon) return;
    p->impact = horizon;
    e->partner = LOOK_AGAIN;
}
