/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grains among facets: courses against another integrator, budgets, equilibrium, restarts, and what is refused. */
#include "tests/libcore/grains/facets_scene.h"

/* Puts n grains of diameter 1 at random between the facets, velocities uniform */
static struct scene *scene_in(const struct facets *f, int n, uint64_t seed) {
    const struct facet_space *p = &f->space;
    struct scene *s = calloc(1, sizeof *s);
    struct facet_cells c = {.n = {1, 1, 1}};
    assert_non_null(s);
    s->box = (struct grain_box){.dim = p->dim, .facets = f};
    s->law = (struct grain_law){.diameter = 1, .mass = 2, .restitution = 1};
    for (int k = 0; k < 3; k++) {
        s->box.low[k] = c.low[k] = p->low[k];
        s->box.high[k] = p->high[k];
        s->box.periodic[k] = p->periodic[k];
        c.width[k] = k < p->dim ? p->high[k] - p->low[k] : 1;
    }
    ok(facet_cells_make(f, 1, (double[3]){0}, &c));
    while (s->n < n) {
        double *x = s->x[s->n];
        bool room = true;
        for (int k = 0; k < p->dim; k++) x[k] = p->low[k] + uniform(&seed) * (p->high[k] - p->low[k]);
        for (int j = 0; j < s->n; j++) {
            double square = 0;
            for (int k = 0; k < p->dim; k++) {
                double r = fabs(x[k] - s->x[j][k]);
                if (p->periodic[k]) r = fmin(r, p->high[k] - p->low[k] - r);
                square += r * r;
            }
            room = room && square > 1.02;
        }
        if (!room || facet_cells_nearest(f, &c, x, true) < 0.51 || !facet_cells_inside(f, &c, x, 0.5)) continue;
        for (int k = 0; k < p->dim; k++) s->u[s->n][k] = sqrt(12) * (uniform(&seed) - 0.5);
        s->n++;
    }
    facet_cells_free(&c);
    return s;
}

enum shape { TETRAHEDRON, FUNNEL, BALL, CHANNEL, STAR, SHAPES };
static void build(struct walls *w, enum shape shape) {
    *w = (struct walls){.n = 0};
    if (shape == TETRAHEDRON) {
        tetrahedron(w, 9);
        turn_walls(w, 0, 0.4);
        turn_walls(w, 2, -0.9);
    } else if (shape == FUNNEL) { /* a wide box on a narrow one, with a convex edge where they meet */
        const double p[12][3] = {{2, 2, 0}, {4, 2, 0}, {2, 4, 0}, {4, 4, 0}, {2, 2, 3}, {4, 2, 3},
                                 {2, 4, 3}, {4, 4, 3}, {0, 0, 5}, {6, 0, 5}, {0, 6, 5}, {6, 6, 5}};
        const double top[4][3] = {{0, 0, 9}, {6, 0, 9}, {0, 6, 9}, {6, 6, 9}};
        const int lower[5][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}};
        const int cone[4][4] = {{4, 8, 10, 6}, {5, 7, 11, 9}, {4, 5, 9, 8}, {6, 10, 11, 7}};
        double q[8][3];
        memcpy(q, p + 8, sizeof(double[4][3]));
        memcpy(q + 4, top, sizeof top);
        const int upper[5][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {4, 5, 7, 6}};
        hull(w, p, 5, lower, 0, false);
        hull(w, p, 4, cone, 5, false);
        hull(w, (const double(*)[3])q, 5, upper, 9, false);
    } else if (shape == BALL) {
        box_of_facets(w, (double[3]){7, 7, 7}, 1);
        ball(w, (double[3]){3.4, 3.6, 3.3}, 1.5, 0);
    } else if (shape == CHANNEL) { /* periodic along x, with a ridge across its end */
        const double p[10][2] = {{0, 0}, {1, 1.5}, {2, 0}, {6, 0}, {8, 0}, {8, 6}, {0, 6}};
        for (int i = 0; i < 4; i++) segment(w, p[i], p[i + 1], 0);
        segment(w, p[5], p[6], 1);
        w->space.periodic[0] = true;
    } else { /* a star: every other corner is convex for the grains */
        double p[10][2];
        for (int i = 0; i < 10; i++) {
            p[i][0] = (i % 2 ? 4 : 8) * cos(PI / 5 * i + 0.2);
            p[i][1] = (i % 2 ? 4 : 8) * sin(PI / 5 * i + 0.2);
        }
        for (int i = 0; i < 10; i++) segment(w, p[i], p[(i + 1) % 10], i);
    }
    finish_walls(w, shape < CHANNEL ? 3 : 2, 0.5);
    if (shape == CHANNEL) w->space.volume = 48 - 1.5;
}

