/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/stress/grains/rooms.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

/* ---- shapes */

static void add(struct room *r, const double *a, const double *b, const double *c, bool turned) {
    struct facet *f = &r->facet[r->n++];
    const double *corner[3] = {a, turned ? c : b, turned ? b : c};
    *f = (struct facet){.wall = 0};
    for (int j = 0; j < 3; j++)
        if (corner[j]) memcpy(f->corner[j], corner[j], sizeof f->corner[j]);
}
static void add_segment(struct room *r, const double *a, const double *b, bool turned) {
    add(r, turned ? b : a, turned ? a : b, NULL, false);
}

struct globe { /* a sphere of triangles: radius, how far corners are drawn inwards, which of them */
    double radius, inwards;
    uint64_t choice;
    bool turned;
};

/* Moves a corner of the unit sphere to its place, which is the same for all triangles that meet there. */
static void place_corner(const struct globe *g, const double p[3], double out[3]) {
    struct seed own = seed_start(7, g->choice);
    for (int k = 0; k < 3; k++) own.state = seed_next(&own) ^ (uint64_t)llround(1e6 * p[k]);
    const double radius = g->radius * (1 - g->inwards * seed_uniform(&own, 0, 1));
    for (int k = 0; k < 3; k++) out[k] = radius * p[k];
}

static void add_part(struct room *r, const struct globe *g, double (*p)[3], int times) {
    double m[3][3], at[3][3];
    if (times == 0) {
        for (int j = 0; j < 3; j++) place_corner(g, p[j], at[j]);
        add(r, at[0], at[1], at[2], g->turned);
        return;
    }
    for (int j = 0; j < 3; j++) {
        double length = 0;
        for (int k = 0; k < 3; k++) {
            m[j][k] = p[j][k] + p[(j + 1) % 3][k];
            length += m[j][k] * m[j][k];
        }
        for (int k = 0; k < 3; k++) m[j][k] /= sqrt(length);
    }
    for (int j = 0; j < 3; j++) {
        memcpy(at[0], p[j], sizeof at[0]);
        memcpy(at[1], m[j], sizeof at[1]);
        memcpy(at[2], m[(j + 2) % 3], sizeof at[2]);
        add_part(r, g, at, times - 1);
    }
    add_part(r, g, m, times - 1);
}

/* The octahedron, its triangles cut in four `times` over. */
static void add_globe(struct room *r, const struct globe *g, int times) {
    for (int octant = 0; octant < 8; octant++) {
        double p[3][3] = {{0}};
        int turn = 0;
        for (int k = 0; k < 3; k++) {
            p[k][k] = octant >> k & 1 ? -1 : 1;
            turn ^= octant >> k & 1;
        }
        if (turn) {
            double swap[3];
            memcpy(swap, p[1], sizeof swap);
            memcpy(p[1], p[2], sizeof swap);
            memcpy(p[2], swap, sizeof swap);
        }
        add_part(r, g, p, times);
    }
}

static void make_star(struct room *r, struct seed *s, bool shell) {
    static const double inwards[] = {0, 0.2, 0.6};
    const struct globe outer = {1, inwards[seed_below(s, 3)], seed_next(s), false};
    add_globe(r, &outer, seed_below(s, 3));
    if (!shell) return;
    /* flat sides of an octahedron are 0.577 from its centre, those of drawn corners 0.23 */
    const struct globe inner = {outer.inwards > 0.3 ? 0.15 : 0.35, inwards[seed_below(s, 3)], seed_next(s), true};
    add_globe(r, &inner, seed_below(s, 3));
}

static int make_ring(struct seed *s, double radius, double inwards, int corners, double (*p)[3]) {
    for (int i = 0; i < corners; i++) {
        const double angle = 2 * PI * i / corners, far = radius * (1 - inwards * seed_uniform(s, 0, 1));
        p[i][0] = 0;
        p[i][1] = far * cos(angle);
        p[i][2] = far * sin(angle);
    }
    return corners;
}

