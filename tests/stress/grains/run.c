/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hard grains in random rooms: none is ever outside, or in a wall, and energy is kept (tests/stress/README.md). */
#include "libcore/grains/grains.h"
#include "tests/stress/grains/rooms.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 150, EVENTS = 3000 };
static const char *const shape_names[ROOM_SHAPES] = {"star", "shell", "lathe", "polygon", "pipe"};

struct problem {
    struct observer { /* its first member hears of impacts */
        struct grain_observer base;
        struct problem *problem;
    } ear;
    uint64_t number;
    struct room room;
    struct grain_box box;
    struct grain_law law;
    double restitution, (*x)[3], (*u)[3]; /* restitution: of the wall */
    int n;
    int64_t heard, every; /* impacts; one in `every` is judged */
    double worst, bad;    /* largest miss over the bound of rounding: depth in a wall, or of a contact; > 1: bad */
    struct facets *walls;
    struct grains *grains;
};

static double length_of(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}
static double size_of(const struct problem *p, int number) {
    return p->law.kinds.n && number >= p->law.kinds.first[1] ? p->law.kinds.size[1] : 1;
}

/* A place is rounded by eps of the room's extent, and by eps of the time that has gone times its speed and
 * that of the walls; a contact is found from a few of such places. */
static double rounding(const struct problem *p, double speed) {
    const double extent = fmax(length_of(p->room.space.low), length_of(p->room.space.high));
    const double swing = p->box.omega * p->box.shake[p->box.dim - 1];
    return 4 * 0x1p-52 * (extent + (speed + swing) * grains_time(p->grains));
}

/* No grain is in a wall; in an impact on it they touch. */
static void judge(struct problem *p, const double x[3], double radius, double speed, bool touches) {
    const double miss = (radius - room_depth(&p->room, x)) / rounding(p, speed);
    p->worst = fmax(p->worst, touches ? fabs(miss) : miss);
}

static void hear(struct grain_observer *self, const struct grain_impact *i) {
    struct problem *p = ((struct observer *)self)->problem;
    if (p->heard++ % p->every) return;
    const int32_t *id = grains_ids(p->grains);
    const int who[2] = {i->a, i->b};
    double speed = 0, r[3];
    for (int q = 0; q < 2 && who[q] >= 0; q++) {
        const double own = length_of(grains_all(p->grains)[who[q]].u);
        judge(p, i->x[q], 0.5 * p->law.diameter * size_of(p, id[who[q]]), own, i->b < 0);
        speed += own;
    }
    for (int k = 0; k < 3; k++) r[k] = i->x[1][k] - i->x[0][k];
    if (i->b >= 0) p->worst = fmax(p->worst, fabs(length_of(r) - i->branch) / rounding(p, speed));
}

static void judge_all(struct problem *p) {
    grains_at(p->grains, grains_time(p->grains), p->x, p->u);
    for (int i = 0; i < p->n; i++) judge(p, p->x[i], 0.5 * p->law.diameter * size_of(p, i), length_of(p->u[i]), false);
}

/* Puts up to `most` grains at random places that are free. */
static void fill(struct problem *p, struct seed *s, int most) {
    const struct facet_space *space = &p->room.space;
    const double d = p->law.diameter;
    for (int tries = 0; tries < 300 * most && p->n < most; tries++) {
        double *x = p->x[p->n];
        bool free = true;
        for (int k = 0; k < 3; k++) x[k] = k < space->dim ? seed_uniform(s, space->low[k], space->high[k]) : 0;
        for (int i = 0; i < p->n && free; i++) {
            double r[3];
            for (int k = 0; k < 3; k++) r[k] = p->x[i][k] - x[k];
            if (space->periodic[0])
                r[0] -= (space->high[0] - space->low[0]) * round(r[0] / (space->high[0] - space->low[0]));
            free = length_of(r) > d * (1 + 1e-6);
        }
        if (!free || room_depth(&p->room, x) < 0.5 * d * (1 + 1e-6)) continue;
        for (int k = 0; k < space->dim; k++) p->u[p->n][k] = seed_uniform(s, -1.7, 1.7);
        p->n++;
    }
}

static void set_kinds(struct problem *p, struct seed *s) {
    struct grain_kinds *k = &p->law.kinds;
    const double e = p->law.restitution, size = seed_uniform(s, 0.3, 0.9);
    *k = (struct grain_kinds){.n = 2, .first = {0, p->n / 2, p->n}, .size = {1, size}, .mass = {1, size * size}};
    for (int a = 0; a < 2; a++)
        for (int b = 0; b < 2; b++) k->restitution[a][b] = e;
}

/* One room in three is shaken and takes energy; the others are at rest: half of them elastic, half with gravity. */
static status make(struct problem *p, struct seed *s) {
    struct facet_space *space = &p->room.space;
    const bool shaken = seed_chance(s, 1. / 3), cools = shaken || seed_chance(s, 0.5);
    const int most = 10 + seed_below(s, MOST - 10), down = space->dim - 1;
    const double packing = seed_uniform(s, 0.02, 0.2) * space->volume / most;
    p->law =
        (struct grain_law){.mass = 1, .restitution = cools ? seed_uniform(s, 0.7, 1) : 1, .threshold = cools ? 0.1 : 0};
    p->law.diameter = space->dim == 2 ? sqrt(4 / 3.1415927 * packing) : cbrt(6 / 3.1415927 * packing);
    if (space->periodic[0]) p->law.diameter = fmin(p->law.diameter, (space->high[0] - space->low[0]) / 3.1);
    space->reach = 0.5 * p->law.diameter;
    p->restitution = cools ? seed_uniform(s, 0.7, 1) : 1;
    if (seed_chance(s, 0.5)) p->law.gravity[down] = -seed_uniform(s, 0.1, 5);
    fill(p, s, most);
    if (p->n > 4 && seed_chance(s, 1. / 3)) set_kinds(p, s);
    TRY(facets_make(space, p->room.n, p->room.facet, &p->walls));
    p->box = (struct grain_box){.dim = space->dim, .facets = p->walls, .wall_restitution = &p->restitution};
    for (int k = 0; k < 3; k++) {
        p->box.low[k] = space->low[k];
        p->box.high[k] = space->high[k];
        p->box.periodic[k] = space->periodic[k];
    }
    if (shaken) {
        p->box.shake[down] = seed_uniform(s, 0.01, 0.3);
        p->box.omega = seed_uniform(s, 3, 20);
    }
    return grains_make(&p->box, &p->law, p->n, (const double(*)[3])p->x, (const double(*)[3])p->u, 0, &p->grains);
}