static void compare_courses(const struct grains *g, const struct other *o) {
    const struct scene *s = o->s;
    double x[20][3] = {{0}}, u[20][3] = {{0}};
    grains_at(g, grains_time(g), x, u);
    for (int i = 0; i < s->n; i++) {
        real y[3], v[3], at[3], swing[3];
        other_fly(o, i, grains_time(g), y, v);
        other_swing(o, grains_time(g), at, swing);
        for (int k = 0; k < s->box.dim; k++) {
            double away = x[i][k] - (double)(y[k] - at[k]), length = s->box.high[k] - s->box.low[k];
            if (s->box.periodic[k]) away -= length * round(away / length);
            close_to(away, 0, 1e-9, "place");
            close_to(u[i][k], (double)(v[k] - swing[k]), 1e-9, "velocity");
        }
    }
}

/* 200 impacts of 20 grains are those of the other integrator, which starts anew from the grains each 40 of them: by
 * then round-off has grown a thousandfold. Kinds: elastic; inelastic under gravity; shaken, too */
static void courses(void **state) {
    (void)state;
    struct walls *w = calloc(1, sizeof *w);
    struct other *o = calloc(1, sizeof *o);
    for (int q = 0; q < 3 * SHAPES; q++) {
        const int kind = q / SHAPES;
        build(w, q % SHAPES);
        struct facets *f = make_facets(w);
        struct scene *s = scene_in(f, 20, 7 + (uint64_t)q);
        double restitution[16], x[20][3] = {{0}}, u[20][3] = {{0}};
        for (int i = 0; i < 16; i++) restitution[i] = kind ? 0.9 : 1;
        s->box.wall_restitution = restitution;
        s->law.restitution = kind ? 0.8 : 1;
        if (kind) s->law.gravity[s->box.dim - 1] = -0.7;
        if (kind == 2) {
            s->box.shake[s->box.dim - 1] = 0.2;
            s->box.omega = 3;
            s->box.phase = 0.5;
        }
        struct grains *g = make(s);
        struct recorder *r = recorder();
        for (int n = 0; n < 200; n++) {
            if (n % 40 == 0) {
                grains_at(g, grains_time(g), x, u);
                other_start(o, w, s, grains_time(g), (const double(*)[3])x, (const double(*)[3])u);
            }
            while (r->n == n) grains_advance(g, HUGE_VAL, 1, &r->observer);
            close_to(r->impact[n].t, (double)other_step(o), 1e-9, "time of an impact");
            if (n % 40 == 39) compare_courses(g, o);
        }
        if (grains_counted(g)->walls < 40) fail_msg("%d impacts on walls", (int)grains_counted(g)->walls);
        grains_free(g);
        facets_free(f);
        free(r);
        free(s);
    }
    free(o);
    free(w);
}

/* Energy to round-off; the momentum is what gravity and the walls gave; no grain is ever outside */
static void budgets(void **state) {
    (void)state;
    struct walls *w = calloc(1, sizeof *w);
    for (int shape = 0; shape < SHAPES; shape++) {
        build(w, (enum shape)shape);
        struct facets *f = make_facets(w);
        struct scene *s = scene_in(f, 20, 3);
        struct facet_cells c = {.n = {1, 1, 1}};
        double before[3], after[3], x[20][3] = {{0}}, u[20][3], t = 0;
        const int last = s->box.dim - 1;
        s->law.gravity[last] = shape % 2 ? -0.3 : 0;
        memcpy(c.low, s->box.low, sizeof c.low);
        for (int k = 0; k < 3; k++) c.width[k] = k <= last ? s->box.high[k] - s->box.low[k] : 1;
        ok(facet_cells_make(f, 1, (double[3]){0}, &c));
        struct grains *g = make(s);
        const double energy = total(g, before);
        for (int piece = 0; piece < 300; piece++) {
            grains_advance(g, t += 0.37, INT64_MAX, NULL);
            grains_at(g, t, x, u);
            for (int i = 0; i < 20; i++) {
                if (facet_cells_nearest(f, &c, x[i], true) < 0.5 - 1e-13 || !facet_cells_inside(f, &c, x[i], 0.4))
                    fail_msg("shape %d, t = %g: grain %d is outside", shape, t, i);
            }
        }
        const double change = total(g, after) / energy - 1;
        /* an impact rounds the energy of one of n grains by up to 4 units in the last place: 1e-14 after 200 impacts */
        const double impacts = (double)(grains_counted(g)->pairs + grains_counted(g)->walls);
        close_to(change, 0, 4 * 0x1p-52 * impacts / s->n, "energy");
        for (int k = 0; k <= last; k++) {
            double given = s->law.mass * s->n * s->law.gravity[k] * t, all = 0;
            for (int p = 0; p < w->space.walls; p++) given -= grains_impulses(g)[p][k];
            for (int p = 0; p < w->space.walls; p++) all += fabs(grains_impulses(g)[p][k]);
            close_to(after[k] - before[k], given, 1e-12 * (all + fabs(before[k])), "momentum");
        }
        assert_true(grains_counted(g)->walls > 500);
        facet_cells_free(&c);
        grains_free(g);
        facets_free(f);
        free(s);
    }
    free(w);
}

