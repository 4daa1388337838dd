/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts per second of the event-driven grains: bench_grains [disks|spheres|many|bed|layer|walls|room|all] [impacts].
 * Lattices with random velocities; the first tenth of the impacts melts them and is not timed. */
#include "libcore/grains/grains.h"
#include "tests/bench/clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct scene {
    const char *name;
    int dim, n[3];  /* lattice cells: square with one grain, face-centred cubic with four */
    double packing; /* of the lattice */
    double restitution;
    bool bed; /* gravity 1 along -y, walls below and high above, diameter 1 */
    double T, shake;
    int64_t impacts;
    int facets; /* > 0: walls all around, of facets: the number of squares, cut in two, along each side; < 0: flat ones
                 */
};
static const struct scene scenes[] = {
    {"disks", 2, {50, 60, 1}, 0.5, 1, false, 1, 0, 3000000, 0},
    {"spheres", 3, {15, 10, 5}, 0.26, 1, false, 1, 0, 3000000, 0},
    {"many", 3, {36, 36, 36}, 0.26, 0.9, false, 1, 0, 2500000, 0},
    {"walls", 3, {36, 36, 36}, 0.26, 0.9, false, 1, 0, 2500000, -1},
    {"room", 3, {36, 36, 36}, 0.26, 0.9, false, 1, 0, 2500000, 29}, /* 10,092 facets */
    {"bed", 3, {66, 11, 66}, 0.62, 0.9, true, 0.1, 0, 5000000, 0},
    {"layer", 2, {314, 6, 1}, 0.76, 0.75, true, 0.1, 5.57, 3000000, 0}, /* 2.75 g, where layers show waves */
};

static uint64_t state = 88172645463325252u;
static double uniform(void) {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (double)(state >> 11) * 0x1p-53;
}

/* A lattice of the packing fraction, grains of diameter 1, and its box */
static int lattice(const struct scene *s, struct grain_box *box, double (*x)[3], double (*u)[3]) {
    static const double fcc[4][3] = {{.25, .25, .25}, {.75, .75, .25}, {.75, .25, .75}, {.25, .75, .75}};
    const double pi = 3.14159265358979323846;
    double a = s->dim == 2 ? sqrt(pi / 4 / s->packing) : cbrt(4 * pi / 6 / s->packing);
    int n = 0, basis = s->dim == 2 ? 1 : 4;
    *box = (struct grain_box){.dim = s->dim, .periodic = {true, true, true}};
    for (int k = 0; k < s->dim; k++) box->high[k] = s->n[k] * a;
    for (int cell = 0; cell < s->n[0] * s->n[1] * s->n[2]; cell++)
        for (int q = 0; q < basis; q++, n++) {
            int at[3] = {cell % s->n[0], cell / s->n[0] % s->n[1], cell / s->n[0] / s->n[1]};
            for (int k = 0; k < s->dim; k++) {
                x[n][k] = (at[k] + (s->dim == 2 ? 0.5 : fcc[q][k])) * a;
                u[n][k] = sqrt(12 * s->T) * (uniform() - 0.5);
            }
        }
    if (s->bed) {
        box->periodic[1] = false;
        for (int i = 0; i < n; i++) x[i][1] += 0.2;
        box->high[1] = s->shake > 0 ? 60 : 5 * box->high[1];
        box->shake[1] = s->shake;
        box->omega = s->shake > 0 ? sqrt(2.75 / s->shake) : 0;
        box->restitution[1][0] = box->restitution[1][1] = s->shake > 0 ? 1 : 0.9;
    }
    for (int i = n - 1; i > 0; i--) { /* in no order, as after a long run */
        int j = (int)(uniform() * (i + 1));
        for (int k = 0; k < 3; k++) {
            double swap = x[i][k];
            x[i][k] = x[j][k];
            x[j][k] = swap;
        }
    }
    return n;
}

