/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Event-driven grains against closed forms, against a plain reference that looks at all pairs, and against themselves
 * in pieces. */
#include "tests/libcore/grains/grains_scene.h"

/* Two grains that meet across a periodic side, at an angle: everything by hand. */
static void two_grains(void **state) {
    (void)state;
    for (int dim = 2; dim <= 3; dim++)
        for (int axis = 0; axis < dim; axis++)
            for (int soft = 0; soft < 2; soft++) {
                struct scene *s = lattice(dim, (int[3]){2, 1, 1}, 5, 1);
                double e = soft ? 1 : 0.6, off = 0.3, d = s->law.diameter, along = sqrt(d * d - off * off);
                int next = (axis + 1) % dim;
                for (int k = 0; k < dim; k++) s->box.high[k] = 8;
                s->law.restitution = 0.6;
                s->law.threshold = soft ? 10 : 0.1;
                for (int i = 0; i < 2; i++)
                    for (int k = 0; k < dim; k++) s->x[i][k] = 4, s->u[i][k] = 0;
                s->x[0][axis] = 7.25; /* to the right, around the side at 8 */
                s->x[1][axis] = 0.75;
                s->x[1][next] += off;
                s->u[0][axis] = 1.5;
                s->u[1][axis] = -0.5;
                struct grains *g = make(s);
                struct recorder *r = recorder();
                double t = (1.5 - along) / 2, x[2][3], u[2][3], K, P, p[3];
                assert_true(grains_advance(g, 1, 1000, &r->observer) == 1);
                assert_int_equal(r->n, 1);
                close_to(r->impact[0].t, t, 1e-14, "time of the impact");
                double approach = 2 * along, J = s->law.mass * (1 + e) / 2 * approach;
                close_to(r->impact[0].impulse, J, 1e-14 * J, "impulse");
                int sign = r->impact[0].a == 0 ? 1 : -1;
                close_to(r->impact[0].normal[axis], sign * along, 1e-13, "normal");
                close_to(r->impact[0].normal[next], sign * off, 1e-13, "normal");
                close_to(r->impact[0].x[1][axis] - r->impact[0].x[0][axis], sign * along, 1e-13, "unwrapped");
                grains_at(g, 1, x, u);
                double du = (1 + e) / 2 * approach;
                close_to(u[0][axis], 1.5 - du * along, 2e-14, "u");
                close_to(u[0][next], -du * off, 2e-14, "u");
                close_to(u[1][axis], -0.5 + du * along, 2e-14, "u");
                grains_energy(g, &K, &P, p);
                close_to(p[axis], s->law.mass, 4e-15, "momentum");
                close_to(p[next], 0, 4e-15, "momentum");
                const struct grain_counts *c = grains_counted(g);
                double lost = s->law.mass * (1 - e * e) / 4 * approach * approach;
                close_to(c->lost, lost, 1e-14 * 2.5, "lost");
                close_to(K, 2.5 - lost, 1e-14 * 2.5, "kinetic energy");
                assert_int_equal(c->pairs, 1);
                assert_int_equal(c->elastic, soft);
                grains_free(g);
                free(r);
                free(s);
            }
}