/* In equilibrium the centres of grains press alike on all sides of the space they reach: with P of them, the virial is
 * 3 P V = 2 E + sum of impulse * distance / time, whatever the density (V of a tetrahedron shrunk by the radius) */
static void pressures(void **state) {
    (void)state;
    const double side = 12, edge = side * sqrt(2), inner = edge - 2 * sqrt(6) * 0.5, time = 4000;
    struct walls *w = calloc(1, sizeof *w);
    tetrahedron(w, side);
    turn_walls(w, 1, 0.7);
    finish_walls(w, 3, 0.5);
    struct facets *f = make_facets(w);
    struct scene *s = scene_in(f, 60, 5);
    struct grains *g = make(s);
    struct recorder *r = recorder();
    double p[3], area = sqrt(3) / 4 * inner * inner, volume = inner * inner * inner / (6 * sqrt(2));
    grains_advance(g, 50, INT64_MAX, NULL);
    double start[4], mean = (2 * total(g, p));
    for (int i = 0; i < 4; i++)
        start[i] = sqrt(pow(grains_impulses(g)[i][0], 2) + pow(grains_impulses(g)[i][1], 2) +
                        pow(grains_impulses(g)[i][2], 2));
    grains_advance(g, 50 + time, INT64_MAX, &r->observer);
    mean = (mean + r->virial / time) / (3 * volume);
    for (int i = 0; i < 4; i++) {
        double now = sqrt(pow(grains_impulses(g)[i][0], 2) + pow(grains_impulses(g)[i][1], 2) +
                          pow(grains_impulses(g)[i][2], 2));
        close_to((now - start[i]) / (time * area * mean), 1, 0.005, "pressure");
    }
    grains_free(g);
    facets_free(f);
    free(r);
    free(s);
    free(w);
}

/* A box of facets is the box of flat walls */
static void boxes(void **state) {
    (void)state;
    struct walls *w = calloc(1, sizeof *w);
    box_of_facets(w, (double[3]){6, 5, 7}, 1);
    finish_walls(w, 3, 0.5);
    struct facets *f = make_facets(w);
    struct scene *s = scene_in(f, 20, 9);
    struct recorder *r[2] = {recorder(), recorder()};
    s->law.gravity[1] = -0.5;
    for (int flat = 0; flat < 2; flat++) {
        if (flat) s->box.facets = NULL;
        for (int k = 0; k < 3; k++) s->box.restitution[k][0] = s->box.restitution[k][1] = 1;
        struct grains *g = make(s);
        while (r[flat]->n < 60) grains_advance(g, HUGE_VAL, 1, &r[flat]->observer);
        grains_free(g);
    }
    for (int i = 0; i < 60; i++) {
        close_to(r[0]->impact[i].t, r[1]->impact[i].t, 1e-10, "time");
        close_to(r[0]->impact[i].impulse, r[1]->impact[i].impulse, 1e-9, "impulse");
    }
    facets_free(f);
    free(r[0]);
    free(r[1]);
    free(s);
    free(w);
}