/* Puts walls around the grains, half a diameter beyond the lattice. */
static status wall_in(const struct scene *s, struct grain_box *box, struct facets **out) {
    const int m = s->facets, most = 12 * m * m;
    struct facet_space space = {.dim = 3, .volume = 1, .reach = 0.5, .walls = 6};
    struct facet *list;
    int n = 0;
    for (int k = 0; k < 3; k++) {
        box->periodic[k] = false;
        box->restitution[k][0] = box->restitution[k][1] = 1;
        space.low[k] = box->low[k] -= 0.5;
        space.high[k] = box->high[k] += 0.5;
        space.volume *= box->high[k] - box->low[k];
    }
    *out = NULL;
    if (m < 0) return OK;
    TRY(allocate(&list, most, sizeof *list, "facets"));
    for (int side = 0; side < 6; side++)
        for (int half = 0; half < 2 * m * m; half++) {
            const int k = side / 2, p = (k + 1) % 3, q = (k + 2) % 3, i = half / 2 % m, j = half / 2 / m;
            /* corners that are right-handed about axis k, the other way at the low end */
            const int at[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
            struct facet *f = &list[n++];
            f->wall = side;
            for (int c = 0; c < 3; c++) {
                const int *corner = at[half % 2][side & 1 ? c : 2 - c];
                f->corner[c][k] = side & 1 ? box->high[k] : box->low[k];
                f->corner[c][p] = box->low[p] + (box->high[p] - box->low[p]) * (i + corner[0]) / m;
                f->corner[c][q] = box->low[q] + (box->high[q] - box->low[q]) * (j + corner[1]) / m;
            }
        }
    status e = facets_make(&space, n, list, out);
    free(list);
    box->facets = *out;
    return e;
}

/* Kinetic, potential and what impacts took: constant in a box at rest */
static double balance(const struct grains *g) {
    double kinetic, potential, momentum[3];
    grains_energy(g, &kinetic, &potential, momentum);
    return kinetic + potential + grains_counted(g)->lost;
}

static status run(const struct scene *s, int64_t impacts) {
    struct grain_law law = {
        .diameter = 1, .mass = 1, .restitution = s->restitution, .threshold = s->shake > 0 ? 0.03 : 1e-3};
    struct grain_box box;
    struct grains *g;
    struct facets *walls = NULL;
    double(*x)[3], (*u)[3];
    long most = 4L * s->n[0] * s->n[1] * s->n[2];
    if (s->bed) law.gravity[1] = -1;
    TRY(allocate(&x, most, sizeof *x, "places"));
    TRY(allocate(&u, most, sizeof *u, "velocities"));
    int n = lattice(s, &box, x, u);
    if (s->facets) TRY(wall_in(s, &box, &walls));
    double made = cpu_seconds();
    TRY(grains_make(&box, &law, n, (const double(*)[3])x, (const double(*)[3])u, 0, &g));
    made = cpu_seconds() - made;
    const struct grain_counts *c = grains_counted(g);
    while (c->pairs < impacts / 10) grains_advance(g, HUGE_VAL, n, NULL);
    struct grain_counts old = *c;
    double energy = balance(g), seconds = cpu_seconds();
    while (c->pairs - old.pairs < impacts) grains_advance(g, HUGE_VAL, 10000, NULL);
    seconds = cpu_seconds() - seconds;
    double pairs = (double)(c->pairs - old.pairs), events = (double)(c->events - old.events);
    printf("%-8s %7d grains: %6.3f million impacts/s, %6.3f million events/s (%.2f an impact), %.0f bytes a grain, "
           "made in %.2f s, t = %.6g, lost %.17g",
           s->name, n, 1e-6 * pairs / seconds, 1e-6 * events / seconds, events / pairs, grains_bytes(n, s->dim) / n,
           made, grains_time(g), c->lost);
    if (s->shake == 0) printf(", energy changed by %.2g", balance(g) / energy - 1);
    printf("\n");
    grains_free(g);
    facets_free(walls);
    free(x);
    free(u);
    return OK;
}

int main(int argc, char **argv) {
    const char *which = argc > 1 ? argv[1] : "all";
    status s = OK;
    for (int i = 0; !s && i < (int)(sizeof scenes / sizeof *scenes); i++)
        if (!strcmp(which, "all") || !strcmp(which, scenes[i].name))
            s = run(&scenes[i], argc > 2 ? atoll(argv[2]) : scenes[i].impacts);
    int code = status_print(s, true);
    status_free(s);
    return code;
}