/* No event queue, no cells: the earliest impact of all pairs and walls, again and again. */
struct plain {
    const struct scene *s;
    double t, x[64][3], u[64][3];
};
static double plain_pair(const struct plain *p, int i, int j) {
    double r[3] = {0}, v[3] = {0}, rr = 0, rv = 0, vv = 0;
    for (int k = 0; k < p->s->box.dim; k++) {
        double L = p->s->box.high[k] - p->s->box.low[k];
        r[k] = p->x[j][k] - p->x[i][k];
        if (p->s->box.periodic[k]) r[k] -= L * nearbyint(r[k] / L);
        v[k] = p->u[j][k] - p->u[i][k];
        rr += r[k] * r[k];
        rv += r[k] * v[k];
        vv += v[k] * v[k];
    }
    double c = rr - p->s->law.diameter * p->s->law.diameter, square = rv * rv - vv * c;
    if (rv >= 0 || square < 0) return HUGE_VAL;
    return c <= 0 ? 0 : c / (-rv + sqrt(square));
}
static double plain_wall(const struct plain *p, int i, int k, int side) {
    double R = p->s->law.diameter / 2, a = p->s->law.gravity[k] * (side ? -1 : 1), v = side ? -p->u[i][k] : p->u[i][k];
    double h = side ? p->s->box.high[k] - R - p->x[i][k] : p->x[i][k] - R - p->s->box.low[k];
    if (p->s->box.periodic[k]) return HUGE_VAL;
    if (h < 1e-12) return a < 0 ? (v < 0 ? 0 : -2 * v / a) : (v < 0 ? 0 : HUGE_VAL);
    double square = v * v - 2 * a * h;
    if (a == 0) return v < 0 ? -h / v : HUGE_VAL;
    if (square < 0) return HUGE_VAL;
    double t1 = (-v - sqrt(square)) / a, t2 = (-v + sqrt(square)) / a, first = fmin(t1, t2), last = fmax(t1, t2);
    return first > 0 ? first : last > 0 ? last : HUGE_VAL;
}
static double plain_next(const struct plain *p, int *a, int *b) {
    double best = HUGE_VAL;
    for (int i = 0; i < p->s->n; i++) {
        for (int j = i + 1; j < p->s->n; j++) {
            double t = plain_pair(p, i, j);
            if (t < best) best = t, *a = i, *b = j;
        }
        for (int w = 0; w < 2 * p->s->box.dim; w++) {
            double t = plain_wall(p, i, w / 2, w & 1);
            if (t < best) best = t, *a = i, *b = -1 - w;
        }
    }
    return best;
}
static void plain_impact(struct plain *p, int a, int b) {
    if (b < 0) {
        p->u[a][(-1 - b) / 2] *= -p->s->box.restitution[(-1 - b) / 2][(-1 - b) & 1];
        return;
    }
    double r[3], rr = 0, rv = 0;
    for (int k = 0; k < p->s->box.dim; k++) {
        double L = p->s->box.high[k] - p->s->box.low[k];
        r[k] = p->x[b][k] - p->x[a][k];
        if (p->s->box.periodic[k]) r[k] -= L * nearbyint(r[k] / L);
        rr += r[k] * r[k];
        rv += r[k] * (p->u[b][k] - p->u[a][k]);
    }
    for (int k = 0; k < p->s->box.dim; k++) {
        double du = (1 + p->s->law.restitution) / 2 * rv / rr * r[k];
        p->u[a][k] += du;
        p->u[b][k] -= du;
    }
}
static void plain_fly(struct plain *p, double dt) {
    for (int i = 0; i < p->s->n; i++)
        for (int k = 0; k < p->s->box.dim; k++) {
            p->x[i][k] += dt * (p->u[i][k] + 0.5 * p->s->law.gravity[k] * dt);
            p->u[i][k] += dt * p->s->law.gravity[k];
        }
    p->t += dt;
}

/* The same impacts in the same order until round-off has grown: chaos multiplies it by ten or more each time every
 * grain has had an impact. */
static void same_as_all_pairs(void **state) {
    (void)state;
    for (int kind = 0; kind < 5; kind++) {
        int dim = kind < 2 ? 2 : 3, walls = kind & 1;
        struct scene *s =
            lattice(dim, dim == 2 ? (int[3]){6, 5, 1} : (int[3]){3, 4, 3}, kind < 4 ? 1.25 : 1.6, 77u + kind);
        s->law.restitution = 0.8;
        for (int k = 0; k < dim && walls; k++) {
            s->box.periodic[k] = k == 0;
            s->box.restitution[k][0] = 0.9;
            s->box.restitution[k][1] = 0.7;
            s->law.gravity[k] = k == 1 ? -0.7 : k == 2 ? 0.2 : 0;
        }
        if (kind == 4) s->law.gravity[2] = -0.3; /* falls round and round */
        struct grains *g = make(s);
        struct recorder *r = recorder();
        struct plain *p = calloc(1, sizeof *p);
        *p = (struct plain){.s = s};
        memcpy(p->x, s->x, sizeof p->x);
        memcpy(p->u, s->u, sizeof p->u);
        while (r->n < 120) grains_advance(g, HUGE_VAL, 100, &r->observer);
        int checked = 0;
        for (; checked < 120; checked++) {
            int a = 0, b = 0;
            double dt = plain_next(p, &a, &b);
            plain_fly(p, dt);
            plain_impact(p, a, b);
            const struct grain_impact *i = &r->impact[checked];
            int low = i->b < 0 || i->a < i->b ? i->a : i->b, high = i->b < 0 || i->a < i->b ? i->b : i->a;
            if (low != a || high != b)
                fail_msg("kind %d, impact %d: %d with %d at %.9g, expected %d with %d at %.9g", kind, checked, i->a,
                         i->b, i->t, a, b, p->t);
            close_to(i->t, p->t, 1e-8 * p->t, "time");
        }
        grains_free(g);
        free(r);
        free(p);
        free(s);
    }
}