static void make_lathe(struct room *r, struct seed *s) {
    const int rings = 2 + seed_below(s, 5), sides = 3 + seed_below(s, 10);
    double p[7][12][3], end[2][3] = {{-1, 0, 0}, {1, 0, 0}};
    for (int i = 0; i < rings; i++) {
        make_ring(s, seed_uniform(s, 0.3, 1), 0, sides, p[i]);
        for (int j = 0; j < sides; j++) p[i][j][0] = -1 + 2. * i / (rings - 1);
    }
    for (int j = 0; j < sides; j++) {
        const int next = (j + 1) % sides;
        add(r, end[0], p[0][next], p[0][j], false);
        add(r, end[1], p[rings - 1][j], p[rings - 1][next], false);
        for (int i = 0; i + 1 < rings; i++) {
            add(r, p[i][j], p[i][next], p[i + 1][next], false);
            add(r, p[i][j], p[i + 1][next], p[i + 1][j], false);
        }
    }
}

static void make_polygon(struct room *r, struct seed *s) {
    double p[24][3];
    const int around = 1 + seed_below(s, 2);
    for (int q = 0; q < around; q++) {
        const int n =
            make_ring(s, q ? 0.2 : 1, seed_uniform(s, 0, 0.5), (q == 0 && around > 1 ? 6 : 3) + seed_below(s, 18), p);
        for (int i = 0; i < n; i++) {
            for (int k = 0; k < 2; k++) p[i][k] = p[i][k + 1];
            p[i][2] = 0;
        }
        for (int i = 0; i < n; i++) add_segment(r, p[i], p[(i + 1) % n], q > 0);
    }
}

static void make_pipe(struct room *r, struct seed *s) {
    double p[2][24][3];
    const int n = make_ring(s, 1, seed_uniform(s, 0, 0.5), 3 + seed_below(s, 18), p[0]), parts = 1 + seed_below(s, 4);
    const double length = seed_uniform(s, 1, 4);
    for (int part = 0; part < parts; part++) {
        for (int i = 0; i < n; i++) {
            memcpy(p[1][i], p[0][i], sizeof p[1][i]);
            p[0][i][0] = length * part / parts;
            p[1][i][0] = part + 1 == parts ? length : length * (part + 1) / parts;
        }
        for (int i = 0; i < n; i++) {
            add(r, p[0][i], p[0][(i + 1) % n], p[1][(i + 1) % n], false);
            add(r, p[0][i], p[1][(i + 1) % n], p[1][i], false);
        }
    }
}

/* ---- their place */

static void turn_and_stretch(struct room *r, struct seed *s) {
    const int dim = r->space.dim;
    double stretch[3], angle[3];
    for (int k = 0; k < 3; k++) {
        stretch[k] = seed_uniform(s, 0.6, 1.6);
        angle[k] = seed_uniform(s, 0, 2 * PI);
    }
    for (int i = 0; i < r->n; i++)
        for (int j = 0; j < dim; j++) {
            double *x = r->facet[i].corner[j];
            for (int k = 0; k < dim; k++) x[k] *= stretch[k];
            for (int k = dim == 2 ? 2 : 0; k < 3; k++) {
                const int a = (k + 1) % 3, b = (k + 2) % 3;
                const double p = x[a], q = x[b];
                x[a] = p * cos(angle[k]) - q * sin(angle[k]);
                x[b] = p * sin(angle[k]) + q * cos(angle[k]);
            }
        }
}

static double volume_below(const struct facet *f, int dim) {
    const double(*c)[3] = (const double(*)[3])f->corner;
    double sum = 0;
    if (dim == 2) return (c[0][0] * c[1][1] - c[0][1] * c[1][0]) / 2;
    for (int k = 0; k < 3; k++) {
        const int p = (k + 1) % 3, q = (k + 2) % 3;
        sum += c[0][k] * (c[1][p] * c[2][q] - c[1][q] * c[2][p]) / 6;
    }
    return sum;
}

