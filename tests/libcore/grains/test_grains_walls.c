/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Grains and walls: contacts with moving ones at the first root, hops on one at rest, a column that rests on one. */
#include "tests/libcore/grains/grains_scene.h"

/* Distance of a grain's surface to the wall of `side` at time t of a flight, in the frame at rest, by libm */
static long double gap(const struct scene *s, const struct grain *p, int side, long double t) {
    long double dt = t - p->t, x = p->x[1] + dt * (p->u[1] + s->law.gravity[1] * dt / 2);
    long double shift = s->box.shake[1] * cosl((long double)s->box.omega * t + s->box.phase), R = s->law.diameter / 2;
    return side ? s->box.high[1] + shift - x - R : x - s->box.low[1] - shift - R;
}
/* First contact after the flight's start, by small steps and halving; HUGE_VAL: none before `until` */
static double first_contact(const struct scene *s, const struct grain *p, int side, double until) {
    const long double step = 1e-4L;
    long double a = p->t, b = a;
    while (gap(s, p, side, a) <= 1e-10L) a = b += 1e-6L; /* just touched */
    while (gap(s, p, side, b) > 0) {
        a = b;
        b += step;
        if (b > until + step) return HUGE_VAL;
    }
    for (int i = 0; i < 80; i++) {
        long double middle = (a + b) / 2;
        if (gap(s, p, side, middle) > 0)
            a = middle;
        else
            b = middle;
    }
    return (double)b;
}

/* A ball between a shaken floor and lid: each flight ends at the first root, each impact is that of an infinite mass */
static void moving_floor(void **state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        struct scene *s = lattice(2, (int[3]){1, 1, 1}, 5, 1);
        s->box.periodic[1] = false;
        s->box.high[1] = kind == 1 ? 1.9 : 30;
        s->x[0][1] = 0.9;
        s->u[0][1] = kind == 2 ? -2 : 0.3;
        s->u[0][0] = 0.11;
        s->law.gravity[1] = kind == 2 ? 0 : -1;
        s->box.shake[1] = 0.37;
        s->box.omega = kind == 3 ? 11 : 2.5;
        s->box.phase = 0.3;
        s->box.restitution[1][0] = s->box.restitution[1][1] = kind == 3 ? 0.7 : 1;
        s->law.threshold = 1e-4;
        struct grains *g = make(s);
        struct recorder *r = recorder();
        struct grain last = grains_all(g)[0];
        for (int hits = 0; hits < 60 && grains_time(g) < 500; hits++) {
            while (r->n == hits && grains_time(g) < 500) {
                last = grains_all(g)[0];
                grains_advance(g, HUGE_VAL, 1, &r->observer);
            }
            if (r->n == hits) break;
            const struct grain_impact *i = &r->impact[hits];
            int side = (-1 - i->b) & 1;
            assert_true(i->a == 0 && (i->b == -3 || i->b == -4));
            close_to(i->t, first_contact(s, &last, side, i->t + 1e-3), 1e-12 * fmax(1, i->t), "time of contact");
            assert_true(first_contact(s, &last, !side, i->t - 1e-9) == HUGE_VAL);
            double w = -s->box.shake[1] * s->box.omega * sin(s->box.omega * i->t + s->box.phase);
            double v = last.u[1] + s->law.gravity[1] * (i->t - last.t) - w, e = s->box.restitution[1][side];
            close_to(grains_all(g)[0].u[1] - w, -e * v, 1e-11, "velocity after it");
        }
        if (r->n < 10) fail_msg("kind %d: %d impacts to t = %g", kind, r->n, grains_time(g));
        grains_free(g);
        free(r);
        free(s);
    }
}

/* Flat walls at rest: hops of a ball that loses, against the closed form; and one that lies there from the start */
static void hops(void **state) {
    (void)state;
    struct scene *s = lattice(3, (int[3]){1, 1, 1}, 5, 1);
    s->box.periodic[2] = false;
    s->box.restitution[2][0] = 0.8;
    s->law.gravity[2] = -2;
    s->x[0][2] = 0.5 + 1;
    memset(s->u, 0, sizeof s->u);
    struct grains *g = make(s);
    struct recorder *r = recorder();
    while (r->n < 30) grains_advance(g, HUGE_VAL, 1, &r->observer);
    double t = 1, v = 2;
    for (int i = 0; i < 30; i++) {
        close_to(r->impact[i].t, t, 1e-13 * t, "time of a hop");
        close_to(r->impact[i].impulse, 1.8 * v * s->law.mass, 1e-12, "impulse of a hop");
        v *= 0.8;
        t += v;
    }
    grains_advance(g, HUGE_VAL, 20000, NULL); /* beyond the collapse at t = 9 time still goes on */
    assert_true(grains_time(g) > 9);
    close_to(grains_all(g)[0].x[2], 0.5, 1e-12, "height at rest");
    grains_free(g);
    s->x[0][2] = 0.5;
    g = make(s);
    grains_advance(g, HUGE_VAL, 1000, NULL);
    assert_true(grains_time(g) > 1e-5);
    close_to(grains_all(g)[0].x[2], 0.5, 1e-12, "height at rest");
    grains_free(g);
    s->law.gravity[2] = 0; /* nothing ever happens */
    g = make(s);
    assert_true(grains_advance(g, HUGE_VAL, 10, NULL) == 0);
    assert_true(grains_advance(g, 7, 10, NULL) == 7 && grains_counted(g)->events == 0);
    grains_free(g);
    free(r);
    free(s);
}

/* A dilute elastic gas under gravity: the same temperature in both directions and at all heights, n ~ exp(-g y/T).
 * Samples lie some free times apart. */
static void column(void **state) {
    (void)state;
    enum { BINS = 4, SAMPLES = 400 };
    struct scene *s = lattice(2, (int[3]){20, 5, 1}, 20, 11);
    s->box.periodic[1] = false;
    s->box.high[1] = 1000;
    s->box.restitution[1][0] = s->box.restitution[1][1] = 1;
    s->law.gravity[1] = -1;
    for (int i = 0; i < s->n; i++) s->u[i][0] *= 7, s->u[i][1] *= 7;
    struct grains *g = make(s);
    double p[3], E = total(g, p), T = (E / (s->law.mass * s->n) - 0.5) / 2, x[100][3], u[100][3];
    double square[2] = {0}, above = 0;
    int bin[BINS] = {0};
    assert_int_equal(s->n, 100);
    for (int i = -20; i < SAMPLES; i++) {
        grains_advance(g, 40 * (i + 21), INT64_MAX, NULL);
        grains_at(g, grains_time(g), x, u);
        for (int j = 0; j < 100 && i >= 0; j++) {
            double below = 1 - exp(-(x[j][1] - 0.5) / T);
            bin[(int)(BINS * below)]++;
            for (int k = 0; k < 2; k++) square[k] += u[j][k] * u[j][k];
            if (below > 0.5) above += u[j][0] * u[j][0] + u[j][1] * u[j][1];
        }
    }
    double count = 100. * SAMPLES, sigma = sqrt(2 / count) * T;
    for (int k = 0; k < 2; k++) close_to(square[k] / count, T, 4 * sigma, "temperature of a direction");
    close_to(above / 2 / (bin[2] + bin[3]), T, 4 * sigma, "temperature above");
    for (int b = 0; b < BINS; b++) close_to(bin[b] * BINS / count, 1, 4 * sqrt((BINS - 1) / count), "profile");
    grains_free(g);
    free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(moving_floor), cmocka_unit_test(hops),
                                       cmocka_unit_test(column)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
