/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sheared boxes: courses against an integrator that looks at all images in short steps, budgets, restarts, refusals. */
#include "tests/libcore/grains/grains_scene.h"

typedef long double real;
struct brute {
    const struct scene *s;
    real x[100][3], u[100][3], t;
};

static real length_of(const struct brute *b, int k) {
    return b->s->box.high[k] - (real)b->s->box.low[k];
}

/* Flies all grains to t, and puts those that left the box back as their images */
static void brute_fly(struct brute *b, real t) {
    const real S = b->s->box.shear;
    for (int i = 0; i < b->s->n; i++) {
        for (int k = 0; k < b->s->box.dim; k++) b->x[i][k] += b->u[i][k] * (t - b->t);
        real over = floorl(b->x[i][1] / length_of(b, 1));
        b->x[i][1] -= over * length_of(b, 1);
        b->x[i][0] -= over * S * length_of(b, 1) * t;
        b->u[i][0] -= over * S * length_of(b, 1);
        for (int k = 0; k < b->s->box.dim; k++) b->x[i][k] -= length_of(b, k) * floorl(b->x[i][k] / length_of(b, k));
    }
    b->t = t;
}

/* The first contact of i with an image of j within dt; sets place and velocity of the image relative to i then */
static real brute_pair(const struct brute *b, int i, int j, real dt, real r[3], real v[3]) {
    const real S = b->s->box.shear, d = b->s->law.diameter;
    real first = dt;
    for (int image = 0; image < 3 * 5 * 3; image++) {
        const int up = image % 3 - 1, along = image / 3 % 5 - 2, deep = image / 15 - 1;
        real p[3], w[3], rr = 0, rv = 0, vv = 0;
        if (b->s->box.dim == 2 && deep) continue;
        for (int k = 0; k < 3; k++) {
            p[k] = b->x[j][k] - b->x[i][k];
            w[k] = b->u[j][k] - b->u[i][k];
        }
        p[1] += up * length_of(b, 1);
        p[0] += along * length_of(b, 0) + up * fmodl(S * length_of(b, 1) * b->t, length_of(b, 0));
        p[2] += deep * length_of(b, 2);
        w[0] += up * S * length_of(b, 1);
        for (int k = 0; k < 3; k++) {
            rr += p[k] * p[k];
            rv += p[k] * w[k];
            vv += w[k] * w[k];
        }
        const real c = fmaxl(rr - d * d, 0), square = rv * rv - vv * c;
        if (!(rv < 0 && square >= 0) || c / (sqrtl(square) - rv) >= first) continue;
        first = c / (sqrtl(square) - rv);
        for (int k = 0; k < 3; k++) {
            r[k] = p[k] + first * w[k];
            v[k] = w[k];
        }
    }
    return first;
}

/* Works off one impact; returns its time */
static real brute_step(struct brute *b) {
    const real step = 0.05L;
    for (;;) {
        real first = step, r[3] = {0}, v[3] = {0}, square = 0, normal = 0;
        int hit[2] = {-1, -1};
        for (int i = 0; i < b->s->n; i++)
            for (int j = 0; j < i; j++) {
                real p[3] = {0}, w[3] = {0};
                const real t = brute_pair(b, i, j, first, p, w);
                if (t >= first) continue;
                first = t;
                memcpy(r, p, sizeof r);
                memcpy(v, w, sizeof v);
                hit[0] = i;
                hit[1] = j;
            }
        const real at = b->t + first;
        for (int k = 0; k < 3; k++) {
            square += r[k] * r[k];
            normal += r[k] * v[k];
        }
        for (int k = 0; k < 3 && hit[0] >= 0; k++) { /* velocities change alike in all images */
            const real du = (1 + (real)b->s->law.restitution) / 2 * normal / square * r[k];
            b->x[hit[0]][k] -= du * first; /* so that the flight to `at` ends where the contact is */
            b->x[hit[1]][k] += du * first;
            b->u[hit[0]][k] += du;
            b->u[hit[1]][k] -= du;
        }
        brute_fly(b, at);
        if (hit[0] >= 0) return at;
    }
}

static void start(struct brute *b, const struct scene *s, double t, const double (*x)[3], const double (*u)[3]) {
    *b = (struct brute){.s = s, .t = t};
    for (int i = 0; i < s->n; i++)
        for (int k = 0; k < 3; k++) {
            b->x[i][k] = x[i][k];
            b->u[i][k] = u[i][k];
        }
}

/* Grains with the flow of the shear rate */
static struct scene *sheared(int dim, double spacing, double rate, uint64_t seed) {
    struct scene *s = lattice(dim, dim == 2 ? (const int[]){5, 4, 1} : (const int[]){4, 3, 3}, spacing, seed);
    s->box.shear = rate;
    for (int i = 0; i < s->n; i++) s->u[i][0] += rate * (s->x[i][1] - s->box.high[1] / 2);
    return s;
}

