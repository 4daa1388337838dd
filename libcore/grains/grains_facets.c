/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds when a grain in flight touches facets, the walls of any shape (facets.h; docs/physics.md 10.2), and lets it
 * rebound from them (10.1; rough ones: docs/physics.md 10.7). */
#include "libcore/grains/grains_private.h"
#include "libcore/grains/random.h"

struct approach { /* distance of the surfaces of a grain and a facet (m), its rate (m/s), the unit normal of the latter
                   */
    double h, v, normal[3];
};

static double along(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Computes place and velocity of a grain at time t in the frame of the box. */
static void fly_in_box(const struct grains *g, const struct grain *p, double t, double x[3], double u[3]) {
    fly(g, p, t, x, u);
    for (int k = 0; k < g->dim; k++) {
        struct swing w = grains_swing(&g->box, k, t);
        x[k] -= w.s;
        u[k] -= w.v;
    }
}

static struct approach approach_at(const struct grains *g, int i, const struct facet *f, double t) {
    struct approach a;
    double x[3], u[3], size = grains_size(g, i);
    fly_in_box(g, &g->grain[i], t, x, u);
    a.h = facet_distance(f, g->dim, x, a.normal) - 0.5 * grains_diameter(g, t) * size;
    a.v = along(a.normal, u) - 0.5 * g->law.growth * size;
    return a;
}

/* Is the point of the facet's plane that is nearest to x in the facet, or beyond it by no more than `slack` (m)? */
static bool is_over(const struct facet *f, int dim, const double x[3], double slack) {
    for (int j = 0; j < dim; j++) {
        double s = 0;
        for (int k = 0; k < dim; k++) s += (x[k] - f->corner[j][k]) * f->out[j][k];
        if (s > slack) return false;
    }
    return true;
}

/* Of a box at rest: returns the first time at which the grain touches the plane of the facet, before which it cannot
 * touch the facet; HUGE_VAL: never. *done: it touches the facet then. */
static double plane_time(const struct grains *g, int i, const struct facet *f, bool *done) {
    const struct grain *p = &g->grain[i];
    double r[3], x[3], u[3], size = grains_size(g, i);
    for (int k = 0; k < 3; k++) r[k] = p->x[k] - f->corner[0][k];
    const double height = along(r, f->normal), sign = height < 0 ? -1 : 1; /* it may pass behind, on another wall */
    double h = fabs(height) - 0.5 * grains_diameter(g, p->t) * size;
    double v = sign * along(p->u, f->normal) - 0.5 * g->law.growth * size, a = sign * along(g->law.gravity, f->normal);
    *done = false;
    if (h <= 0 && !is_over(f, g->dim, p->x, 0)) return p->t;
    double t = p->t + grains_first_root(h, v, a);
    if (t == HUGE_VAL) return t;
    fly(g, p, t, x, u);
    *done = is_over(f, g->dim, x, 0);
    return t;
}

/* Returns when the centre of a grain comes to an open facet, from within; no later than `limit`, else HUGE_VAL. */
static double open_time(const struct grains *g, const struct grain *p, const struct facet *f, double limit) {
    double r[3], x[3], u[3];
    for (int k = 0; k < 3; k++) r[k] = p->x[k] - f->corner[0][k];
    const double t =
        p->t + grains_first_root(along(r, f->normal), along(p->u, f->normal), along(g->law.gravity, f->normal));
    if (!(t <= limit)) return HUGE_VAL;
    fly(g, p, t, x, u);
    return is_over(f, g->dim, x, 1e-7 * g->law.diameter) ? t : HUGE_VAL;
}

void grains_depart(struct grains *g, int i, int partner) {
    const int wall = g->box.facets->facet[FIRST_FACET - partner].wall;
    const struct grain *p = &g->grain[i];
    double *momentum = g->impulse[wall], *left = g->impulse[g->box.facets->space.walls + wall];
    const double mass = grains_mass(g, i);
    left[0]++;
    for (int k = 0; k < g->dim; k++) {
        momentum[k] += mass * p->u[k];
        left[1] += 0.5 * mass * p->u[k] * p->u[k];
        left[2] -= mass * g->law.gravity[k] * p->x[k];
    }
    grains_cell_leave(g, i);
    g->grain[i].impact = HUGE_VAL;
    g->event[i].partner = GONE;
    if (g->vacant) g->vacant[i / 64] |= (uint64_t)1 << i % 64;
    g->event[i].changes++;
    calendar_move(g->queue, i, HUGE_VAL);
}

/* The steps of grains_walls.c, with the bound G of all components of the acceleration. */
double grains_facet_time(const struct grains *g, int i, int facet, double limit, bool *again) {
    enum { STEPS = 100 };
    const struct grain *p = &g->grain[i];
    const struct facet *f = &g->box.facets->facet[facet];
    double G = g->pull_all, t = p->t;
    bool done = false;
    *again = false;
    if (f->open && g->opens) return open_time(g, p, f, limit);
    if (!g->swings) t = plane_time(g, i, f, &done);
    if (!(t <= limit)) return HUGE_VAL;
    for (int step = 0; step < STEPS && !done; step++) {
        struct approach a = approach_at(g, i, f, t);
        if (a.h <= 0) {
            if (a.v < 0 || (a.v == 0 && G > 0)) return t;
            a.h = 0;
        }
        double root = sqrt(a.v * a.v + 2 * G * a.h), d = a.v > 0 ? (a.v + root) / G : 2 * a.h / (root - a.v);
        if (!(t + d <= limit)) return HUGE_VAL;
        done = t + d == t;
        t += d;
        *again = step == STEPS - 1 && !done;
    }
    return t;
}

void grains_consider_facets(struct grains *g, int i, double leaving) {
    const struct facet_cells *c = &g->walls;
    const struct grain_cells *all = &g->cells;
    struct grain *p = &g->grain[i];
    struct grain_event *e = &g->event[i];
    long cell = 0;
    for (int k = g->dim - 1; k >= 0; k--) cell = cell * c->n[k] + cell_number(all, e->cell, k);
    for (int32_t q = c->start[cell]; q < c->start[cell + 1]; q++) {
        bool again;
        double t = grains_facet_time(g, i, c->list[q], fmin(p->impact, leaving), &again);
        if (t >= p->impact) continue;
        p->impact = t;
        e->partner = again ? LOOK_AGAIN : FIRST_FACET - c->list[q];
    }
}

/* Gives v, the velocity of a grain along a wall (m/s), a new direction across the unit normal, if it comes so by the
 * grain's own random numbers: they follow from its number and the count of its changes, so that a restart has them,
 * too. Sets du (m/s) to the change. */
static void scatter(const struct grains *g, int i, double phi, const double normal[3], const double v[3],
                    double du[3]) {
    struct random r = random_make(g->box.seed, (uint64_t)g->id[i] << 32 | g->event[i].changes);
    double sine = 0, cosine = -1; /* a disk turns back */
    du[0] = du[1] = du[2] = 0;
    if (random_uniform(&r) >= phi) return;
    if (g->dim == 2 && random_uniform(&r) < 0.5) return;
    if (g->dim == 3) cosine = grains_phase_cos(6.28318530717958647692 * random_uniform(&r), &sine);
    for (int k = 0; k < 3; k++) {
        const int p = (k + 1) % 3, q = (k + 2) % 3;
        du[k] = (cosine - 1) * v[k] + sine * (normal[p] * v[q] - normal[q] * v[p]);
    }
}

/* Lets grain a, which touches wall w, have a diffuse impact, perhaps; `impact` gets drag and work. */
static void rub(struct grains *g, int a, int w, double t, const double normal[3], struct grain_impact *impact) {
    const struct grain_rough *rough = &g->box.rough[w];
    struct grain *p = &g->grain[a];
    const double mass = grains_mass(g, a);
    double v[3] = {0}, du[3], unit[3];
    const double square = along(normal, normal);
    for (int k = 0; k < 3; k++) v[k] = p->u[k] - grains_swing(&g->box, k, t).v - rough->u[k];
    const double away = along(v, normal) / square;
    for (int k = 0; k < 3; k++) {
        v[k] -= away * normal[k];
        unit[k] = normal[k] / sqrt(square);
    }
    scatter(g, a, rough->phi, unit, v, du);
    for (int k = 0; k < g->dim; k++) {
        p->u[k] += du[k];
        impact->drag[k] = -mass * du[k];
        impact->work += mass * du[k] * rough->u[k];
        g->impulse[w][k] -= mass * du[k];
    }
    g->counts.lost -= impact->work;
}

void grains_rebound_facet(struct grains *g, int a, int partner, double t, struct grain_observer *observer) {
    struct grain *p = &g->grain[a];
    const struct facet *f = &g->box.facets->facet[FIRST_FACET - partner];
    const struct approach now = approach_at(g, a, f, t);
    const double e = g->box.wall_restitution ? g->box.wall_restitution[f->wall] : 1,
                 growth = 0.5 * g->law.growth * grains_size(g, a);
    const double mass = grains_mass(g, a), outward = -(now.v + growth),
                 to_wall[3] = {-now.normal[0], -now.normal[1], -now.normal[2]};
    const double after = grains_speed_after(g, fmax(outward + growth, 0), e, p->u) + growth;
    const double gain = outward + after, square = along(now.normal, now.normal); /* not 1 to the bit: a bias, else */
    for (int k = 0; k < g->dim; k++) {
        const double du = gain / square * now.normal[k];
        p->u[k] += du;
        g->impulse[f->wall][k] -= mass * du;
    }
    struct grain_impact impact = {.mass = mass};
    if (observer) impact = grains_impact_of(g, a, partner, t, to_wall, 1, mass * gain);
    if (g->box.rough && g->box.rough[f->wall].phi > 0) rub(g, a, f->wall, t, now.normal, &impact);
    g->event[a].changes++;
    g->counts.walls++;
    g->counts.lost += 0.5 * mass * (outward - after) * (outward + after);
    if (observer) observer->impact(observer, &impact);
}

status grains_facets_make(struct grains *g) {
    const struct facets *f = g->box.facets;
    const struct grain_cells *c = &g->cells;
    double swing[3] = {0};
    if (!f) return OK;
    facet_cells_free(&g->walls);
    for (int k = 0; k < 3; k++) {
        g->walls.n[k] = c->n[k];
        g->walls.low[k] = c->low[k];
        g->walls.width[k] = c->width[k];
        if (is_shaken(&g->box, k)) swing[k] = fabs(g->box.shake[k]);
    }
    return facet_cells_make(f, g->law.growth > 0 ? f->space.reach : 0.5 * g->law.diameter, swing, &g->walls);
}