static double worst_overlap(const struct scene *s, double (*x)[3]) {
    double worst = 0;
    for (int i = 0; i < s->n; i++) {
        for (int j = 0; j < i; j++) {
            double rr = 0;
            for (int k = 0; k < s->box.dim; k++) {
                double L = s->box.high[k] - s->box.low[k], r = fabs(x[i][k] - x[j][k]);
                if (s->box.periodic[k] && r > L / 2) r = L - r;
                rr += r * r;
            }
            worst = fmax(worst, s->law.diameter - sqrt(rr));
        }
        for (int k = 0; k < s->box.dim; k++) {
            if (s->box.periodic[k]) continue;
            worst = fmax(worst, s->box.low[k] + s->law.diameter / 2 - x[i][k]);
            worst = fmax(worst, x[i][k] + s->law.diameter / 2 - s->box.high[k]);
        }
    }
    return worst;
}

/* A dense shaken layer of disks and a box of spheres that shakes along two axes */
static struct scene *shaken(int dim) {
    struct scene *s = lattice(dim, dim == 2 ? (int[3]){20, 8, 1} : (int[3]){6, 6, 5}, 1.1, 5);
    s->law.restitution = 0.75;
    s->law.threshold = 1e-2;
    s->law.gravity[1] = -1;
    s->box.periodic[1] = false;
    s->box.high[1] += 20;
    s->box.shake[1] = 0.6;
    s->box.omega = 2.2;
    s->box.phase = 0.4;
    s->box.restitution[1][0] = 1;
    s->box.restitution[1][1] = 0.5;
    if (dim == 3) {
        s->box.periodic[2] = false;
        s->box.shake[2] = -0.1;
        s->box.restitution[2][0] = s->box.restitution[2][1] = 0.9;
    }
    return s;
}

static void no_overlap(void **state) {
    (void)state;
    for (int dim = 2; dim <= 3; dim++) {
        struct scene *s = shaken(dim);
        struct grains *g = make(s);
        double(*x)[3] = calloc((size_t)s->n, sizeof *x), (*u)[3] = calloc((size_t)s->n, sizeof *u), t = 0;
        uint64_t seed = 99;
        for (int i = 0; i < 150; i++) {
            t += 0.4 * uniform(&seed);
            assert_true(grains_advance(g, t, INT64_MAX, NULL) == t);
            grains_at(g, t, x, u);
            close_to(worst_overlap(s, x), 0, 1e-12, "overlap");
        }
        assert_true(grains_counted(g)->pairs > 5000 && grains_counted(g)->walls > 500);
        grains_free(g);
        free(x);
        free(u);
        free(s);
    }
}

static void same_state(const struct grains *a, const struct grains *b) {
    size_t n = (size_t)grains_number(a);
    assert_memory_equal(grains_all(a), grains_all(b), n * sizeof(struct grain));
    assert_memory_equal(grains_ids(a), grains_ids(b), n * sizeof(int32_t));
    assert_memory_equal(grains_counted(a), grains_counted(b), sizeof(struct grain_counts));
    assert_true(grains_time(a) == grains_time(b));
    for (size_t i = 0; i < n; i++) {
        assert_true(grains_events(a)[i].partner == grains_events(b)[i].partner);
    }
}