/* Saved and resumed after any impact, a run has the same bits */
static void resumed(void **state) {
    (void)state;
    struct walls *w = calloc(1, sizeof *w);
    build(w, FUNNEL);
    struct facets *f = make_facets(w);
    struct scene *s = scene_in(f, 30, 11);
    s->law.gravity[2] = -1;
    s->box.shake[2] = 0.1;
    s->box.omega = 4;
    struct grains *g = make(s), *h = make(s);
    for (int leg = 0; leg < 20; leg++) {
        const double t = 0.3 * (leg + 1);
        struct grains *next;
        grains_advance(g, t, INT64_MAX, NULL);
        grains_advance(h, t - 0.17, INT64_MAX, NULL);
        grains_advance(h, t, INT64_MAX, NULL);
        const struct grain_save save = {
            s->n, t, grains_all(h), grains_events(h), grains_ids(h), grains_counted(h), grains_impulses(h), NULL};
        ok(grains_resume(&s->box, &s->law, &save, &next));
        grains_free(h);
        h = next;
        assert_memory_equal(grains_all(g), grains_all(h), (size_t)s->n * sizeof(struct grain));
        assert_memory_equal(grains_impulses(g), grains_impulses(h), (size_t)w->space.walls * sizeof(double[3]));
    }
    grains_free(g);
    grains_free(h);
    facets_free(f);
    free(s);
    free(w);
}

/* A box without a lid: grains leave when their centres come to it, with their momentum and energy */
static void outlet(void **state) {
    (void)state;
    struct walls *w = calloc(1, sizeof *w);
    box_of_facets(w, (double[3]){6, 5, 7}, 1);
    finish_walls(w, 3, 0.5);
    for (int i = 0; i < w->n; i++) w->facet[i].open = w->facet[i].wall == 5;
    struct facets *f = make_facets(w);
    for (int kind = 0; kind < 2; kind++) {
        struct scene *s = scene_in(f, 40, 13);
        double before[3], after[3], left = 0, energy[2] = {0}, x[40][3], u[40][3];
        if (kind) s->law.gravity[2] = -0.05;
        s->x[0][2] = 6.9; /* half of it is out */
        struct grains *g = make(s), *h = make(s), *next;
        const double start = total(g, before);
        for (double t = 0.5; t < 60; t += 0.5) {
            grains_advance(g, t, INT64_MAX, NULL);
            grains_advance(h, t, INT64_MAX, NULL);
            const struct grain_save save = {
                s->n, t, grains_all(h), grains_events(h), grains_ids(h), grains_counted(h), grains_impulses(h), NULL};
            ok(grains_resume(&s->box, &s->law, &save, &next));
            grains_free(h);
            h = next;
            grains_at(g, t, x, u);
            for (int i = 0; i < s->n; i++) assert_true(isnan(x[i][2]) || x[i][2] <= 7);
        }
        assert_memory_equal(grains_all(g), grains_all(h), (size_t)s->n * sizeof(struct grain));
        assert_true(grains_present(g) == grains_present(h));
        const double(*rows)[3] = grains_impulses(g);
        for (int p = 0; p < 6; p++) {
            left += rows[6 + p][0];
            energy[0] += rows[6 + p][1];
            energy[1] += rows[6 + p][2];
            if (p < 5) assert_true(rows[6 + p][0] == 0);
        }
        assert_true(left == s->n - grains_present(g) && left > (kind ? 15 : 35));
        const double now = total(g, after);
        close_to(now + energy[0] + energy[1], start, 1e-12 * fabs(start), "energy");
        for (int k = 0; k < 2; k++) {
            double given = 0, all = 1;
            for (int p = 0; p < 6; p++) given += rows[p][k];
            for (int p = 0; p < 6; p++) all += fabs(rows[p][k]);
            close_to(after[k] + given, before[k], 1e-12 * all, "momentum");
        }
        grains_free(g);
        grains_free(h);
        free(s);
    }
    /* one grain alone leaves at the time of its parabola */
    struct scene *s = scene_in(f, 1, 1);
    struct grains *g;
    memcpy(s->x[0], (double[3]){3, 2, 1}, sizeof s->x[0]);
    memcpy(s->u[0], (double[3]){0.1, 0, 3}, sizeof s->u[0]);
    s->law.gravity[2] = -0.5;
    g = make(s);
    const double t = (3 - sqrt(9 - 2 * 0.5 * 6)) / 0.5;
    grains_advance(g, t - 1e-12, INT64_MAX, NULL);
    assert_int_equal(grains_present(g), 1);
    grains_advance(g, t + 1e-12, INT64_MAX, NULL);
    assert_int_equal(grains_present(g), 0);
    grains_advance(g, HUGE_VAL, 10, NULL);
    grains_free(g);
    free(s);
    facets_free(f);
    free(w);
}