static void set_space(struct room *r) {
    struct facet_space *p = &r->space;
    for (int k = 0; k < p->dim; k++) {
        p->low[k] = HUGE_VAL;
        p->high[k] = -HUGE_VAL;
    }
    for (int i = 0; i < r->n; i++) {
        p->volume += volume_below(&r->facet[i], p->dim);
        for (int j = 0; j < p->dim; j++)
            for (int k = 0; k < p->dim; k++) {
                p->low[k] = fmin(p->low[k], r->facet[i].corner[j][k]);
                p->high[k] = fmax(p->high[k], r->facet[i].corner[j][k]);
            }
    }
    if (!p->periodic[0]) return;
    p->volume = 0; /* the area of the polygon, from its triangles: their sides on the end at low[0] */
    for (int i = 0; i < r->n; i++) {
        const double(*c)[3] = (const double(*)[3])r->facet[i].corner;
        if (c[0][0] == p->low[0] && c[1][0] == p->low[0])
            p->volume += (p->high[0] - p->low[0]) * (c[0][1] * c[1][2] - c[0][2] * c[1][1]) / 2;
    }
}

void room_make(enum room_shape shape, struct seed *s, struct room *r) {
    *r = (struct room){.shape = shape, .space = {.dim = shape == POLYGON ? 2 : 3, .walls = 1}};
    r->space.periodic[0] = shape == PIPE;
    if (shape == STAR || shape == SHELL) make_star(r, s, shape == SHELL);
    if (shape == LATHE) make_lathe(r, s);
    if (shape == POLYGON) make_polygon(r, s);
    if (shape == PIPE) make_pipe(r, s);
    if (shape != PIPE) turn_and_stretch(r, s);
    set_space(r);
}

/* ---- where a point is */

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
static double to_segment(const double a[3], const double b[3]) { /* of the origin */
    double e[3], at[3];
    for (int k = 0; k < 3; k++) e[k] = b[k] - a[k];
    const double share = fmin(1, fmax(0, -dot(a, e) / dot(e, e)));
    for (int k = 0; k < 3; k++) at[k] = a[k] + share * e[k];
    return sqrt(dot(at, at));
}
static double to_triangle(double (*c)[3]) {
    double e[3], d[3], at[3], least = HUGE_VAL;
    for (int k = 0; k < 3; k++) {
        e[k] = c[1][k] - c[0][k];
        d[k] = c[2][k] - c[0][k];
    }
    const double ee = dot(e, e), ed = dot(e, d), dd = dot(d, d), er = -dot(e, c[0]), dr = -dot(d, c[0]);
    const double det = ee * dd - ed * ed, a = (dd * er - ed * dr) / det, b = (ee * dr - ed * er) / det;
    for (int k = 0; k < 3; k++) at[k] = c[0][k] + a * e[k] + b * d[k];
    if (a >= 0 && b >= 0 && a + b <= 1) return sqrt(dot(at, at));
    for (int j = 0; j < 3; j++) least = fmin(least, to_segment(c[j], c[(j + 1) % 3]));
    return least;
}
/* The share of all directions that a facet fills, seen from the origin (van Oosterom & Strackee 1983) */
static double solid_angle(double (*c)[3]) {
    double l[3], det = 0, sum;
    for (int j = 0; j < 3; j++) l[j] = sqrt(dot(c[j], c[j]));
    for (int k = 0; k < 3; k++) {
        const int p = (k + 1) % 3, q = (k + 2) % 3;
        det += c[0][k] * (c[1][p] * c[2][q] - c[1][q] * c[2][p]);
    }
    sum = l[0] * l[1] * l[2] + dot(c[0], c[1]) * l[2] + dot(c[1], c[2]) * l[0] + dot(c[2], c[0]) * l[1];
    return 2 * atan2(det, sum) / (4 * PI);
}
static double plane_angle(double (*c)[3]) {
    return atan2(c[0][0] * c[1][1] - c[0][1] * c[1][0], dot(c[0], c[1])) / (2 * PI);
}

double room_depth(const struct room *r, const double x[3]) {
    const bool pipe = r->space.periodic[0], flat = pipe || r->space.dim == 2;
    double least = HUGE_VAL, filled = 0;
    for (int i = 0; i < r->n; i++) {
        double c[3][3] = {{0}};
        const struct facet *f = &r->facet[i];
        if (pipe && !(f->corner[0][0] == r->space.low[0] && f->corner[1][0] == r->space.low[0])) continue;
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < (flat ? 2 : 3); k++) c[j][k] = f->corner[j][k + pipe] - x[k + pipe];
        filled += flat ? plane_angle(c) : solid_angle(c);
        least = fmin(least, flat ? to_segment(c[0], c[1]) : to_triangle(c));
    }
    return filled > 0.5 ? least : -least;
}
