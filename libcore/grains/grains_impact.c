/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Changes the velocities of two grains, or of a grain at a wall, in an impact; grains.h and docs/physics.md 10.1 have
 * the rule.
 *
 * A grain leaves an impact with at least a normal speed of v0 = 1e-13 (|u_a| + |u_b|) + 1e-7 sqrt(G d). That is far
 * below any approach speed except where without a threshold infinitely many impacts would fall into a finite time
 * (inelastic collapse; a grain at rest on the floor). There v0 bounds their number: a grain that hops on a floor stays
 * 2 v0/G > 0 in the air, and grains that touch within round-off move apart by more than round-off. */
#include "libcore/grains/grains_private.h"

static double speed(const double u[3]) {
    return sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
}

/* The speed after an approach is `ratio` times the speed before, but no less than `least`. rebound counts elastic
 * impacts. */
struct rebound {
    double ratio, speed;
};
static struct rebound rebound(struct grains *g, double approach, double e, double least) {
    bool soft = approach < g->law.threshold || e * approach < least;
    if (e < 1 && soft) g->counts.elastic++;
    double ratio = soft ? 1 : e;
    return (struct rebound){ratio, fmax(ratio * approach, least)};
}

double grains_speed_after(struct grains *g, double approach, double e, const double u[3]) {
    return rebound(g, approach, e, g->gentle + 1e-13 * speed(u)).speed;
}

struct grain_impact grains_impact_of(const struct grains *g, int a, int b, double t, const double r[3], double distance,
                                     double impulse) {
    const double size = b < 0 ? 0.5 * grains_size(g, a) : grains_pair_size(g, a, b);
    struct grain_impact i = {.t = t, .impulse = impulse, .a = a, .b = b, .branch = size * g->law.diameter};
    i.mass = grains_mass(g, a);
    const struct grain *p = &g->grain[a];
    for (int k = 0; k < g->dim; k++) {
        i.x[0][k] = p->x[k] - grains_swing(&g->box, k, t).s;
        if (g->box.periodic[k]) i.x[0][k] = grains_wrap(&g->box, k, i.x[0][k]);
        i.x[1][k] = i.x[0][k] + (b < 0 ? 0 : r[k]);
        i.normal[k] = r[k] / distance;
    }
    return i;
}

static void tell(struct grain_observer *observer, const struct grain_impact i) {
    observer->impact(observer, &i);
}

struct couple { /* of two grains: shares of the change of velocity, twice the reduced mass, restitution, growth */
    double share[2], mass, e, growth;
};
static struct couple couple_of(const struct grains *g, int a, int b) {
    if (!g->kind) return (struct couple){{1, 1}, g->law.mass, g->law.restitution, g->law.growth};
    const double m[2] = {grains_mass(g, a), grains_mass(g, b)}, both = m[0] + m[1];
    return (struct couple){{2 * m[1] / both, 2 * m[0] / both},
                           2 * m[0] * m[1] / both,
                           grains_restitution(g, a, b),
                           g->law.growth * grains_pair_size(g, a, b)};
}

void grains_collide(struct grains *g, int a, int b, double t, struct grain_observer *observer) {
    struct grain *p = &g->grain[a], *q = &g->grain[b];
    double r[3], v[3], square = 0, rv = 0, jump = 0, least = g->gentle + 1e-13 * (speed(p->u) + speed(q->u));
    for (int k = 0; k < 3; k++) {
        r[k] = nearest(g, k, q->x[k] - p->x[k]);
        v[k] = q->u[k] - p->u[k];
    }
    if (g->box.shear != 0) jump = grains_sheared(g, p, q, t, r, v);
    for (int k = 0; k < 3; k++) {
        square += r[k] * r[k];
        rv += r[k] * v[k];
    }
    const struct couple pair = couple_of(g, a, b);
    double distance = sqrt(square), normal = rv / distance, growth = pair.growth, approach = fmax(growth - normal, 0);
    struct rebound back = rebound(g, approach, pair.e, least);
    double after = back.speed + growth, factor = 0.5 * (after - normal) / distance;
    /* The same factor without the root, whose rounding has a bias: all distances are nearly one diameter. */
    if (growth == 0 && back.speed == back.ratio * approach) factor = -0.5 * (1 + back.ratio) * rv / square;
    for (int k = 0; k < 3; k++) {
        double du = factor * r[k];
        p->u[k] -= pair.share[0] * du;
        q->u[k] += pair.share[1] * du;
    }
    if (jump != 0) g->impulse[0][1] -= pair.mass * factor * r[0] * jump;
    g->event[a].changes++;
    g->event[b].changes++;
    g->counts.pairs++;
    g->counts.lost += 0.25 * pair.mass * (normal - after) * (normal + after);
    if (observer) tell(observer, grains_impact_of(g, a, b, t, r, distance, pair.mass * factor * distance));
}

void grains_rebound(struct grains *g, int a, int wall, double t, struct grain_observer *observer) {
    struct grain *p = &g->grain[a];
    int k = (-1 - wall) / 2, side = (-1 - wall) & 1;
    double out = side ? 1 : -1, e = g->box.restitution[k][side];
    const double mass = grains_mass(g, a);
    double growth = 0.5 * g->law.growth * grains_size(g, a), outward = out * (p->u[k] - grains_swing(&g->box, k, t).v);
    double approach = fmax(outward + growth, 0), after = grains_speed_after(g, approach, e, p->u) + growth;
    double gain = outward + after, r[3] = {0};
    p->u[k] -= out * gain;
    g->event[a].changes++;
    g->counts.walls++;
    g->counts.lost += 0.5 * mass * (outward - after) * (outward + after);
    g->counts.wall_impulse[k][side] += mass * gain;
    r[k] = out;
    if (observer) tell(observer, grains_impact_of(g, a, wall, t, r, 1, mass * gain));
}
