/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rooms of facets for tests of the engine, and an integrator of its own in long double: the next contact with a wall is
 * found by steps of distance over speed, with all pairs and all facets looked at. */
#ifndef TESTS_LIBCORE_GRAINS_FACETS_SCENE_H
#define TESTS_LIBCORE_GRAINS_FACETS_SCENE_H

#include "tests/libcore/grains/grains_scene.h"

enum { MOST_FACETS = 400 };
struct walls {
    struct facet_space space;
    int n;
    struct facet facet[MOST_FACETS];
};

/* Adds a triangle whose normal leads away from the grains when it is right-handed, or the other way if `turned` */
static inline void triangle(struct walls *w, const double a[3], const double b[3], const double c[3], int wall,
                            bool turned) {
    struct facet *f = &w->facet[w->n++];
    assert_true(w->n <= MOST_FACETS);
    for (int k = 0; k < 3; k++) {
        f->corner[0][k] = a[k];
        f->corner[1][k] = turned ? c[k] : b[k];
        f->corner[2][k] = turned ? b[k] : c[k];
    }
    f->wall = wall;
    if (wall >= w->space.walls) w->space.walls = wall + 1;
}
static inline void segment(struct walls *w, const double a[2], const double b[2], int wall) {
    struct facet *f = &w->facet[w->n++];
    for (int k = 0; k < 2; k++) {
        f->corner[0][k] = a[k];
        f->corner[1][k] = b[k];
    }
    f->wall = wall;
    if (wall >= w->space.walls) w->space.walls = wall + 1;
}
/* Adds the hull of points in which face i has the corners face[i][0..3] (the last -1: a triangle); walls from `wall` */
static inline void hull(struct walls *w, const double (*p)[3], int faces, const int (*face)[4], int wall, bool turned) {
    for (int i = 0; i < faces; i++) {
        triangle(w, p[face[i][0]], p[face[i][1]], p[face[i][2]], wall + i, turned);
        if (face[i][3] >= 0) triangle(w, p[face[i][0]], p[face[i][2]], p[face[i][3]], wall + i, turned);
    }
}
/* Sets the box around all facets and the volume between them */
static inline void finish_walls(struct walls *w, int dim, double reach) {
    w->space.dim = dim;
    w->space.reach = reach;
    w->space.volume = 0;
    for (int k = 0; k < dim; k++) {
        w->space.low[k] = HUGE_VAL;
        w->space.high[k] = -HUGE_VAL;
    }
    for (int i = 0; i < w->n; i++) {
        double(*c)[3] = w->facet[i].corner;
        for (int j = 0; j < dim; j++)
            for (int k = 0; k < dim; k++) {
                w->space.low[k] = fmin(w->space.low[k], c[j][k]);
                w->space.high[k] = fmax(w->space.high[k], c[j][k]);
            }
        if (dim == 2)
            w->space.volume += (c[0][0] * c[1][1] - c[0][1] * c[1][0]) / 2;
        else
            for (int k = 0; k < 3; k++)
                w->space.volume +=
                    c[0][k] * (c[1][(k + 1) % 3] * c[2][(k + 2) % 3] - c[1][(k + 2) % 3] * c[2][(k + 1) % 3]) / 6;
    }
}
static inline struct facets *make_facets(const struct walls *w) {
    struct facets *f;
    ok(facets_make(&w->space, w->n, w->facet, &f));
    return f;
}
/* Turns all corners by the angle a about the axis k */
static inline void turn_walls(struct walls *w, int k, double a) {
    for (int i = 0; i < w->n; i++)
        for (int j = 0; j < 3; j++) {
            double *x = w->facet[i].corner[j], p = x[(k + 1) % 3], q = x[(k + 2) % 3];
            x[(k + 1) % 3] = p * cos(a) - q * sin(a);
            x[(k + 2) % 3] = p * sin(a) + q * cos(a);
        }
}