static struct grains *resumed(const struct scene *s, struct grains *g) {
    struct grains *h;
    const struct grain_save save = {s->n,          grains_time(g),    grains_all(g), grains_events(g),
                                    grains_ids(g), grains_counted(g), NULL,          NULL};
    ok(grains_resume(&s->box, &s->law, &save, &h));
    grains_free(g);
    return h;
}

/* At once, in pieces of time, by single events, and saved and resumed at each piece: the same bits. */
static void pieces(void **state) {
    (void)state;
    for (int dim = 2; dim <= 3; dim++) {
        struct scene *s = shaken(dim);
        struct grains *whole = make(s), *parts = make(s), *saved = make(s);
        uint64_t seed = 3;
        grains_advance(whole, 20, INT64_MAX, NULL);
        for (double t = 0; t < 20;) {
            t = fmin(20, t + 0.5 * uniform(&seed));
            for (int i = 0; i < 50; i++) grains_advance(parts, t, 1 + (int)(10 * uniform(&seed)), NULL);
            grains_advance(parts, t, INT64_MAX, NULL);
            grains_advance(saved, t, INT64_MAX, NULL);
            saved = resumed(s, saved);
        }
        same_state(whole, parts);
        same_state(whole, saved);
        assert_true(grains_counted(whole)->pairs > 2000);
        grains_free(whole);
        grains_free(parts);
        grains_free(saved);
        free(s);
    }
}

/* So many that they are sorted in memory on the way: again the same bits in pieces and resumed, each grain keeps its
 * number, and neighbours in space are neighbours in memory more often than by chance. */
static void sorted(void **state) {
    (void)state;
    struct scene *s = lattice(3, (int[3]){14, 13, 12}, 1.25, 5);
    uint64_t seed = 8;
    s->law.restitution = 0.9;
    for (int i = s->n - 1; i > 0; i--) {
        int j = (int)(uniform(&seed) * (i + 1));
        double swap[3];
        memcpy(swap, s->x[i], sizeof swap);
        memcpy(s->x[i], s->x[j], sizeof swap);
        memcpy(s->x[j], swap, sizeof swap);
    }
    struct grains *whole = make(s), *parts = make(s);
    double(*x)[3] = calloc((size_t)s->n, sizeof *x), (*u)[3] = calloc((size_t)s->n, sizeof *u);
    grains_at(whole, 0, x, u);
    for (int i = 0; i < s->n; i++)
        for (int k = 0; k < 3; k++) assert_true(x[i][k] == s->x[i][k] && u[i][k] == s->u[i][k]);
    while (grains_counted(whole)->pairs < 50000) grains_advance(whole, HUGE_VAL, 1000, NULL);
    while (grains_time(parts) < grains_time(whole)) {
        grains_advance(parts, fmin(grains_time(whole), grains_time(parts) + 0.05), INT64_MAX, NULL);
        if (uniform(&seed) < 0.3) parts = resumed(s, parts);
    }
    same_state(whole, parts);
    grains_at(whole, grains_time(whole), x, u);
    double near = 0;
    int moved = 0;
    for (int i = 0; i + 1 < s->n; i++) {
        int a = grains_ids(whole)[i], b = grains_ids(whole)[i + 1];
        double square = 0;
        for (int k = 0; k < 3; k++) square += pow(remainder(x[a][k] - x[b][k], s->box.high[k]), 2);
        near += square < 4;
        moved += a != i;
    }
    assert_true(near > 0.3 * s->n && moved > s->n / 2);
    grains_free(whole);
    grains_free(parts);
    free(x);
    free(u);
    free(s);
}

/* Elastic: energy (with gravity between walls) and, where nothing acts, momentum stay */
static void conservation(void **state) {
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        struct scene *s = lattice(kind ? 3 : 2, kind ? (int[3]){10, 10, 10} : (int[3]){30, 30, 1}, 1.3, 8);
        if (kind == 2) {
            s->law.gravity[2] = -0.5;
            s->box.periodic[2] = false;
            s->box.restitution[2][0] = s->box.restitution[2][1] = 1;
        }
        struct grains *g = make(s);
        double before[3], after[3], E0 = total(g, before);
        while (grains_counted(g)->pairs < 300000) grains_advance(g, HUGE_VAL, 10000, NULL);
        double E1 = total(g, after); /* a bias of half a unit in the last place an impact would make 3e-14 */
        close_to(E1, E0, 5e-15 * E0, "energy");
        for (int k = 0; k < (kind == 2 ? 2 : 3); k++) close_to(after[k], before[k], 1e-14 * s->n, "momentum");
        grains_free(g);
        free(s);
    }
}