struct rubbing { /* hears the impacts on wall 0 */
    struct grain_observer observer;
    const struct grain_box *box;
    int impacts, diffuse;
    double drag[3], work;
};
static void hear_rubbing(struct grain_observer *self, const struct grain_impact *i) {
    struct rubbing *r = (struct rubbing *)self;
    const struct facet *f = i->b < 0 ? grains_facet_of(r->box, i->b) : NULL;
    if (!f || f->wall != 0) return;
    const double along = i->drag[0] * i->normal[0] + i->drag[1] * i->normal[1] + i->drag[2] * i->normal[2];
    close_to(along, 0, 1e-12, "drag leads along the wall");
    r->impacts++;
    r->diffuse += i->drag[0] != 0 || i->drag[1] != 0;
    for (int k = 0; k < 3; k++) r->drag[k] += i->drag[k];
    r->work += i->work;
}

/* The part phi of the impacts on a rough wall that moves is diffuse, of disks half of it turned back; energy and
 * momentum balance with the work of the wall and the impulses; other walls stay smooth; pieces and restarts have the
 * same bits */
static void rough(void **state) {
    (void)state;
    for (int dim = 2; dim <= 3; dim++) {
        struct walls *w = calloc(1, sizeof *w);
        const double a[4][2] = {{0, 0}, {8, 0}, {8, 6}, {0, 6}};
        if (dim == 3) box_of_facets(w, (double[3]){6, 5, 7}, 1);
        for (int k = 0; dim == 2 && k < 4; k++) segment(w, a[k], a[(k + 1) % 4], k);
        finish_walls(w, dim, 0.5);
        struct facets *f = make_facets(w);
        struct scene *s = scene_in(f, 20, 5);
        const struct grain_rough all[6] = {{.phi = 0.4, .u = {dim == 2 ? 0.7 : 0, dim == 3 ? 0.7 : 0, 0}}};
        struct rubbing heard = {.observer = {hear_rubbing}, .box = &s->box};
        double before[3], after[3];
        s->box.rough = all;
        s->box.seed = 3;
        struct grains *g = make(s), *h = make(s), *next;
        const double start = total(g, before);
        for (int leg = 1; leg <= 40; leg++) {
            grains_advance(g, 10 * leg, INT64_MAX, &heard.observer);
            grains_advance(h, 10 * leg - 7, INT64_MAX, NULL);
            grains_advance(h, 10 * leg, INT64_MAX, NULL);
            const struct grain_save save = {s->n,          10 * leg,          grains_all(h),      grains_events(h),
                                            grains_ids(h), grains_counted(h), grains_impulses(h), NULL};
            ok(grains_resume(&s->box, &s->law, &save, &next));
            grains_free(h);
            h = next;
        }
        assert_memory_equal(grains_all(g), grains_all(h), (size_t)s->n * sizeof(struct grain));
        const double now = total(g, after), lost = grains_counted(g)->lost;
        close_to(now - start, -lost, 1e-12 * (fabs(lost) + heard.work), "energy");
        assert_true(heard.work > 0.01 && heard.impacts > 1000);
        const double part = dim == 2 ? 0.2 : 0.4, off = 4 * sqrt(part * (1 - part) / heard.impacts);
        close_to((double)heard.diffuse / heard.impacts, part, off, "part of the impacts that are diffuse");
        for (int k = 0; k < dim; k++) {
            double given = 0, sum = 1;
            for (int p = 0; p < w->space.walls; p++) given += grains_impulses(g)[p][k];
            for (int p = 0; p < w->space.walls; p++) sum += fabs(grains_impulses(g)[p][k]);
            close_to(after[k] + given, before[k], 1e-12 * sum, "momentum");
        }
        grains_free(g);
        grains_free(h);
        free(s);
        facets_free(f);
        free(w);
    }
}

/* A box that is fed: a grain comes in where there is room and a number, and flies on as if it had always been there;
 * grains that are made anew for more of them keep their course; what came in and was pushed is counted. */