/* 120 impacts are those of the other integrator, which starts anew each 40 */
static void courses(void **state) {
    (void)state;
    struct brute *b = calloc(1, sizeof *b);
    const double rates[] = {0.5, -3, 0.02};
    for (int q = 0; q < 6; q++) {
        struct scene *s = sheared(2 + q % 2, q % 2 ? 1.4 : 1.25, rates[q / 2], 5 + (uint64_t)q);
        double x[100][3] = {{0}}, u[100][3] = {{0}};
        s->law.restitution = 0.9;
        struct grains *g = make(s);
        struct recorder *r = recorder();
        for (int n = 0; n < 120; n++) {
            if (n % 40 == 0) {
                grains_at(g, grains_time(g), x, u);
                start(b, s, grains_time(g), (const double(*)[3])x, (const double(*)[3])u);
            }
            while (r->n == n) grains_advance(g, HUGE_VAL, 1, &r->observer);
            close_to(r->impact[n].t, (double)brute_step(b), 1e-9, "time of an impact");
        }
        grains_at(g, grains_time(g), x, u);
        for (int i = 0; i < s->n; i++) {
            close_to(x[i][1] - (double)b->x[i][1], 0, 1e-9, "height");
            close_to(u[i][0] - (double)b->u[i][0], 0, 1e-8, "velocity");
        }
        grains_free(g);
        free(r);
        free(s);
    }
    free(b);
}

/* The energy is what the ends did less what impacts took; the momentum relative to the flow stays */
static void budgets(void **state) {
    (void)state;
    for (int dim = 2; dim < 4; dim++) {
        struct scene *s = sheared(dim, 1.5, 0.7, 3);
        double before[3], after[3], x[100][3] = {{0}}, u[100][3] = {{0}}, flow = 0;
        s->law.restitution = 0.8;
        struct grains *g = make(s);
        const double energy = total(g, before);
        grains_advance(g, 300, INT64_MAX, NULL);
        const double now = total(g, after), given = grains_work(g) - grains_counted(g)->lost;
        close_to(now - energy, given, 1e-12 * (grains_work(g) + grains_counted(g)->lost), "energy");
        assert_true(grains_work(g) > 10 * energy && grains_counted(g)->pairs > 3000);
        grains_at(g, grains_time(g), x, u);
        for (int i = 0; i < s->n; i++) flow += s->law.mass * (u[i][0] - 0.7 * (x[i][1] - s->box.high[1] / 2));
        close_to(flow, 0, 1e-10, "momentum relative to the flow");
        for (int k = 1; k < dim; k++) close_to(after[k], before[k], 1e-10, "momentum across it");
        grains_free(g);
        free(s);
    }
}

/* Saved and resumed at any time, a run has the same bits */
static void resumed(void **state) {
    (void)state;
    struct scene *s = sheared(3, 1.4, 1, 9);
    s->law.restitution = 0.9;
    struct grains *g = make(s), *h = make(s);
    for (int leg = 0; leg < 20; leg++) {
        const double t = 0.4 * (leg + 1);
        struct grains *next;
        grains_advance(g, t, INT64_MAX, NULL);
        grains_advance(h, t - 0.13, INT64_MAX, NULL);
        grains_advance(h, t, INT64_MAX, NULL);
        const struct grain_save save = {
            s->n, t, grains_all(h), grains_events(h), grains_ids(h), grains_counted(h), grains_impulses(h), NULL};
        ok(grains_resume(&s->box, &s->law, &save, &next));
        grains_free(h);
        h = next;
        assert_memory_equal(grains_all(g), grains_all(h), (size_t)s->n * sizeof(struct grain));
        assert_true(grains_work(g) == grains_work(h));
    }
    grains_free(g);
    grains_free(h);
    free(s);
}

static void refused(void **state) {
    (void)state;
    struct scene *s = sheared(2, 1.3, 1, 9);
    struct grains *g;
    s->law.gravity[1] = -1;
    says(grains_make(&s->box, &s->law, s->n, (const double(*)[3])s->x, (const double(*)[3])s->u, 0, &g),
         "without gravity");
    s->law.gravity[1] = 0;
    s->box.periodic[0] = false;
    says(grains_make(&s->box, &s->law, s->n, (const double(*)[3])s->x, (const double(*)[3])s->u, 0, &g),
         "periodic along all axes");
    s->box.periodic[0] = true;
    s->box.high[0] = 3.5;
    says(grains_make(&s->box, &s->law, 1, (const double(*)[3])s->x, (const double(*)[3])s->u, 0, &g),
         "at least 4 diameters, 4 m, long along axis 0");
    free(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(courses), cmocka_unit_test(budgets), cmocka_unit_test(resumed),
                                       cmocka_unit_test(refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