/* What inelastic impacts take is counted: in a box that moves too, with the work of the walls. */
static void balance(void **state) {
    (void)state;
    struct scene *s = lattice(3, (int[3]){8, 8, 8}, 1.2, 8);
    s->law.restitution = 0.9;
    s->law.threshold = 0.03;
    s->law.gravity[1] = -1;
    s->box.periodic[1] = false;
    s->box.restitution[1][0] = 0.8;
    s->box.restitution[1][1] = 0.7;
    struct grains *g = make(s);
    double p[3], E0 = total(g, p), p0 = p[1];
    grains_advance(g, 8, INT64_MAX, NULL);
    const struct grain_counts *c = grains_counted(g);
    double E1 = total(g, p), weight = s->law.mass * s->n * 8;
    close_to(E1 + c->lost, E0, 1e-11 * E0, "energy and what was lost");
    close_to(p[1] - p0, c->wall_impulse[1][0] - c->wall_impulse[1][1] - weight, 1e-11 * weight, "impulse of the walls");
    assert_true(c->walls > 1000 && c->lost > 0.3 * E0);
    grains_free(g);
    free(s);
}

/* Two grains at rest grow into each other and part; a crowd grows to a dense packing. */
static void growth(void **state) {
    (void)state;
    struct scene *s = lattice(3, (int[3]){2, 1, 1}, 5, 1);
    memset(s->u, 0, sizeof s->u);
    memcpy(s->box.high, (double[3]){10, 10, 10}, sizeof s->box.high);
    s->x[1][0] = s->x[0][0] + 3;
    s->law.growth = 0.5;
    struct grains *g = make(s);
    struct recorder *r = recorder();
    assert_true(grains_advance(g, 4.5, 1000, &r->observer) == 4.5);
    assert_int_equal(r->n, 1);
    close_to(r->impact[0].t, 4, 1e-13, "when they touch");
    close_to(fabs(grains_all(g)[0].u[0] - grains_all(g)[1].u[0]), 2 * s->law.growth, 1e-13, "how they part");
    grains_free(g);
    free(s);
    free(r);

    s = lattice(2, (int[3]){12, 12, 1}, 1.6, 4);
    s->law.growth = 0.1;
    g = make(s);
    double(*x)[3] = calloc((size_t)s->n, sizeof *x), (*u)[3] = calloc((size_t)s->n, sizeof *u);
    for (int i = 1; i <= 20; i++) {
        double t = 0.25 * i;
        assert_true(grains_advance(g, t, INT64_MAX, NULL) == t);
        grains_at(g, t, x, u);
        s->law.diameter = 1 + s->law.growth * t;
        close_to(worst_overlap(s, x), 0, 1e-12, "overlap");
    }
    double packing = s->n * PI / 4 * s->law.diameter * s->law.diameter / (s->box.high[0] * s->box.high[1]);
    assert_true(packing > 0.68 && grains_counted(g)->pairs > 1000);
    grains_free(g);
    free(x);
    free(u);
    free(s);
}

/* p/(n T) = 1 + virial/(dim N m T t) against Henderson's disks and Carnahan & Starling's spheres */
static void pressure(void **state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        int dim = kind < 2 ? 2 : 3;
        double phi = kind & 1 ? 0.35 : 0.15, spacing = dim == 2 ? sqrt(PI / 4 / phi) : cbrt(PI / 6 / phi);
        struct scene *s = lattice(dim, dim == 2 ? (int[3]){40, 40, 1} : (int[3]){12, 12, 12}, spacing, 31);
        struct grains *g = make(s);
        struct recorder *r = recorder();
        double p[3], start = 1;
        grains_advance(g, start, INT64_MAX, NULL);
        for (; grains_counted(g)->pairs < 250000;) grains_advance(g, HUGE_VAL, 10000, &r->observer);
        double found = 1 + r->virial / ((grains_time(g) - start) * 2 * total(g, p));
        double disks = 1 + 2 * phi * (1 - 7. / 16 * phi) / ((1 - phi) * (1 - phi));
        double spheres = (1 + phi + phi * phi - phi * phi * phi) / pow(1 - phi, 3);
        double expected = dim == 2 ? disks : spheres;
        close_to(found, expected, 0.01 * expected, "p/(n T)");
        grains_free(g);
        free(r);
        free(s);
    }
}