static void inlet(void **state) {
    (void)state;
    struct walls *w = calloc(1, sizeof *w);
    box_of_facets(w, (double[3]){6, 5, 7}, 1);
    finish_walls(w, 3, 0.5);
    for (int i = 0; i < w->n; i++) w->facet[i].open = w->facet[i].wall == 5;
    struct facets *f = make_facets(w);
    struct scene *s = scene_in(f, 2, 1);
    struct grains *g;
    double x[4][3], u[4][3], before[3], after[3], at[3], v[3];
    const double down[3] = {0, 0, -1}, top[3] = {3, 2, 7 - 1e-6}, wall[3] = {0.2, 2, 6.5}, blocked[3] = {2, 2, 1.9};
    s->box.fed = true;
    memcpy(s->x[0], (double[3]){2, 2, 1}, sizeof s->x[0]);
    memcpy(s->x[1], (double[3]){4, 4, 1}, sizeof s->x[1]);
    for (int i = 0; i < 2; i++) memset(s->u[i], 0, sizeof s->u[i]);
    g = make(s);
    assert_true(grains_is_full(g) && !grains_enter(g, top, down, 0, 5));
    ok(grains_grow(&g, 4));
    assert_true(!grains_is_full(g) && grains_number(g) == 4 && grains_present(g) == 2);
    assert_true(!grains_enter(g, blocked, down, 0, 5) && !grains_enter(g, wall, down, 0, 5));
    const double start = total(g, before);
    assert_true(grains_enter(g, top, down, 0, 5) && grains_present(g) == 3 && !grains_enter(g, top, down, 0, 5));
    grains_advance(g, 2.5, INT64_MAX, NULL);
    ok(grains_grow(&g, 4)); /* in flight */
    grains_advance(g, 4, INT64_MAX, NULL);
    grains_at(g, 4, x, u);
    assert_true(isnan(x[3][0]) && x[2][0] == 3);
    close_to(x[2][2], 3, 2e-6, "flight");
    const int i = grains_covering(g, (double[3]){2.3, 2.3, 1.1}, at, v);
    assert_true(i >= 0 && at[0] == 2 && v[2] == 0 && grains_covering(g, (double[3]){2.6, 2, 1}, at, v) < 0);
    grains_push(g, i, (double[3]){0.5, 0, 0.25}, 5);
    const double now = total(g, after), *gave = grains_impulses(g)[5], *came = grains_impulses(g)[12 + 5];
    assert_true(came[0] == 1);
    close_to(now, start + came[1] + came[2], 1e-12, "energy");
    for (int k = 0; k < 3; k++) close_to(after[k] + gave[k], before[k], 1e-12, "momentum");
    close_to(came[1], s->law.mass * 0.5 * (1 + 0.3125), 1e-12, "what came");
    grains_free(g);
    free(s);
    facets_free(f);
    free(w);
}

static void refused(void **state) {
    (void)state;
    struct walls *w = calloc(1, sizeof *w);
    struct facets *f;
    struct grains *g;
    build(w, TETRAHEDRON);
    says(facets_make(&w->space, 3, w->facet, &f), "leave a gap: no facet goes on at the edge from (");
    w->facet[4] = w->facet[0];
    memcpy(w->facet[4].corner[1], w->facet[4].corner[0], sizeof(double[3]));
    says(facets_make(&w->space, 5, w->facet, &f), "facet 4 at (");
    build(w, STAR);
    says(facets_make(&w->space, 9, w->facet, &f), "leave a gap: no facet goes on at the corner (");
    f = make_facets(w);
    struct scene *s = scene_in(f, 2, 1);
    const struct {
        double x[2];
        const char *text;
    } bad[] = {{{7.2 * cos(PI / 5 + 0.2), 7.2 * sin(PI / 5 + 0.2)}, "grain 1 at ("}, /* between two points */
               {{4.2 * cos(PI / 5 + 0.2), 4.2 * sin(PI / 5 + 0.2)}, "cuts a wall"},
               {{20, 0}, "grain 1 is outside"}};
    for (int i = 0; i < 3; i++) {
        memcpy(s->x[1], bad[i].x, sizeof bad[i].x);
        says(grains_make(&s->box, &s->law, 2, (const double(*)[3])s->x, (const double(*)[3])s->u, 0, &g), bad[i].text);
    }
    s->law.diameter = 1.1;
    says(grains_make(&s->box, &s->law, 1, (const double(*)[3])s->x, (const double(*)[3])s->u, 0, &g),
         "made for grains of at most 1 m");
    facets_free(f);
    free(s);
    free(w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(courses), cmocka_unit_test(budgets), cmocka_unit_test(pressures),
        cmocka_unit_test(boxes),   cmocka_unit_test(resumed), cmocka_unit_test(outlet),
        cmocka_unit_test(rough),   cmocka_unit_test(inlet),   cmocka_unit_test(refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