static inline void tetrahedron(struct walls *w, double side) {
    const double p[4][3] = {{0, 0, 0}, {side, side, 0}, {side, 0, side}, {0, side, side}};
    const int face[4][4] = {{0, 1, 2, -1}, {0, 3, 1, -1}, {0, 2, 3, -1}, {1, 3, 2, -1}};
    hull(w, p, 4, face, 0, false);
}
static const int box_faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
/* A box of the sides; the lower ends of the last axis are drawn together by `narrow` (1: not) */
static inline void box_of_facets(struct walls *w, const double side[3], double narrow) {
    double p[8][3];
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 3; k++) {
            p[i][k] = (i >> k & 1) * side[k];
            if (k < 2 && i < 4) p[i][k] = side[k] / 2 + narrow * (p[i][k] - side[k] / 2);
        }
    hull(w, (const double(*)[3])p, 6, box_faces, 0, false);
}
/* Adds a ball of facets, an icosahedron whose triangles are cut in four `times` over; its outside faces the grains */
static inline void ball_part(struct walls *w, const double centre[3], double radius, double (*p)[3], int times) {
    if (times == 0) {
        double at[3][3];
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) at[j][k] = centre[k] + radius * p[j][k];
        triangle(w, at[0], at[1], at[2], 6, true);
        return;
    }
    double m[3][3];
    for (int j = 0; j < 3; j++) {
        /* the same bits from both sides */
        double length = 0;
        for (int k = 0; k < 3; k++) {
            m[j][k] = p[j][k] + p[(j + 1) % 3][k];
            length += m[j][k] * m[j][k];
        }
        for (int k = 0; k < 3; k++) m[j][k] /= sqrt(length);
    }
    for (int j = 0; j < 3; j++) {
        double part[3][3];
        memcpy(part[0], p[j], sizeof part[0]);
        memcpy(part[1], m[j], sizeof part[1]);
        memcpy(part[2], m[(j + 2) % 3], sizeof part[2]);
        ball_part(w, centre, radius, part, times - 1);
    }
    ball_part(w, centre, radius, m, times - 1);
}
static inline void ball(struct walls *w, const double centre[3], double radius, int times) {
    const double g = (1 + sqrt(5)) / 2, length = sqrt(1 + g * g);
    double p[12][3];
    for (int i = 0; i < 12; i++) {
        int k = i / 4;
        p[i][k] = 0;
        p[i][(k + 1) % 3] = (i & 1 ? -1 : 1) / length;
        p[i][(k + 2) % 3] = (i & 2 ? -g : g) / length;
    }
    for (int a = 0; a < 12; a++)
        for (int b = a + 1; b < 12; b++)
            for (int c = b + 1; c < 12; c++) {
                const int q[3] = {a, b, c};
                double longest = 0, turn = 0, t[3][3];
                for (int j = 0; j < 3; j++) {
                    double square = 0;
                    for (int k = 0; k < 3; k++) square += pow(p[q[j]][k] - p[q[(j + 1) % 3]][k], 2);
                    longest = fmax(longest, square);
                }
                if (longest > 1.2 * 4 / (length * length)) continue;
                for (int k = 0; k < 3; k++)
                    turn += p[a][k] * (p[b][(k + 1) % 3] * p[c][(k + 2) % 3] - p[b][(k + 2) % 3] * p[c][(k + 1) % 3]);
                for (int j = 0; j < 3; j++) memcpy(t[j], p[turn > 0 ? q[j] : q[2 - j]], sizeof t[j]);
                ball_part(w, centre, radius, t, times);
            }
}

/* ---- the other integrator */

typedef long double real;
struct other {
    const struct walls *w;
    const struct scene *s;
    real x[MOST][3], u[MOST][3], t[MOST], next[MOST], time; /* next: contact with a wall */
    real normal[MOST][3];
};