/* Strongly dissipative disks cluster; the threshold keeps time going on and nothing overlaps. */
static void cluster(void **state) {
    (void)state;
    struct scene *s = lattice(2, (int[3]){24, 24, 1}, 1.4, 6);
    s->law.restitution = 0.5;
    s->law.threshold = 1e-3;
    struct grains *g = make(s);
    double(*x)[3] = calloc((size_t)s->n, sizeof *x), (*u)[3] = calloc((size_t)s->n, sizeof *u);
    while (grains_counted(g)->pairs < 60000) grains_advance(g, HUGE_VAL, 1000, NULL);
    grains_at(g, grains_time(g), x, u);
    close_to(worst_overlap(s, x), 0, 1e-12, "overlap");
    assert_true(grains_counted(g)->elastic > 1000);
    grains_free(g);
    s->law.threshold = 0; /* collapses; a few million impacts later it is beyond */
    g = make(s);
    double t = 0;
    for (int i = 0; i < 4; i++) {
        grains_advance(g, HUGE_VAL, 500000, NULL);
        assert_true(grains_time(g) > t);
        t = grains_time(g);
    }
    grains_free(g);
    free(x);
    free(u);
    free(s);
}

static void refuse(const struct scene *s, const char *parts) {
    struct grains *g = NULL;
    says(grains_make(&s->box, &s->law, s->n, (const double(*)[3])s->x, (const double(*)[3])s->u, 0, &g), parts);
    assert_null(g);
}

static void errors(void **state) {
    (void)state;
    struct scene *s = lattice(2, (int[3]){5, 4, 1}, 1.25, 6);
    struct scene good = *s;
    s->x[7][0] = s->x[3][0] + 0.25;
    s->x[7][1] = s->x[3][1] + 0.5;
    refuse(s, "3 at (4.375 0.625|7 at (4.625 1.125|0.559016994 m apart");
    *s = good;
    s->x[4][0] = -1e-3;
    s->x[9][0] = s->x[4][0] + 1;
    refuse(s, "grain 4|outside|-0.001");
    *s = good;
    s->x[4][0] = NAN;
    refuse(s, "grain 4|outside");
    *s = good;
    s->box.periodic[1] = false;
    s->x[2][1] = 0.49;
    refuse(s, "grain 2|outside|0.5");
    *s = good;
    s->u[2][1] = INFINITY;
    refuse(s, "grain 2|velocity");
    *s = good;
    s->law.diameter = 1.4;
    refuse(s, "20 grains would fill 0.98|0.9069");
    *s = good;
    s->n = 0;
    refuse(s, "no grains");
    *s = good;
    s->n = 2;
    s->box.high[1] = 2.9;
    refuse(s, "periodic|3 m|axis 1");
    *s = good;
    s->law.growth = 0.1;
    s->law.gravity[0] = 1;
    refuse(s, "grow only");
    *s = good;
    struct grains *g = make(s), *h = NULL;
    struct grain *saved = malloc(sizeof *saved * 20);
    memcpy(saved, grains_all(g), sizeof *saved * 20);
    saved[5].x[0] += 2;
    const struct grain_save save = {20, 0, saved, grains_events(g), grains_ids(g), grains_counted(g), NULL, NULL};
    says(grains_resume(&s->box, &s->law, &save, &h), "saved grain 5");
    assert_null(h);
    grains_free(g);
    free(saved);
    free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_grains), cmocka_unit_test(same_as_all_pairs),
        cmocka_unit_test(no_overlap), cmocka_unit_test(pieces),
        cmocka_unit_test(sorted),     cmocka_unit_test(conservation),
        cmocka_unit_test(balance),    cmocka_unit_test(growth),

        cmocka_unit_test(pressure),   cmocka_unit_test(cluster),
        cmocka_unit_test(errors),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
