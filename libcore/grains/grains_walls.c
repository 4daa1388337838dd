/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds when a grain in flight touches a flat wall (docs/physics.md 10.2): a wall at rest by the root of a parabola, a
 * moving wall by steps that cannot pass the first contact. */
#include "libcore/grains/grains_private.h"

/* Returns the first t >= 0 at which h + v t + a t^2/2 falls to zero; HUGE_VAL: never. h <= 0 is a contact: the root is
 * 0 if it closes, else the next one. */
double grains_first_root(double h, double v, double a) {
    if (h <= 0) {
        if (v < 0 || (v == 0 && a < 0)) return 0;
        return a < 0 ? -2 * v / a : HUGE_VAL;
    }
    double square = v * v - 2 * a * h;
    if (square < 0 || (v >= 0 && a >= 0)) return HUGE_VAL;
    double root = sqrt(square);
    return v < 0 ? 2 * h / (root - v) : (v + root) / -a;
}

/* Computes cos x and sin x to 1e-16 for |x| < 1e6, the same bits everywhere: x - n pi/2 with pi/2 in three parts (33
 * bits each), then the minimax polynomials of fdlibm on |y| < pi/4. */
double grains_phase_cos(double x, double *sine) {
    const double round_bits = 6755399441055744.0; /* 1.5 * 2^52 */
    double n = x * 0.63661977236758138243 + round_bits - round_bits;
    double y = x - n * 1.57079632673412561417 - n * 6.07710050630396597660e-11 - n * 2.02226624871116645580e-21;
    double z = y * y;
    double s = 2.75573137070700676789e-06 + z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10);
    s = -1.66666666666666324348e-01 + z * (8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04 + z * s));
    s = y + y * z * s;
    double c = -2.75573143513906633035e-07 + z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11);
    c = 4.16666666666666019037e-02 + z * (-1.38888888888741095749e-03 + z * (2.48015872894767294178e-05 + z * c));
    c = 1 - (0.5 * z - z * z * c);
    int64_t quarter = (int64_t)n & 3;
    double swapped_s = quarter & 1 ? c : s, swapped_c = quarter & 1 ? s : c;
    *sine = quarter & 2 ? -swapped_s : swapped_s;
    return quarter == 1 || quarter == 2 ? -swapped_c : swapped_c;
}

struct swing grains_swing(const struct grain_box *box, int axis, double t) {
    if (box->shake[axis] == 0) return (struct swing){0, 0};
    double sine, cosine = grains_phase_cos(box->omega * t + box->phase, &sine);
    return (struct swing){box->shake[axis] * cosine, -box->shake[axis] * box->omega * sine};
}

/* The distance h of the surfaces has |h''| <= G, so that it cannot reach zero before h + h' d - G d^2/2 does; steps of
 * that d never pass the first contact, and near it they converge as Newton's do. The search ends when a step no longer
 * changes the time: the contact is then exact to a few units in the last place of the time (and of x, through h'). */
static double moving_wall_time(const struct grains *g, int i, int k, int side, double limit, bool *again) {
    enum { STEPS = 100 };
    const struct grain *p = &g->grain[i];
    const double radius = 0.5 * g->law.diameter * grains_size(g, i);
    double sign = side ? -1 : 1, wall = side ? -g->box.high[k] : g->box.low[k], G = g->pull[k], t = p->t;
    for (int step = 0; step < STEPS; step++) {
        struct swing w = grains_swing(&g->box, k, t);
        double dt = t - p->t, a = g->law.gravity[k];
        double h = sign * (p->x[k] + dt * (p->u[k] + 0.5 * a * dt) - w.s) - wall - radius;
        double v = sign * (p->u[k] + a * dt - w.v);
        if (h <= 0) {
            if (v < 0 || (v == 0 && G > 0)) return t;
            h = 0;
        }
        double root = sqrt(v * v + 2 * G * h), d = v > 0 ? (v + root) / G : 2 * h / (root - v);
        if (!(t + d <= limit)) return HUGE_VAL;
        if (t + d == t) return t;
        t += d;
    }
    *again = true;
    return t;
}

double grains_wall_time(const struct grains *g, int i, int axis, int side, double limit, bool *again) {
    const struct grain *p = &g->grain[i];
    *again = false;
    if (is_shaken(&g->box, axis)) return moving_wall_time(g, i, axis, side, limit, again);
    const double size = grains_size(g, i);
    double radius = 0.5 * grains_diameter(g, p->t) * size, a = g->law.gravity[axis], u = p->u[axis];
    double h = side ? g->box.high[axis] - radius - p->x[axis] : p->x[axis] - (g->box.low[axis] + radius);
    double v = (side ? -u : u) - 0.5 * g->law.growth * size;
    double t = p->t + grains_first_root(h, v, side ? -a : a);
    return t <= limit ? t : HUGE_VAL;
}