static inline real dot3(const real *a, const real *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
/* The nearest point of the triangle or segment, by the weights of its corners */
static inline real other_distance(const struct facet *f, int dim, const double shift[3], const real x[3], real n[3]) {
    real best = HUGE_VALL;
    for (int part = 0; part < 1 + 3 * (dim == 3); part++) { /* the inside (a segment's all), then the three sides */
        real c[3][3], e[3], r[3], at[3];
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) c[j][k] = f->corner[(j + (part + 2) % 3) % 3][k] + (real)shift[k];
        if (dim == 2)
            for (int j = 0; j < 2; j++)
                for (int k = 0; k < 3; k++) c[j][k] = f->corner[j][k] + (real)shift[k];
        for (int k = 0; k < 3; k++) {
            e[k] = c[1][k] - c[0][k];
            r[k] = x[k] - c[0][k];
        }
        if (part == 0 && dim == 3) {
            real d[3], ee, ed, dd, er, dr;
            for (int k = 0; k < 3; k++) d[k] = c[2][k] - c[0][k];
            ee = dot3(e, e), ed = dot3(e, d), dd = dot3(d, d), er = dot3(e, r), dr = dot3(d, r);
            real det = ee * dd - ed * ed, a = (dd * er - ed * dr) / det, b = (ee * dr - ed * er) / det;
            if (a < 0 || b < 0 || a + b > 1) continue;
            for (int k = 0; k < 3; k++) at[k] = r[k] - a * e[k] - b * d[k];
        } else {
            real a = fminl(1, fmaxl(0, dot3(e, r) / dot3(e, e)));
            for (int k = 0; k < 3; k++) at[k] = r[k] - a * e[k];
        }
        real distance = sqrtl(dot3(at, at));
        if (distance >= best) continue;
        best = distance;
        for (int k = 0; k < 3; k++) n[k] = at[k] / distance;
    }
    return best;
}
static inline void other_swing(const struct other *o, real t, real s[3], real v[3]) {
    for (int k = 0; k < 3; k++) {
        s[k] = o->s->box.shake[k] * cosl((real)o->s->box.omega * t + o->s->box.phase);
        v[k] = -o->s->box.shake[k] * (real)o->s->box.omega * sinl((real)o->s->box.omega * t + o->s->box.phase);
    }
}
static inline void other_fly(const struct other *o, int i, real t, real x[3], real u[3]) {
    real dt = t - o->t[i];
    for (int k = 0; k < 3; k++) {
        real g = o->s->law.gravity[k];
        x[k] = o->x[i][k] + dt * (o->u[i][k] + g * dt / 2);
        u[k] = o->u[i][k] + g * dt;
    }
}
/* Distance of grain i's surface to facet f; *rate: its rate, n: the normal. Along a periodic axis 0 images count */
static inline real other_gap(const struct other *o, int i, int f, real t, real *rate, real n[3]) {
    const struct facet_space *p = &o->w->space;
    const real length = p->high[0] - (real)p->low[0];
    real x[3], u[3], s[3], v[3], least = HUGE_VALL;
    other_fly(o, i, t, x, u);
    other_swing(o, t, s, v);
    for (int k = 0; k < 3; k++) {
        x[k] -= s[k];
        u[k] -= v[k];
    }
    if (p->periodic[0]) x[0] -= length * floorl((x[0] - p->low[0]) / length);
    for (int q = -1; q < 2; q++) {
        const double shift[3] = {(double)(q * length), 0, 0};
        real m[3];
        if (q && !p->periodic[0]) continue;
        real distance = other_distance(&o->w->facet[f], p->dim, shift, x, m);
        if (distance >= least) continue;
        least = distance;
        memcpy(n, m, sizeof m);
    }
    *rate = dot3(n, u);
    return least - (real)o->s->law.diameter / 2;
}
/* Steps that no distance can shrink faster than, then halving */
static inline void other_facet(struct other *o, int i, int f) {
    const real tiny = 1e-12L;
    real t = o->t[i], rate, n[3], swing = 0, fall = 0, first = t, speed = sqrtl(dot3(o->u[i], o->u[i]));
    for (int k = 0; k < 3; k++) {
        swing += fabs(o->s->box.shake[k]) * o->s->box.omega;
        fall += fabs(o->s->law.gravity[k]);
    }
    while (t < fminl(o->next[i], o->time + 100)) {
        real h = other_gap(o, i, f, t, &rate, n);
        if (h < tiny && rate < 0 && t > first) { /* the contact lies in the last step */
            real a = first, b = t;
            for (int q = 0; q < 90; q++) {
                real middle = (a + b) / 2, r;
                if (other_gap(o, i, f, middle, &r, n) > 0)
                    a = middle;
                else
                    b = middle;
            }
            if (b >= o->next[i]) return;
            o->next[i] = b;
            (void)other_gap(o, i, f, b, &rate, o->normal[i]);
            return;
        }
        first = h > 0 ? t : first;
        t += fminl(1, fmaxl(h, 0) / (speed + swing + fall * (t - o->t[i] + 1))) + 1e-9L; /* speed after 1 s */
    }
}
static inline void other_wall(struct other *o, int i) {
    o->next[i] = HUGE_VALL;
    for (int f = 0; f < o->w->n; f++) other_facet(o, i, f);
}
static inline real other_pair(const struct other *o, int i, int j) {
    real now = fmaxl(o->t[i], o->t[j]), x[2][3], u[2][3], r[3], v[3];
    const struct facet_space *p = &o->w->space;
    other_fly(o, i, now, x[0], u[0]);
    other_fly(o, j, now, x[1], u[1]);
    for (int k = 0; k < 3; k++) {
        r[k] = x[1][k] - x[0][k];
        v[k] = u[1][k] - u[0][k];
        if (k < p->dim && p->periodic[k]) r[k] -= (p->high[k] - p->low[k]) * roundl(r[k] / (p->high[k] - p->low[k]));
    }
    real b = dot3(r, v), c = dot3(r, r) - (real)o->s->law.diameter * o->s->law.diameter, q = b * b - dot3(v, v) * c;
    return b < 0 && q >= 0 ? now + c / (sqrtl(q) - b) : HUGE_VALL;
}
/* Works off one impact; returns its time */
static inline real other_step(struct other *o) {
    int a = -1, b = -1, n = o->s->n;
    real t = HUGE_VALL, normal, r[3], out;
    for (int i = 0; i < n; i++) {
        if (o->next[i] < t) t = o->next[i], a = i, b = -1;
        for (int j = 0; j < i; j++) {
            real at = other_pair(o, i, j);
            if (at < t) t = at, a = i, b = j;
        }
    }
    assert_true(a >= 0);
    const int hit[2] = {a, b};
    for (int q = 0; q < 2 && hit[q] >= 0; q++) {
        real x[3], u[3];
        other_fly(o, hit[q], t, x, u);
        memcpy(o->x[hit[q]], x, sizeof x);
        memcpy(o->u[hit[q]], u, sizeof u);
        o->t[hit[q]] = t;
    }
    if (b < 0) {
        real s[3], w[3], u[3];
        other_swing(o, t, s, w);
        for (int k = 0; k < 3; k++) u[k] = o->u[a][k] - w[k];
        out = dot3(u, o->normal[a]);
        for (int k = 0; k < 3; k++)
            o->u[a][k] -=
                (1 + (real)(o->s->box.wall_restitution ? o->s->box.wall_restitution[0] : 1)) * out * o->normal[a][k];
    } else {
        const struct facet_space *p = &o->w->space;
        real v[3];
        for (int k = 0; k < 3; k++) {
            r[k] = o->x[b][k] - o->x[a][k];
            if (k < p->dim && p->periodic[k])
                r[k] -= (p->high[k] - p->low[k]) * roundl(r[k] / (p->high[k] - p->low[k]));
            v[k] = o->u[b][k] - o->u[a][k];
        }
        normal = dot3(r, v) / dot3(r, r);
        for (int k = 0; k < 3; k++) {
            o->u[a][k] += (1 + (real)o->s->law.restitution) / 2 * normal * r[k];
            o->u[b][k] -= (1 + (real)o->s->law.restitution) / 2 * normal * r[k];
        }
        other_wall(o, b);
    }
    other_wall(o, a);
    return o->time = t;
}
/* Starts from places and velocities in the frame of the box at time t */
static inline void other_start(struct other *o, const struct walls *w, const struct scene *s, double t,
                               const double (*x)[3], const double (*u)[3]) {
    real at[3], v[3];
    *o = (struct other){.w = w, .s = s, .time = t};
    other_swing(o, t, at, v);
    for (int i = 0; i < s->n; i++) {
        for (int k = 0; k < 3; k++) {
            o->x[i][k] = x[i][k] + at[k];
            o->u[i][k] = u[i][k] + v[k];
        }
        o->t[i] = t;
        other_wall(o, i);
    }
}

#endif