static double energy(const struct problem *p, double *scale) {
    double kinetic, potential, momentum[3];
    grains_energy(p->grains, &kinetic, &potential, momentum);
    *scale = kinetic + fabs(potential);
    return kinetic + potential + grains_counted(p->grains)->lost;
}

/* The energy that n impacts may gain or lose by rounding: each some units in the last place of the energy of a grain,
 * and under gravity what its place is rounded by, which goes up and down alike. */
static double energy_rounding(const struct problem *p, double n, double scale) {
    const double each = scale / p->n, gravity = fabs(p->law.gravity[p->box.dim - 1]);
    return 2 * 0x1p-52 * (n + p->n) * each + sqrt(n) * gravity * rounding(p, sqrt(2 * each));
}

/* Advances to that many impacts. */
static void advance(struct problem *p, int64_t impacts) {
    const struct grain_counts *c = grains_counted(p->grains);
    double largest, scale;
    const double start = energy(p, &largest);
    for (int64_t batch = 0; c->pairs + c->walls < impacts && batch < 10 + 20 * impacts / EVENTS && p->worst <= 1;
         batch++) {
        grains_advance(p->grains, HUGE_VAL, EVENTS, &p->ear.base);
        judge_all(p);
    }
    const double change = fabs(energy(p, &scale) - start);
    if (p->box.omega == 0) p->bad = change / energy_rounding(p, (double)(c->pairs + c->walls), fmax(largest, scale));
}

static status run(struct problem *p, int64_t impacts, bool verbose, struct grain_counts *sum) {
    struct seed s = seed_start(100, p->number);
    room_make((enum room_shape)(p->number % ROOM_SHAPES), &s, &p->room);
    TRY(make(p, &s));
    p->ear = (struct observer){{hear}, p};
    judge_all(p);
    advance(p, impacts);
    const struct grain_counts *c = grains_counted(p->grains);
    sum->pairs += c->pairs;
    sum->walls += c->walls;
    const bool few = c->pairs + c->walls < impacts;
    if (verbose || p->worst > 1 || p->bad > 1 || few)
        printf("room %d, %s: %d facets, %d grains, e %.2f, %s%s%s t = %.4g: %lld + %lld impacts; off by %.2g, "
               "energy "
               "%.2g of the bound of rounding%s\n",
               (int)p->number, shape_names[p->room.shape], p->room.n, p->n, p->law.restitution,
               p->box.omega > 0 ? "shaken, " : "", p->law.gravity[p->box.dim - 1] < 0 ? "gravity, " : "",
               p->law.kinds.n ? "two sizes," : "", grains_time(p->grains), (long long)c->pairs, (long long)c->walls,
               p->worst, p->bad, few && p->worst <= 1 ? "; too few impacts" : "");
    if (p->worst > 1 || p->bad > 1 || few) return fail(ERR_STATE, "room %d failed", (int)p->number);
    return OK;
}

static status run_one(uint64_t number, int64_t impacts, int64_t every, bool verbose, struct grain_counts *sum) {
    struct problem *p;
    TRY(allocate(&p, 1, sizeof *p, "problem"));
    p->number = number;
    p->every = every;
    status e = allocate(&p->x, MOST, sizeof *p->x, "grains");
    if (!e) e = allocate(&p->u, MOST, sizeof *p->u, "grains");
    if (!e) e = run(p, impacts, verbose, sum);
    grains_free(p->grains);
    facets_free(p->walls);
    free(p->x);
    free(p->u);
    free(p);
    return e;
}

int main(int argc, char **argv) {
    int64_t from = 0, rooms = 50, impacts = 1000000, every = 20;
    bool verbose = false, used = argc % 2;
    struct grain_counts sum = {.pairs = 0};
    int failed = 0;
    for (int i = 1; i + 1 < argc; i += 2) {
        const char *names[] = {"-from", "-rooms", "-impacts", "-every", "-verbose"};
        int64_t *to[] = {&from, &rooms, &impacts, &every}, value = atoll(argv[i + 1]);
        int q = 0;
        while (q < 5 && strcmp(argv[i], names[q]) != 0) q++;
        used = used && q < 5;
        if (q < 4) *to[q] = value;
        if (q == 4) verbose = value != 0;
    }
    if (!used || rooms < 1 || every < 1) {
        fprintf(stderr,
                "stress_rooms [-from N] [-rooms 50] [-impacts 1000000] [-every 20] [-verbose 0]: impacts of all "
                "rooms; one in 20 is judged\n");
        return 2;
    }
    for (int64_t i = from; i < from + rooms; i++) {
        status e = run_one((uint64_t)i, impacts / rooms, every, verbose, &sum);
        if (e) {
            failed++;
            status_print(e, true);
            status_free(e);
        }
    }
    printf("%d rooms, %lld impacts of pairs and %lld on walls: %d failed\n", (int)rooms, (long long)sum.pairs,
           (long long)sum.walls, failed);
    return failed > 0;
}
